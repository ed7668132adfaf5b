#include "bench/sections/single_builds.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/worlds/random.h"
#include "bench/worlds/workload.h"
#include "halfspace/halfspace.h"

namespace halfspace::bench {
namespace {

// With 256 in turn most calls take half as long, because a branch predictor
// learns them.
constexpr std::size_t kShapes = kTimedQueries;
constexpr std::size_t kCallsOfRun = 256;

constexpr std::size_t kPointsOfSet = 64;
constexpr std::size_t kPieces = 16;

// Random numbers, and the shapes that a case makes of them.
struct Shapes {
  std::vector<Point3> a{kShapes};
  std::vector<Point3> b{kShapes};
  std::vector<Point3> c{kShapes};
  std::vector<float> length = std::vector<float>(kShapes);
  std::vector<Aabo3> bound{kShapes};

  Shapes() {
    Random random(11);
    const auto point = [&] {
      Point3 p;
      for (float& x : p) x = 50.0f * random.Signed();
      return p;
    };
    for (std::size_t i = 0; i < kShapes; ++i) {
      a[i] = point();
      b[i] = point();
      c[i] = point();
      length[i] = 1.25f + 0.75f * random.Signed();
      bound[i] = BoundSegment(Segment3{a[i], b[i]});
    }
  }

  OrientedBox3 Box(std::size_t i) const {
    return {a[i], {b[i], c[i], a[i]}, {length[i], length[i], length[i]}};
  }

  Affine3 Map(std::size_t i) const { return {{b[i], c[i], a[i]}, c[i]}; }

  // Around a[i], closed: a cube whose faces lean by a little.
  std::array<HalfSpace3, 6> Planes(std::size_t i) const {
    std::array<HalfSpace3, 6> planes{};
    for (std::size_t f = 0; f < planes.size(); ++f) {
      Point3 normal{};
      for (std::size_t k = 0; k < 3; ++k) normal[k] = 0.002f * b[i][k];
      normal[f / 2] += f % 2 == 0 ? 1.0f : -1.0f;
      float offset = length[i];
      for (std::size_t k = 0; k < 3; ++k) offset -= normal[k] * a[i][k];
      planes[f] = {normal, offset};
    }
    return planes;
  }
};

// The bits of a minimum, so that no call is left out.
template <typename Bound>
std::uint32_t Digest(const Bound& bound) {
  return std::bit_cast<std::uint32_t>(bound.min.back());
}

// build(shapes, i) returns the bound of shape i.
template <typename Build>
Case CaseOf(const char* name, const std::shared_ptr<const Shapes>& shapes,
            std::size_t items_per_call, const Build& build) {
  Case c;
  c.name = std::string("single/") + name;
  c.group = "single";
  c.items = static_cast<double>(kCallsOfRun * items_per_call);
  c.check = [shapes, build]() -> std::string {
    for (std::size_t i = 0; i < kCallsOfRun; ++i) {
      using Bound = decltype(build(*shapes, i));
      if (build(*shapes, i) == Bound::Everything()) {
        return "shape " + std::to_string(i) + " was not bounded";
      }
    }
    return {};
  };
  c.run = [shapes, build, next = std::size_t{0}]() mutable {
    std::uint32_t digest = 0;
    for (std::size_t i = 0; i < kCallsOfRun; ++i) {
      digest ^= Digest(build(*shapes, next));
      next = next + 1 == kShapes ? 0 : next + 1;
    }
    KeepResult(digest);
  };
  return c;
}

}  // namespace

std::vector<Case> SingleBuildCases() {
  const auto shapes = std::make_shared<const Shapes>();
  std::vector<Case> cases;
  const auto add = [&](const char* name, const auto& build,
                       std::size_t items = 1) {
    cases.push_back(CaseOf(name, shapes, items, build));
  };
  using S = Shapes;
  add("BoundPoint",
      [](const S& s, std::size_t i) { return BoundPoint<3>(s.a[i]); });
  add(
      "BoundPoints, a point",
      [](const S& s, std::size_t i) {
        const std::size_t first = i % (kShapes - kPointsOfSet);
        return BoundPoints(Points3{s.a[first].data(), kPointsOfSet});
      },
      kPointsOfSet);
  add("BoundSegment", [](const S& s, std::size_t i) {
    return BoundSegment(Segment3{s.a[i], s.b[i]});
  });
  add("BoundTriangle", [](const S& s, std::size_t i) {
    return BoundTriangle(Triangle3{s.a[i], s.b[i], s.c[i]});
  });
  add("BoundAabb",
      [](const S& s, std::size_t i) { return BoundAabb(s.bound[i].aabb()); });
  add("BoundOrientedBox",
      [](const S& s, std::size_t i) { return BoundOrientedBox(s.Box(i)); });
  add("BoundSphere", [](const S& s, std::size_t i) {
    return BoundSphere(Sphere3{s.a[i], s.length[i]});
  });
  add("BoundCapsule", [](const S& s, std::size_t i) {
    return BoundCapsule(Capsule3{s.a[i], s.b[i], s.length[i]});
  });
  add("BoundRay", [](const S& s, std::size_t i) {
    return BoundRay(Ray3{s.a[i], s.b[i], s.length[i]});
  });
  add(
      "BoundSegmentPieces, a piece",
      [](const S& s, std::size_t i) {
        std::array<Aabo3, kPieces> pieces;
        BoundSegmentPieces<3>({s.a[i], s.b[i]}, pieces);
        return pieces.back();
      },
      kPieces);
  add("BoundFrustum",
      [](const S& s, std::size_t i) { return BoundFrustum(s.Planes(i)); });
  add("BoundTransformed, a point", [](const S& s, std::size_t i) {
    return BoundTransformed(Points3{s.a[i].data(), 1}, s.Map(i));
  });
  add("BoundTransformed, a box", [](const S& s, std::size_t i) {
    return BoundTransformed(s.bound[i].aabb(), s.Map(i));
  });
  add("Merge", [](const S& s, std::size_t i) {
    return Merge(s.bound[i], s.bound[kShapes - 1 - i]);
  });
  add("Inflate", [](const S& s, std::size_t i) {
    return Inflate(s.bound[i], s.length[i]);
  });
  add("InflateByBox", [](const S& s, std::size_t i) {
    return InflateByBox(s.bound[i], s.length[i]);
  });
  add("Translate",
      [](const S& s, std::size_t i) { return Translate(s.bound[i], s.c[i]); });
  add("TranslateVertices", [](const S& s, std::size_t i) {
    return TranslateVertices(s.bound[i], s.c[i]);
  });
  add("Scale",
      [](const S& s, std::size_t i) { return Scale(s.bound[i], s.length[i]); });
  add("Sweep",
      [](const S& s, std::size_t i) { return Sweep(s.bound[i], s.c[i]); });
  add("Circumscribe", [](const S& s, std::size_t i) {
    return Circumscribe(s.bound[i].down());
  });
  return cases;
}

}  // namespace halfspace::bench

// Bulk builders next to a copy of as many bytes, and the builders of one shape.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/inner/target_loops.h"
#include "bench/sections/contest.h"
#include "bench/worlds/random.h"
#include "bench/worlds/workload.h"
#include "halfspace/halfspace.h"

namespace halfspace::bench {
namespace {

// A build takes long enough for less time than the scans are given.
Effort ShareOf(Effort effort) {
  effort.seconds_per_repetition /= 5.0;
  return effort;
}

// What a bulk builder bounds: as many shapes as take about `all_bytes` with
// their bounds, where the objects of a workload lie.
struct Source {
  Source(const char* name, std::size_t bytes_of_shape, std::size_t all_bytes)
      : shapes(name), bytes(bytes_of_shape + sizeof(Aabo3)) {
    constexpr std::size_t kStep = 128;
    objects = std::max(kStep, all_bytes / bytes / kStep * kStep);
    built.Resize(objects);
  }

  const char* shapes;
  std::size_t bytes;  // of an object, read and written
  std::size_t objects = 0;
  AaboWorld3 built;
  std::function<Target(const FitOptions& options, AaboPlanes3 planes)> build;
  std::function<Aabo3(std::size_t object)> single;  // by its builder of fit.h
};

Aabb3 BoxOf(const Workload& workload, std::size_t i) {
  return workload.objects.Get(i % workload.objects.size()).aabb();
}

Point<3> MiddleOf(const Aabb3& box) {
  Point<3> middle;
  for (std::size_t k = 0; k < 3; ++k) {
    middle[k] = 0.5f * box.min[k] + 0.5f * box.max[k];
  }
  return middle;
}

Source BoxesSource(const Workload& workload, std::size_t bytes) {
  Source source("boxes", sizeof(Aabb3), bytes);
  auto boxes = std::make_shared<AabbWorld3>();
  for (std::size_t i = 0; i < source.objects; ++i) {
    boxes->Push(BoxOf(workload, i));
  }
  source.build = [boxes](const FitOptions& options, AaboPlanes3 planes) {
    return BoundBoxes(BoxesOf(boxes->view()), planes, options);
  };
  source.single = [boxes](std::size_t i) { return BoundAabb(boxes->Get(i)); };
  return source;
}

// The spheres within the boxes' longest sides. Their planes, the center's and
// the radius', are a SimplexWorld's, for its alignment.
Source SpheresSource(const Workload& workload, std::size_t bytes) {
  Source source("spheres", sizeof(Sphere3), bytes);
  auto columns = std::make_shared<SimplexWorld3>();
  for (std::size_t i = 0; i < source.objects; ++i) {
    const Aabb3 box = BoxOf(workload, i);
    const Point<3> center = MiddleOf(box);
    float radius = 0.0f;
    for (std::size_t k = 0; k < 3; ++k) {
      radius = std::max(radius, box.max[k] - center[k]);
    }
    columns->Push(UpSimplex3{{center[0], center[1], center[2], radius}});
  }
  source.build = [columns](const FitOptions& options, AaboPlanes3 planes) {
    const auto [min, size] = columns->view();
    return BoundSpheres(
        Spheres<3>{{min[0], min[1], min[2]}, min[3], size, /*stride=*/1},
        planes, options);
  };
  source.single = [columns](std::size_t i) {
    const auto [x, y, z, radius] = columns->Get(i).min;
    return BoundSphere(Sphere3{{x, y, z}, radius});
  };
  return source;
}

// A grid, which has half as many vertices as triangles, as closed meshes do.
Source TrianglesSource(const Workload& workload, std::size_t bytes) {
  constexpr std::size_t kRow = 64;  // vertices
  struct Mesh {
    std::vector<float> coords;
    std::vector<std::uint32_t> indices;
    Points3 vertices() const { return {coords.data(), coords.size() / 3}; }
  };
  Source source("triangles", 3 * sizeof(std::uint32_t) + sizeof(Point<3>) / 2,
                bytes);
  auto mesh = std::make_shared<Mesh>();
  const std::size_t vertices = source.objects / 2;
  for (std::size_t v = 0; v < vertices; ++v) {
    const Point<3> at = MiddleOf(BoxOf(workload, v));
    mesh->coords.insert(mesh->coords.end(), at.begin(), at.end());
    for (std::size_t corner :
         {v, v + 1, v + kRow, v + 1, v + kRow, v + kRow + 1}) {
      mesh->indices.push_back(static_cast<std::uint32_t>(corner % vertices));
    }
  }
  source.build = [mesh](const FitOptions& options, AaboPlanes3 planes) {
    return BoundTriangles(mesh->vertices(), mesh->indices, planes, options);
  };
  source.single = [mesh](std::size_t i) {
    return BoundPoints(mesh->vertices(), std::span<const std::uint32_t>(
                                             &mesh->indices[3 * i], 3));
  };
  return source;
}

// Builds with these options. Empty if the bounds of some objects enclose those
// of fit.h and are equal to them in X, Y and Z; else what is wrong.
std::string CheckBuild(Source& source, const FitOptions& options) {
  constexpr std::size_t kChecked = 64;
  constexpr std::size_t kD = 3;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const AaboPlanes3 planes = source.built.planes();
  const std::size_t step = std::max<std::size_t>(1, source.objects / kChecked);
  // What is looked at afterwards must have been written.
  for (std::size_t i = 0; i < source.objects; i += step) {
    for (float* plane : planes.min) plane[i] = kNan;
    for (float* plane : planes.max) plane[i] = kNan;
  }
  if (source.build(options, planes) != options.target) {
    return "another target ran";
  }
  for (std::size_t i = 0; i < source.objects; i += step) {
    const Aabo3 built = source.built.Get(i);
    const Aabo3 single = source.single(i);
    const bool is_right = built.aabb() == single.aabb() &&
                          built.min[kD] <= single.min[kD] &&
                          built.max[kD] >= single.max[kD];
    if (!is_right) {
      return "object " + std::to_string(i) +
             ": not the bound of the builder of one shape";
    }
  }
  return {};
}

// The builds of one kind at one size, and the copies they are measured by.
void AddBuilds(Run& run, Source source, const std::string& set, Table& table) {
  // A copy reads half of its bytes and writes the other half, with the widest
  // vectors. Stores past the caches are faster or not.
  struct alignas(64) Lines {
    std::array<std::uint32_t, 64> words;
  };
  std::vector<Lines> from(source.objects * source.bytes / 2 / sizeof(Lines));
  std::vector<Lines> to(from.size());
  const auto copy = LoopsFor(SupportedTargets().front()).copy;
  const std::string shapes = source.shapes;
  Contest contest(run, "build/" + set);
  for (bool streamed : {false, true}) {
    contest.Add({shapes, "copy"},
                CaseOfObjects(source.objects,
                              [&, copy, streamed] {
                                copy(streamed, from[0].words.data(),
                                     to[0].words.data(),
                                     from.size() * from[0].words.size());
                              }),
                Who::kLimit);
  }
  for (Target target : run.targets) {
    for (bool tightest : {false, true}) {
      // The tightest D of a triangle is that of its corners, and of a sphere it
      // is computed for so long that the size of the set tells nothing more.
      if (tightest &&
          (shapes == "triangles" || (shapes == "spheres" && set == "memory"))) {
        continue;
      }
      const FitOptions options{.tightest = tightest, .target = target};
      Case c = CaseOfObjects(source.objects, [&, options] {
        source.build(options, source.built.planes());
      });
      c.check = [&, options] { return CheckBuild(source, options); };
      contest.Add({shapes, "aabo", tightest ? "tightest" : "within-ulp",
                   NameOf(target), set, source.objects},
                  std::move(c));
    }
  }
  contest.Time(ShareOf(run.effort));
  contest.AddTo(table, [&](std::size_t i) -> Row {
    const Timing& timing = contest.timing(i);
    return {timing.Median(),
            static_cast<double>(source.bytes) / timing.Median(),
            RatioOf(contest.fastest(), timing).Percent()};
  });
}

constexpr std::size_t kPointsOfSingle = 64;
constexpr std::size_t kPiecesOfSingle = 16;

// What a shape is made of.
struct Single {
  const Point3& a;  // the first of kPointsOfSingle
  const Point3& b;
  const Point3& c;
  float length;
  const Aabo3& bound;
  const Aabo3& other;

  Affine3 Map() const { return {{b, c, a}, c}; }

  // Around a, closed: a cube whose faces lean by a little.
  std::array<HalfSpace3, 6> Planes() const {
    std::array<HalfSpace3, 6> planes{};
    for (std::size_t f = 0; f < planes.size(); ++f) {
      Point3 normal{};
      for (std::size_t k = 0; k < 3; ++k) normal[k] = 0.002f * b[k];
      normal[f / 2] += f % 2 == 0 ? 1.0f : -1.0f;
      float offset = length;
      for (std::size_t k = 0; k < 3; ++k) offset -= normal[k] * a[k];
      planes[f] = {normal, offset};
    }
    return planes;
  }
};

// Random numbers for so many shapes: with 256 in turn most calls take half as
// long, because a branch predictor learns them.
class Singles {
 public:
  Singles() {
    Random random(11);
    for (std::vector<Point3>* points : {&a_, &b_, &c_}) {
      for (Point3& p : *points) {
        for (float& x : p) x = 50.0f * random.Signed();
      }
    }
    for (std::size_t i = 0; i < kTimedQueries; ++i) {
      length_[i] = 1.25f + 0.75f * random.Signed();
      bound_[i] = BoundSegment(Segment3{a_[i], b_[i]});
    }
  }

  Single operator[](std::size_t i) const {
    return {a_[i],      b_[i],     c_[i],
            length_[i], bound_[i], bound_[kTimedQueries - 1 - i]};
  }

 private:
  std::vector<Point3> a_{kTimedQueries + kPointsOfSingle};
  std::vector<Point3> b_{kTimedQueries};
  std::vector<Point3> c_{kTimedQueries};
  std::vector<float> length_ = std::vector<float>(kTimedQueries);
  std::vector<Aabo3> bound_{kTimedQueries};
};

// Each builder of fit.h and transform.h in 3 dimensions, over random shapes.
void AddSingles(Run& run, Table& table) {
  const Singles singles;
  Contest contest(run, "single");
  const auto add = [&](const char* name, auto build, std::size_t items = 1) {
    constexpr std::size_t kCallsOfRun = 256;
    Case c;
    c.items = static_cast<double>(kCallsOfRun * items);
    c.check = [&singles, build]() -> std::string {
      for (std::size_t i = 0; i < kCallsOfRun; ++i) {
        using Bound = decltype(build(singles[i]));
        if (build(singles[i]) == Bound::Everything()) {
          return "shape " + std::to_string(i) + " was not bounded";
        }
      }
      return {};
    };
    c.run = [&singles, build, next = std::size_t{0}]() mutable {
      // The bits of a minimum, so that no call is left out.
      std::uint32_t digest = 0;
      for (std::size_t i = 0; i < kCallsOfRun; ++i) {
        digest ^= std::bit_cast<std::uint32_t>(build(singles[next]).min.back());
        next = next + 1 == kTimedQueries ? 0 : next + 1;
      }
      KeepResult(digest);
    };
    contest.Add({name}, std::move(c));
  };
  using S = const Single&;
  add("BoundPoint", [](S s) { return BoundPoint<3>(s.a); });
  add(
      "BoundPoints, a point",
      [](S s) {
        return BoundPoints(Points3{s.a.data(), kPointsOfSingle});
      },
      kPointsOfSingle);
  add("BoundSegment", [](S s) { return BoundSegment(Segment3{s.a, s.b}); });
  add("BoundTriangle", [](S s) {
    return BoundTriangle(Triangle3{s.a, s.b, s.c});
  });
  add("BoundAabb", [](S s) { return BoundAabb(s.bound.aabb()); });
  add("BoundOrientedBox", [](S s) {
    return BoundOrientedBox(
        OrientedBox3{s.a, {s.b, s.c, s.a}, {s.length, s.length, s.length}});
  });
  add("BoundSphere", [](S s) { return BoundSphere(Sphere3{s.a, s.length}); });
  add("BoundCapsule", [](S s) {
    return BoundCapsule(Capsule3{s.a, s.b, s.length});
  });
  add("BoundRay", [](S s) { return BoundRay(Ray3{s.a, s.b, s.length}); });
  add(
      "BoundSegmentPieces, a piece",
      [](S s) {
        std::array<Aabo3, kPiecesOfSingle> pieces;
        BoundSegmentPieces<3>({s.a, s.b}, pieces);
        return pieces.back();
      },
      kPiecesOfSingle);
  add("BoundFrustum", [](S s) { return BoundFrustum(s.Planes()); });
  add("BoundTransformed, a point", [](S s) {
    return BoundTransformed(Points3{s.a.data(), 1}, s.Map());
  });
  add("BoundTransformed, a box",
      [](S s) { return BoundTransformed(s.bound.aabb(), s.Map()); });
  add("Merge", [](S s) { return Merge(s.bound, s.other); });
  add("Inflate", [](S s) { return Inflate(s.bound, s.length); });
  add("InflateByBox", [](S s) { return InflateByBox(s.bound, s.length); });
  add("Translate", [](S s) { return Translate(s.bound, s.c); });
  add("TranslateVertices", [](S s) { return TranslateVertices(s.bound, s.c); });
  add("Scale", [](S s) { return Scale(s.bound, s.length); });
  add("Sweep", [](S s) { return Sweep(s.bound, s.c); });
  add("Circumscribe", [](S s) { return Circumscribe(s.bound.down()); });
  contest.Time(ShareOf(run.effort));
  contest.AddTo(table, [&](std::size_t i) -> Row {
    return {SpreadOf(contest.timing(i))};
  });
}

}  // namespace

Tables RunBuild(Run& run) {
  Table builds{"build",
               "bulk builders against copying as many bytes",
               {Key("shapes"), Key("planes"), Key("rounding"), Key("target"),
                Key("set"), Key("objects"), Value("ns/item"),
                Value("GB/s", "", 1), Higher("% of copy", "", 0)}};
  Table singles{"build: single",
                "one shape at a time, in 3 dimensions",
                {Key("call"), Lower("time", "ns")}};
  const Workload& workload = run.Measured();
  Parts parts;
  for (const WorkingSetSize& size : run.Reached({"L2", "memory"})) {
    for (auto make : {BoxesSource, SpheresSource, TrianglesSource}) {
      if (run.is_quick() && size.name == "memory" && make != BoxesSource) {
        continue;
      }
      parts.emplace_back([&, size, make] {
        AddBuilds(run, make(workload, size.bytes), size.name, builds);
      });
    }
  }
  parts.emplace_back([&] { AddSingles(run, singles); });
  RunParts(run, parts);
  builds.notes = run.NotReached();
  return {builds, singles};
}

}  // namespace halfspace::bench

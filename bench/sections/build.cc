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
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
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
  const std::size_t rounds =
      std::max<std::size_t>(1, kObjectsPerRun / source.objects);
  std::vector<Case> cases;
  const auto add = [&](std::string name, auto once) {
    Case c;
    c.name = "build/" + set + "/" + source.shapes + "/" + std::move(name);
    c.items = static_cast<double>(source.objects * rounds);
    c.run = [rounds, once] {
      for (std::size_t i = 0; i < rounds; ++i) once();
    };
    cases.push_back(std::move(c));
  };
  // A copy reads half of its bytes and writes the other half, with the widest
  // vectors. Stores past the caches are faster or not.
  struct alignas(64) Lines {
    std::array<std::uint32_t, 64> words;
  };
  std::vector<Lines> from(source.objects * source.bytes / 2 / sizeof(Lines));
  std::vector<Lines> to(from.size());
  for (bool streamed : {false, true}) {
    add("copy",
        [&, streamed, copy = LoopsFor(SupportedTargets().front()).copy] {
          copy(streamed, from[0].words.data(), to[0].words.data(),
               from.size() * from[0].words.size());
        });
  }
  std::vector<Row> rows;
  for (Target target : run.targets) {
    for (bool tightest : {false, true}) {
      // The tightest D of a triangle is that of its corners, and of a sphere it
      // is computed for so long that the size of the set tells nothing more.
      const std::string shapes = source.shapes;
      if (tightest &&
          (shapes == "triangles" || (shapes == "spheres" && set == "memory"))) {
        continue;
      }
      const char* rounding = tightest ? "tightest" : "within-ulp";
      const FitOptions options{.tightest = tightest, .target = target};
      rows.push_back(
          {shapes, "aabo", rounding, NameOf(target), set, source.objects});
      add(NameOf(target) + "/" + rounding,
          [&, options] { source.build(options, source.built.planes()); });
      cases.back().check = [&, options] { return CheckBuild(source, options); };
    }
  }
  const std::vector<Timing> timings = run.Time(cases, ShareOf(run.effort));
  const Timing& copy =
      timings[timings[0].Median() < timings[1].Median() ? 0 : 1];
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Timing& timing = timings[2 + i];
    rows[i].insert(
        rows[i].end(),
        {timing.Median(), static_cast<double>(source.bytes) / timing.Median(),
         RatioOf(copy, timing).Percent()});
    table.Add(rows[i]);
  }
}

// With 256 in turn most calls take half as long, because a branch predictor
// learns them.
constexpr std::size_t kSingles = kTimedQueries;
constexpr std::size_t kCallsOfRun = 256;

constexpr std::size_t kPointsOfSingle = 64;
constexpr std::size_t kPieces = 16;

// Random numbers, and the shapes that a case makes of them.
struct Singles {
  std::vector<Point3> a{kSingles};
  std::vector<Point3> b{kSingles};
  std::vector<Point3> c{kSingles};
  std::vector<float> length = std::vector<float>(kSingles);
  std::vector<Aabo3> bound{kSingles};

  Singles() {
    Random random(11);
    const auto point = [&] {
      Point3 p;
      for (float& x : p) x = 50.0f * random.Signed();
      return p;
    };
    for (std::size_t i = 0; i < kSingles; ++i) {
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
Case CaseOf(const char* name, const std::shared_ptr<const Singles>& shapes,
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
      next = next + 1 == kSingles ? 0 : next + 1;
    }
    KeepResult(digest);
  };
  return c;
}

// A case for each builder of fit.h and transform.h in 3 dimensions, over random
// shapes. Its items are calls.
std::vector<Case> SingleBuildCases() {
  const auto shapes = std::make_shared<const Singles>();
  std::vector<Case> cases;
  const auto add = [&](const char* name, const auto& build,
                       std::size_t items = 1) {
    cases.push_back(CaseOf(name, shapes, items, build));
  };
  using S = Singles;
  add("BoundPoint",
      [](const S& s, std::size_t i) { return BoundPoint<3>(s.a[i]); });
  add(
      "BoundPoints, a point",
      [](const S& s, std::size_t i) {
        const std::size_t first = i % (kSingles - kPointsOfSingle);
        return BoundPoints(Points3{s.a[first].data(), kPointsOfSingle});
      },
      kPointsOfSingle);
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
    return Merge(s.bound[i], s.bound[kSingles - 1 - i]);
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

}  // namespace

Tables RunBuild(Run& run) {
  Table builds{"build",
               "bulk builders against copying as many bytes",
               {Key("shapes"), Key("planes"), Key("rounding"), Key("target"),
                Key("set"), Key("objects"), Value("ns/item"),
                Value("GB/s", "", 1), Higher("% of copy", "", 0)}};
  const Workload& workload = run.Measured();
  std::size_t part = 0;
  const std::vector<WorkingSetSize> sizes = run.Reached({"L2", "memory"});
  for (const WorkingSetSize& size : sizes) {
    for (auto make : {BoxesSource, SpheresSource, TrianglesSource}) {
      run.progress.BeginPart(part++, 3 * sizes.size() + 1);
      if (run.is_quick() && size.name == "memory" && make != BoxesSource) {
        continue;
      }
      AddBuilds(run, make(workload, size.bytes), size.name, builds);
    }
  }
  builds.notes = run.NotReached();
  Table singles{"build: single",
                "one shape at a time, in 3 dimensions",
                {Key("call"), Lower("time", "ns")}};
  for (const Timing& timing :
       run.Time(SingleBuildCases(), ShareOf(run.effort))) {
    singles.Add(
        {timing.name.substr(timing.name.find('/') + 1), SpreadOf(timing)});
  }
  return {builds, singles};
}

}  // namespace halfspace::bench

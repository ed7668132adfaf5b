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

// Each builder of fit.h and transform.h in 3 dimensions, over random shapes.
void AddSingles(Run& run, Table& table) {
  constexpr std::size_t kPoints = 64;
  constexpr std::size_t kPieces = 16;
  // So many shapes: with 256 in turn most calls take half as long, because a
  // branch predictor learns them.
  Random random(11);
  std::vector<Point3> a(kTimedQueries + kPoints);
  std::vector<Point3> b(kTimedQueries);
  std::vector<Point3> c(kTimedQueries);
  for (std::vector<Point3>* points : {&a, &b, &c}) {
    for (Point3& p : *points) {
      for (float& x : p) x = 50.0f * random.Signed();
    }
  }
  std::vector<float> length(kTimedQueries);
  std::vector<Aabo3> bound(kTimedQueries);
  for (std::size_t i = 0; i < kTimedQueries; ++i) {
    length[i] = 1.25f + 0.75f * random.Signed();
    bound[i] = BoundSegment(Segment3{a[i], b[i]});
  }
  const auto map_of = [&](std::size_t i) -> Affine3 {
    return {{b[i], c[i], a[i]}, c[i]};
  };
  // Around a, closed: a cube whose faces lean by a little.
  const auto planes_of = [&](std::size_t i) {
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
  };

  Contest contest(run, "single");
  // build(i) bounds shape i.
  const auto add = [&](const char* name, auto build, std::size_t items = 1) {
    constexpr std::size_t kCallsOfRun = 256;
    Case call;
    call.items = static_cast<double>(kCallsOfRun * items);
    call.check = [build]() -> std::string {
      for (std::size_t i = 0; i < kCallsOfRun; ++i) {
        using Bound = decltype(build(i));
        if (build(i) == Bound::Everything()) {
          return "shape " + std::to_string(i) + " was not bounded";
        }
      }
      return {};
    };
    call.run = [build, next = std::size_t{0}]() mutable {
      // The bits of a minimum, so that no call is left out.
      std::uint32_t digest = 0;
      for (std::size_t i = 0; i < kCallsOfRun; ++i) {
        digest ^= std::bit_cast<std::uint32_t>(build(next).min.back());
        next = next + 1 == kTimedQueries ? 0 : next + 1;
      }
      KeepResult(digest);
    };
    contest.Add({name}, std::move(call));
  };
  using I = std::size_t;
  add("BoundPoint", [&](I i) { return BoundPoint<3>(a[i]); });
  add(
      "BoundPoints, a point",
      [&](I i) {
        return BoundPoints(Points3{a[i].data(), kPoints});
      },
      kPoints);
  add("BoundSegment", [&](I i) { return BoundSegment(Segment3{a[i], b[i]}); });
  add("BoundTriangle", [&](I i) {
    return BoundTriangle(Triangle3{a[i], b[i], c[i]});
  });
  add("BoundAabb", [&](I i) { return BoundAabb(bound[i].aabb()); });
  add("BoundOrientedBox", [&](I i) {
    return BoundOrientedBox(OrientedBox3{
        a[i], {b[i], c[i], a[i]}, {length[i], length[i], length[i]}});
  });
  add("BoundSphere", [&](I i) {
    return BoundSphere(Sphere3{a[i], length[i]});
  });
  add("BoundCapsule", [&](I i) {
    return BoundCapsule(Capsule3{a[i], b[i], length[i]});
  });
  add("BoundRay", [&](I i) { return BoundRay(Ray3{a[i], b[i], length[i]}); });
  add(
      "BoundSegmentPieces, a piece",
      [&](I i) {
        std::array<Aabo3, kPieces> pieces;
        BoundSegmentPieces<3>({a[i], b[i]}, pieces);
        return pieces.back();
      },
      kPieces);
  add("BoundFrustum", [&](I i) { return BoundFrustum(planes_of(i)); });
  add("BoundTransformed, a point", [&](I i) {
    return BoundTransformed(Points3{a[i].data(), 1}, map_of(i));
  });
  add("BoundTransformed, a box",
      [&](I i) { return BoundTransformed(bound[i].aabb(), map_of(i)); });
  add("Merge",
      [&](I i) { return Merge(bound[i], bound[kTimedQueries - 1 - i]); });
  add("Inflate", [&](I i) { return Inflate(bound[i], length[i]); });
  add("InflateByBox", [&](I i) { return InflateByBox(bound[i], length[i]); });
  add("Translate", [&](I i) { return Translate(bound[i], c[i]); });
  add("TranslateVertices",
      [&](I i) { return TranslateVertices(bound[i], c[i]); });
  add("Scale", [&](I i) { return Scale(bound[i], length[i]); });
  add("Sweep", [&](I i) { return Sweep(bound[i], c[i]); });
  add("Circumscribe", [&](I i) { return Circumscribe(bound[i].down()); });
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

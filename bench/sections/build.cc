// Bulk builders next to a copy of as many bytes, and the builders of one shape.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/copy.h"
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

Aabb3 BoxOf(const Workload& workload, std::size_t i) {
  return workload.objects.Get(i % workload.objects.size()).aabb();
}

Point3 MiddleOf(const Aabb3& box) {
  Point3 middle;
  for (std::size_t k = 0; k < 3; ++k) {
    middle[k] = 0.5f * box.min[k] + 0.5f * box.max[k];
  }
  return middle;
}

// Shapes for the bulk builders, where the objects of a workload lie. Each kind
// has the bytes of a shape, its bulk builder, and the builder of fit.h for one.
struct Boxes {
  static constexpr const char* kName = "boxes";
  static constexpr std::size_t kBytes = sizeof(Aabb3);

  Boxes(const Workload& workload, std::size_t objects) {
    for (std::size_t i = 0; i < objects; ++i) world.Push(BoxOf(workload, i));
  }
  Target Build(const FitOptions& options, AaboPlanes3 planes) const {
    return BoundBoxes(BoxesOf(world.view()), planes, options);
  }
  Aabo3 Single(std::size_t i) const { return BoundAabb(world.Get(i)); }

  AabbWorld3 world;
};

// The spheres within the boxes' longest sides.
struct Balls {
  static constexpr const char* kName = "spheres";
  static constexpr std::size_t kBytes = sizeof(Sphere3);

  Balls(const Workload& workload, std::size_t objects) {
    for (std::size_t i = 0; i < objects; ++i) {
      const Aabb3 box = BoxOf(workload, i);
      const auto [x, y, z] = MiddleOf(box);
      const float radius =
          std::max({0.0f, box.max[0] - x, box.max[1] - y, box.max[2] - z});
      columns.Push(UpSimplex3{{x, y, z, radius}});
    }
  }
  Target Build(const FitOptions& options, AaboPlanes3 planes) const {
    const auto [min, size] = columns.view();
    return BoundSpheres(
        Spheres<3>{{min[0], min[1], min[2]}, min[3], size, /*stride=*/1},
        planes, options);
  }
  Aabo3 Single(std::size_t i) const {
    const auto [x, y, z, radius] = columns.Get(i).min;
    return BoundSphere(Sphere3{{x, y, z}, radius});
  }

  SimplexWorld3 columns;  // x, y, z, radius: a world for its alignment
};

// A grid, which has half as many vertices as triangles, as closed meshes do.
struct Triangles {
  static constexpr const char* kName = "triangles";
  static constexpr std::size_t kBytes =
      3 * sizeof(std::uint32_t) + sizeof(Point3) / 2;

  Triangles(const Workload& workload, std::size_t objects) {
    constexpr std::size_t kRow = 64;  // vertices
    for (std::size_t v = 0; v < objects / 2; ++v) {
      const Point3 at = MiddleOf(BoxOf(workload, v));
      coords.insert(coords.end(), at.begin(), at.end());
      for (std::size_t corner :
           {v, v + 1, v + kRow, v + 1, v + kRow, v + kRow + 1}) {
        indices.push_back(static_cast<std::uint32_t>(corner % (objects / 2)));
      }
    }
  }
  Points3 Vertices() const { return {coords.data(), coords.size() / 3}; }
  Target Build(const FitOptions& options, AaboPlanes3 planes) const {
    return BoundTriangles(Vertices(), indices, planes, options);
  }
  Aabo3 Single(std::size_t i) const {
    return BoundPoints(Vertices(), std::span(indices).subspan(3 * i, 3));
  }

  std::vector<float> coords;
  std::vector<std::uint32_t> indices;
};

// Builds with these options. Empty if the bounds of some objects enclose those
// of single shapes and are equal to them in X, Y and Z; else what is wrong.
template <typename Shapes>
std::string CheckBuild(const Shapes& shapes, const FitOptions& options,
                       AaboWorld3& built) {
  constexpr std::size_t kChecked = 64;
  constexpr std::size_t kD = 3;
  const std::size_t step = std::max<std::size_t>(1, built.size() / kChecked);
  // What is looked at afterwards must have been written.
  Aabo3 unwritten;
  unwritten.min.fill(std::numeric_limits<float>::quiet_NaN());
  unwritten.max = unwritten.min;
  for (std::size_t i = 0; i < built.size(); i += step) built.Set(i, unwritten);
  if (shapes.Build(options, built.planes()) != options.target) {
    return "another target ran";
  }
  for (std::size_t i = 0; i < built.size(); i += step) {
    const Aabo3 bulk = built.Get(i);
    const Aabo3 single = shapes.Single(i);
    if (bulk.aabb() != single.aabb() || !(bulk.min[kD] <= single.min[kD]) ||
        !(bulk.max[kD] >= single.max[kD])) {
      return "object " + std::to_string(i) +
             ": not the bound of the builder of one shape";
    }
  }
  return {};
}

// The builds of one kind at one size, and the copies they are measured by: as
// many shapes as take about so many bytes with their bounds.
template <typename Shapes>
void AddBuilds(Run& run, const WorkingSetSize& size, Table& table) {
  constexpr std::size_t kStep = 128;
  constexpr std::size_t kBytes = Shapes::kBytes + sizeof(Aabo3);
  const std::size_t objects =
      std::max(kStep, size.bytes / kBytes / kStep * kStep);
  const Shapes shapes(run.Measured(), objects);
  AaboWorld3 built;
  built.Resize(objects);
  Copy copy(objects * kBytes);
  Contest contest(run, "build/" + size.name);
  for (bool streamed : {false, true}) {
    contest.Add({Shapes::kName, "copy"},
                CaseOfObjects(objects, [&, streamed] { copy.Run(streamed); }),
                Who::kLimit);
  }
  for (Target target : run.targets) {
    const FitOptions options{.target = target};
    Case c = CaseOfObjects(
        objects, [&, options] { shapes.Build(options, built.planes()); });
    c.check = [&, options] { return CheckBuild(shapes, options, built); };
    contest.Add({Shapes::kName, "aabo", NameOf(target), size.name, objects},
                std::move(c));
  }
  contest.Time(ShareOf(run.effort));
  contest.AddTo(table, [&](std::size_t i) -> Row {
    return {contest.Median(i), kBytes / contest.Median(i),
            RatioOf(contest.fastest(), contest.timing(i)).Times(100.0)};
  });
}

// Each builder of fit.h and transform.h in 3 dimensions, over random shapes.
void AddSingles(Run& run, Table& table) {
  using I = std::size_t;
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
  const auto map_of = [&](I i) -> Affine3 {
    return {{b[i], c[i], a[i]}, c[i]};
  };
  Contest contest(run, "single");
  // build(i) bounds shape i, or as many `items` of it.
  const auto add = [&](const char* name, std::size_t items, auto build) {
    constexpr std::size_t kCallsOfRun = 256;
    Case call;
    call.items = static_cast<double>(kCallsOfRun * items);
    call.check = CheckOf(kCallsOfRun, "was not bounded", [build](I i) {
      using Bound = decltype(build(i));
      return build(i) != Bound::Everything();
    });
    call.run = [build, next = I{0}]() mutable {
      // The bits of a minimum, so that no call is left out.
      std::uint32_t digest = 0;
      for (I i = 0; i < kCallsOfRun; ++i) {
        digest ^= std::bit_cast<std::uint32_t>(build(next).min.back());
        next = next + 1 == kTimedQueries ? 0 : next + 1;
      }
      KeepResult(digest);
    };
    contest.Add({name}, std::move(call));
  };
  add("BoundPoint", 1, [&](I i) { return BoundPoint<3>(a[i]); });
  add("BoundPoints, a point", kPoints, [&](I i) {
    return BoundPoints(Points3{a[i].data(), kPoints});
  });
  add("BoundSegment", 1, [&](I i) {
    return BoundSegment(Segment3{a[i], b[i]});
  });
  add("BoundTriangle", 1, [&](I i) {
    return BoundTriangle(Triangle3{a[i], b[i], c[i]});
  });
  add("BoundAabb", 1, [&](I i) { return BoundAabb(bound[i].aabb()); });
  add("BoundOrientedBox", 1, [&](I i) {
    return BoundOrientedBox(OrientedBox3{
        a[i], {b[i], c[i], a[i]}, {length[i], length[i], length[i]}});
  });
  add("BoundSphere", 1, [&](I i) {
    return BoundSphere(Sphere3{a[i], length[i]});
  });
  add("BoundCapsule", 1, [&](I i) {
    return BoundCapsule(Capsule3{a[i], b[i], length[i]});
  });
  add("BoundRay", 1, [&](I i) {
    return BoundRay(Ray3{a[i], b[i], length[i]});
  });
  add("BoundSegmentPieces, a piece", kPieces, [&](I i) {
    std::array<Aabo3, kPieces> pieces;
    BoundSegmentPieces<3>({a[i], b[i]}, pieces);
    return pieces.back();
  });
  add("BoundTransformed, a point", 1, [&](I i) {
    return BoundTransformed(Points3{a[i].data(), 1}, map_of(i));
  });
  add("BoundTransformed, a box", 1,
      [&](I i) { return BoundTransformed(bound[i].aabb(), map_of(i)); });
  add("Merge", 1,
      [&](I i) { return Merge(bound[i], bound[kTimedQueries - 1 - i]); });
  add("Inflate", 1, [&](I i) { return Inflate(bound[i], length[i]); });
  add("InflateByBox", 1,
      [&](I i) { return InflateByBox(bound[i], length[i]); });
  add("Translate", 1, [&](I i) { return Translate(bound[i], c[i]); });
  add("TranslateVertices", 1,
      [&](I i) { return TranslateVertices(bound[i], c[i]); });
  add("Scale", 1, [&](I i) { return Scale(bound[i], length[i]); });
  add("Sweep", 1, [&](I i) { return Sweep(bound[i], c[i]); });
  contest.Time(ShareOf(run.effort));
  contest.AddTo(table);
}

}  // namespace

Tables RunBuild(Run& run) {
  Table builds{
      "build",
      "bulk builders against copying as many bytes",
      {Key("shapes"), Key("planes"), Key("target"), Key("set"), Key("objects"),
       Value("ns/item"), Value("GB/s", "", 1), Higher("% of copy", "", 0)}};
  Table singles{"build: single",
                "one shape at a time, in 3 dimensions",
                {Key("call"), Lower("time", "ns")}};
  run.Measured();
  for (const WorkingSetSize& size : run.Reached({"L2", "memory"})) {
    for (const auto add :
         {&AddBuilds<Boxes>, &AddBuilds<Balls>, &AddBuilds<Triangles>}) {
      if (run.options.is_quick && size.name == "memory" &&
          add != &AddBuilds<Boxes>) {
        continue;
      }
      add(run, size, builds);
    }
  }
  AddSingles(run, singles);
  builds.notes = run.NotReached();
  return {builds, singles};
}

}  // namespace halfspace::bench

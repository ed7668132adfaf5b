#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/inner/target_loops.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/worlds/build_source.h"
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

bool IsInCache(const WorkingSetSize& size) { return size.name != "memory"; }

struct Rounding {
  const char* name;
  bool tightest;
};

// The tightest D of a sphere is computed for so long that its size tells
// nothing more.
std::vector<Rounding> RoundingsOf(BuildKind kind, bool is_in_cache) {
  std::vector<Rounding> roundings = {{"within-ulp", false}};
  if (kind == BuildKind::kBoxes ||
      (kind == BuildKind::kSpheres && is_in_cache)) {
    roundings.push_back({"tightest", true});
  }
  return roundings;
}

// The builds of one kind at one size, and the copies they are measured by: they
// share their memory, and are timed together.
class BuildGroup {
 public:
  BuildGroup(BuildKind kind, const WorkingSetSize& size,
             const Workload& workload, const std::vector<Target>& targets)
      : working_set_(size.name),
        source_(MakeBuildSource(kind, workload, size.bytes)),
        rounds_(std::max<std::size_t>(1, kObjectsPerRun / source_.objects)) {
    // Stores past the caches only lose in them.
    copies_ = IsInCache(size) ? 1 : 2;
    for (std::size_t c = 0; c < copies_; ++c) AddCopy(/*streamed=*/c == 1);
    for (Target target : targets) {
      for (const Rounding& rounding : RoundingsOf(kind, IsInCache(size))) {
        AddBuild(target, rounding);
      }
    }
  }

  void Run(bench::Run& run, Table& table) {
    const std::vector<Timing> timings = run.Time(cases_, ShareOf(run.effort));
    double bytes = 0.0;  // of an object
    for (const auto& stream : source_.copy.reads) {
      bytes += static_cast<double>(stream.object_bytes);
    }
    for (const auto& stream : source_.copy.writes) {
      bytes += static_cast<double>(stream.object_bytes);
    }
    // The faster copy is the ceiling.
    const Timing& copy = *std::min_element(
        timings.begin(), timings.begin() + static_cast<std::ptrdiff_t>(copies_),
        [](const Timing& a, const Timing& b) {
          return a.Median() < b.Median();
        });
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Timing& timing = timings[copies_ + i];
      Row& row = rows_[i];
      row.insert(row.end(), {timing.Median(), bytes / timing.Median(),
                             RatioOf(copy, timing).Percent()});
      table.Add(row);
    }
  }

 private:
  Case MakeCase(std::string name) const {
    Case c;
    c.name = std::move(name);
    c.items = static_cast<double>(source_.objects * rounds_);
    return c;
  }

  // With the widest vectors, whatever is measured.
  void AddCopy(bool streamed) {
    Case c = MakeCase("copy/" + working_set_ + "/" + source_.shapes +
                      (streamed ? "/streamed" : ""));
    c.run = [this, streamed, copy = LoopsFor(SupportedTargets().front()).copy] {
      for (std::size_t i = 0; i < rounds_; ++i) copy(streamed, source_.copy);
    };
    cases_.push_back(std::move(c));
  }

  void AddBuild(Target target, const Rounding& rounding) {
    rows_.push_back({source_.shapes, source_.planes, rounding.name,
                     NameOf(target), working_set_, source_.objects});
    Case c = MakeCase("build/" + working_set_ + "/" + NameOf(target) + "/" +
                      source_.shapes + "-to-" + source_.planes + "/" +
                      rounding.name);
    const FitOptions options{.tightest = rounding.tightest, .target = target};
    c.check = [this, options] { return CheckBuild(source_, options); };
    c.run = [this, options] {
      for (std::size_t i = 0; i < rounds_; ++i) source_.build(options, nullptr);
    };
    cases_.push_back(std::move(c));
  }

  std::string working_set_;
  BuildSource source_;
  std::size_t rounds_;
  std::size_t copies_ = 0;
  std::vector<Row> rows_;
  std::vector<Case> cases_;  // the copies, then the rows
};

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
               "bulk builders against copying the same bytes",
               {Key("shapes"), Key("planes"), Key("rounding"), Key("target"),
                Key("set"), Key("objects"), Value("ns/item"),
                Value("GB/s", "", 1), Higher("% of copy", "", 0)}};
  const Workload& workload = run.Measured();
  const std::vector<WorkingSetSize> sizes = run.Reached({"L2", "memory"});
  std::size_t part = 0;
  for (const WorkingSetSize& size : sizes) {
    for (BuildKind kind : kBuildKinds) {
      run.progress.BeginPart(part++, sizes.size() * kBuildKinds.size() + 1);
      if (run.is_quick() && !IsInCache(size) && kind != BuildKind::kBoxes) {
        continue;
      }
      BuildGroup(kind, size, workload, run.targets).Run(run, builds);
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

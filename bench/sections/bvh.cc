#include "halfspace/bvh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/curves.h"
#include "bench/measure/machine.h"
#include "bench/sections/bvh_parts.h"
#include "bench/sections/contest.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/sections/throughput.h"
#include "bench/worlds/box_set.h"

namespace halfspace::bench {
namespace {

// A scan of more is slower than anything else.
constexpr std::size_t kMostScanned = 10000;
// Of a file. Bullet takes no coordinates further out; and of more ids, writing
// them is what would be timed.
constexpr std::size_t kMostOfFile = 4'000'000;
constexpr float kFarthest = 1e12f;
constexpr std::size_t kMostFound = 2000;
// Where a scan may be faster.
constexpr std::array<std::size_t, 6> kFewObjects = {30,   100,  300,
                                                    1000, 3000, 10000};
// All structures of a workload together.
constexpr std::size_t kBytesOfBox = 1500;

// As many survivors of a query in 2D as in 3D, with the same number of objects:
// (2 * 0.37 / 100)^2 is (2 * 1.9 / 100)^3.
constexpr float kSide3D = 1.9f;
constexpr float kSide2D = 0.37f;

// What a competition needs to be told, apart from its boxes.
struct Aims {
  Aim threshold;
  std::vector<Target> targets;  // the best one first
  bool is_order_compared = false;
};

template <int kDims>
void RunContest(const BoxSet<kDims>& set, const Aims& aims,
                Throughput& throughput, BvhResult& result) {
  Contest<kDims> contest(set, throughput);
  const Target best = aims.targets.front();
  for (Target target : aims.targets) {
    for (BuildQuality quality : {BuildQuality::kHigh, BuildQuality::kFast}) {
      contest.AddBvh(quality, target);
    }
  }
  contest.AddCounts(best);
  if (set.boxes.size() <= kMostScanned) contest.AddQuantizedScan(best);
  contest.AddCompetitors();
  contest.AddGrid();
  constexpr std::size_t kMostRepetitions = 5;
  contest.Run(set.boxes.size() < 1'000'000
                  ? throughput.repetitions()
                  : std::min(throughput.repetitions(), kMostRepetitions));
  for (Target target : aims.targets) {
    contest.AddRatios(aims.threshold, target);
  }
  if (aims.is_order_compared) contest.AddFastOverTight(best);
  contest.AddRemarks(best);
  contest.AddTo(result);
}

void RunSkewed(const SkewedWorld& world, std::size_t objects,
               std::uint64_t seed, const std::vector<Target>& targets,
               Throughput& throughput, BvhResult& result) {
  const BoxSet<3> set = world.make(world.name, objects, kSide3D, seed);
  const BoxSet<3> uniform =
      MakeUniformBoxes<3>("uniform", objects, kSide3D, seed);
  Contest<3> contest(set, throughput);
  for (Target target : targets) {
    contest.AddBvhOneByOne(BuildQuality::kHigh, target);
    contest.AddUniform(uniform, target);
  }
  contest.AddCompetitors();
  contest.Run(throughput.repetitions());
  for (Target target : targets) {
    contest.AddSkewedRatios(
        objects < 100'000 ? aims::kBvhSkewedTenThousand : aims::kBvhSkewedMore,
        target);
  }
  contest.AddTo(result);
}

void RunScan(std::size_t most, std::uint64_t seed, Throughput& throughput,
             BvhResult& result) {
  const Target target = throughput.targets().front();
  std::vector<double> sizes;
  std::vector<double> scan;
  std::vector<double> sorted;
  for (std::size_t objects : kFewObjects) {
    if (objects > most) continue;
    const BoxSet<3> set = MakeUniformBoxes<3>("few", objects, kSide3D, seed);
    Contest<3> contest(set, throughput);
    contest.AddFloatScan(target);
    contest.AddQuantizedScan(target);
    contest.AddBvh(BuildQuality::kHigh, target);
    contest.Run(std::min<std::size_t>(throughput.repetitions(), 3));
    sizes.push_back(static_cast<double>(objects));
    scan.push_back(std::min(contest.MedianOf(0), contest.MedianOf(1)));
    sorted.push_back(contest.MedianOf(2));
  }
  const double below = CrossoverSize(sizes, scan, sorted);
  result.queries.notes.push_back(
      below > 0.0 ? "Below " + Fixed(below, 0) +
                        " boxes a flat scan is faster, one query a call."
                  : "A flat scan is at no size faster, one query a call.");
}

bool HasMemoryFor(std::size_t objects) {
  const std::size_t available = FreeMemory();
  return available == 0 || objects < available / kBytesOfBox;
}

// The sizes up to `most`; if none, that one.
std::vector<std::size_t> UpTo(std::size_t most,
                              std::vector<std::size_t> sizes) {
  std::erase_if(sizes, [most](std::size_t size) { return size > most; });
  if (sizes.empty()) sizes.push_back(most);
  return sizes;
}

// Why the boxes of a file are not measured; empty if they are.
std::string WhyNot(const Workload* input) {
  if (input == nullptr) return "no --mesh or --bounds";
  const std::size_t objects = input->objects.size();
  if (objects > kMostOfFile || !HasMemoryFor(objects)) {
    return "too many boxes";
  }
  const AabbView3 view = input->objects.view().aabb();
  for (std::size_t k = 0; k < 3; ++k) {
    const bool is_near = std::all_of(view.min[k], view.min[k] + objects,
                                     [](float x) { return x >= -kFarthest; }) &&
                         std::all_of(view.max[k], view.max[k] + objects,
                                     [](float x) { return x <= kFarthest; });
    if (!is_near) return "coordinates beyond 1e12, which not all trees take";
  }
  const Bvh<AabbView3> world(view);
  std::size_t found = 0;
  for (const Aabo3& query : input->queries) {
    found += CountSurvivors(world, query.aabb());
  }
  if (found > kMostFound * input->queries.size()) {
    return "a query finds more than " + std::to_string(kMostFound) + " boxes";
  }
  return {};
}

Aim ThresholdFor(std::size_t objects) {
  if (objects < 10'000) return aims::kBvhThousand;
  if (objects < 100'000) return aims::kBvhTenThousand;
  if (objects < 1'000'000) return aims::kBvhHundredThousand;
  return aims::kBvhMillion;
}

}  // namespace

Tables RunBvh(Run& run) {
  const Workload* input = run.input();
  const std::uint64_t seed = run.options.seed;
  BvhResult result;
  Throughput throughput(run, "bvh");
  const Target best = throughput.targets().front();
  std::size_t most = run.is_quick() ? 100'000 : 1'000'000;
  if (run.options.objects != 0) most = std::min(most, run.options.objects);
  if (most > 100'000 && !HasMemoryFor(most)) {
    most = 100'000;
    throughput.NotReached("more than " + Grouped(most) +
                          " boxes, which do not fit the free memory");
  }

  std::vector<Target> targets = {best};
  for (Target target : throughput.targets()) {
    if (IsAvx2(target) && target != best) targets.push_back(target);
  }

  ThroughputParts parts;
  const std::vector<std::size_t> sizes =
      UpTo(most, {1000, 10'000, 100'000, 1'000'000});
  for (std::size_t objects : sizes) {
    const Aims aims{ThresholdFor(objects), targets, objects == sizes.back()};
    parts.push_back([=, &result](Throughput& to) {
      RunContest(MakeUniformBoxes<3>("a", objects, kSide3D, seed), aims, to,
                 result);
    });
  }
  for (std::size_t objects : UpTo(most, {100'000, 1'000'000})) {
    parts.push_back([=, &result](Throughput& to) {
      RunContest(MakeClusters("clusters", objects, seed),
                 {aims::kBvhClusters, {best}}, to, result);
    });
  }
  // Of a quick run, the first two with few objects.
  const std::vector<std::size_t> skewed_sizes =
      UpTo(run.is_quick() ? std::min<std::size_t>(most, 10'000) : most,
           {10'000, 100'000});
  for (const SkewedWorld& world :
       SkewedWorlds().first(run.is_quick() ? 2 : SkewedWorlds().size())) {
    for (std::size_t objects : skewed_sizes) {
      parts.push_back([=, &result](Throughput& to) {
        RunSkewed(world, objects, seed, targets, to, result);
      });
    }
  }
  if (const std::string why = WhyNot(input); why.empty()) {
    parts.push_back([=, &result](Throughput& to) {
      RunContest(BoxesOf("file", *input), {aims::kBvhFile, {best}}, to, result);
    });
  } else {
    throughput.NotReached("the boxes of a file: " + why);
  }
  for (std::size_t objects : UpTo(most, {100'000, 1'000'000})) {
    parts.push_back([=, &result](Throughput& to) {
      RunContest(MakeUniformBoxes<2>("2D", objects, kSide2D, seed),
                 {aims::kBvh2D, {best}}, to, result);
    });
  }
  parts.push_back(
      [=, &result](Throughput& to) { RunScan(most, seed, to, result); });
  parts.push_back([=, &result](Throughput& to) {
    RunBvhBuilds(MakeUniformBoxes<3>("a", most, kSide3D, seed), to, result);
  });
  parts.push_back([=, &result](Throughput& to) {
    RunBvhRefits(MakeUniformBoxes<3>("a", most, kSide3D, seed), to, result);
  });
  for (std::size_t objects : UpTo(most, {100'000, 1'000'000})) {
    parts.push_back([=, &result](Throughput& to) {
      RunBvhPairs(MakeUniformBoxes<3>("a", objects, kSide3D, seed), to, result);
    });
  }
  parts.push_back([=, &result](Throughput& to) {
    RunBvhSearches(MakeUniformBoxes<3>("a", most, kSide3D, seed), seed, to,
                   result);
  });
  RunParts(parts, throughput);

  return {result.queries, result.jobs, throughput.Aims()};
}

}  // namespace halfspace::bench

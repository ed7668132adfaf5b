#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/baselines/box_tree.h"
#include "bench/measure/crossover_size.h"
#include "bench/measure/machine.h"
#include "bench/measure/queries_in_turn.h"
#include "bench/sections/sections.h"
#include "bench/sections/throughput.h"
#include "bench/worlds/box_set.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "halfspace/sorted.h"

namespace halfspace::bench {
namespace {

using Ids = std::vector<std::uint32_t>;

// In one turn of the structures, after which each has evicted the others.
constexpr std::size_t kQueriesInTurn = 2000;
constexpr std::size_t kTurns = kTimedQueries / kQueriesInTurn;
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
// Of more, it takes ten times as long as others for a query, and many seconds
// for itself.
constexpr std::size_t kMostOfBullet = 100000;
// All structures of a workload together.
constexpr std::size_t kBytesOfBox = 1500;

constexpr const char* kOneByOne = ", one query a call";
constexpr const char* kAllAtOnce = ", all in one call";

// As many survivors of a query in 2D as in 3D, with the same number of objects:
// (2 * 0.37 / 100)^2 is (2 * 1.9 / 100)^3.
constexpr float kSide3D = 1.9f;
constexpr float kSide2D = 0.37f;

// All that can answer the queries of a set, beside each other.
template <int kDims>
class Contest {
 public:
  Contest(const BoxSet<kDims>& set, Throughput& throughput)
      : set_(set), throughput_(throughput), boxes_(set.boxes) {
    workload_.name = set.name;
    workload_.objects = set.boxes.size();
    all_ = BatchesOf(kTimedQueries);
    turns_ = BatchesOf(kQueriesInTurn);
    one_.resize(set.boxes.size());
    found_.reserve(set.boxes.size());
    FindExpected();
  }

  // Each row has a copy of the world, so that in turns with the others it finds
  // the caches as a tree finds them.
  void AddSorted(Order order, Target target) {
    const std::string name = order == Order::kTight ? "tight" : "fast";
    const Sorted world(boxes_.view(), order);
    if (all_ids_.empty()) MakeRoom(world);
    AddOneByOne(name + kOneByOne, std::string(target.name()),
                [this, target, own = Copy(world)](const Box& query) {
                  return FoundOne(Survivors(*own, query, one_, target));
                });
    AddAllAtOnce(name + kAllAtOnce, target, Copy(world));
  }

  void AddCounts(Target target) {
    const auto world = std::make_shared<const Sorted>(boxes_.view());
    const auto count = [world, target](const Box& query) {
      return CountSurvivors(*world, query, target);
    };
    const auto check = [this, count]() -> std::string {
      for (std::size_t q = 0; q < expected_.size(); ++q) {
        if (count(set_.queries[q]) != expected_[q].size()) {
          return "the counts are not those of a scan";
        }
      }
      return {};
    };
    AddRow("tight, counts, one query a call", std::string(target.name()), check,
           [&](std::size_t queries) {
             return CaseOneByOne(queries, [count](const Box& query) {
               std::ignore = count(query);
             });
           });
  }

  void AddFloatScan(Target target) {
    AddOneByOne("scan, one query a call", std::string(target.name()),
                [this, target](const Box& query) {
                  return FoundOne(Survivors(
                      boxes_.view(), query, one_,
                      {.schedule = Schedule::kFlat, .target = target}));
                });
  }

  void AddQuantizedScan(Target target) {
    AddOneByOne(
        "quantized scan, one query a call", std::string(target.name()),
        [this, target,
         world = std::make_shared<const QuantizedWorld<View>>(set_.boxes)](
            const Box& query) {
          return FoundOne(Survivors(*world, query, one_, {.target = target}));
        });
  }

  // Those that were built. The grid is our own, and no competitor.
  void AddTrees() {
    for (std::size_t node_size : {8, 16, 32}) {
      AddCompetitor("Boost R-tree, " + std::to_string(node_size) + " a node",
                    MakeBoostTree(set_.boxes, node_size));
    }
    if constexpr (kDims == 3) {
      if (set_.boxes.size() <= kMostOfBullet) {
        AddCompetitor("Bullet btDbvt", MakeBulletTree(set_.boxes));
      }
      AddCompetitor("Embree", MakeEmbreeTree(set_.boxes));
    } else {
      AddCompetitor("GEOS STRtree", MakeGeosTree(set_.boxes));
    }
    grid_ = workload_.rows.size();
    AddTree("grid", MakeGrid(set_.boxes));
  }

  // Times all that was added, and fills the rows.
  void Run(std::size_t repetitions) {
    in_a_row_ = throughput_.TimeRuns(std::move(in_a_row_cases_), repetitions);
    // So many that each has all queries.
    in_turns_ = throughput_.TimeRuns(std::move(in_turns_cases_),
                                     std::max(repetitions, kTurns));
    for (std::size_t i = 0; i < workload_.rows.size(); ++i) {
      SortedRow& row = workload_.rows[i];
      row.ns = in_a_row_[i].Median();
      row.ns_in_turns = in_turns_[i].Median();
      if (competitors_.empty()) continue;
      row.over_fastest = Fastest(in_a_row_).Median() / row.ns;
      row.over_fastest_in_turns = Fastest(in_turns_).Median() / row.ns_in_turns;
    }
  }

  // Of the rows of a sorted world with that target: times the fastest
  // competitor, which is asked one query a call in either case.
  void AddRatios(Threshold threshold, Target target) {
    if (competitors_.empty()) return;
    for (const char* how : {kOneByOne, kAllAtOnce}) {
      const std::size_t row = RowOf(std::string("tight") + how, target);
      const std::string name = workload_.name + " " +
                               Grouped(workload_.objects) + how + ", " +
                               std::string(target.name());
      throughput_.AddRatio(threshold, target,
                           name + ": times the fastest competitor",
                           RatioOf(Fastest(in_a_row_), in_a_row_[row]));
      throughput_.AddRatio(thresholds::WhereEvicted(threshold), target,
                           name + ", in turns: times the fastest competitor",
                           RatioOf(Fastest(in_turns_), in_turns_[row]));
    }
  }

  void AddFastOverTight(Target target) {
    throughput_.AddRatio(
        thresholds::kFastOverTight, target,
        workload_.name + " " + Grouped(workload_.objects) + kOneByOne +
            ": time of the fast order over the tight one's",
        RatioOf(in_a_row_[RowOf(std::string("fast") + kOneByOne, target)],
                in_a_row_[RowOf(std::string("tight") + kOneByOne, target)]));
  }

  // Where the grid wins.
  void AddRemarks(Target target, std::vector<std::string>& remarks) const {
    const SortedRow& grid = workload_.rows[grid_];
    const SortedRow& tight =
        workload_.rows[RowOf(std::string("tight") + kOneByOne, target)];
    const auto add = [&](double share, const char* of) {
      if (share < 1.0) {
        remarks.push_back(workload_.name + " " + Grouped(workload_.objects) +
                          ": our own grid, no competitor here, takes " +
                          Fixed(share, 2) + " of the time of " + of);
      }
    };
    add(grid.ns / tight.ns, "a sorted world, one query a call");
    if (grid.over_fastest) {
      add(1.0 / *grid.over_fastest, "the fastest competitor");
    }
  }

  double MedianOf(std::size_t row) const { return workload_.rows[row].ns; }
  SortedWorkload TakeWorkload() { return std::move(workload_); }

 private:
  using Box = Aabb<kDims>;
  using View = AabbView<kDims>;
  using Sorted = SortedWorld<View>;
  using Batches = std::vector<std::span<const Box>>;

  static std::shared_ptr<const Sorted> Copy(const Sorted& world) {
    return std::make_shared<const Sorted>(world);
  }

  Batches BatchesOf(std::size_t size) const {
    Batches batches;
    for (std::size_t q = 0; q < set_.queries.size(); q += size) {
      batches.push_back(std::span(set_.queries).subspan(q, size));
    }
    return batches;
  }

  // The answers of a flat scan of the floats, for as many queries as it answers
  // in a moment.
  void FindExpected() {
    constexpr std::size_t kPairs = 50'000'000;
    constexpr std::size_t kMost = 1000;
    const std::size_t count =
        std::clamp<std::size_t>(kPairs / workload_.objects, 20, kMost);
    for (std::size_t q = 0; q < count; ++q) {
      const std::size_t kept = Survivors(boxes_.view(), set_.queries[q], one_,
                                         {.schedule = Schedule::kFlat});
      expected_.emplace_back(one_.begin(),
                             one_.begin() + static_cast<std::ptrdiff_t>(kept));
    }
  }

  // For the ids of all queries.
  void MakeRoom(const Sorted& world) {
    std::size_t sum = 0;
    for (const Box& query : set_.queries) sum += CountSurvivors(world, query);
    workload_.survivors = static_cast<double>(sum) / kTimedQueries;
    all_ids_.resize(sum + 1);
    offsets_.resize(kTimedQueries + 1);
  }

  bool IsExpected(std::size_t query, std::span<const std::uint32_t> ids) const {
    Ids sorted(ids.begin(), ids.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted == expected_[query];
  }

  static constexpr const char* kWrong =
      "the boxes found are not those of a scan";

  // find(query) returns the ids.
  template <typename Find>
  void AddOneByOne(std::string name, std::string target, Find find) {
    const auto check = [this, find]() -> std::string {
      for (std::size_t q = 0; q < expected_.size(); ++q) {
        if (!IsExpected(q, find(set_.queries[q]))) return kWrong;
      }
      return {};
    };
    AddRow(std::move(name), std::move(target), check, [&](std::size_t queries) {
      return CaseOneByOne(
          queries, [find](const Box& query) { std::ignore = find(query); });
    });
  }

  void AddTree(std::string name, std::unique_ptr<BoxTree<kDims>> tree) {
    AddOneByOne(std::move(name), "",
                [this, own = std::shared_ptr<const BoxTree<kDims>>(
                           std::move(tree))](const Box& query) {
                  own->Find(query, found_);
                  return std::span<const std::uint32_t>(found_);
                });
  }
  void AddCompetitor(std::string name, std::unique_ptr<BoxTree<kDims>> tree) {
    if (tree == nullptr) return;
    competitors_.push_back(workload_.rows.size());
    AddTree(std::move(name), std::move(tree));
  }

  void AddAllAtOnce(std::string name, Target target,
                    std::shared_ptr<const Sorted> world) {
    const auto ask = [this, world, target](std::span<const Box> queries) {
      std::ignore =
          SurvivorsOfEach(*world, queries, all_ids_, offsets_, target);
    };
    const auto check = [this, ask]() -> std::string {
      ask(std::span(set_.queries).first(expected_.size()));
      for (std::size_t q = 0; q < expected_.size(); ++q) {
        if (!IsExpected(q, std::span(all_ids_).subspan(
                               offsets_[q], offsets_[q + 1] - offsets_[q]))) {
          return kWrong;
        }
      }
      return {};
    };
    AddRow(std::move(name), std::string(target.name()), check,
           [&](std::size_t queries) {
             const Batches& batches = queries == kQueriesInTurn ? turns_ : all_;
             Case c = InTurn("", batches, batches.size(), 1, ask);
             c.items = static_cast<double>(queries);
             return c;
           });
  }

  template <typename Call>
  Case CaseOneByOne(std::size_t queries, Call call) const {
    return InTurn("", set_.queries, kTimedQueries, queries, call);
  }

  // case_of(n) asks n queries in a run, and the next ones in the next run.
  template <typename Check, typename CaseOf>
  void AddRow(std::string name, std::string target, const Check& check,
              const CaseOf& case_of) {
    const std::string place = workload_.name + "/" +
                              std::to_string(workload_.objects) + "/" + name +
                              (target.empty() ? "" : "/" + target);
    in_a_row_cases_.push_back(case_of(kTimedQueries));
    in_a_row_cases_.back().name = place;
    in_a_row_cases_.back().check = check;
    in_turns_cases_.push_back(case_of(kQueriesInTurn));
    in_turns_cases_.back().name = place + "/in turns";
    SortedRow row;
    row.name = std::move(name);
    row.target = std::move(target);
    workload_.rows.push_back(std::move(row));
  }

  std::span<const std::uint32_t> FoundOne(std::size_t count) const {
    return std::span(one_).first(count);
  }

  const Timing& Fastest(const Timings& timings) const {
    return timings[FastestOf(timings, competitors_)];
  }
  std::size_t RowOf(const std::string& name, Target target) const {
    std::size_t row = 0;
    while (workload_.rows[row].name != name ||
           workload_.rows[row].target != target.name()) {
      ++row;
    }
    return row;
  }

  const BoxSet<kDims>& set_;
  Throughput& throughput_;
  World<View> boxes_;
  SortedWorkload workload_;
  std::vector<std::size_t> competitors_;  // their rows
  std::size_t grid_ = 0;
  std::vector<Case> in_a_row_cases_;  // of each row
  std::vector<Case> in_turns_cases_;
  Timings in_a_row_;
  Timings in_turns_;
  Batches all_;
  Batches turns_;
  std::vector<Ids> expected_;  // of the first queries
  Ids one_;                    // what one query finds
  Ids found_;
  Ids all_ids_;
  std::vector<std::size_t> offsets_;
};

// What a competition needs to be told, apart from its boxes.
struct Aims {
  Threshold threshold;
  std::vector<Target> targets;  // the best one first
  bool is_order_compared = false;
};

template <int kDims>
void RunContest(const BoxSet<kDims>& set, const Aims& aims,
                Throughput& throughput, SortedResult& result) {
  Contest<kDims> contest(set, throughput);
  const Target best = aims.targets.front();
  for (Target target : aims.targets) {
    for (Order order : {Order::kTight, Order::kFast}) {
      contest.AddSorted(order, target);
    }
  }
  contest.AddCounts(best);
  if (set.boxes.size() <= kMostScanned) contest.AddQuantizedScan(best);
  contest.AddTrees();
  constexpr std::size_t kMostRepetitions = 5;
  contest.Run(set.boxes.size() < 1'000'000
                  ? throughput.repetitions()
                  : std::min(throughput.repetitions(), kMostRepetitions));
  for (Target target : aims.targets) {
    contest.AddRatios(aims.threshold, target);
  }
  if (aims.is_order_compared) contest.AddFastOverTight(best);
  contest.AddRemarks(best, result.remarks);
  result.workloads.push_back(contest.TakeWorkload());
}

void RunScan(std::size_t most, std::uint64_t seed, Throughput& throughput,
             SortedResult& result) {
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
    contest.AddSorted(Order::kTight, target);
    contest.Run(std::min<std::size_t>(throughput.repetitions(), 3));
    sizes.push_back(static_cast<double>(objects));
    scan.push_back(std::min(contest.MedianOf(0), contest.MedianOf(1)));
    sorted.push_back(contest.MedianOf(2));
  }
  result.scan_is_faster_below = CrossoverSize(sizes, scan, sorted);
}

// One after the other, and again. What was built ends between two of them, as
// its end is no part of a build.
class Builds {
 public:
  using Make = std::function<std::shared_ptr<const void>()>;

  void Add(const char* name, Make make) {
    makes_.push_back(std::move(make));
    timings_.emplace_back();
    timings_.back().name = std::string("sorted/build/") + name;
    timings_.back().iterations = 1;
  }

  Timings Time(std::size_t repetitions) {
    // The first ones find memory that nobody has used.
    for (std::size_t r = 0; r <= repetitions; ++r) {
      for (std::size_t i = 0; i < makes_.size(); ++i) {
        const std::clock_t start = std::clock();
        const std::shared_ptr<const void> made = makes_[i]();
        const std::clock_t end = std::clock();
        if (r == 0) continue;
        timings_[i].samples.push_back(static_cast<double>(end - start) * 1e9 /
                                      CLOCKS_PER_SEC);
      }
    }
    return timings_;
  }

 private:
  std::vector<Make> makes_;
  Timings timings_;
};

void RunBuilds(std::size_t objects, std::uint64_t seed, Throughput& throughput,
               SortedResult& result) {
  constexpr std::size_t kMostRepetitions = 5;
  const Target target = throughput.targets().front();
  const BoxSet<3> set = MakeUniformBoxes<3>("a", objects, kSide3D, seed);
  using Sorted = SortedWorld<AabbView3>;
  const std::array<const char*, 3> names = {"tight", "fast",
                                            "Boost R-tree, 16 a node"};
  Builds builds;
  builds.Add(names[0], [&] {
    return std::make_shared<const Sorted>(set.boxes, Order::kTight);
  });
  builds.Add(names[1], [&] {
    return std::make_shared<const Sorted>(set.boxes, Order::kFast);
  });
  const bool has_competitor =
      MakeBoostTree(std::span(set.boxes).first(1)) != nullptr;
  if (has_competitor) {
    builds.Add(names[2], [&] {
      return std::shared_ptr<const BoxTree<3>>(MakeBoostTree(set.boxes));
    });
  }
  const Timings timings =
      builds.Time(std::min(throughput.repetitions(), kMostRepetitions));
  throughput.AddTimings(timings);
  for (std::size_t i = 0; i < timings.size(); ++i) {
    result.builds.push_back({names[i], objects, timings[i].Median() / 1e6});
  }
  const std::string size = Grouped(objects);
  if (has_competitor) {
    throughput.AddRatio(thresholds::kFastBuild, target,
                        "fast build of " + size + ": times Boost's bulk load",
                        RatioOf(timings[2], timings[1]));
    throughput.AddRatio(thresholds::kTightBuild, target,
                        "tight build of " + size + ": times Boost's bulk load",
                        RatioOf(timings[2], timings[0]));
  } else {
    throughput.NotReached("threshold 2, builds: built without Boost.Geometry");
  }
  const Sorted world(set.boxes);
  const auto floats =
      static_cast<double>(objects * detail::kPlaneCount<Aabb3> * sizeof(float));
  throughput.AddRatio(thresholds::kSortedMemory, target,
                      "bytes beyond the floats, over the floats, of " + size,
                      static_cast<double>(world.bytes()) / floats - 1.0);
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
  const SortedWorld<AabbView3> world(view);
  std::size_t found = 0;
  for (const Aabo3& query : input->queries) {
    found += CountSurvivors(world, query.aabb());
  }
  if (found > kMostFound * input->queries.size()) {
    return "a query finds more than " + std::to_string(kMostFound) + " boxes";
  }
  return {};
}

Threshold ThresholdFor(std::size_t objects) {
  if (objects < 10'000) return thresholds::kSortedThousand;
  if (objects < 100'000) return thresholds::kSortedTenThousand;
  return thresholds::kSortedMore;
}

}  // namespace

SortedResult RunSorted(const Workload* input, std::size_t most_objects,
                       std::uint64_t seed, bool is_quick,
                       const Context& context) {
  SortedResult result;
  ThroughputResult found;
  Throughput throughput(context, is_quick, found, "sorted");
  const Target best = throughput.targets().front();
  std::size_t most = is_quick ? 100'000 : 1'000'000;
  if (most_objects != 0) most = std::min(most, most_objects);
  if (!HasMemoryFor(most)) {
    most = std::min<std::size_t>(most, 100'000);
    throughput.NotReached("more than " + Grouped(most) +
                          " boxes, which do not fit the free memory");
  }

  ThroughputParts parts;
  const std::vector<std::size_t> sizes =
      UpTo(most, {1000, 10'000, 100'000, 1'000'000});
  for (std::size_t objects : sizes) {
    Aims aims{ThresholdFor(objects), {best}, objects == sizes.back()};
    for (Target target : throughput.targets()) {
      if (IsAvx2(target) && target != best) aims.targets.push_back(target);
    }
    parts.push_back([=, &result](Throughput& to) {
      RunContest(MakeUniformBoxes<3>("a", objects, kSide3D, seed), aims, to,
                 result);
    });
  }
  for (std::size_t objects : UpTo(most, {100'000, 1'000'000})) {
    parts.push_back([=, &result](Throughput& to) {
      RunContest(MakeClusters("clusters", objects, seed),
                 {thresholds::kSortedMore, {best}}, to, result);
    });
  }
  if (const std::string why = WhyNot(input); why.empty()) {
    parts.push_back([=, &result](Throughput& to) {
      RunContest(BoxesOf("file", *input), {thresholds::kSortedFile, {best}}, to,
                 result);
    });
  } else {
    throughput.NotReached("threshold 1, the boxes of a file: " + why);
  }
  for (std::size_t objects : UpTo(most, {100'000, 1'000'000})) {
    parts.push_back([=, &result](Throughput& to) {
      RunContest(MakeUniformBoxes<2>("2D", objects, kSide2D, seed),
                 {thresholds::kSorted2D, {best}}, to, result);
    });
  }
  parts.push_back(
      [=, &result](Throughput& to) { RunScan(most, seed, to, result); });
  parts.push_back(
      [=, &result](Throughput& to) { RunBuilds(most, seed, to, result); });
  RunParts(parts, throughput);

  if (std::none_of(
          found.ratios.begin(), found.ratios.end(),
          [](const ThroughputRatio& ratio) { return ratio.threshold == 1; })) {
    throughput.NotReached("threshold 1: built without a competitor");
  }
  std::stable_sort(found.ratios.begin(), found.ratios.end(),
                   [](const ThroughputRatio& a, const ThroughputRatio& b) {
                     return a.threshold < b.threshold;
                   });
  result.ratios = std::move(found.ratios);
  result.not_reached = std::move(found.not_reached);
  return result;
}

}  // namespace halfspace::bench

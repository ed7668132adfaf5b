// Box queries of BVHs, of scans and of trees, timed beside each other.
#ifndef HALFSPACE_BENCH_SECTIONS_CONTEST_H_
#define HALFSPACE_BENCH_SECTIONS_CONTEST_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/box_tree.h"
#include "bench/measure/measure.h"
#include "bench/sections/bvh_parts.h"
#include "bench/worlds/box_set.h"
#include "halfspace/bvh.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"

namespace halfspace::bench {

// All that can answer the queries of a set, beside each other.
template <int kDims>
class Contest {
 public:
  Contest(const BoxSet<kDims>& set, Throughput& throughput)
      : set_(set), throughput_(throughput), boxes_(set.boxes) {
    all_ = BatchesOf(kTimedQueries);
    turns_ = BatchesOf(kQueriesInTurn);
    one_.resize(set.boxes.size());
    found_.reserve(set.boxes.size());
    FindExpected();
  }

  // Each row has a copy of the world, so that in turns with the others it finds
  // the caches as a tree finds them.
  void AddBvh(BuildQuality quality, Target target) {
    AddAllAtOnce(QualityName(quality) + kAllAtOnce, target,
                 AddBvhOneByOne(quality, target));
  }

  // Returns a copy of the world.
  std::shared_ptr<const Bvh<AabbView<kDims>>> AddBvhOneByOne(
      BuildQuality quality, Target target) {
    const Tree world(boxes_.view(), {.quality = quality});
    if (all_ids_.empty()) MakeRoom(world);
    AddOneByOne(
        QualityName(quality) + kOneByOne, NameOf(target),
        [this, target, own = Copy(world)](const Box& query) {
          return FoundOne(Survivors(*own, query, one_, {.target = target}));
        });
    return Copy(world);
  }

  // A BVH of as many uniform boxes, which answers the queries of their set.
  void AddUniform(const BoxSet<kDims>& uniform, Target target) {
    const auto find = [this, target,
                       world = std::make_shared<const Tree>(uniform.boxes)](
                          const Box& query) {
      return FoundOne(Survivors(*world, query, one_, {.target = target}));
    };
    const auto check = [this, &uniform, find]() -> std::string {
      const World<View> boxes(uniform.boxes);
      Ids scanned(boxes.size());
      for (std::size_t q = 0; q < expected_.size(); ++q) {
        const Box& query = uniform.queries[q];
        const std::size_t kept = Survivors(boxes.view(), query, scanned,
                                           {.schedule = Schedule::kFlat});
        if (!AreSame(find(query), std::span(scanned).first(kept))) {
          return kWrong;
        }
      }
      return {};
    };
    uniform_.push_back(rows_.size());
    AddRow(kUniform, NameOf(target), check, [&](std::size_t queries) {
      return InTurn("", uniform.queries, kTimedQueries, queries,
                    [find](const Box& query) { std::ignore = find(query); });
    });
  }

  void AddCounts(Target target) {
    const auto world = std::make_shared<const Tree>(boxes_.view());
    const auto count = [world, target](const Box& query) {
      return CountSurvivors(*world, query, {.target = target});
    };
    const auto check = [this, count]() -> std::string {
      for (std::size_t q = 0; q < expected_.size(); ++q) {
        if (count(set_.queries[q]) != expected_[q].size()) {
          return "the counts are not those of a scan";
        }
      }
      return {};
    };
    AddRow("tight, counts, one query a call", NameOf(target), check,
           [&](std::size_t queries) {
             return CaseOneByOne(queries, [count](const Box& query) {
               std::ignore = count(query);
             });
           });
  }

  void AddFloatScan(Target target) {
    AddOneByOne("scan, one query a call", NameOf(target),
                [this, target](const Box& query) {
                  return FoundOne(Survivors(
                      boxes_.view(), query, one_,
                      {.schedule = Schedule::kFlat, .target = target}));
                });
  }

  void AddQuantizedScan(Target target) {
    AddOneByOne(
        "quantized scan, one query a call", NameOf(target),
        [this, target,
         world = std::make_shared<const QuantizedWorld<View>>(set_.boxes)](
            const Box& query) {
          return FoundOne(Survivors(*world, query, one_, {.target = target}));
        });
  }

  // Those that were built.
  void AddCompetitors() {
    for (std::size_t node_size : {8, 16, 32}) {
      AddCompetitor("Boost R-tree, " + std::to_string(node_size) + " a node",
                    MakeBoostTree(set_.boxes, node_size));
    }
    if constexpr (kDims == 3) {
      if (set_.boxes.size() <= kMostOfBullet) {
        AddCompetitor("Bullet btDbvt", MakeBulletTree(set_.boxes));
      }
      if (IsWithin(kFarthestOfEmbree)) {
        AddCompetitor("Embree", MakeEmbreeTree(set_.boxes));
      } else {
        throughput_.NotReached("Embree in " + set_.name + " " +
                               Grouped(set_.boxes.size()) +
                               ", whose coordinates are too large for it");
      }
    } else {
      AddCompetitor("GEOS STRtree", MakeGeosTree(set_.boxes));
    }
  }

  // Our own, and no competitor.
  void AddGrid() {
    grid_ = rows_.size();
    AddTree("grid", MakeGrid(set_.boxes));
  }

  // Times all that was added, and fills the rows.
  void Run(std::size_t repetitions) {
    in_a_row_ = throughput_.TimeRuns(std::move(in_a_row_cases_), repetitions);
    // So many that each has all queries.
    in_turns_ = throughput_.TimeRuns(std::move(in_turns_cases_),
                                     std::max(repetitions, kTurns));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      BvhRow& row = rows_[i];
      row.ns = in_a_row_[i].Median();
      row.ns_in_turns = in_turns_[i].Median();
      const bool is_other =
          std::find(uniform_.begin(), uniform_.end(), i) != uniform_.end();
      if (competitors_.empty() || is_other) continue;
      row.over_fastest = RatioOf(Fastest(in_a_row_), in_a_row_[i]);
      row.over_fastest_in_turns = RatioOf(Fastest(in_turns_), in_turns_[i]);
    }
  }

  // Of the rows of a BVH with that target: times the fastest
  // competitor, which is asked one query a call in either case.
  void AddRatios(Aim threshold, Target target) {
    if (competitors_.empty()) return;
    for (const char* how : {kOneByOne, kAllAtOnce}) {
      const Aim aim =
          how == kOneByOne ? threshold : aims::WhereManyInACall(threshold);
      const std::size_t row = RowOf(std::string("tight") + how, target);
      const std::string name = set_.name + " " + Grouped(set_.boxes.size()) +
                               how + ", " + NameOf(target);
      throughput_.AddRatio(aim, target, name + ": times the fastest competitor",
                           RatioOf(Fastest(in_a_row_), in_a_row_[row]));
      throughput_.AddRatio(aims::WhereEvicted(aim), target,
                           name + ", in turns: times the fastest competitor",
                           RatioOf(Fastest(in_turns_), in_turns_[row]));
    }
  }

  // One query a call: times the fastest competitor, and the time over that of
  // the uniform world.
  void AddSkewedRatios(Aim threshold, Target target) {
    const std::string name = set_.name + " " + Grouped(set_.boxes.size()) +
                             kOneByOne + ", " + NameOf(target);
    const Timing& skewed =
        in_a_row_[RowOf(std::string("tight") + kOneByOne, target)];
    if (!competitors_.empty()) {
      throughput_.AddRatio(threshold, target,
                           name + ": times the fastest competitor",
                           RatioOf(Fastest(in_a_row_), skewed));
    }
    throughput_.AddRatio(aims::kSkewedOverUniform, target,
                         name + ": time over that of a uniform world",
                         RatioOf(skewed, in_a_row_[RowOf(kUniform, target)]));
  }

  void AddFastOverTight(Target target) {
    throughput_.AddRatio(
        aims::kFastOverTight, target,
        set_.name + " " + Grouped(set_.boxes.size()) + kOneByOne +
            ": time of the fast order over the tight one's",
        RatioOf(in_a_row_[RowOf(std::string("fast") + kOneByOne, target)],
                in_a_row_[RowOf(std::string("tight") + kOneByOne, target)]));
  }

  // Where the grid wins.
  void AddRemarks(Target target) {
    const double grid = *rows_[grid_].ns.value;
    const auto add = [&](double share, const char* of) {
      if (share >= 1.0) return;
      throughput_.AddNote(set_.name + " " + Grouped(set_.boxes.size()) +
                          ": our own grid, no competitor here, takes " +
                          Fixed(share, 2) + " of the time of " + of + ".");
    };
    add(grid / *rows_[RowOf(std::string("tight") + kOneByOne, target)].ns.value,
        "a BVH, one query a call");
    if (!competitors_.empty()) {
      add(grid / Fastest(in_a_row_).Median(), "the fastest competitor");
    }
  }

  double MedianOf(std::size_t row) const { return *rows_[row].ns.value; }

  void AddTo(BvhResult& result) const {
    for (const BvhRow& row : rows_) {
      result.AddRow(set_.name, set_.boxes.size(), row);
    }
    result.queries.notes.push_back(
        set_.name + ", " + Grouped(set_.boxes.size()) +
        " boxes: a query finds " + Fixed(survivors_, 1) + " and visits " +
        Fixed(blocks_, 1) + " blocks of 64.");
  }

 private:
  using Box = Aabb<kDims>;
  using View = AabbView<kDims>;
  using Tree = Bvh<View>;
  using Batches = std::vector<std::span<const Box>>;
  using Ids = std::vector<std::uint32_t>;

  // In one turn of the structures, after which each has evicted the others.
  static constexpr std::size_t kQueriesInTurn = 2000;
  static constexpr std::size_t kTurns = kTimedQueries / kQueriesInTurn;
  // Of more, it takes ten times as long as others for a query, and many seconds
  // for itself.
  static constexpr std::size_t kMostOfBullet = 100000;

  // A query of 10 000 boxes takes it 0.1 ms where ten of them are at 10^8.
  static constexpr float kFarthestOfEmbree = 1e7f;

  static constexpr const char* kOneByOne = ", one query a call";
  static constexpr const char* kAllAtOnce = ", all in one call";
  static constexpr const char* kUniform =
      "tight, one query a call, of a uniform world";
  static constexpr const char* kWrong =
      "the boxes found are not those of a scan";

  static std::string QualityName(BuildQuality quality) {
    return quality == BuildQuality::kHigh ? "tight" : "fast";
  }

  static std::shared_ptr<const Tree> Copy(const Tree& world) {
    return std::make_shared<const Tree>(world);
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
        std::clamp<std::size_t>(kPairs / set_.boxes.size(), 20, kMost);
    for (std::size_t q = 0; q < count; ++q) {
      const std::size_t kept = Survivors(boxes_.view(), set_.queries[q], one_,
                                         {.schedule = Schedule::kFlat});
      expected_.emplace_back(one_.begin(),
                             one_.begin() + static_cast<std::ptrdiff_t>(kept));
    }
  }

  // For the ids of all queries.
  void MakeRoom(const Tree& world) {
    std::size_t sum = 0;
    QueryStatistics read;
    for (const Box& query : set_.queries) {
      // By ids: a count does not visit what is inside a query.
      sum += Survivors(world, query, {}, {.statistics = &read});
    }
    blocks_ =
        static_cast<double>(read.node_blocks + read.leaves) / kTimedQueries;
    survivors_ = static_cast<double>(sum) / kTimedQueries;
    all_ids_.resize(sum + 1);
    offsets_.resize(kTimedQueries + 1);
  }

  bool IsWithin(float most) const {
    return std::all_of(
        set_.boxes.begin(), set_.boxes.end(), [most](const Box& box) {
          bool is_within = true;
          for (std::size_t k = 0; k < kDims; ++k) {
            is_within &= box.min[k] >= -most && box.max[k] <= most;
          }
          return is_within;
        });
  }
  static bool AreSame(std::span<const std::uint32_t> ids,
                      std::span<const std::uint32_t> expected) {
    Ids sorted(ids.begin(), ids.end());
    std::sort(sorted.begin(), sorted.end());
    return std::equal(sorted.begin(), sorted.end(), expected.begin(),
                      expected.end());
  }
  bool IsExpected(std::size_t query, std::span<const std::uint32_t> ids) const {
    return AreSame(ids, expected_[query]);
  }

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
    competitors_.push_back(rows_.size());
    AddTree(std::move(name), std::move(tree));
  }

  void AddAllAtOnce(std::string name, Target target,
                    std::shared_ptr<const Tree> world) {
    const auto ask = [this, world, target](std::span<const Box> queries) {
      std::ignore = SurvivorsOfEach(*world, queries, all_ids_, offsets_,
                                    {.target = target});
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
    AddRow(std::move(name), NameOf(target), check, [&](std::size_t queries) {
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
    const std::string place = set_.name + "/" +
                              std::to_string(set_.boxes.size()) + "/" + name +
                              (target.empty() ? "" : "/" + target);
    in_a_row_cases_.push_back(case_of(kTimedQueries));
    in_a_row_cases_.back().name = place;
    in_a_row_cases_.back().check = check;
    in_turns_cases_.push_back(case_of(kQueriesInTurn));
    in_turns_cases_.back().name = place + "/in turns";
    BvhRow row;
    row.name = std::move(name);
    row.target = std::move(target);
    rows_.push_back(std::move(row));
  }

  std::span<const std::uint32_t> FoundOne(std::size_t count) const {
    return std::span(one_).first(count);
  }

  const Timing& Fastest(const Timings& timings) const {
    return timings[FastestOf(timings, competitors_)];
  }
  std::size_t RowOf(const std::string& name, Target target) const {
    std::size_t row = 0;
    while (rows_[row].name != name || rows_[row].target != NameOf(target)) {
      ++row;
    }
    return row;
  }

  const BoxSet<kDims>& set_;
  Throughput& throughput_;
  World<View> boxes_;
  std::vector<BvhRow> rows_;
  double survivors_ = 0.0;                // of a query
  double blocks_ = 0.0;                   // that it visits in tight quality
  std::vector<std::size_t> competitors_;  // their rows
  std::vector<std::size_t> uniform_;      // rows of another set
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

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_CONTEST_H_

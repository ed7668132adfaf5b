// BVHs next to the trees of other libraries.
#include "halfspace/bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/box_tree.h"
#include "bench/measure/machine.h"
#include "bench/measure/team.h"
#include "bench/sections/contest.h"
#include "bench/sections/sections.h"
#include "bench/worlds/box_set.h"
#include "bench/worlds/random.h"
#include "halfspace/bvh_nearest.h"
#include "halfspace/bvh_pairs.h"
#include "halfspace/bvh_shapes.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

using Ids = std::vector<std::uint32_t>;
using Bvh3 = Bvh<AabbView3>;

// Of a file. Bullet takes no coordinates further out; and of more ids, writing
// them is what would be timed.
constexpr std::size_t kMostOfFile = 4'000'000;
constexpr float kFarthest = 1e12f;
constexpr std::size_t kMostFound = 2000;
// All structures of a workload together.
constexpr std::size_t kBytesOfBox = 1500;
// In one turn of the structures, after which each has evicted the others.
constexpr std::size_t kQueriesInTurn = 2000;

// As many survivors of a query in 2D as in 3D, with the same number of objects:
// (2 * 0.37 / 100)^2 is (2 * 1.9 / 100)^3.
constexpr float kSide3D = 1.9f;
constexpr float kSide2D = 0.37f;

struct Result {
  Table queries{"bvh",
                "us a query; times as fast as the fastest competitor",
                {Key("world"), Key("objects"), Key("what"), Key("target"),
                 Value("in a row", "us", 3), Higher("times"),
                 Value("in turns", "us", 3)}};
  Table jobs{"bvh: jobs",
             "what is done to all objects at once",
             {Key("job"), Key("objects"), Value("time", "ms", 1)}};

  void AddJobs(const Contest& contest, std::size_t objects) {
    for (std::size_t i = 0; i < contest.size(); ++i) {
      jobs.Add({contest.name(i), objects, contest.timing(i).Median() / 1e6});
    }
  }
};

// The box queries of a set, by all that can answer them.
template <int kDims>
class QueryContest {
  using Box = Aabb<kDims>;
  using View = AabbView<kDims>;
  using Tree = Bvh<View>;

 public:
  QueryContest(Run& run, const BoxSet<kDims>& set)
      : run_(run),
        set_(set),
        place_("bvh/" + set.name + "/" + std::to_string(set.boxes.size())),
        boxes_(set.boxes),
        in_a_row_(run, place_),
        in_turns_(run, place_ + "/in turns") {
    // The answers of a flat scan of the floats, for as many queries as it
    // answers in a moment.
    const std::size_t count =
        std::clamp<std::size_t>(50'000'000 / set.boxes.size(), 20, 1000);
    found_.resize(set.boxes.size());
    for (std::size_t q = 0; q < count; ++q) {
      const std::size_t kept = Survivors(boxes_.view(), set_.queries[q], found_,
                                         {.schedule = Schedule::kFlat});
      expected_.emplace_back(
          found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(kept));
    }
  }

  // Each row has a copy of the world, so that in turns with the others it finds
  // the caches as a tree finds them.
  void AddBvh(BuildQuality quality, Target target, bool has_calls_of_many) {
    const std::string name = quality == BuildQuality::kHigh ? "tight" : "fast";
    const auto world = std::make_shared<const Tree>(
        boxes_.view(), BuildOptions{.quality = quality});
    if (all_ids_.empty()) MakeRoom(*world);
    AddFind(
        name + ", one query a call", NameOf(target), Who::kOurs,
        [this, target, world](const Box& query) {
          return Found(Survivors(*world, query, found_, {.target = target}));
        });
    if (has_calls_of_many) {
      AddAllAtOnce(name + ", all in one call", target,
                   std::make_shared<const Tree>(*world));
    }
  }
  void AddCompetitors() {
    for (const auto& competitor : Registered<BoxTree<kDims>>::All()) {
      if (set_.boxes.size() > competitor.most) continue;
      AddFind(competitor.name, "", Who::kCompetitor,
              [this, tree = std::shared_ptr<const BoxTree<kDims>>(
                         competitor.make(set_.boxes))](const Box& query) {
                tree->Find(query, listed_);
                return std::span<const std::uint32_t>(listed_);
              });
    }
  }

  void Time(Table& table) {
    const std::size_t repetitions =
        set_.boxes.size() < 1'000'000
            ? run_.effort.repetitions
            : std::min<std::size_t>(run_.effort.repetitions, 5);
    in_a_row_.Time(repetitions);
    // So many that each has all queries.
    in_turns_.Time(std::max(repetitions, kTimedQueries / kQueriesInTurn));
    for (std::size_t i = 0; i < in_a_row_.size(); ++i) {
      table.Add({set_.name, set_.boxes.size(), in_a_row_.name(i),
                 in_a_row_.target(i), in_a_row_.timing(i).Median() / 1e3,
                 in_a_row_.OverFastest(i), in_turns_.timing(i).Median() / 1e3});
    }
    table.notes.push_back(set_.name + ", " + Grouped(set_.boxes.size()) +
                          " boxes: a query finds " + Fixed(survivors_, 1) +
                          " and visits " + Fixed(blocks_, 1) +
                          " blocks of 64.");
  }

 private:
  static constexpr const char* kWrong =
      "the boxes found are not those of a scan";

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
  std::span<const std::uint32_t> Found(std::size_t count) const {
    return std::span(found_).first(count);
  }
  bool IsExpected(std::size_t query, std::span<const std::uint32_t> ids) const {
    Ids sorted(ids.begin(), ids.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted == expected_[query];
  }

  // case_of(n) asks n queries in a run, and the next ones in the next run.
  template <typename Check, typename CaseOf>
  void Add(const std::string& name, const std::string& target, Who who,
           const Check& check, const CaseOf& case_of) {
    Case c = case_of(kTimedQueries);
    c.check = check;
    in_a_row_.Add(name, target, who, std::move(c));
    in_turns_.Add(name, target, who, case_of(kQueriesInTurn));
  }
  // find(query) returns the ids.
  template <typename Find>
  void AddFind(const std::string& name, const std::string& target, Who who,
               Find find) {
    const auto check = [this, find]() -> std::string {
      for (std::size_t q = 0; q < expected_.size(); ++q) {
        if (!IsExpected(q, find(set_.queries[q]))) return kWrong;
      }
      return {};
    };
    Add(name, target, who, check, [&](std::size_t queries) {
      return InTurn("", set_.queries, kTimedQueries, queries,
                    [find](const Box& query) { std::ignore = find(query); });
    });
  }
  void AddAllAtOnce(const std::string& name, Target target,
                    const std::shared_ptr<const Tree>& world) {
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
    Add(name, NameOf(target), Who::kOurs, check, [&](std::size_t queries) {
      Case c;
      c.items = static_cast<double>(queries);
      c.run = [this, ask, queries, next = std::size_t{0}]() mutable {
        ask(std::span(set_.queries).subspan(next, queries));
        next = (next + queries) % kTimedQueries;
      };
      return c;
    });
  }

  Run& run_;
  const BoxSet<kDims>& set_;
  std::string place_;
  World<View> boxes_;
  Contest in_a_row_;
  Contest in_turns_;
  double survivors_ = 0.0;     // of a query
  double blocks_ = 0.0;        // that it visits in tight quality
  std::vector<Ids> expected_;  // of the first queries
  Ids found_;                  // what one query finds
  Ids listed_;                 // by a competitor
  Ids all_ids_;
  std::vector<std::size_t> offsets_;
};

// By fast builds and in one call, too, unless only_tight.
template <int kDims>
void RunQueries(Run& run, const BoxSet<kDims>& set,
                const std::vector<Target>& targets, Result& result,
                bool only_tight = false) {
  QueryContest<kDims> contest(run, set);
  for (Target target : targets) {
    contest.AddBvh(BuildQuality::kHigh, target, !only_tight);
    if (!only_tight) contest.AddBvh(BuildQuality::kFast, target, true);
  }
  contest.AddCompetitors();
  contest.Time(result.queries);
}

// What is built ends after its time, as its end is no part of a build.
void RunBuilds(Run& run, const BoxSet<3>& set, Result& result) {
  using Made = std::shared_ptr<const void>;
  std::vector<std::pair<std::string, std::function<Made()>>> builds = {
      {"tight", [&] { return std::make_shared<const Bvh3>(set.boxes); }},
      {"fast", [&] {
         return std::make_shared<const Bvh3>(
             set.boxes, BuildOptions{.quality = BuildQuality::kFast});
       }}};
  for (const auto& competitor : Registered<BoxTree<3>>::All()) {
    if (set.boxes.size() > competitor.most) continue;
    builds.emplace_back(competitor.name, [&] {
      return std::shared_ptr<const BoxTree<3>>(competitor.make(set.boxes));
    });
  }
  std::vector<std::vector<double>> ns(builds.size());
  const std::size_t repetitions =
      std::min<std::size_t>(run.effort.repetitions, 5);
  // The first ones find memory that nobody has used.
  for (std::size_t r = 0; r <= repetitions; ++r) {
    for (std::size_t i = 0; i < builds.size(); ++i) {
      Made made;
      const double time = CpuNanoseconds([&] { made = builds[i].second(); });
      if (r != 0) ns[i].push_back(time);
    }
  }
  for (std::size_t i = 0; i < builds.size(); ++i) {
    result.jobs.Add(
        {builds[i].first, set.boxes.size(), RangeOf(ns[i]).median / 1e6});
  }
}

// Each is a BVH of its own, so that none finds what another has left in the
// caches.
void RunRefits(Run& run, const BoxSet<3>& set, Result& result) {
  constexpr std::size_t kPlanes = detail::kPlaneCount<Aabb3>;
  const std::span<const Aabb3> boxes = set.boxes;
  Bvh3 in_order(boxes);
  Bvh3 by_id(boxes);
  World<AabbView3> bounds;
  for (std::uint32_t id : in_order.ids()) bounds.Push(boxes[id]);
  // A refit reads the floats and writes them and the codes; a copy moves as
  // many bytes, half of them each way.
  const std::size_t moved =
      boxes.size() * kPlanes * (2 * sizeof(float) + sizeof(std::int16_t));
  std::vector<std::byte> from(moved / 2, std::byte{1});
  std::vector<std::byte> to(moved / 2);
  Contest contest(run, "bvh/refit");
  const auto add = [&](const char* name, const Bvh3* tree, auto refit) {
    Case c;
    c.run = refit;
    c.check = [tree, refit]() -> std::string {
      refit();
      if (tree == nullptr || tree->CostRatio() == 1.0) return {};
      return "the same bounds make another world";
    };
    contest.Add(name, "", Who::kOurs, std::move(c));
  };
  add("refit, in order", &in_order,
      [&] { in_order.RefitInOrder(bounds.view()); });
  add("refit, by id, of a list", &by_id, [&] { by_id.Refit(boxes); });
  add("copy of as many bytes", nullptr,
      [&] { std::memcpy(to.data(), from.data(), to.size()); });
  contest.Time(std::max<std::size_t>(5, run.effort.repetitions));
  result.AddJobs(contest, boxes.size());
}

// A case of a job, of which run() returns how many pairs there are.
template <typename Run>
Case CountedCase(std::size_t expected, Run run) {
  Case c;
  c.run = [run] { std::ignore = run(); };
  c.check = [expected, run]() -> std::string {
    const std::size_t count = run();
    if (count == expected) return {};
    return std::to_string(count) + " pairs, and not " +
           std::to_string(expected);
  };
  return c;
}

void RunPairs(Run& run, const BoxSet<3>& set, Target target, Result& result) {
  const PairOptions options{.target = target};
  Bvh3 world(set.boxes);
  std::vector<IdPair> pairs(Pairs(world, {}, options));
  std::vector<IndexPair> found;
  found.reserve(pairs.size());
  Contest contest(run, "bvh/pairs");
  contest.Add("pairs", "", Who::kOurs, CountedCase(pairs.size(), [&] {
                return Pairs(world, pairs, options);
              }));
  contest.Add("fast build and pairs", "", Who::kOurs,
              CountedCase(pairs.size(), [&] {
                return Pairs(Bvh3(set.boxes, {.quality = BuildQuality::kFast}),
                             pairs, options);
              }));
  // The pairs of a few objects, and a query for each.
  Ids moved;
  for (std::size_t i = 0; i < set.boxes.size();
       i += std::max<std::size_t>(1, set.boxes.size() / 256)) {
    moved.push_back(static_cast<std::uint32_t>(i));
  }
  world.Reserve(world.size());  // as if they had been moved by id
  std::vector<bool> is_moved(set.boxes.size());
  for (std::uint32_t id : moved) is_moved[id] = true;
  std::ignore = Pairs(world, pairs, options);
  std::size_t of_moved = 0;
  std::size_t survivors = moved.size();  // themselves
  for (const IdPair& pair : pairs) {
    of_moved += is_moved[pair.a] || is_moved[pair.b] ? 1 : 0;
    survivors += (is_moved[pair.a] ? 1 : 0) + (is_moved[pair.b] ? 1 : 0);
  }
  const std::string some = std::to_string(moved.size());
  contest.Add("pairs of " + some + " objects", "", Who::kOurs,
              CountedCase(of_moved, [&] {
                return PairsOf(world, moved, pairs, options);
              }));
  Ids ids(set.boxes.size());
  contest.Add(some + " queries", "", Who::kOurs, CountedCase(survivors, [&] {
                std::size_t count = 0;
                for (std::uint32_t id : moved) {
                  count +=
                      Survivors(world, set.boxes[id], ids, {.target = target});
                }
                return count;
              }));
  for (const auto& competitor : Registered<PairFinder>::All()) {
    if (set.boxes.size() > competitor.most) continue;
    contest.Add(competitor.name + ", build", "", Who::kCompetitor,
                CountedCase(0, [&] {
                  std::ignore = competitor.make(set.boxes);
                  return std::size_t{0};
                }));
    contest.Add(
        competitor.name + ", pairs", "", Who::kCompetitor,
        CountedCase(pairs.size(), [&found, finder = std::shared_ptr<PairFinder>(
                                               competitor.make(set.boxes))] {
          finder->Pairs(found);
          return found.size();
        }));
  }
  contest.Time(3);
  result.AddJobs(contest, set.boxes.size());
}

// One kind of search, by a BVH and by others, over queries of a type.
template <typename Query>
class Search {
 public:
  Search(Run& run, std::string name, const std::vector<Query>& queries)
      : run_(run),
        name_(std::move(name)),
        queries_(queries),
        contest_(run, "bvh/" + name_) {}

  // number(query, find(query)) is the same for all that are added. `per_run` of
  // the queries are asked in a run, and the next ones in the next.
  template <typename Find, typename Number>
  void Add(const std::string& name, const std::string& target, Who who,
           std::size_t per_run, Find find, Number number) {
    Case c = InTurn("", queries_, queries_.size(), per_run,
                    [find](const Query& query) { std::ignore = find(query); });
    c.check = [this, find, number]() -> std::string {
      std::vector<std::size_t> numbers;
      for (std::size_t q = 0; q < 20; ++q) {
        numbers.push_back(number(queries_[q], find(queries_[q])));
      }
      if (expected_.empty()) expected_ = numbers;
      return numbers == expected_ ? "" : "the answers differ";
    };
    contest_.Add(name, target, who, std::move(c));
  }

  void Time(std::size_t objects, Table& table) {
    contest_.Time(run_.effort.repetitions);
    for (std::size_t i = 0; i < contest_.size(); ++i) {
      table.Add({name_, objects, contest_.name(i), contest_.target(i),
                 contest_.timing(i).Median() / 1e3, contest_.OverFastest(i),
                 Cell()});
    }
  }

 private:
  Run& run_;
  std::string name_;
  const std::vector<Query>& queries_;
  Contest contest_;
  std::vector<std::size_t> expected_;
};

void RunSearches(Run& run, const BoxSet<3>& set, Target target,
                 Result& result) {
  constexpr float kHalfWorld = 50.0f;
  const std::string target_name = NameOf(target);
  const Bvh3 world(set.boxes);
  Random random(run.options.seed);
  Ids found(set.boxes.size());
  const auto itself = [](const auto&, std::size_t count) { return count; };

  // A tenth of the world: its third root of each axis.
  constexpr float kHalfSide = 0.4642f * kHalfWorld;
  std::vector<Aabb3> large(kTimedQueries);
  std::vector<Point<3>> points(kTimedQueries);
  for (std::size_t q = 0; q < kTimedQueries; ++q) {
    for (std::size_t k = 0; k < 3; ++k) {
      const float center = (kHalfWorld - kHalfSide) * random.Signed();
      large[q].min[k] = center - kHalfSide;
      large[q].max[k] = center + kHalfSide;
    }
    for (float& x : points[q]) x = kHalfWorld * random.Signed();
  }

  {
    Search<Aabb3> counts(run, "counts of a tenth", large);
    counts.Add(
        "counts", target_name, Who::kOurs, 2000,
        [&](const Aabb3& query) {
          return CountSurvivors(world, query, {.target = target});
        },
        itself);
    counts.Add(
        "ids", target_name, Who::kOurs, 200,
        [&](const Aabb3& query) {
          return Survivors(world, query, found, {.target = target});
        },
        itself);
    for (const auto& competitor : Registered<BoxTree<3>>::All()) {
      if (set.boxes.size() > competitor.most) continue;
      const std::shared_ptr<const BoxTree<3>> tree = competitor.make(set.boxes);
      if (!tree->CanCount()) continue;
      counts.Add(
          competitor.name, "", Who::kCompetitor, 5,
          [tree](const Aabb3& query) { return tree->Count(query); }, itself);
    }
    counts.Time(set.boxes.size(), result.queries);
  }
  {
    constexpr std::size_t kCount = 8;
    Search<Point<3>> nearest(run, "nearest 8", points);
    // Many boxes are equally far away, so the answer is a distance: of the
    // last.
    const auto farthest = [&set](const Point<3>& point, auto&& ids) {
      double most = 0;
      for (std::uint32_t id : ids) {
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const double beyond =
              std::max({set.boxes[id].min[k] - point[k],
                        point[k] - set.boxes[id].max[k], 0.0f});
          square += beyond * beyond;
        }
        most = std::max(most, square);
      }
      return static_cast<std::size_t>(1e6 * std::sqrt(most)) + ids.size();
    };
    std::array<std::uint32_t, kCount> ids;
    std::array<float, kCount> distances;
    nearest.Add(
        "nearest", target_name, Who::kOurs, 2000,
        [&](const Point<3>& point) {
          constexpr float kFar = std::numeric_limits<float>::infinity();
          return std::span(ids).first(
              KNearest(world, point, ids, distances, kFar, {.target = target}));
        },
        farthest);
    for (const auto& competitor : Registered<NearestTree>::All()) {
      nearest.Add(
          competitor.name, "", Who::kCompetitor, 200,
          [&found, tree = std::shared_ptr<NearestTree>(
                       competitor.make(set.boxes))](const Point<3>& point) {
            tree->Nearest(point, kCount, found);
            return std::span<const std::uint32_t>(found);
          },
          farthest);
    }
    nearest.Time(set.boxes.size(), result.queries);
  }
}

bool HasMemoryFor(std::size_t objects) {
  const std::size_t available = FreeMemory();
  return available == 0 || objects < available / kBytesOfBox;
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
  const Bvh3 world(view);
  std::size_t found = 0;
  for (const Aabo3& query : input->queries) {
    found += CountSurvivors(world, query.aabb());
  }
  if (found > kMostFound * input->queries.size()) {
    return "a query finds more than " + std::to_string(kMostFound) + " boxes";
  }
  return {};
}

}  // namespace

Tables RunBvh(Run& run) {
  const std::uint64_t seed = run.options.seed;
  const Target best = run.WidthTargets().front();
  std::vector<Target> targets = {best};
  for (Target target : run.WidthTargets()) {
    if (target.name() == "AVX2" && target != best) targets.push_back(target);
  }
  Result result;
  std::size_t most = run.is_quick() ? 100'000 : 1'000'000;
  if (run.options.objects != 0) most = std::min(most, run.options.objects);
  if (most > 100'000 && !HasMemoryFor(most)) {
    most = 100'000;
    result.queries.notes.push_back(
        "Not measured: more than 100 000 boxes, which do not fit the free "
        "memory.");
  }
  const auto uniform = [seed](std::size_t objects) {
    return MakeUniformBoxes<3>("a", objects, kSide3D, seed);
  };

  Parts parts;
  for (std::size_t objects : UpTo(most, {1000, 10'000, 100'000, 1'000'000})) {
    parts.emplace_back(
        [&, objects] { RunQueries(run, uniform(objects), targets, result); });
  }
  // Of clusters all ways, and more objects. Of a quick run, the first three
  // with few objects.
  const std::span<const SkewedWorld> worlds =
      SkewedWorlds().first(run.is_quick() ? 3 : SkewedWorlds().size());
  for (const SkewedWorld& world : worlds) {
    const bool is_first = &world == worlds.data();
    for (std::size_t objects :
         is_first
             ? UpTo(most, {100'000, 1'000'000})
             : UpTo(run.is_quick() ? std::min<std::size_t>(most, 10'000) : most,
                    {10'000, 100'000})) {
      parts.emplace_back([&, objects, is_first] {
        BoxSet<3> set = world.make(objects, kSide3D, seed);
        set.name = world.name;
        RunQueries(run, set, is_first ? std::vector{best} : targets, result,
                   !is_first);
      });
    }
  }
  if (const std::string why = WhyNot(run.input()); why.empty()) {
    parts.emplace_back([&] {
      RunQueries(run, BoxesOf("file", *run.input()), {best}, result);
    });
  } else {
    result.queries.notes.push_back("Not measured: the boxes of a file: " + why +
                                   ".");
  }
  for (std::size_t objects : UpTo(most, {100'000, 1'000'000})) {
    parts.emplace_back([&, objects] {
      RunQueries(run, MakeUniformBoxes<2>("2D", objects, kSide2D, seed), {best},
                 result);
    });
  }
  parts.emplace_back([&] { RunBuilds(run, uniform(most), result); });
  parts.emplace_back([&] { RunRefits(run, uniform(most), result); });
  for (std::size_t objects : UpTo(most, {100'000, 1'000'000})) {
    parts.emplace_back(
        [&, objects] { RunPairs(run, uniform(objects), best, result); });
  }
  parts.emplace_back([&] { RunSearches(run, uniform(most), best, result); });
  RunParts(run, parts);
  return {result.queries, result.jobs};
}

}  // namespace halfspace::bench

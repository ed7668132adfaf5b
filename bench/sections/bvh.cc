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
#include "bench/sections/contest.h"
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

// All structures of a workload together.
constexpr std::size_t kBytesOfBox = 1500;
// In one turn of the structures, after which each has evicted the others.
constexpr std::size_t kQueriesInTurn = 2000;

// As many survivors of a query in 2D as in 3D, with the same number of objects:
// (2 * 0.37 / 100)^2 is (2 * 1.9 / 100)^3.
constexpr float kSide3D = 1.9f;
constexpr float kSide2D = 0.37f;

// One kind of query, by BVHs and by others: all queries in a row, and in turns
// with the others if `is_in_turns`. The first `checked` are checked.
class Search {
 public:
  Search(Run& run, std::string world, std::size_t objects, std::size_t checked,
         bool is_in_turns)
      : world_(std::move(world)),
        objects_(objects),
        checked_(checked),
        is_in_turns_(is_in_turns),
        row_(run, "bvh"),
        turns_(run, "bvh, in turns") {}

  // find(q) answers query number q, `in_a_row` of them a run, and is_right(q,
  // find(q)) tells whether that is the answer.
  template <typename Find, typename IsRight>
  void Add(const std::string& name, const std::string& target, Who who,
           std::size_t in_a_row, Find find, IsRight is_right) {
    const auto check = [this, find, is_right]() -> std::string {
      for (std::size_t q = 0; q < checked_; ++q) {
        if (!is_right(q, find(q))) return "a query has other answers";
      }
      return {};
    };
    AddCases(name, target, who, in_a_row, check, [find](std::size_t count) {
      return InTurn(kTimedQueries, count,
                    [find](std::size_t q) { std::ignore = find(q); });
    });
  }
  // case_of(n) asks n queries in a run, and the next ones in the next run.
  template <typename CaseOf>
  void AddCases(const std::string& name, const std::string& target, Who who,
                std::size_t in_a_row, std::function<std::string()> check,
                const CaseOf& case_of) {
    const Row keys = {world_, objects_, name, target};
    Case c = case_of(in_a_row);
    c.check = std::move(check);
    row_.Add(keys, std::move(c), who);
    if (is_in_turns_) turns_.Add(keys, case_of(kQueriesInTurn), who);
  }

  void Time(std::size_t repetitions, Table& table) {
    row_.TimeOnce(repetitions);
    // So many that each has all queries.
    if (is_in_turns_) {
      turns_.TimeOnce(std::max(repetitions, kTimedQueries / kQueriesInTurn));
    }
    row_.AddTo(table, [&](std::size_t i) -> Row {
      return {row_.timing(i).Median() / 1e3, row_.OverFastest(i),
              is_in_turns_ ? Cell(turns_.timing(i).Median() / 1e3) : Cell()};
    });
  }

 private:
  std::string world_;
  std::size_t objects_;
  std::size_t checked_;
  bool is_in_turns_;
  Contest row_;
  Contest turns_;
};

// The box queries of a set, by all that can answer them, and by a BVH in one
// call, too.
template <int kDims>
void RunQueries(Run& run, const BoxSet<kDims>& set, Target target,
                Table& table) {
  using Box = Aabb<kDims>;
  using Tree = Bvh<AabbView<kDims>>;
  using Found = std::span<const std::uint32_t>;
  const std::size_t objects = set.boxes.size();
  // The answers of a flat scan of the floats, for as many queries as it answers
  // in a moment.
  const World<AabbView<kDims>> boxes(set.boxes);
  std::vector<Ids> expected(
      std::clamp<std::size_t>(50'000'000 / objects, 20, 1000));
  Ids found(objects);
  const auto found_in = [&found](const auto& world, const Box& query,
                                 const auto& options) {
    return Found(found).first(Survivors(world, query, found, options));
  };
  for (std::size_t q = 0; q < expected.size(); ++q) {
    const Found kept = found_in(boxes.view(), set.queries[q],
                                Options{.schedule = Schedule::kFlat});
    expected[q].assign(kept.begin(), kept.end());
  }
  const auto is_right = [&expected](std::size_t q, Found ids) {
    Ids sorted(ids.begin(), ids.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted == expected[q];
  };

  Search search(run, set.name, objects, expected.size(), true);
  // Each row has a copy of the world, so that in turns with the others it finds
  // the caches as a tree finds them.
  const auto tree = std::make_shared<const Tree>(boxes.view());
  search.Add(
      "tight, one query a call", NameOf(target), Who::kOurs, kTimedQueries,
      [&set, found_in, tree, target](std::size_t q) {
        return found_in(*tree, set.queries[q], QueryOptions{.target = target});
      },
      is_right);
  std::size_t sum = 0;
  for (const Box& query : set.queries) sum += CountSurvivors(*tree, query);
  Ids all_ids(sum);
  std::vector<std::size_t> offsets(kTimedQueries + 1);
  const auto ask = [&all_ids, &offsets, target,
                    tree = std::make_shared<const Tree>(*tree)](
                       std::span<const Box> queries) {
    std::ignore =
        SurvivorsOfEach(*tree, queries, all_ids, offsets, {.target = target});
  };
  const auto check = [&, ask]() -> std::string {
    ask(std::span(set.queries).first(expected.size()));
    for (std::size_t q = 0; q < expected.size(); ++q) {
      const std::size_t count = offsets[q + 1] - offsets[q];
      if (!is_right(q, Found(all_ids).subspan(offsets[q], count))) {
        return "a query of a call has other answers";
      }
    }
    return {};
  };
  search.AddCases(
      "tight, all in one call", NameOf(target), Who::kOurs, kTimedQueries,
      check, [&](std::size_t count) {
        Case c =
            InTurn(kTimedQueries / count, 1, [&set, ask, count](std::size_t i) {
              ask(std::span(set.queries).subspan(i * count, count));
            });
        c.items = static_cast<double>(count);
        return c;
      });
  Ids listed;  // by a competitor
  for (const auto& competitor : Registered<BoxTree<kDims>>::AllFor(objects)) {
    search.Add(
        competitor.name, "", Who::kCompetitor, kTimedQueries,
        [&, tree = std::shared_ptr<const BoxTree<kDims>>(
                competitor.make(set.boxes))](std::size_t q) {
          tree->Find(set.queries[q], listed);
          return Found(listed);
        },
        is_right);
  }
  search.Time(objects < 1'000'000
                  ? run.effort.repetitions
                  : std::min<std::size_t>(run.effort.repetitions, 5),
              table);
}

// What is done to all objects, and to a few of them.
void RunJobs(Run& run, const BoxSet<3>& set, Target target, Table& table) {
  const std::span<const Aabb3> boxes = set.boxes;
  std::shared_ptr<const void> made;
  Contest contest(run, "bvh/jobs");
  // job() returns `expected` if it was done right.
  const auto add = [&](const std::string& name, std::size_t expected,
                       auto job) {
    Case c;
    c.run = [job] { std::ignore = job(); };
    c.after = [&made] { made = nullptr; };  // its end is no part of a build
    c.check = [expected, job]() -> std::string {
      const std::size_t count = job();
      if (count == expected) return {};
      return std::to_string(count) + ", and not " + std::to_string(expected);
    };
    contest.Add({name, boxes.size()}, std::move(c));
  };

  for (const auto& [name, quality] : {std::pair("tight", BuildQuality::kHigh),
                                      std::pair("fast", BuildQuality::kFast)}) {
    add(name, boxes.size(), [&made, boxes, quality = quality] {
      auto bvh =
          std::make_shared<const Bvh3>(boxes, BuildOptions{.quality = quality});
      made = bvh;
      return bvh->size();
    });
  }
  for (const auto& competitor : Registered<BoxTree<3>>::AllFor(boxes.size())) {
    add(competitor.name, 1, [&made, boxes, competitor] {
      made = std::shared_ptr<const void>(competitor.make(boxes));
      return std::size_t{1};
    });
  }

  // Each is a BVH of its own, so that none finds what another has left in the
  // caches. The same bounds make the same world.
  Bvh3 in_order(boxes);
  Bvh3 by_id(boxes);
  World<AabbView3> bounds;
  for (std::uint32_t id : in_order.ids()) bounds.Push(boxes[id]);
  const auto is_same = [](const Bvh3& bvh) -> std::size_t {
    return bvh.CostRatio() == 1.0 ? 1 : 0;
  };
  add("refit, in order", 1, [&] {
    in_order.RefitInOrder(bounds.view());
    return is_same(in_order);
  });
  add("refit, by id, of a list", 1, [&] {
    by_id.Refit(boxes);
    return is_same(by_id);
  });
  // A refit reads the floats and writes them and the codes; a copy moves as
  // many bytes, half of them each way.
  const std::size_t moved_bytes = boxes.size() * detail::kPlaneCount<Aabb3> *
                                  (2 * sizeof(float) + sizeof(std::int16_t));
  std::vector<std::byte> from(moved_bytes / 2, std::byte{1});
  std::vector<std::byte> to(moved_bytes / 2);
  add("copy of as many bytes", 1, [&] {
    std::memcpy(to.data(), from.data(), to.size());
    return std::to_integer<std::size_t>(to.back());
  });

  const PairOptions options{.target = target};
  Bvh3 world(boxes);
  std::vector<IdPair> pairs(Pairs(world, {}, options));
  add("pairs", pairs.size(), [&] { return Pairs(world, pairs, options); });
  add("fast build and pairs", pairs.size(), [&] {
    return Pairs(Bvh3(boxes, {.quality = BuildQuality::kFast}), pairs, options);
  });
  // The pairs of a few objects, and a query for each.
  Ids moved;
  for (std::size_t i = 0; i < boxes.size();
       i += std::max<std::size_t>(1, boxes.size() / 256)) {
    moved.push_back(static_cast<std::uint32_t>(i));
  }
  world.Reserve(world.size());  // as if they had been moved by id
  std::vector<bool> is_moved(boxes.size());
  for (std::uint32_t id : moved) is_moved[id] = true;
  std::ignore = Pairs(world, pairs, options);
  std::size_t of_moved = 0;
  std::size_t survivors = moved.size();  // themselves
  for (const IdPair& pair : pairs) {
    of_moved += is_moved[pair.a] || is_moved[pair.b] ? 1 : 0;
    survivors += (is_moved[pair.a] ? 1 : 0) + (is_moved[pair.b] ? 1 : 0);
  }
  const std::string some = std::to_string(moved.size());
  add("pairs of " + some + " objects", of_moved,
      [&] { return PairsOf(world, moved, pairs, options); });
  Ids ids(boxes.size());
  add(some + " queries", survivors, [&] {
    std::size_t count = 0;
    for (std::uint32_t id : moved) {
      count += Survivors(world, boxes[id], ids, {.target = target});
    }
    return count;
  });
  std::vector<IndexPair> found;
  found.reserve(pairs.size());
  for (const auto& competitor : Registered<PairFinder>::AllFor(boxes.size())) {
    add(competitor.name + ", build", 1, [&made, boxes, competitor] {
      made = std::shared_ptr<const void>(competitor.make(boxes));
      return std::size_t{1};
    });
    add(competitor.name + ", pairs", pairs.size(),
        [&found, finder = std::shared_ptr<PairFinder>(competitor.make(boxes))] {
          finder->Pairs(found);
          return found.size();
        });
  }
  contest.TimeOnce(std::min<std::size_t>(run.effort.repetitions, 5));
  contest.AddTo(table, [&](std::size_t i) -> Row {
    return {contest.timing(i).Median() / 1e6};
  });
}

void RunSearches(Run& run, const BoxSet<3>& set, Target target, Table& table) {
  constexpr std::size_t kChecked = 20;
  constexpr std::size_t kCount = 8;
  constexpr float kHalfWorld = 50.0f;
  const std::string target_name = NameOf(target);
  const std::size_t objects = set.boxes.size();
  const Bvh3 world(set.boxes);
  Random random(run.options.seed);

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

  Ids found(objects);
  Search counts(run, "counts of a tenth", objects, kChecked, false);
  const AabbWorld3 boxes(set.boxes);
  const auto is_count = [&](std::size_t q, std::size_t count) {
    return count == CountSurvivors(boxes, large[q]);
  };
  counts.Add(
      "counts", target_name, Who::kOurs, 2000,
      [&](std::size_t q) {
        return CountSurvivors(world, large[q], {.target = target});
      },
      is_count);
  for (const auto& competitor : Registered<BoxTree<3>>::AllFor(objects)) {
    const std::shared_ptr<const BoxTree<3>> tree = competitor.make(set.boxes);
    if (!tree->CanCount()) continue;
    counts.Add(
        competitor.name, "", Who::kCompetitor, 5,
        [&, tree](std::size_t q) { return tree->Count(large[q]); }, is_count);
  }
  counts.Time(run.effort.repetitions, table);

  // Many boxes are equally far away, so the answer is a distance: of the last.
  const auto square_of = [&](const Point<3>& point, std::uint32_t id) {
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double beyond = std::max({set.boxes[id].min[k] - point[k],
                                      point[k] - set.boxes[id].max[k], 0.0f});
      square += beyond * beyond;
    }
    return square;
  };
  Search nearest(run, "nearest 8", objects, kChecked, false);
  const auto is_nearest = [&](std::size_t q,
                              std::span<const std::uint32_t> ids) {
    std::vector<double> squares;
    for (std::uint32_t id = 0; id < objects; ++id) {
      squares.push_back(square_of(points[q], id));
    }
    const auto last = static_cast<std::ptrdiff_t>(std::min(kCount, objects));
    std::nth_element(squares.begin(), squares.begin() + last - 1,
                     squares.end());
    double most = 0;
    for (std::uint32_t id : ids) {
      most = std::max(most, square_of(points[q], id));
    }
    // Floats round the distances.
    return ids.size() == static_cast<std::size_t>(last) &&
           most <= (1 + 1e-5) * squares[static_cast<std::size_t>(last - 1)];
  };
  std::array<std::uint32_t, kCount> ids;
  std::array<float, kCount> distances;
  nearest.Add(
      "nearest", target_name, Who::kOurs, 2000,
      [&](std::size_t q) {
        constexpr float kFar = std::numeric_limits<float>::infinity();
        return std::span<const std::uint32_t>(ids).first(KNearest(
            world, points[q], ids, distances, kFar, {.target = target}));
      },
      is_nearest);
  for (const auto& competitor : Registered<NearestTree>::All()) {
    nearest.Add(
        competitor.name, "", Who::kCompetitor, 200,
        [&, tree = std::shared_ptr<NearestTree>(competitor.make(set.boxes))](
            std::size_t q) {
          tree->Nearest(points[q], kCount, found);
          return std::span<const std::uint32_t>(found);
        },
        is_nearest);
  }
  nearest.Time(run.effort.repetitions, table);
}

}  // namespace

Tables RunBvh(Run& run) {
  const std::uint64_t seed = run.options.seed;
  const Target target = run.best();
  Table table{"bvh",
              "us a query; times as fast as the fastest competitor",
              {Key("world"), Key("objects"), Key("what"), Key("target"),
               Value("in a row", "us", 3), Higher("times"),
               Value("in turns", "us", 3)}};
  Table jobs{"bvh: jobs",
             "what is done to all objects at once",
             {Key("job"), Key("objects"), Value("time", "ms", 1)}};
  std::size_t most = run.MostObjects(1'000'000, /*of_quick=*/10'000);
  const std::size_t available = FreeMemory();
  if (available != 0 && most > available / kBytesOfBox) {
    most = std::min<std::size_t>(most, 100'000);
    table.notes.push_back(
        "Not measured: more than 100 000 boxes, which do not fit the free "
        "memory.");
  }
  const auto uniform = [seed](std::size_t objects) {
    return MakeUniformBoxes<3>("a", objects, kSide3D, seed);
  };

  Parts parts;
  for (std::size_t objects : UpTo(most, {1000, 10'000, 100'000, 1'000'000})) {
    parts.emplace_back(
        [&, objects] { RunQueries(run, uniform(objects), target, table); });
  }
  for (const SkewedWorld& world : SkewedWorlds()) {
    for (std::size_t objects : UpTo(most, {10'000, 100'000})) {
      parts.emplace_back([&, objects] {
        BoxSet<3> set = world.make(objects, kSide3D, seed);
        set.name = world.name;
        RunQueries(run, set, target, table);
      });
    }
  }
  for (std::size_t objects : UpTo(most, {100'000, 1'000'000})) {
    parts.emplace_back([&, objects] {
      RunQueries(run, MakeUniformBoxes<2>("2D", objects, kSide2D, seed), target,
                 table);
    });
  }
  for (std::size_t objects : UpTo(most, {100'000, 1'000'000})) {
    parts.emplace_back(
        [&, objects] { RunJobs(run, uniform(objects), target, jobs); });
  }
  parts.emplace_back([&] { RunSearches(run, uniform(most), target, table); });
  RunParts(run, parts);
  return {table, jobs};
}

}  // namespace halfspace::bench

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
#include "halfspace/mesh.h"
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
template <typename Answer>
struct Search {
  Run& run;
  std::string world;
  std::size_t objects;
  bool is_in_turns;
  std::size_t checked;
  // Whether that is the answer to query number q.
  std::function<bool(std::size_t q, Answer answer)> is_right;
  Contest row{run, "bvh"};
  Contest turns{run, "bvh, in turns"};

  // find(q) answers query number q, `in_a_row` of them a run. Competitors have
  // no target.
  template <typename Find>
  void Add(const std::string& name, const std::string& target,
           std::size_t in_a_row, Find find) {
    AddCases(
        name, target, in_a_row,
        CheckOf(checked, "the query has other answers",
                [this, find](std::size_t q) { return is_right(q, find(q)); }),
        [find](std::size_t count) {
          return InTurn(kTimedQueries, count,
                        [find](std::size_t q) { std::ignore = find(q); });
        });
  }
  // case_of(n) asks n queries in a run, and the next ones in the next run.
  template <typename CaseOf>
  void AddCases(const std::string& name, const std::string& target,
                std::size_t in_a_row, std::function<std::string()> check,
                const CaseOf& case_of) {
    const Row keys = {world, objects, name, target};
    const Who who = target.empty() ? Who::kCompetitor : Who::kOurs;
    Case c = case_of(in_a_row);
    c.check = std::move(check);
    row.Add(keys, std::move(c), who);
    if (is_in_turns) turns.Add(keys, case_of(kQueriesInTurn), who);
  }

  void Time(std::size_t repetitions, Table& table) {
    row.TimeOnce(repetitions);
    // So many that each has all queries.
    if (is_in_turns) {
      turns.TimeOnce(std::max(repetitions, kTimedQueries / kQueriesInTurn));
    }
    row.AddTo(table, [&](std::size_t i) -> Row {
      return {row.Median(i) / 1e3, row.OverFastest(i),
              is_in_turns ? Cell(turns.Median(i) / 1e3) : Cell()};
    });
  }
};

using Found = std::span<const std::uint32_t>;

// The box queries of a set, by all that can answer them, and by a BVH in one
// call, too.
template <int kDims>
void RunQueries(Run& run, const BoxSet<kDims>& set, Table& table) {
  const std::size_t objects = set.boxes.size();
  const std::span<const Aabb<kDims>> queries = set.queries;
  const QueryOptions options{.target = run.best()};
  // The answers of a flat scan of the floats, for as many queries as it answers
  // in a moment.
  const World<AabbView<kDims>> boxes(set.boxes);
  std::vector<Ids> expected(
      std::clamp<std::size_t>(50'000'000 / objects, 20, 1000));
  Ids found(objects);
  for (std::size_t q = 0; q < expected.size(); ++q) {
    const Found kept = Found(found).first(Survivors(
        boxes.view(), queries[q], found, {.schedule = Schedule::kFlat}));
    expected[q].assign(kept.begin(), kept.end());
  }
  const auto is_right = [&expected](std::size_t q, Found ids) {
    Ids sorted(ids.begin(), ids.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted == expected[q];
  };

  Search<Found> search{run, set.name, objects, true, expected.size(), is_right};
  // Each row has a copy of the world, so that in turns with the others it finds
  // the caches as a tree finds them.
  const Bvh<AabbView<kDims>> tree(boxes.view());
  const Bvh<AabbView<kDims>> copy = tree;
  const std::string target = NameOf(run.best());
  search.Add(
      "tight, one query a call", target, kTimedQueries, [&](std::size_t q) {
        return Found(found).first(Survivors(tree, queries[q], found, options));
      });
  std::size_t sum = 0;
  for (const Aabb<kDims>& query : queries) sum += CountSurvivors(tree, query);
  Ids all_ids(sum);
  std::vector<std::size_t> offsets(kTimedQueries + 1);
  const auto ask = [&](std::size_t first, std::size_t count) {
    std::ignore = SurvivorsOfEach(copy, queries.subspan(first, count), all_ids,
                                  offsets, options);
  };
  search.AddCases(
      "tight, all in one call", target, kTimedQueries,
      CheckOf(expected.size(), "a query of a call has other answers",
              [&](std::size_t q) {
                if (q == 0) ask(0, expected.size());
                return is_right(
                    q, Found(all_ids).subspan(offsets[q],
                                              offsets[q + 1] - offsets[q]));
              }),
      [&](std::size_t count) {
        Case c = InTurn(kTimedQueries / count, 1,
                        [ask, count](std::size_t i) { ask(i * count, count); });
        c.items = static_cast<double>(count);
        return c;
      });
  Ids listed;  // by a competitor
  for (const auto& competitor : Registered<BoxTree<kDims>>::AllFor(objects)) {
    search.Add(competitor.name, "", kTimedQueries,
               [&, its_tree = std::shared_ptr<const BoxTree<kDims>>(
                       competitor.make(set.boxes))](std::size_t q) {
                 its_tree->Find(queries[q], listed);
                 return Found(listed);
               });
  }
  search.Time(run.AtMostRepetitions(objects < 1'000'000 ? 1000 : 5), table);
}

// What is done to all objects, and to a few of them.
void RunJobs(Run& run, const BoxSet<3>& set, Table& table) {
  const std::span<const Aabb3> boxes = set.boxes;
  const Target target = run.best();
  Contest contest(run, "bvh/jobs");
  std::shared_ptr<const void> made;
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
  const auto add_build = [&](const std::string& name, auto make) {
    add(name, 1, [&made, make] {
      made = make();
      return std::size_t{made != nullptr};
    });
  };

  for (const auto& [name, quality] : {std::pair("tight", BuildQuality::kHigh),
                                      std::pair("fast", BuildQuality::kFast)}) {
    add_build(name, [boxes, options = BuildOptions{.quality = quality}] {
      return std::make_shared<const Bvh3>(boxes, options);
    });
  }
  for (const auto& competitor : Registered<BoxTree<3>>::AllFor(boxes.size())) {
    add_build(competitor.name,
              [boxes, competitor] { return competitor.make(boxes); });
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
    add_build(competitor.name + ", build",
              [boxes, competitor] { return competitor.make(boxes); });
    add(competitor.name + ", pairs", pairs.size(),
        [&found, finder = std::shared_ptr<PairFinder>(competitor.make(boxes))] {
          finder->Pairs(found);
          return found.size();
        });
  }
  contest.TimeOnce(run.AtMostRepetitions(5));
  contest.AddTo(
      table, [&](std::size_t i) -> Row { return {contest.Median(i) / 1e6}; });
}

void RunSearches(Run& run, const BoxSet<3>& set, Table& table) {
  constexpr std::size_t kChecked = 20;
  constexpr std::size_t kCount = 8;
  constexpr float kHalfWorld = 50.0f;
  const QueryOptions options{.target = run.best()};
  const std::string target = NameOf(run.best());
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

  const AabbWorld3 boxes(set.boxes);
  const auto is_count = [&](std::size_t q, std::size_t count) {
    return count == CountSurvivors(boxes, large[q]);
  };
  Search<std::size_t> counts{
      run, "counts of a tenth", objects, false, kChecked, is_count};
  counts.Add("counts", target, 2000, [&](std::size_t q) {
    return CountSurvivors(world, large[q], options);
  });
  for (const auto& competitor : Registered<BoxTree<3>>::AllFor(objects)) {
    const std::shared_ptr<const BoxTree<3>> tree = competitor.make(set.boxes);
    if (!tree->CanCount()) continue;
    counts.Add(competitor.name, "", 5,
               [&, tree](std::size_t q) { return tree->Count(large[q]); });
  }
  counts.Time(run.effort.repetitions, table);

  const auto is_nearest = [&](std::size_t q, Found ids) {
    return AreNearest(set.boxes, points[q], kCount, ids);
  };
  Search<Found> nearest{run, "nearest 8", objects, false, kChecked, is_nearest};
  std::array<std::uint32_t, kCount> ids;
  std::array<float, kCount> distances;
  const SearchOptions near{.target = run.best()};
  nearest.Add("nearest", target, 2000, [&](std::size_t q) {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    return Found(ids).first(
        KNearest(world, points[q], ids, distances, kFar, near));
  });
  Ids listed(objects);
  for (const auto& competitor : Registered<NearestTree>::All()) {
    nearest.Add(competitor.name, "", 200,
                [&, tree = std::shared_ptr<NearestTree>(
                        competitor.make(set.boxes))](std::size_t q) {
                  tree->Nearest(points[q], kCount, listed);
                  return Found(listed);
                });
  }
  nearest.Time(run.effort.repetitions, table);
}

// About so many triangles: a sphere with bumps.
std::vector<Triangle3> BumpySphere(std::size_t triangles) {
  constexpr double kPi = 3.14159265358979;
  const auto rows =
      static_cast<std::size_t>(std::sqrt(static_cast<double>(triangles) / 4));
  const auto at = [rows](std::size_t row, std::size_t column) {
    const double down =
        kPi * static_cast<double>(row) / static_cast<double>(rows);
    const double around =
        kPi * static_cast<double>(column) / static_cast<double>(rows);
    const double radius = 40 + 4 * std::sin(7 * down) * std::sin(9 * around);
    return Point3{
        static_cast<float>(radius * std::sin(down) * std::cos(around)),
        static_cast<float>(radius * std::sin(down) * std::sin(around)),
        static_cast<float>(radius * std::cos(down))};
  };
  std::vector<Triangle3> sphere;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < 2 * rows; ++column) {
      const Point3 a = at(row, column);
      const Point3 c = at(row + 1, column + 1);
      sphere.push_back({a, at(row + 1, column), c});
      sphere.push_back({a, c, at(row, column + 1)});
    }
  }
  return sphere;
}

// Rays and points in all directions and places, on triangles.
void RunTriangles(Run& run, std::size_t objects, Table& table) {
  constexpr std::size_t kChecked = 1000;
  constexpr float kHalfWorld = 50.0f;
  constexpr float kFar = std::numeric_limits<float>::infinity();
  const std::vector<Triangle3> triangles = BumpySphere(objects);
  const TriangleMesh mesh(triangles);
  const Target target = run.best();
  Random random(run.options.seed);
  std::vector<Ray3> rays(kTimedQueries);
  for (Ray3& ray : rays) {
    for (std::size_t k = 0; k < 3; ++k) {
      ray.origin[k] = kHalfWorld * random.Signed();
      ray.direction[k] = random.Signed();
    }
    ray.max_t = kFar;
  }
  const auto first = [&](std::size_t q) {
    MeshHit hit;
    mesh.FirstHits({&rays[q], 1}, {&hit, 1}, target);
    return hit.t;
  };
  const auto is_hit = [&](std::size_t q) {
    bool hits = false;
    mesh.Occluded({&rays[q], 1}, {&hits, 1}, target);
    return hits ? 1.0f : 0.0f;
  };
  const auto distance = [&](std::size_t q) {
    MeshPoint closest;
    mesh.ClosestPoints({&rays[q].origin, 1}, {&closest, 1}, kFar, target);
    return closest.distance;
  };
  const auto time = [&](const std::string& name, const auto& ours,
                        const auto& its) {
    // As floats compute it.
    const auto is_right = [&](std::size_t q, float answer) {
      const float expected = ours(q);
      return answer == expected ||
             std::abs(answer - expected) < 1e-3f * (1 + expected);
    };
    Search<float> search{run,   name,     triangles.size(),
                         false, kChecked, is_right};
    search.Add("mesh", NameOf(target), 2000, ours);
    for (const auto& competitor : Registered<TriangleTree>::All()) {
      search.Add(competitor.name, "", 2000,
                 [its, tree = std::shared_ptr<const TriangleTree>(
                           competitor.make(triangles))](std::size_t q) {
                   return its(*tree, q);
                 });
    }
    search.Time(run.effort.repetitions, table);
  };
  time("first hits", first, [&](const TriangleTree& tree, std::size_t q) {
    return tree.FirstHit(rays[q]);
  });
  time("any hits", is_hit, [&](const TriangleTree& tree, std::size_t q) {
    return tree.IsHit(rays[q]) ? 1.0f : 0.0f;
  });
  time("closest points", distance,
       [&](const TriangleTree& tree, std::size_t q) {
         return tree.Distance(rays[q].origin);
       });
}

}  // namespace

Tables RunBvh(Run& run) {
  const std::uint64_t seed = run.options.seed;
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

  const auto add = [&](const std::vector<std::size_t>& sizes, auto run_part) {
    for (std::size_t objects : UpTo(most, sizes)) run_part(objects);
  };
  add({1000, 10'000, 100'000, 1'000'000},
      [&](std::size_t objects) { RunQueries(run, uniform(objects), table); });
  for (const SkewedWorld& world : SkewedWorlds()) {
    add({10'000, 100'000}, [&](std::size_t objects) {
      BoxSet<3> set = world.make(objects, kSide3D, seed);
      set.name = world.name;
      RunQueries(run, set, table);
    });
  }
  add({100'000, 1'000'000}, [&](std::size_t objects) {
    RunQueries(run, MakeUniformBoxes<2>("2D", objects, kSide2D, seed), table);
  });
  add({100'000, 1'000'000},
      [&](std::size_t objects) { RunJobs(run, uniform(objects), jobs); });
  add({most},
      [&](std::size_t objects) { RunSearches(run, uniform(objects), table); });
  add({std::min<std::size_t>(most, 100'000)},
      [&](std::size_t objects) { RunTriangles(run, objects, table); });
  return {table, jobs};
}

}  // namespace halfspace::bench

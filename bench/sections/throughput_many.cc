#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/baselines/target_loops.h"
#include "bench/sections/throughput.h"
#include "bench/worlds/grid_world.h"
#include "halfspace/reject_many.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

// A case of run(counts) that leaves the survivors of the first queries in
// counts, and is checked by them.
template <typename Run>
Case CountsCase(std::string name, const GridWorld& grid, ShapeKind shape,
                std::size_t queries, const Run& run) {
  auto counts = std::make_shared<std::vector<std::size_t>>(queries);
  Case c;
  c.name = std::move(name);
  c.items = static_cast<double>(grid.objects()) * static_cast<double>(queries);
  c.run = [counts, run] { run(*counts); };
  c.check = [counts, run, &grid, shape] {
    run(*counts);
    return grid.Check(shape, *counts);
  };
  return c;
}

// `target` is empty for what is none of the library's.
ThroughputRow GridRow(const GridWorld& grid, std::string name,
                      std::string target, std::size_t queries,
                      const Timing& timing) {
  ThroughputRow row;
  row.name = std::move(name);
  row.objects = grid.objects();
  row.queries = queries;
  row.working_set = "grid";
  row.target = std::move(target);
  row.ns_per_pair = timing.Median();
  return row;
}

// Made by the first part that needs it, and gone with the last.
struct SharedGrid {
  std::size_t objects;
  std::uint64_t seed;
  std::unique_ptr<GridWorld> world;
  std::vector<std::uint64_t> rows;

  GridWorld& Get() {
    if (!world) world = std::make_unique<GridWorld>(objects, seed);
    return *world;
  }
};

std::vector<std::size_t> CountRows(const GridWorld& grid,
                                   const std::vector<std::uint64_t>& rows) {
  std::vector<std::size_t> counts(grid.queries().size());
  const std::size_t words = MaskWords(grid.objects());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    counts[i / words] += static_cast<std::size_t>(std::popcount(rows[i]));
  }
  return counts;
}

Case MasksCase(std::string name, SharedGrid& shared, ShapeKind shape,
               Target target) {
  GridWorld& grid = shared.Get();
  shared.rows.resize(grid.queries().size() * MaskWords(grid.objects()));
  Case c;
  c.name = std::move(name);
  c.items = static_cast<double>(grid.objects()) *
            static_cast<double>(grid.queries().size());
  c.run = [&grid, &rows = shared.rows, shape, target] {
    grid.queries().With(shape, grid.view(), [&](const auto& v, const auto& q) {
      SurvivorMasks(v, q, rows,
                    {.schedule = Schedule::kFlat, .target = target});
    });
  };
  c.check = [run = c.run, &grid, &rows = shared.rows, shape] {
    run();
    return grid.Check(shape, CountRows(grid, rows));
  };
  return c;
}

// A world of one shape that takes half of the first-level cache, and so many
// queries that their masks stay in the cache with the planes.
class InCache {
 public:
  InCache(const Workload& workload, const Machine& machine, ShapeKind shape)
      : shape_(shape),
        world_(ResizedTo(workload.objects, ObjectsInHalf(machine, shape))),
        queries_(std::span(workload.queries)
                     .first(std::min(kQueries, workload.queries.size()))),
        rows_(queries_.size() * MaskWords(world_.size())) {}

  ShapeKind shape() const { return shape_; }
  std::size_t objects() const { return world_.size(); }
  std::size_t queries() const { return queries_.size(); }

  // Checked against one query at a time.
  Case MasksCase(std::string name, Target target) {
    const auto write = [this, target] {
      With([&](const auto& view, const auto& queries) {
        RejectMasks(view, queries, rows_,
                    {.schedule = Schedule::kFlat, .target = target});
      });
    };
    const std::size_t pairs = objects() * queries();
    const std::size_t rounds = std::max<std::size_t>(1, kObjectsPerRun / pairs);
    Case c;
    c.name = std::move(name);
    c.items = static_cast<double>(rounds * pairs);
    c.check = [this, write]() -> std::string {
      std::vector<std::uint64_t> expected(rows_.size());
      With([&](const auto& view, const auto& queries) {
        for (std::size_t q = 0; q < queries.size(); ++q) {
          reference::RejectMask(view, queries[q],
                                &expected[q * MaskWords(objects())]);
        }
      });
      std::fill(rows_.begin(), rows_.end(), 0x5555555555555555);
      write();
      return rows_ == expected ? ""
                               : "the masks are not the scalar reference's";
    };
    c.run = [write, rounds] {
      for (std::size_t i = 0; i < rounds; ++i) write();
    };
    return c;
  }

 private:
  static constexpr std::size_t kQueries = 16;

  static std::size_t ObjectsInHalf(const Machine& machine, ShapeKind shape) {
    const std::size_t record = PlaneCountOf(shape) * sizeof(float);
    return std::max<std::size_t>(64,
                                 machine.CacheBytes(1) / 2 / record / 64 * 64);
  }
  template <typename F>
  void With(const F& f) {
    queries_.With(shape_, world_.view(), f);
  }

  ShapeKind shape_;
  AaboWorld3 world_;
  ShapeQueries queries_;
  std::vector<std::uint64_t> rows_;
};

// One shape: masks of the grid against masks in the first-level cache.
void RunAgainstCache(SharedGrid& shared, InCache& in_cache,
                     Throughput& throughput) {
  const ShapeKind shape = in_cache.shape();
  for (Target target : throughput.targets()) {
    const std::string place = "/" + NameOf(target) + "/" + NameOf(shape);
    const Timings timings = throughput.TimeLong(
        {in_cache.MasksCase("flat-many/L1-again" + place, target),
         MasksCase("flat-many/grid" + place, shared, shape, target)});
    const GridWorld& grid = shared.Get();
    ThroughputRow row =
        GridRow(grid, std::string(NameOf(shape)) + " flat, masks of many",
                NameOf(target), grid.queries().size(), timings[1]);
    ThroughputRow again = row;
    again.name += ", again";
    again.objects = in_cache.objects();
    again.queries = in_cache.queries();
    again.working_set = "L1";
    again.ns_per_pair = timings[0].Median();
    row.ceiling = again.name;
    throughput.AddRow(std::move(again));
    const Ratio percent = RatioOf(timings[0], timings[1]).Percent();
    row.percent_of_ceiling = percent.median;
    throughput.AddRatio(aims::kInCache, target,
                        std::string(NameOf(shape)) + " flat, many, " +
                            row.target + ": % of the same in L1",
                        percent);
    throughput.AddRow(row);
  }
}

// Several queries: the refined octahedron against the simplex of floats.
void RunQuantized(const GridWorld& grid, Throughput& throughput) {
  for (Target target : throughput.targets()) {
    const std::string place = "grid/" + NameOf(target);
    const Options options{.target = target};
    const std::size_t queries = grid.queries().size();
    const Timings timings = throughput.TimeLong(
        {CountsCase("quantized-many/" + place, grid, ShapeKind::kAabo, queries,
                    [&grid, options](std::vector<std::size_t>& counts) {
                      SurvivorCounts(grid.quantized_world(),
                                     grid.queries().aabos(), counts, options);
                    }),
         CountsCase("simplex-many/" + place, grid, ShapeKind::kSimplex, queries,
                    [&grid, options](std::vector<std::size_t>& counts) {
                      SurvivorCounts(grid.view().simplex(),
                                     grid.queries().simplices(), counts,
                                     options);
                    })});
    const std::string name = NameOf(target);
    throughput.AddRow(GridRow(grid, "AABO uint8 refined, counts of many", name,
                              queries, timings[0]));
    throughput.AddRow(
        GridRow(grid, "simplex, counts of many", name, queries, timings[1]));
    throughput.AddRatio(
        aims::kFilterOverSimplex, target,
        "AABO uint8 refined, many, " + name + ": times the float simplex",
        RatioOf(timings[1], timings[0]));
  }
}

// The scalar loop is so slow that it answers some of the queries only.
constexpr std::size_t kScalarQueries = 10;

// Every surviving pair; counts them for the check.
template <typename AnyWorld>
Case PairsCase(std::string name, const GridWorld& grid, const AnyWorld& world,
               Target target) {
  struct Pairs {
    std::vector<std::uint32_t> query_indices;
    std::vector<std::uint32_t> object_indices;
  };
  const std::size_t survivors = grid.Survivors(ShapeKind::kAabo);
  return CountsCase(
      std::move(name), grid, ShapeKind::kAabo, grid.queries().size(),
      [&grid, &world, target, survivors,
       pairs = std::make_shared<Pairs>()](std::vector<std::size_t>& counts) {
        pairs->query_indices.resize(survivors);
        pairs->object_indices.resize(survivors);
        const std::size_t count =
            SurvivorPairs(world, grid.queries().aabos(), pairs->query_indices,
                          pairs->object_indices, {.target = target});
        std::fill(counts.begin(), counts.end(), std::size_t{0});
        for (std::size_t i = 0; i < std::min(count, survivors); ++i) {
          ++counts[pairs->query_indices[i]];
        }
      });
}

Case VectorisedCase(std::string name, const GridWorld& grid,
                    CountSimplices count) {
  return CountsCase(
      std::move(name), grid, ShapeKind::kSimplex, grid.queries().size(),
      [&grid, count](std::vector<std::size_t>& counts) {
        const SimplexView3 view = grid.view().simplex();
        count({{view.min[0], view.min[1], view.min[2], view.min[3]},
               view.size,
               grid.queries().simplices().front().max.data(),
               counts.size(),
               counts.data()});
      });
}

void RunAgainstBaselines(const GridWorld& grid, Throughput& throughput) {
  throughput.AddNote("Survivors on the grid: AABB " +
                     Grouped(grid.Survivors(ShapeKind::kAabb)) + ", simplex " +
                     Grouped(grid.Survivors(ShapeKind::kSimplex)) + ", AABO " +
                     Grouped(grid.Survivors(ShapeKind::kAabo)) + ".");
  const std::size_t queries = grid.queries().size();
  const AaboView3 floats = grid.view();
  std::vector<Case> cases = {CountsCase(
      "baseline/scalar", grid, ShapeKind::kAabo, kScalarQueries,
      [&grid](std::vector<std::size_t>& counts) {
        CountScalar(grid.halves(), grid.queries().aabos().first(kScalarQueries),
                    counts);
      })};
  for (Target target : throughput.targets()) {
    const std::string name = NameOf(target);
    cases.push_back(PairsCase("pairs/quantized/" + name, grid,
                              grid.quantized_world(), target));
    cases.push_back(PairsCase("pairs/floats/" + name, grid, floats, target));
    const TargetLoops loops = LoopsFor(target);
    for (CountSimplices count : {loops.count_by_or, loops.count_by_and}) {
      cases.push_back(
          VectorisedCase("baseline/vectorised/" + name, grid, count));
    }
  }
  const Timings timings = throughput.TimeLong(std::move(cases));
  throughput.AddRow(GridRow(grid, "baseline: scalar early-out AABO", "",
                            kScalarQueries, timings[0]));
  std::size_t next = 1;
  for (Target target : throughput.targets()) {
    const std::string name = NameOf(target);
    const Timing& quantized = timings[next++];
    throughput.AddRow(
        GridRow(grid, "AABO uint8 refined, pairs", name, queries, quantized));
    throughput.AddRow(
        GridRow(grid, "AABO floats, pairs", name, queries, timings[next++]));
    const std::size_t fastest = FastestOf(timings, {next, next + 1});
    next += 2;
    throughput.AddRow(GridRow(grid, "baseline: vectorised simplex", name,
                              queries, timings[fastest]));
    if (target == throughput.targets().front()) {
      throughput.AddRatio(
          aims::kOverScalar, target,
          "exact AABO survivors, " + name + ": times the scalar early-out",
          RatioOf(timings[0], quantized));
    }
    throughput.AddRatio(
        aims::kOverVectorised, target,
        "exact AABO survivors, " + name + ": times the vectorised simplex",
        RatioOf(timings[fastest], quantized));
  }
}

}  // namespace

void AddManyParts(const Workload& workload, const Machine& machine,
                  std::uint64_t seed, bool is_quick, ThroughputParts& parts) {
  auto shared = std::make_shared<SharedGrid>();
  shared->objects = is_quick ? GridWorld::kQuickObjects : GridWorld::kObjects;
  shared->seed = seed;
  const std::string reason = GridWorld::WhyNotReached(machine, shared->objects);
  if (!reason.empty()) {
    parts.push_back(
        [reason](Throughput& throughput) { throughput.NotReached(reason); });
    return;
  }
  for (ShapeKind shape : kShapes) {
    parts.push_back([shared, &workload, &machine, shape](Throughput& all) {
      InCache in_cache(workload, machine, shape);
      RunAgainstCache(*shared, in_cache, all);
    });
  }
  parts.push_back(
      [shared](Throughput& all) { RunQuantized(shared->Get(), all); });
  parts.push_back(
      [shared](Throughput& all) { RunAgainstBaselines(shared->Get(), all); });
}

}  // namespace halfspace::bench

#include <bit>
#include <memory>
#include <string>
#include <utility>

#include "bench/sections/grid_cases.h"
#include "bench/sections/throughput.h"
#include "bench/worlds/grid_world.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {
namespace {

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

// one shape: masks of the grid against masks in the first-level
// cache.
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
    again.objects = in_cache.view().size;
    again.queries = in_cache.queries().size();
    again.working_set = "L1";
    again.ns_per_pair = timings[0].Median();
    row.ceiling = throughput.AddRow(std::move(again));
    const Ratio percent = RatioOf(timings[0], timings[1]).Percent();
    row.percent_of_ceiling = percent.median;
    throughput.AddRatio(aims::kInCache, target,
                        std::string(NameOf(shape)) + " flat, many, " +
                            row.target + ": % of the same in L1",
                        percent);
    throughput.AddRow(row);
  }
}

// several queries: the refined octahedron against the simplex of
// floats.
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
    throughput.AddRowUnder(
        {Ceiling::Kind::kRegisters, ShapeKind::kSimplex, "L1", target},
        GridRow(grid, "simplex, counts of many", name, queries, timings[1]));
    throughput.AddRatio(
        aims::kFilterOverSimplex, target,
        "AABO uint8 refined, many, " + name + ": times the float simplex",
        RatioOf(timings[1], timings[0]));
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
    parts.push_back([reason](Throughput& throughput) {
      throughput.NotReached("" + reason);
    });
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

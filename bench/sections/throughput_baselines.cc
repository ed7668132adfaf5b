#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/baselines/baselines.h"
#include "bench/sections/grid_cases.h"
#include "bench/sections/throughput.h"
#include "bench/worlds/grid_world.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {
namespace {

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

}  // namespace

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
    for (const VectorisedForm& form : VectorisedFormsFor(target.name())) {
      cases.push_back(VectorisedCase(
          "baseline/vectorised/" + name + "/" + form.name, grid, form.count));
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
    // What tests the simplex first is measured by its compares alone.
    const Ceiling ceiling{Ceiling::Kind::kRegisters, ShapeKind::kSimplex, "L1",
                          target};
    throughput.AddRowUnder(ceiling, GridRow(grid, "AABO floats, pairs", name,
                                            queries, timings[next++]));
    const VectorisedForms forms = VectorisedFormsFor(target.name());
    const std::size_t fastest = FastestOf(timings, {next, next + 1});
    throughput.AddRowUnder(
        ceiling, GridRow(grid,
                         std::string("baseline: vectorised simplex, ") +
                             forms[fastest - next].name,
                         name, queries, timings[fastest]));
    next += forms.size();
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

}  // namespace halfspace::bench

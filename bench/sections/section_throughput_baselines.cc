#include <memory>
#include <string>
#include <utility>

#include "bench/baselines/baselines.h"
#include "bench/sections/throughput.h"
#include "bench/worlds/grid_world.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {
namespace {

// The scalar loop is so slow that it answers some of the queries only.
constexpr std::size_t kScalarQueries = 10;

// What one case leaves behind.
struct Answer {
  std::vector<std::size_t> counts;
  std::vector<std::uint32_t> query_indices;
  std::vector<std::uint32_t> object_indices;
};

// A case that leaves its counts, and is checked by them.
template <typename Run>
Case MakeCase(std::string name, const GridWorld& grid, ShapeKind shape,
              std::size_t queries, const Run& run) {
  auto answer = std::make_shared<Answer>();
  answer->counts.resize(queries);
  Case c;
  c.name = std::move(name);
  c.items = static_cast<double>(grid.objects()) * static_cast<double>(queries);
  c.run = [answer, run] { run(*answer); };
  c.check = [answer, run, &grid, shape] {
    run(*answer);
    return grid.Check(shape, answer->counts);
  };
  return c;
}

// Every surviving pair; counts them for the check.
template <typename AnyWorld>
Case PairsCase(std::string name, const GridWorld& grid, const AnyWorld& world,
               Target target) {
  const std::size_t survivors = grid.Survivors(ShapeKind::kAabo);
  return MakeCase(
      std::move(name), grid, ShapeKind::kAabo, grid.queries().size(),
      [&grid, &world, target, survivors](Answer& answer) {
        answer.query_indices.resize(survivors);
        answer.object_indices.resize(survivors);
        const std::size_t count =
            SurvivorPairs(world, grid.queries().aabos(), answer.query_indices,
                          answer.object_indices, {.target = target});
        std::fill(answer.counts.begin(), answer.counts.end(), std::size_t{0});
        for (std::size_t i = 0; i < std::min(count, survivors); ++i) {
          ++answer.counts[answer.query_indices[i]];
        }
      });
}

Case VectorisedCase(std::string name, const GridWorld& grid,
                    CountSimplices count) {
  return MakeCase(std::move(name), grid, ShapeKind::kSimplex,
                  grid.queries().size(), [&grid, count](Answer& answer) {
                    const SimplexView3 view = grid.view().simplex();
                    count({{view.min[0], view.min[1], view.min[2], view.min[3]},
                           view.size,
                           grid.queries().simplices().front().max.data(),
                           answer.counts.size(),
                           answer.counts.data()});
                  });
}

ThroughputRow RowOf(const GridWorld& grid, std::string name, std::string target,
                    std::size_t queries, const Timing& timing) {
  ThroughputRow row;
  row.name = std::move(name);
  row.objects = grid.objects();
  row.queries = queries;
  row.working_set = "grid";
  row.target = std::move(target);
  row.ns_per_pair = timing.Median();
  return row;
}

}  // namespace

void RunAgainstBaselines(const GridWorld& grid, Throughput& throughput) {
  throughput.SetSurvivors({.aabb = grid.Survivors(ShapeKind::kAabb),
                           .simplex = grid.Survivors(ShapeKind::kSimplex),
                           .aabo = grid.Survivors(ShapeKind::kAabo)});
  const std::size_t queries = grid.queries().size();
  const AaboView3 floats = grid.view();
  std::vector<Case> cases = {MakeCase(
      "baseline/scalar", grid, ShapeKind::kAabo, kScalarQueries,
      [&grid](Answer& answer) {
        CountScalar(grid.halves(), grid.queries().aabos().first(kScalarQueries),
                    answer.counts);
      })};
  for (Target target : throughput.targets()) {
    const std::string name(target.name());
    cases.push_back(PairsCase("pairs/quantized/" + name, grid,
                              grid.quantized_world(), target));
    cases.push_back(PairsCase("pairs/floats/" + name, grid, floats, target));
    for (const VectorisedForm& form : VectorisedFormsFor(name)) {
      cases.push_back(VectorisedCase(
          "baseline/vectorised/" + name + "/" + form.name, grid, form.count));
    }
  }
  const Timings timings = throughput.TimeLong(std::move(cases));
  throughput.AddRow(RowOf(grid, "baseline: scalar early-out aabo", "",
                          kScalarQueries, timings[0]));
  std::size_t next = 1;
  for (Target target : throughput.targets()) {
    const std::string name(target.name());
    const Timing& quantized = timings[next++];
    throughput.AddRow(
        RowOf(grid, "aabo uint8 refined, pairs", name, queries, quantized));
    // What tests the simplex first is measured by its compares alone.
    const Ceiling ceiling{Ceiling::Kind::kRegisters, ShapeKind::kSimplex, "L1",
                          target};
    throughput.AddRowUnder(ceiling, RowOf(grid, "aabo floats, pairs", name,
                                          queries, timings[next++]));
    const VectorisedForms forms = VectorisedFormsFor(name);
    const std::size_t fastest = FastestOf(timings, {next, next + 1});
    throughput.AddRowUnder(ceiling,
                           RowOf(grid,
                                 std::string("baseline: vectorised simplex, ") +
                                     forms[fastest - next].name,
                                 name, queries, timings[fastest]));
    next += forms.size();
    if (target == throughput.targets().front()) {
      throughput.AddRatio(
          thresholds::kOverScalar, target,
          "exact aabo survivors, " + name + ": times the scalar early-out",
          RatioOf(timings[0], quantized).median);
    }
    throughput.AddRatio(
        thresholds::kOverVectorised, target,
        "exact aabo survivors, " + name + ": times the vectorised simplex",
        RatioOf(timings[fastest], quantized).median);
  }
}

}  // namespace halfspace::bench

// Survivors of the three shapes.
#include "bench/base/text.h"
#include "bench/measure/counts.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {

Tables RunQuality(Run& run) {
  const Workload& workload = run.Measured();
  const AaboView3 view = workload.objects.view();
  PerShape<std::size_t> survivors;
  double done = 0.0;
  for (const Aabo3& query : workload.queries) {
    AddSurvivors(view, query, survivors);
    run.progress.Update(++done / static_cast<double>(workload.queries.size()));
  }
  Table table{"quality",
              "survivors in " + workload.name,
              {Key("shape"), Value("survivors", "", 0), Value("of a query"),
               Value("over AABB")}};
  for (ShapeKind shape : kShapes) {
    const auto count = static_cast<double>(survivors.Of(shape));
    table.Add({NameOf(shape), survivors.Of(shape),
               count / static_cast<double>(workload.queries.size()),
               survivors.aabb == 0
                   ? Cell()
                   : Cell(count / static_cast<double>(survivors.aabb))});
  }
  table.notes = {Grouped(workload.objects.size()) + " objects, " +
                 Grouped(workload.queries.size()) + " queries."};
  return {table};
}

}  // namespace halfspace::bench

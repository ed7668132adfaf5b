// Table 1 of "The Bounding Simplex: A SIMD-Era Rejection Primitive".
#include <cstddef>

#include "bench/base/text.h"
#include "bench/measure/counts.h"
#include "bench/paper/work_count.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
Tables RunTable1(Run& run) {
  const Workload& scene = run.Scene();
  const AaboView3 view = scene.objects.view();
  WorkCounter counter(view);
  PerShape<std::size_t> survivors;
  double done = 0.0;
  for (const Aabo3& query : scene.queries) {
    counter.Add(query);
    AddSurvivors(view, query, survivors);
    run.progress.Update(++done / static_cast<double>(scene.queries.size()));
  }
  const WorkCount work = counter.Average();
  Table table{"table1",
              "half-spaces evaluated per object in batches of w, counted",
              {Key("w")}};
  for (ShapeKind shape : kShapes) {
    table.columns.push_back(Value(NameOf(shape)));
    table.columns.push_back(Value("paper"));
  }
  for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
    table.Add({kWorkWidths[i], work.aabb[i], kPaperWork.aabb[i],
               work.simplex[i], kPaperWork.simplex[i], work.aabo[i],
               kPaperWork.aabo[i]});
  }
  const auto count = [](std::size_t of) { return Grouped(of); };
  table.notes.push_back(
      count(scene.objects.size()) + " objects, " + count(scene.queries.size()) +
      " queries. Survivors: AABB " + count(survivors.aabb) + " (paper " +
      count(kPaperSurvivors.aabb) + "), simplex " + count(survivors.simplex) +
      " (" + count(kPaperSurvivors.simplex) + "), AABO " +
      count(survivors.aabo) + " (" + count(kPaperSurvivors.aabo) +
      "), another seed in the paper.");
  return {table};
}

}  // namespace halfspace::bench

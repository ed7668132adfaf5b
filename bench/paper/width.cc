// Simplex or box, by the number of lanes: the same loop in scalar code, and
// then with vectors of each width of the best target.
#include <optional>
#include <vector>

#include "bench/measure/groups.h"
#include "bench/paper/loops.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/sections/verdict.h"

namespace halfspace::bench {
namespace {

std::vector<VerdictColumn> ColumnsOf(const Run& run) {
  std::vector<Target> targets = {run.best()};
  const std::optional<Target> scalar = FindTarget("SCALAR");
  if (run.options.target.empty() && scalar && *scalar != run.best()) {
    targets.insert(targets.begin(), *scalar);
  }
  std::vector<VerdictColumn> columns;
  for (Target target : targets) {
    const PaperLoops loops = PaperLoopsFor(target);
    for (std::size_t i = 0; i < kWidths.size(); ++i) {
      if (loops.staged[i] == nullptr) continue;
      VerdictColumn column{ColumnName(target, kWidths[i]), target, {}};
      for (ShapeKind shape : {ShapeKind::kSimplex, ShapeKind::kAabb}) {
        for (Way way : {Way::kFlat, Way::kLists}) {
          column.contenders.push_back(
              {shape,
               way == Way::kFlat ? "flat" : "staged",
               {},
               [scan = loops.staged[i], shape, way](auto... of) {
                 scan(shape, way, 2, of...);
               }});
        }
      }
      columns.push_back(std::move(column));
    }
  }
  return columns;
}

}  // namespace

Tables RunWidth(Run& run) {
  Verdict verdict(run, ColumnsOf(run));
  for (std::size_t g = 0; g < kGroups; ++g) {
    run.progress.BeginPart(g, kGroups);
    verdict.AddGroup(run);
  }
  Tables tables = VerdictTables(run, verdict, "width",
                                "time of the best float box scan / time of the "
                                "best simplex scan by the lanes of vectors");
  tables.front().notes.emplace_back(
      "The same loops, flat or staged, are compiled for vectors of each width. "
      "They differ in their lanes, and from scalar code in the instruction "
      "set.");
  return tables;
}

}  // namespace halfspace::bench

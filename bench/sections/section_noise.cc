#include <algorithm>
#include <utility>
#include <vector>

#include "bench/sections/plan.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {

Ratio SameOverSame(WorkingSet& set, const Context& context) {
  std::vector<Case> cases;
  for (const char* name : {"noise/a", "noise/b"}) {
    Case c = set.LibraryCase(
        name, ShapeKind::kSimplex,
        {.schedule = Schedule::kFlat, .target = context.targets.front()});
    c.group = "noise";
    cases.push_back(std::move(c));
  }
  // Quartiles of a few repetitions say little.
  Effort effort = context.effort;
  effort.repetitions = std::max<std::size_t>(effort.repetitions, 9);
  const Timings timings = TimeCases(cases, effort, context);
  return RatioOf(timings[0], timings[1]);
}

}  // namespace halfspace::bench

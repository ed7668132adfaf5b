// Every target, shape and schedule against the scalar reference.
#include <algorithm>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {

Tables RunCheck(Run& run) {
  // No multiple of 64, so that tails are checked too.
  constexpr std::size_t kMostObjects = 20'011;
  const Workload& workload = run.Measured();
  WorkingSet set(
      workload, {"check", std::min(kMostObjects, workload.objects.size()), ""});
  std::size_t masks = 0;
  std::string names;
  std::vector<Target> targets = run.targets;
  if (run.options.target.empty()) {
    targets.assign(SupportedTargets().begin(), SupportedTargets().end());
  }
  for (Target target : targets) {
    for (ShapeKind shape : kShapes) {
      const auto check = [&](Schedule schedule) {
        const Case c =
            set.LibraryCase(std::string(target.name()) + ", " + NameOf(shape),
                            shape, {.schedule = schedule, .target = target});
        if (const std::string wrong = c.check(); !wrong.empty()) {
          throw WrongAnswer(c.name + ": " + wrong);
        }
        masks += set.checked_queries();
      };
      for (const NamedSchedule& named : kSchedules) check(named.schedule);
    }
    names += (names.empty() ? "" : ", ") + std::string(target.name());
  }
  return {{"check",
           "answers of the library against the scalar reference",
           {},
           {},
           {Grouped(masks) + " masks of " + Grouped(set.objects()) +
            " objects are equal, bit for bit: " + names + "."}}};
}

}  // namespace halfspace::bench

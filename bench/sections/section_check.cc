#include <algorithm>

#include "bench/base/schedules.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

// No multiple of 64, so that tails are checked too.
constexpr std::size_t kMostObjects = 20'011;

}  // namespace

CheckResult RunCheck(const Workload& workload, const Context& context) {
  WorkingSet set(
      workload, {"check", std::min(kMostObjects, workload.objects.size()), ""});
  CheckResult result;
  result.objects = set.objects();
  result.queries = set.checked_queries();
  double done = 0.0;
  for (Target target : context.targets) {
    for (ShapeKind shape : kShapes) {
      const auto check = [&](Schedule schedule) {
        const Case c =
            set.LibraryCase(std::string(target.name()) + ", " + NameOf(shape),
                            shape, {.schedule = schedule, .target = target});
        if (const std::string wrong = c.check(); !wrong.empty()) {
          throw WrongAnswer(c.name + ": " + wrong);
        }
        result.masks += result.queries;
      };
      check(Schedule::kAuto);
      for (const NamedSchedule& named : kSchedules) check(named.schedule);
    }
    result.targets.emplace_back(target.name());
    context.progress.Update(++done /
                            static_cast<double>(context.targets.size()));
  }
  return result;
}

}  // namespace halfspace::bench

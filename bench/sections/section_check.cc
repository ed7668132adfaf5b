#include <algorithm>
#include <array>

#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

// No multiple of 64, so that tails are checked too.
constexpr std::size_t kMostObjects = 20'011;

constexpr std::array kSchedules = {Schedule::kAuto, Schedule::kFlat,
                                   Schedule::kStaged, Schedule::kStagedByAxis};

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
      for (Schedule schedule : kSchedules) {
        const Case c =
            set.LibraryCase(std::string(target.name()) + ", " + NameOf(shape),
                            shape, {.schedule = schedule, .target = target});
        if (const std::string wrong = c.check(); !wrong.empty()) {
          throw WrongAnswer(c.name + ": " + wrong);
        }
        result.masks += result.queries;
      }
    }
    result.targets.emplace_back(target.name());
    context.progress.Update(++done /
                            static_cast<double>(context.targets.size()));
  }
  return result;
}

}  // namespace halfspace::bench

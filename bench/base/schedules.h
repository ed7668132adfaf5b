// The schedules by name, and those that differ for a shape.
#ifndef HALFSPACE_BENCH_BASE_SCHEDULES_H_
#define HALFSPACE_BENCH_BASE_SCHEDULES_H_

#include <array>
#include <cstddef>
#include <span>

#include "bench/base/shape.h"
#include "halfspace/reject.h"

namespace halfspace::bench {

struct NamedSchedule {
  const char* name;
  Schedule schedule;
};

inline constexpr std::array<NamedSchedule, 3> kSchedules = {
    {{"flat", Schedule::kFlat},
     {"staged", Schedule::kStaged},
     {"by-axis", Schedule::kStagedByAxis}}};

// A simplex has one stage, and the stages of a box are its axes.
constexpr std::span<const NamedSchedule> SchedulesOf(ShapeKind shape) {
  constexpr std::array<std::size_t, kShapes.size()> kCounts = {2, 1, 3};
  return std::span(kSchedules).first(kCounts[static_cast<std::size_t>(shape)]);
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_SCHEDULES_H_

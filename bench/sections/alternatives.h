// The sections that hold the simplex's design against others.
#ifndef HALFSPACE_BENCH_SECTIONS_ALTERNATIVES_H_
#define HALFSPACE_BENCH_SECTIONS_ALTERNATIVES_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/report/alternatives.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {

// Whether a target is measured in a working set: in memory targets hardly
// differ, and take long.
inline bool IsMeasuredIn(const std::string& set, Target target, bool is_quick,
                         const Context& context) {
  const bool is_best = target == context.targets.front();
  return is_best || (!is_quick && set != "memory");
}

// Bounding volumes at the same layout, in L2 and, if it was reached, in memory,
// of the file `input`, or of the scene if it is null; and the scene in 2, 3 and
// 4 dimensions. Of at most so many different objects, or as many as it sees
// fit for 0. If it is to be quick, the best target alone.
VolumesResult RunVolumes(const Workload* input, std::size_t most_objects,
                         const std::vector<WorkingSetSize>& sizes,
                         std::uint64_t seed, bool is_quick,
                         const Context& context);

// A part of it: 2, 3 or 4 dimensions, octahedra whose planes take `bytes`, the
// best target.
DimensionRow RunDimension(std::size_t dimensions, std::size_t bytes,
                          std::uint64_t seed, const Context& context);

// How often an octahedron's second simplex is read, and what that saves, of a
// workload and of its boxes.
DualResult RunDual(const Workload& workload,
                   const std::vector<WorkingSet*>& sets,
                   const std::vector<WorkingSetSize>& sizes, bool is_quick,
                   const Context& context);

// The standard axes against those of a regular simplex; also of the file
// `input`, if it is not null.
AxesResult RunAxes(const Workload* input, std::uint64_t seed,
                   const Context& context);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_ALTERNATIVES_H_

// From how many queries on a structure pays.
#ifndef HALFSPACE_BENCH_MEASURE_CURVES_H_
#define HALFSPACE_BENCH_MEASURE_CURVES_H_

#include <algorithm>
#include <limits>

namespace halfspace::bench {

// What a structure costs.
struct StructureCost {
  double make;   // once
  double query;  // each
};

// The number of queries from which on `one` takes less time in total than
// `other`: at least 1, infinite if it never does. `one` takes longer to make.
inline double PaysFrom(const StructureCost& one, const StructureCost& other) {
  const double more = one.make - other.make;
  const double saved = other.query - one.query;
  if (saved <= 0.0) return std::numeric_limits<double>::infinity();
  return std::max(1.0, more / saved);
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_CURVES_H_

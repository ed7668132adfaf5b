// Table 1 of "The Bounding Simplex: A SIMD-Era Rejection Primitive".
#ifndef HALFSPACE_BENCH_PAPER_PAPER_H_
#define HALFSPACE_BENCH_PAPER_PAPER_H_

#include <cstddef>

#include "bench/base/shape.h"
#include "bench/paper/work_count.h"

namespace halfspace::bench {

inline constexpr WorkCount kPaperWork = {
    .aabb = {1.56, 2.29, 2.64, 3.58, 4.27, 5.07, 5.77},
    .simplex = {1.87, 3.09, 3.39, 3.79, 3.93, 3.98, 4.00},
    .aabo = {1.87, 3.09, 3.40, 3.80, 4.00, 4.23, 4.90}};

inline constexpr PerShape<std::size_t> kPaperSurvivors = {21'814, 47'559,
                                                          20'039};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_PAPER_H_

// The paper's scene in 2, 3 and 4 dimensions.
#ifndef HALFSPACE_BENCH_PAPER_DIMENSIONS_H_
#define HALFSPACE_BENCH_PAPER_DIMENSIONS_H_

#include <cstddef>

#include "bench/report/table.h"

namespace halfspace::bench {

class Run;

Table DimensionsTable();

// Adds a row, of octahedra whose planes take `bytes`, with the best target.
void AddDimension(Run& run, std::size_t dimensions, std::size_t bytes,
                  Table& table);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_DIMENSIONS_H_

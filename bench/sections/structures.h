// Which structure, for how many queries between two changes of the world.
#ifndef HALFSPACE_BENCH_SECTIONS_STRUCTURES_H_
#define HALFSPACE_BENCH_SECTIONS_STRUCTURES_H_

#include "bench/report/table.h"

namespace halfspace::bench {

class Run;

// A scan, a QuantizedWorld and a BVH of 100 to 1 000 000 boxes.
Table StructuresTable(Run& run);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_STRUCTURES_H_

// What it takes to build sorted worlds, beside a tree.
#ifndef HALFSPACE_BENCH_SECTIONS_SORTED_BUILDS_H_
#define HALFSPACE_BENCH_SECTIONS_SORTED_BUILDS_H_

#include "bench/sections/throughput.h"
#include "bench/worlds/box_set.h"

namespace halfspace::bench {

// Adds the times of builds, and the ratios of these and of memory.
void RunSortedBuilds(const BoxSet<3>& set, Throughput& throughput,
                     SortedResult& result);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_SORTED_BUILDS_H_

// What else sorted worlds do than find boxes, beside others: parts of the
// section.
#ifndef HALFSPACE_BENCH_SECTIONS_SORTED_PARTS_H_
#define HALFSPACE_BENCH_SECTIONS_SORTED_PARTS_H_

#include <cstdint>

#include "bench/sections/throughput.h"
#include "bench/worlds/box_set.h"

namespace halfspace::bench {

// What was timed, as jobs on all objects.
void AddJobs(const Timings& timings, std::size_t objects, SortedResult& result);

// Each adds rows or jobs, and ratios: builds and memory (threshold 2), refits
// (3), pairs (4), searches by distance, along segments and counts (5).
void RunSortedBuilds(const BoxSet<3>& set, Throughput& throughput,
                     SortedResult& result);
void RunSortedRefits(const BoxSet<3>& set, Throughput& throughput,
                     SortedResult& result);
void RunSortedPairs(const BoxSet<3>& set, Throughput& throughput,
                    SortedResult& result);
void RunSortedSearches(const BoxSet<3>& set, std::uint64_t seed,
                       Throughput& throughput, SortedResult& result);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_SORTED_PARTS_H_

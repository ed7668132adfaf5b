// What every ratio that cpuinfo-bench aims at needs, in one place: sections
// measure a value, and do not know what is enough.
#ifndef HALFSPACE_BENCH_REPORT_THRESHOLDS_H_
#define HALFSPACE_BENCH_REPORT_THRESHOLDS_H_

#include "halfspace/targets.h"

namespace halfspace::bench {

// Of x86; everywhere else what SSE4 must reach.
inline bool IsAvx512(Target target) {
  return target.name().starts_with("AVX3");
}
inline bool IsAvx2(Target target) { return target.name() == "AVX2"; }

struct Threshold {
  int threshold;  // the number of the aim in the report
  bool is_higher_better;
  double avx512;
  double avx2;
  double others;  // SSE4, and other architectures

  double For(Target target) const {
    if (IsAvx512(target)) return avx512;
    return IsAvx2(target) ? avx2 : others;
  }
};

constexpr Threshold AtLeast(int threshold, double needed) {
  return {threshold, true, needed, needed, needed};
}
constexpr Threshold AtMost(int threshold, double needed) {
  return {threshold, false, needed, needed, needed};
}

namespace thresholds {

// One query out of the caches: % of reading the same planes.
inline constexpr Threshold kReading = {1, true, 97.0, 97.0, 90.0};
// In the first-level cache: % of the compares alone, on registers.
inline constexpr Threshold kRegisters = {2, true, 90.0, 85.0, 85.0};
// Many queries over the grid: % of the same in the first-level cache.
inline constexpr Threshold kInCache = AtLeast(3, 90.0);
// Quantized worlds: times the fastest scan of floats with one query, times the
// simplex of floats with many; % of reading what a scan of them reads.
inline constexpr Threshold kFilterOverFloats = AtLeast(4, 3.5);
inline constexpr Threshold kFilterOverSimplex = AtLeast(4, 3.0);
inline constexpr Threshold kReadingQuantized = AtLeast(4, 90.0);
// Exact survivors: times the loops that one would write instead.
inline constexpr Threshold kOverScalar = AtLeast(5, 40.0);
inline constexpr Threshold kOverVectorised = AtLeast(5, 2.0);
// Indices over a mask; times as fast on two threads.
inline constexpr Threshold kIndicesOverMask = AtMost(6, 1.15);
inline constexpr Threshold kTwoThreads = AtLeast(6, 1.8);
// Slowest over fastest size in one cache level; ns of a call by itself.
inline constexpr Threshold kSizes = AtMost(7, 1.15);
inline constexpr Threshold kCall = AtMost(7, 10.0);
// Objects up to which a scan is faster than a tree.
inline constexpr Threshold kTreeSize = AtLeast(8, 10000.0);

// Section sorted. Box queries: times the fastest competitor, and half of that
// where structures evict each other from the caches.
constexpr Threshold TimesFastest(double needed) {
  return {1, true, needed, 0.6 * needed, 0.6 * needed};
}
constexpr Threshold WhereEvicted(const Threshold& threshold) {
  return TimesFastest(0.5 * threshold.avx512);
}
inline constexpr Threshold kSortedThousand = TimesFastest(2.5);
inline constexpr Threshold kSortedTenThousand = TimesFastest(4.0);
inline constexpr Threshold kSortedMore = TimesFastest(7.0);
inline constexpr Threshold kSortedFile = TimesFastest(5.0);
inline constexpr Threshold kSorted2D = TimesFastest(5.0);
// Builds: times as fast as the competitor's bulk load. Queries of the fast
// order over those of the tight one. Bytes beyond the floats over the floats.
inline constexpr Threshold kFastBuild = AtLeast(2, 5.0);
inline constexpr Threshold kTightBuild = AtLeast(2, 1.0);
inline constexpr Threshold kFastOverTight = AtMost(2, 1.5);
inline constexpr Threshold kSortedMemory = AtMost(2, 0.6);
// Refits: % of copying as many bytes as they read and write.
inline constexpr Threshold kRefitInOrder = AtLeast(3, 40.0);
inline constexpr Threshold kRefitById = AtLeast(3, 20.0);
// Pairs: times the fastest competitor, with the build and without; two threads.
inline constexpr Threshold kPairsAndBuild = AtLeast(4, 3.0);
inline constexpr Threshold kPairs = AtLeast(4, 5.0);
inline constexpr Threshold kPairsTwoThreads = AtLeast(4, 1.8);
// Other searches: times Boost, Embree and Boost.
inline constexpr Threshold kNearest = AtLeast(5, 2.0);
inline constexpr Threshold kAlong = AtLeast(5, 1.5);
inline constexpr Threshold kCounts = AtLeast(5, 20.0);

// A bulk build of boxes out of the caches: % of copying the same bytes.
inline constexpr double kBuildPercentOfCopy = 70.0;

}  // namespace thresholds
}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_THRESHOLDS_H_

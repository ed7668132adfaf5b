// The aims that ratios are flagged by, in one place.
#ifndef HALFSPACE_BENCH_SECTIONS_AIMS_H_
#define HALFSPACE_BENCH_SECTIONS_AIMS_H_

#include "halfspace/targets.h"

namespace halfspace::bench {

// Of x86; everywhere else what SSE4 must reach.
inline bool IsAvx512(Target target) {
  return target.name().starts_with("AVX3");
}
inline bool IsAvx2(Target target) { return target.name() == "AVX2"; }

struct Aim {
  bool is_higher_better;
  double avx512;
  double avx2;
  double others;  // SSE4, and other architectures

  double For(Target target) const {
    if (IsAvx512(target)) return avx512;
    return IsAvx2(target) ? avx2 : others;
  }
};

constexpr Aim AtLeast(double needed) { return {true, needed, needed, needed}; }
constexpr Aim AtMost(double needed) { return {false, needed, needed, needed}; }

namespace aims {

// One query out of the caches: % of reading the same planes.
inline constexpr Aim kReading = {true, 97.0, 97.0, 90.0};
// Many queries over the grid: % of the same in the first-level cache.
inline constexpr Aim kInCache = AtLeast(90.0);
// Quantized worlds: times the fastest scan of floats with one query, times the
// simplex of floats with many; % of reading what a scan of them reads.
inline constexpr Aim kFilterOverFloats = AtLeast(3.5);
inline constexpr Aim kFilterOverSimplex = AtLeast(3.0);
inline constexpr Aim kReadingQuantized = AtLeast(90.0);
// Exact survivors: times the loops that one would write instead.
inline constexpr Aim kOverScalar = AtLeast(40.0);
inline constexpr Aim kOverVectorised = AtLeast(2.0);
// ns of a call by itself.
inline constexpr Aim kCall = AtMost(10.0);

// Section sorted. Box queries: times the fastest competitor, and half of that
// where structures evict each other from the caches.
constexpr Aim TimesFastest(double needed) {
  return {true, needed, 0.6 * needed, 0.6 * needed};
}
constexpr Aim WhereEvicted(const Aim& threshold) {
  return TimesFastest(0.5 * threshold.avx512);
}
constexpr Aim WhereManyInACall(const Aim& threshold) {
  return TimesFastest(1.3 * threshold.avx512);
}
inline constexpr Aim kBvhThousand = TimesFastest(2.0);
inline constexpr Aim kBvhTenThousand = TimesFastest(2.8);
inline constexpr Aim kBvhHundredThousand = TimesFastest(6.0);
inline constexpr Aim kBvhMillion = TimesFastest(6.5);
inline constexpr Aim kBvhClusters = TimesFastest(6.5);
inline constexpr Aim kBvhFile = TimesFastest(5.0);
inline constexpr Aim kBvh2D = TimesFastest(6.0);
// Skewed worlds of 10 000 and of 100 000 boxes; 3 is wanted of both. Time over
// that of the uniform world of as many boxes.
inline constexpr Aim kBvhSkewedTenThousand = TimesFastest(1.5);
inline constexpr Aim kBvhSkewedMore = TimesFastest(2.0);
inline constexpr Aim kSkewedOverUniform = AtMost(1.5);
// Builds: times as fast as the competitor's bulk load. Queries of the fast
// order over those of the tight one. Bytes beyond the floats over the floats.
inline constexpr Aim kFastBuild = AtLeast(5.0);
inline constexpr Aim kTightBuild = AtLeast(1.0);
inline constexpr Aim kFastOverTight = AtMost(1.5);
inline constexpr Aim kBvhMemory = AtMost(0.75);
// Refits: % of copying as many bytes as they read and write.
inline constexpr Aim kRefitInOrder = AtLeast(40.0);
inline constexpr Aim kRefitById = AtLeast(20.0);
// Pairs: times the fastest competitor, with the build and without.
inline constexpr Aim kPairsAndBuild = AtLeast(3.0);
inline constexpr Aim kPairs = AtLeast(5.0);
// Other searches: times Boost, Embree and Boost.
inline constexpr Aim kNearest = AtLeast(2.0);
inline constexpr Aim kAlong = AtLeast(1.5);
inline constexpr Aim kCounts = AtLeast(20.0);

// Section broad_phase. Times the fastest competitor: frames of few bodies (of
// more see kScenes), queries of few and of more, the first hit, casts in 2D and
// in 3D.
constexpr Aim WithLessOnAvx2(double needed) {
  return {true, needed, 0.7 * needed, 0.7 * needed};
}
constexpr Aim WithMoreOnAvx2(double needed) {
  return {false, needed, needed / 0.7, needed / 0.7};
}
inline constexpr Aim kFramesOfFew = AtLeast(1.0);
inline constexpr Aim kBodyQueriesOfFew = WithLessOnAvx2(1.5);
inline constexpr Aim kBodyQueries = WithLessOnAvx2(3.0);
inline constexpr Aim kFirstHit = WithLessOnAvx2(1.0);
inline constexpr Aim kBodyCasts2D = WithLessOnAvx2(1.3);
inline constexpr Aim kBodyCasts3D = WithLessOnAvx2(2.0);
// ns of a query or a cast more than with a Bvh: with the lock, with it and two
// threads, and without it.
inline constexpr Aim kLock = WithMoreOnAvx2(8.0);
inline constexpr Aim kLockOfTwo = WithMoreOnAvx2(12.0);
inline constexpr Aim kNoLock = WithMoreOnAvx2(1.0);
// Moves and Update() over the same of a Bvh, if all bodies move, a tenth and
// one in a hundred.
inline constexpr Aim kChangeOfAll = AtMost(1.6);
inline constexpr Aim kChangeOfTenth = AtMost(1.0);
inline constexpr Aim kChangeOfHundredth = AtMost(0.75);
// Pairs, and pairs with events, over the search of a Bvh; ns of a kept pair
// more than that if one in a hundred moves.
inline constexpr Aim kBodyPairs = AtMost(1.1);
inline constexpr Aim kEvents = AtMost(1.4);
inline constexpr Aim kEventsOfPile = AtMost(1.55);
inline constexpr Aim kKeptPair = WithMoreOnAvx2(0.7);
// ns of a body: moved to where it is, and inserted or erased with 15 others.
inline constexpr Aim kStillBody = WithMoreOnAvx2(4.0);
inline constexpr Aim kChangeOfFew = WithMoreOnAvx2(300.0);
// A move before each query: ns more than the query if it is of one of a few
// bodies, and the time of a Bvh if it is of any.
inline constexpr Aim kMoveOfFew = WithMoreOnAvx2(250.0);
inline constexpr Aim kMoveOfAny = AtMost(1.15);
// Queries after many changes over those of a rebuilt tree. The longest Update()
// over the median.
inline constexpr Aim kDecay = AtMost(1.2);
inline constexpr Aim kLongestUpdate = AtMost(3.0);
// Two threads over one, in phases, and where both move and query all the time.
inline constexpr Aim kTwoThreads = AtLeast(1.7);
inline constexpr Aim kTwoThreadsMixed = AtLeast(0.9);
// Bytes of a body beyond its bound, with masks too, and of a pair.
inline constexpr Aim kBytesOfBody = AtMost(56.0);
inline constexpr Aim kBytesWithMasks = AtMost(64.0);
inline constexpr Aim kBytesOfPair = AtMost(8.0);

// A bulk build of boxes out of the caches: % of copying the same bytes.
inline constexpr Aim kBuild = AtLeast(70.0);

}  // namespace aims
}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_AIMS_H_

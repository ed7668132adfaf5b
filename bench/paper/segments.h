// Long segments as queries: how many objects one bound of a segment keeps, and
// how many its bounds in pieces do.
#ifndef HALFSPACE_BENCH_PAPER_SEGMENTS_H_
#define HALFSPACE_BENCH_PAPER_SEGMENTS_H_

#include <array>
#include <cstddef>

#include "bench/base/shape.h"
#include "bench/worlds/random.h"
#include "halfspace/fit.h"
#include "halfspace/world.h"

namespace halfspace::bench {

enum class SegmentDirection : std::size_t {
  kUniform,        // on the sphere
  kSpaceDiagonal,  // (1, 1, 1): D changes most
  kFaceDiagonal,   // (1, -1, 0), (1, 0, -1) or (0, 1, -1): D does not change
};

inline constexpr std::array<SegmentDirection, 3> kSegmentDirections = {
    SegmentDirection::kUniform, SegmentDirection::kSpaceDiagonal,
    SegmentDirection::kFaceDiagonal};

constexpr const char* NameOf(SegmentDirection direction) {
  constexpr const char* kNames[] = {"uniform", "(1,1,1)", "(1,-1,0)"};
  return kNames[static_cast<std::size_t>(direction)];
}

inline constexpr std::array<double, 3> kSegmentLengths = {0.1, 0.3, 1.0};
inline constexpr std::array<std::size_t, 6> kSegmentPieces = {1, 2,  4,
                                                              8, 16, 32};
inline constexpr std::size_t kFloorPieces = 1024;

double LongestSideOf(const Aabb3& box);

// A segment of that length, its middle uniform in the box.
Segment3 MakeSegment(SegmentDirection direction, double length,
                     const Aabb3& box, Random& random);

// The objects that at least one of the pieces keeps.
PerShape<std::size_t> CountKept(const AaboView3& view, const Segment3& segment,
                                std::size_t pieces);

// The same for octahedra and so many pieces that they are all but the segment
// itself: what nothing that knows only the objects' octahedra can reject.
std::size_t CountFloor(const AaboView3& view, const Segment3& segment);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_SEGMENTS_H_

#include <algorithm>

#include "bench/sections/sections.h"
#include "bench/sections/segments.h"

namespace halfspace::bench {
namespace {

// Enough to count in, and counted in a second.
constexpr std::size_t kMostObjects = std::size_t{1} << 16;
constexpr std::size_t kSegments = 32;
constexpr std::size_t kQuickSegments = 8;

// Sums over segments, one row for each number of pieces.
class Sums {
 public:
  Sums(SegmentDirection direction, double length) {
    for (std::size_t pieces : kSegmentPieces) {
      SegmentRow row;
      row.direction = NameOf(direction);
      row.length = length;
      row.pieces = pieces;
      rows_.push_back(row);
    }
  }

  void Add(const AaboView3& view, const Segment3& segment) {
    const auto floor = static_cast<double>(CountFloor(view, segment));
    for (SegmentRow& row : rows_) {
      const PerShape<std::size_t> kept = CountKept(view, segment, row.pieces);
      row.kept.aabb += static_cast<double>(kept.aabb);
      row.kept.simplex += static_cast<double>(kept.simplex);
      row.kept.aabo += static_cast<double>(kept.aabo);
      row.floor += floor;
      row.tests = row.pieces * view.size;
    }
    ++segments_;
  }

  std::vector<SegmentRow> Means() const {
    std::vector<SegmentRow> rows = rows_;
    for (SegmentRow& row : rows) {
      for (double* sum :
           {&row.kept.aabb, &row.kept.simplex, &row.kept.aabo, &row.floor}) {
        *sum /= static_cast<double>(segments_);
      }
    }
    return rows;
  }

 private:
  std::vector<SegmentRow> rows_;
  std::size_t segments_ = 0;
};

}  // namespace

SegmentsResult RunSegments(const Workload& workload, std::uint64_t seed,
                           bool is_quick, const Context& context) {
  const AaboWorld3 world = Thinned(workload.objects, kMostObjects);
  const Aabb3 box = BoxAround(world);
  const double extent = LongestSideOf(box);
  SegmentsResult result;
  result.workload = workload.name;
  result.objects = world.size();
  result.segments = is_quick ? kQuickSegments : kSegments;
  result.seed = seed;
  Random random(seed);
  const double steps =
      static_cast<double>(kSegmentDirections.size() * kSegmentLengths.size());
  double done = 0.0;
  for (SegmentDirection direction : kSegmentDirections) {
    for (double length : kSegmentLengths) {
      Sums sums(direction, length);
      for (std::size_t i = 0; i < result.segments; ++i) {
        sums.Add(world.view(),
                 MakeSegment(direction, length * extent, box, random));
      }
      const std::vector<SegmentRow> rows = sums.Means();
      result.rows.insert(result.rows.end(), rows.begin(), rows.end());
      context.progress.Update(++done / steps);
    }
  }
  return result;
}

}  // namespace halfspace::bench

// Long segments as queries: how many objects one bound of a segment keeps, and
// how many its bounds in pieces do. Counts, and no times.
#include <cstddef>

#include "bench/base/text.h"
#include "bench/paper/segment_counts.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {

Tables RunSegments(Run& run) {
  // Enough to count in, and counted in a second.
  constexpr std::size_t kMostObjects = std::size_t{1} << 16;
  const std::size_t segments = run.is_quick() ? 8 : 32;
  const AaboWorld3 world = Thinned(run.Measured().objects, kMostObjects);
  const Aabb3 box = BoxAround(world);
  Random random(run.options.seed);
  Table table{
      "segments",
      "objects that a segment keeps, bounded in pieces (means)",
      {Key("direction"), Key("length", "%"), Key("pieces"),
       Value("AABB", "", 1), Value("simplex", "", 1), Value("AABO", "", 1),
       Value("1024 pieces", "", 1), Value("tests", "", 0)}};
  table.chart = Chart{"pieces", {"AABO"}, "direction", true, true};
  double done = 0.0;
  for (SegmentDirection direction : kSegmentDirections) {
    for (double length : kSegmentLengths) {
      std::array<PerShape<double>, kSegmentPieces.size()> sums;
      double floor = 0.0;
      for (std::size_t i = 0; i < segments; ++i) {
        const Segment3 segment =
            MakeSegment(direction, length * LongestSideOf(box), box, random);
        floor += static_cast<double>(CountFloor(world.view(), segment));
        for (std::size_t p = 0; p < sums.size(); ++p) {
          const PerShape<std::size_t> kept =
              CountKept(world.view(), segment, kSegmentPieces[p]);
          sums[p].aabb += static_cast<double>(kept.aabb);
          sums[p].simplex += static_cast<double>(kept.simplex);
          sums[p].aabo += static_cast<double>(kept.aabo);
        }
      }
      const auto mean = [segments](double sum) {
        return sum / static_cast<double>(segments);
      };
      for (std::size_t p = 0; p < sums.size(); ++p) {
        table.Add({NameOf(direction), 100.0 * length, kSegmentPieces[p],
                   mean(sums[p].aabb), mean(sums[p].simplex),
                   mean(sums[p].aabo), mean(floor),
                   world.size() * kSegmentPieces[p]});
      }
      run.progress.Update(++done /
                          static_cast<double>(kSegmentDirections.size() *
                                              kSegmentLengths.size()));
    }
  }
  table.notes = {Grouped(world.size()) + " objects, " +
                 std::to_string(segments) +
                 " segments of each direction and length, in % of the world's "
                 "longest side; tests: objects times pieces."};
  return {table};
}

}  // namespace halfspace::bench

// Long segments as queries: how many objects one bound of a segment keeps, and
// how many its bounds in pieces do.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/paper/work_count.h"
#include "bench/sections/run.h"
#include "bench/worlds/random.h"
#include "halfspace/fit.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

using Direction = std::array<double, 3>;

// Along (1, 1, 1) D changes most, along (1, -1, 0) it does not change.
struct NamedDirection {
  const char* name;
  Direction along;  // 0: uniform on the sphere
};
const std::array<NamedDirection, 3> kDirections = {
    {{"uniform", {}},
     {"(1,1,1)",
      {std::sqrt(1.0 / 3.0), std::sqrt(1.0 / 3.0), std::sqrt(1.0 / 3.0)}},
     {"(1,-1,0)", {std::sqrt(0.5), -std::sqrt(0.5), 0.0}}}};
// The last are so many that they are all but the segment itself.
constexpr std::array<std::size_t, 7> kPieces = {1, 2, 4, 8, 16, 32, 1024};

// A segment of that length, its middle uniform in the box.
Segment3 MakeSegment(Direction along, double length, const Aabb3& box,
                     Random& random) {
  if (along == Direction{}) {
    double square = 0.0;
    while (square < 0x1p-10) {
      square = 0.0;
      const std::array<float, 3> point = PointInUnitSphere(random);
      std::copy(point.begin(), point.end(), along.begin());
      for (double x : along) square += x * x;
    }
    for (double& x : along) x /= std::sqrt(square);
  }
  Segment3 segment;
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = box.min[k];
    const double high = box.max[k];
    const double middle =
        0.5 * (low + high) + 0.5 * (high - low) * double{random.Signed()};
    segment.a[k] = static_cast<float>(middle - 0.5 * length * along[k]);
    segment.b[k] = static_cast<float>(middle + 0.5 * length * along[k]);
  }
  return segment;
}

// How many objects at least one piece of a segment keeps.
double KeptBy(ShapeKind shape, const AaboView3& view, const Segment3& segment,
              std::size_t count) {
  std::vector<Aabo3> pieces(count);
  BoundSegmentPieces(segment, std::span<Aabo3>(pieces));
  std::vector<std::uint64_t> mask(MaskWords(view.size));
  std::vector<std::uint64_t> all(mask.size());
  for (const Aabo3& piece : pieces) {
    WithShape(shape, view, piece, [&](const auto& objects, const auto& query) {
      SurvivorMask(objects, query, mask);
    });
    for (std::size_t w = 0; w < all.size(); ++w) all[w] |= mask[w];
  }
  return static_cast<double>(BatchesLeft(all, 1));
}

}  // namespace

Tables RunSegments(Run& run) {
  // Enough to count in, and counted in a second.
  constexpr std::size_t kMostObjects = std::size_t{1} << 16;
  const std::size_t segments = run.options.is_quick ? 8 : 32;
  const AaboWorld3 world = Thinned(run.Measured().objects, kMostObjects);
  const Aabb3 box = BoxAround(world);
  double side = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    side = std::max(side, double{box.max[k]} - box.min[k]);
  }
  Random random(run.options.seed);
  Table table{
      "segments",
      "objects that a segment keeps, bounded in pieces (means)",
      {Key("direction"), Key("length", "%"), Key("pieces"),
       Value("AABB", "", 1), Value("simplex", "", 1), Value("AABO", "", 1)}};
  table.chart = Chart{"pieces", {"AABO"}, "direction", true, true};
  for (const NamedDirection& direction : kDirections) {
    std::array<PerShape<double>, kPieces.size()> sums;
    for (std::size_t i = 0; i < segments; ++i) {
      const Segment3 segment = MakeSegment(direction.along, side, box, random);
      for (std::size_t p = 0; p < kPieces.size(); ++p) {
        for (ShapeKind shape : kShapes) {
          sums[p].Of(shape) += KeptBy(shape, world.view(), segment, kPieces[p]);
        }
      }
    }
    for (std::size_t p = 0; p < kPieces.size(); ++p) {
      Row row = {direction.name, 100.0, kPieces[p]};
      for (ShapeKind shape : kShapes) {
        row.emplace_back(sums[p].Of(shape) / static_cast<double>(segments));
      }
      table.Add(std::move(row));
    }
  }
  table.notes = {Grouped(world.size()) + " objects, " +
                 std::to_string(segments) +
                 " segments of each direction, as long as the world's longest "
                 "side."};
  return {table};
}

}  // namespace halfspace::bench

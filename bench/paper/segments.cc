// Long segments as queries: how many objects one bound of a segment keeps, and
// how many its bounds in pieces do.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/base/text.h"
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
constexpr std::array<double, 3> kLengths = {0.1, 0.3, 1.0};
constexpr std::array<std::size_t, 6> kPieces = {1, 2, 4, 8, 16, 32};
// So many that they are all but the segment itself.
constexpr std::size_t kManyPieces = 1024;

// A segment of that length, its middle uniform in the box.
Segment3 MakeSegment(const Direction& direction, double length,
                     const Aabb3& box, Random& random) {
  Direction along = direction;
  double square = along[0] * along[0] + along[1] * along[1];
  while (square < 0x1p-10) {
    const std::array<float, 3> point = PointInUnitSphere(random);
    std::copy(point.begin(), point.end(), along.begin());
    square = along[0] * along[0] + along[1] * along[1] + along[2] * along[2];
  }
  if (direction == Direction{}) {
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

// The objects that at least one piece of a segment keeps.
std::vector<std::uint64_t> KeptBy(ShapeKind shape, const AaboView3& view,
                                  const Segment3& segment, std::size_t count) {
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
  return all;
}

double CountOf(const std::vector<std::uint64_t>& mask) {
  double sum = 0.0;
  for (std::uint64_t word : mask) sum += std::popcount(word);
  return sum;
}

// What nothing that knows only the objects' octahedra can reject. Whatever many
// pieces keep, a few keep too.
double CountFloor(const AaboWorld3& world, const Segment3& segment) {
  const auto few =
      KeptBy(ShapeKind::kAabo, world.view(), segment, kPieces.back());
  AaboWorld3 kept;
  for (std::size_t i = 0; i < world.size(); ++i) {
    if ((few[i / 64] >> i % 64 & 1) != 0) kept.Push(world.Get(i));
  }
  return CountOf(KeptBy(ShapeKind::kAabo, kept.view(), segment, kManyPieces));
}

}  // namespace

Tables RunSegments(Run& run) {
  // Enough to count in, and counted in a second.
  constexpr std::size_t kMostObjects = std::size_t{1} << 16;
  const std::size_t segments = run.is_quick() ? 8 : 32;
  const AaboWorld3 world = Thinned(run.Measured().objects, kMostObjects);
  const Aabb3 box = BoxAround(world);
  double side = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    side = std::max(side, double{box.max[k]} - double{box.min[k]});
  }
  Random random(run.options.seed);
  Table table{"segments",
              "objects that a segment keeps, bounded in pieces (means)",
              {Key("direction"), Key("length", "%"), Key("pieces"),
               Value("AABB", "", 1), Value("simplex", "", 1),
               Value("AABO", "", 1), Value("1024 pieces", "", 1)}};
  table.chart = Chart{"pieces", {"AABO"}, "direction", true, true};
  double done = 0.0;
  for (const NamedDirection& direction : kDirections) {
    for (double length : kLengths) {
      std::array<PerShape<double>, kPieces.size()> means;
      double floor = 0.0;
      for (std::size_t i = 0; i < segments; ++i) {
        const Segment3 segment =
            MakeSegment(direction.along, length * side, box, random);
        const auto mean_of = [segments](double count) {
          return count / static_cast<double>(segments);
        };
        floor += mean_of(CountFloor(world, segment));
        for (std::size_t p = 0; p < kPieces.size(); ++p) {
          const auto kept = [&](ShapeKind shape) {
            return mean_of(
                CountOf(KeptBy(shape, world.view(), segment, kPieces[p])));
          };
          means[p].aabb += kept(ShapeKind::kAabb);
          means[p].simplex += kept(ShapeKind::kSimplex);
          means[p].aabo += kept(ShapeKind::kAabo);
        }
      }
      for (std::size_t p = 0; p < kPieces.size(); ++p) {
        table.Add({direction.name, 100.0 * length, kPieces[p], means[p].aabb,
                   means[p].simplex, means[p].aabo, floor});
      }
      run.progress.Update(
          ++done / static_cast<double>(kDirections.size() * kLengths.size()));
    }
  }
  table.notes = {Grouped(world.size()) + " objects, " +
                 std::to_string(segments) +
                 " segments of each direction and length, in % of the world's "
                 "longest side."};
  return {table};
}

}  // namespace halfspace::bench

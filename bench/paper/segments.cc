#include "bench/paper/segments.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "bench/base/text.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

using Direction = std::array<double, 3>;

Direction UniformDirection(Random& random) {
  for (;;) {
    const Direction d = {random.Signed(), random.Signed(), random.Signed()};
    const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (square > 1.0 || square < 0x1p-10) continue;
    const double length = std::sqrt(square);
    return {d[0] / length, d[1] / length, d[2] / length};
  }
}

Direction DirectionOf(SegmentDirection direction, Random& random) {
  switch (direction) {
    case SegmentDirection::kUniform:
      return UniformDirection(random);
    case SegmentDirection::kSpaceDiagonal: {
      const double side = std::sqrt(1.0 / 3.0);
      return {side, side, side};
    }
    case SegmentDirection::kFaceDiagonal:
      break;
  }
  const double side = std::sqrt(0.5);
  constexpr std::size_t kAxes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  const auto& axes = kAxes[random.Below(3)];
  Direction d{};
  d[axes[0]] = side;
  d[axes[1]] = -side;
  return d;
}

std::vector<Aabo3> PiecesOf(const Segment3& segment, std::size_t count) {
  std::vector<Aabo3> pieces(count);
  BoundSegmentPieces(segment, std::span<Aabo3>(pieces));
  return pieces;
}

// The survivor masks of several queries, joined.
class Union {
 public:
  explicit Union(std::size_t objects)
      : mask_(MaskWords(objects)), all_(mask_.size(), 0) {}

  template <typename View>
  void Add(const View& view, const typename View::Query& query) {
    SurvivorMask(view, query, mask_);
    for (std::size_t w = 0; w < all_.size(); ++w) all_[w] |= mask_[w];
  }

  const std::vector<std::uint64_t>& words() const { return all_; }

  std::size_t count() const {
    std::size_t sum = 0;
    for (std::uint64_t word : all_) {
      sum += static_cast<std::size_t>(std::popcount(word));
    }
    return sum;
  }

 private:
  std::vector<std::uint64_t> mask_;
  std::vector<std::uint64_t> all_;
};

Union KeptByAabo(const AaboView3& view, const Segment3& segment,
                 std::size_t pieces) {
  Union kept(view.size);
  for (const Aabo3& piece : PiecesOf(segment, pieces)) kept.Add(view, piece);
  return kept;
}

Aabo3 ObjectOf(const AaboView3& view, std::size_t i) {
  Aabo3 object;
  for (std::size_t k = 0; k < Aabo3::kAxes; ++k) {
    object.min[k] = view.min[k][i];
    object.max[k] = view.max[k][i];
  }
  return object;
}

}  // namespace

double LongestSideOf(const Aabb3& box) {
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest = std::max(longest, double{box.max[k]} - double{box.min[k]});
  }
  return longest;
}

Segment3 MakeSegment(SegmentDirection direction, double length,
                     const Aabb3& box, Random& random) {
  const Direction along = DirectionOf(direction, random);
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

PerShape<std::size_t> CountKept(const AaboView3& view, const Segment3& segment,
                                std::size_t pieces) {
  Union aabb(view.size);
  Union simplex(view.size);
  for (const Aabo3& piece : PiecesOf(segment, pieces)) {
    aabb.Add(view.aabb(), piece.aabb());
    simplex.Add(view.simplex(), piece.down());
  }
  return {.aabb = aabb.count(),
          .simplex = simplex.count(),
          .aabo = KeptByAabo(view, segment, pieces).count()};
}

std::size_t CountFloor(const AaboView3& view, const Segment3& segment) {
  // Whatever many pieces keep, a few keep too.
  const Union candidates = KeptByAabo(view, segment, kSegmentPieces.back());
  AaboWorld3 kept;
  for (std::size_t w = 0; w < candidates.words().size(); ++w) {
    for (std::uint64_t word = candidates.words()[w]; word != 0;
         word &= word - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(word));
      kept.Push(ObjectOf(view, w * 64 + bit));
    }
  }
  return KeptByAabo(kept.view(), segment, kFloorPieces).count();
}

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

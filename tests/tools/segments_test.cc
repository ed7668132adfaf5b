// Long segments in pieces: against counts by hand, and that more pieces never
// keep more.
#include "bench/paper/segments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/worlds/scene.h"
#include "tests/library/support/environment.h"

namespace halfspace::bench {
namespace {

// The 16 points (x, y, 0) with x and y in 0 .. 3.
AaboWorld3 PointGrid() {
  AaboWorld3 world;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) {
      world.Push(
          BoundPoint<3>({static_cast<float>(x), static_cast<float>(y), 0.0f}));
    }
  }
  return world;
}

struct Expected {
  std::size_t pieces;
  std::size_t aabb;
  std::size_t simplex;
  std::size_t aabo;
};

void ExpectKept(const Segment3& segment, const std::vector<Expected>& rows) {
  const AaboWorld3 world = PointGrid();
  for (const Expected& row : rows) {
    const auto kept = CountKept(world.view(), segment, row.pieces);
    EXPECT_EQ(kept.aabb, row.aabb) << row.pieces;
    EXPECT_EQ(kept.simplex, row.simplex) << row.pieces;
    EXPECT_EQ(kept.aabo, row.aabo) << row.pieces;
  }
}

// From (0, 0) to (3, 3). A piece from (l, l) to (h, h) keeps of the points
//   aabb     l <= x, y <= h
//   aabo     the same: 2 l <= x + y <= 2 h says nothing more
//   simplex  x, y <= h and x + y >= 2 l
// In 2 pieces (h = 1.5, 3): 4 + 4, and 4 + the 10 with x + y >= 3.
// In 4 (h = 0.75, 1.5, 2.25, 3): 1 each, and 1 + 1 + 3 + 3.
TEST(SegmentsTest, AreCountedByHandAlongTheDiagonal) {
  const Segment3 segment{{0, 0, 0}, {3, 3, 0}};
  ExpectKept(segment, {{1, 16, 16, 16}, {2, 8, 14, 8}, {4, 4, 8, 4}});
  EXPECT_EQ(CountFloor(PointGrid().view(), segment), 4u);
}

// From (0, 3) to (3, 0), where x + y is 3. A piece from (l, 3 - l) to
// (h, 3 - h) keeps of the points
//   aabb     l <= x <= h and 3 - h <= y <= 3 - l
//   aabo     of those the ones with x + y = 3
//   simplex  x <= h, y <= 3 - l and x + y >= 3
// In 2 pieces: aabb 2 * 2 each; simplex (0, 3), (1, 2), (1, 3) and their mirror
// images. In 4, one point each.
TEST(SegmentsTest, AreCountedByHandAcrossTheDiagonal) {
  const Segment3 segment{{0, 3, 0}, {3, 0, 0}};
  ExpectKept(segment, {{1, 16, 10, 4}, {2, 8, 6, 4}, {4, 4, 4, 4}});
  EXPECT_EQ(CountFloor(PointGrid().view(), segment), 4u);
}

TEST(SegmentsTest, KeepNothingFarAway) {
  const Segment3 segment{{9, 9, 9}, {12, 12, 12}};
  ExpectKept(segment, {{1, 0, 0, 0}, {4, 0, 0, 0}});
  EXPECT_EQ(CountFloor(PointGrid().view(), segment), 0u);
}

TEST(SegmentsTest, MorePiecesNeverKeepMore) {
  const Workload scene = MakeScene(3000, 1, /*seed=*/5, [](double) {});
  const AaboView3 view = scene.objects.view();
  const Aabb3 box = BoxAround(scene.objects);
  Random random(11);
  for (SegmentDirection direction : kSegmentDirections) {
    for (double length : kSegmentLengths) {
      for (std::size_t i = 0; i < testing::Scaled(10); ++i) {
        const Segment3 segment =
            MakeSegment(direction, length * LongestSideOf(box), box, random);
        SCOPED_TRACE(NameOf(direction));
        PerShape<std::size_t> before{view.size, view.size, view.size};
        for (std::size_t pieces = 1; pieces <= 128; pieces *= 2) {
          const auto kept = CountKept(view, segment, pieces);
          EXPECT_LE(kept.aabb, before.aabb) << pieces;
          EXPECT_LE(kept.simplex, before.simplex) << pieces;
          EXPECT_LE(kept.aabo, before.aabo) << pieces;
          EXPECT_LE(kept.aabo, std::min(kept.aabb, kept.simplex)) << pieces;
          before = kept;
        }
        const std::size_t floor = CountFloor(view, segment);
        EXPECT_LE(floor, before.aabo);
        EXPECT_EQ(floor, CountKept(view, segment, kFloorPieces).aabo);
      }
    }
  }
}

// Why counts cannot rise: the halves of a piece lie within it, rounding and
// all.
TEST(SegmentsTest, HalvesOfAPieceLieWithinIt) {
  const Aabb3 box{{-50, -50, -50}, {50, 50, 50}};
  Random random(2);
  for (std::size_t i = 0; i < testing::Scaled(2000); ++i) {
    const Segment3 segment =
        MakeSegment(SegmentDirection::kUniform, 100.0, box, random);
    std::vector<Aabo3> whole(1 + random.Below(40));
    std::vector<Aabo3> halves(2 * whole.size());
    BoundSegmentPieces(segment, std::span<Aabo3>(whole));
    BoundSegmentPieces(segment, std::span<Aabo3>(halves));
    for (std::size_t p = 0; p < halves.size(); ++p) {
      for (std::size_t k = 0; k < Aabo3::kAxes; ++k) {
        EXPECT_GE(halves[p].min[k], whole[p / 2].min[k]);
        EXPECT_LE(halves[p].max[k], whole[p / 2].max[k]);
      }
    }
  }
}

TEST(SegmentsTest, HaveTheirDirectionAndLength) {
  const Aabb3 box{{-1, 2, 10}, {1, 8, 14}};
  Random random(3);
  for (SegmentDirection direction : kSegmentDirections) {
    for (int i = 0; i < 100; ++i) {
      const Segment3 segment = MakeSegment(direction, 6.0, box, random);
      double square = 0.0;
      double sum = 0.0;
      double product = 1.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double along = double{segment.b[k]} - double{segment.a[k]};
        square += along * along;
        sum += along;
        product *= along;
        const double middle =
            0.5 * (double{segment.a[k]} + double{segment.b[k]});
        EXPECT_GE(middle, box.min[k] - 1e-5);
        EXPECT_LE(middle, box.max[k] + 1e-5);
      }
      EXPECT_NEAR(std::sqrt(square), 6.0, 1e-5);
      if (direction == SegmentDirection::kSpaceDiagonal) {
        EXPECT_NEAR(sum, 6.0 * std::sqrt(3.0), 1e-5);
      }
      if (direction == SegmentDirection::kFaceDiagonal) {
        EXPECT_NEAR(sum, 0.0, 1e-5);
        EXPECT_EQ(product, 0.0);
      }
    }
  }
}

TEST(SegmentsTest, TheBoxLeavesOutWhatCannotBeBounded) {
  AaboWorld3 world;
  world.Push(Aabo3::Everything());
  EXPECT_EQ(BoxAround(world), Aabb3{});
  world.Push(BoundPoint<3>({1, 2, 3}));
  world.Push(BoundPoint<3>({4, 0, 3}));
  EXPECT_EQ(BoxAround(world), (Aabb3{{1, 0, 3}, {4, 2, 3}}));
  EXPECT_EQ(LongestSideOf(BoxAround(world)), 3.0);
}

}  // namespace
}  // namespace halfspace::bench

// Every builder, and every change of a bound, against exact arithmetic.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/exact_answers.h"
#include "tests/library/fit/exact_shapes.h"
#include "tests/library/fit/random_shapes.h"

namespace halfspace::testing {
namespace {

class FitExactTest : public ::testing::TestWithParam<Builder> {};

TEST_P(FitExactTest, EnclosesAndIsAsTightAsPromised) {
  const Builder& builder = GetParam();
  const bool is_round =
      builder.kind == Kind::kSphere || builder.kind == Kind::kCapsule;
  ForEachSample(
      20, is_round ? 1000 : 200, builder.results(),
      [&](PointKind kind, Random& random) {
        ASSERT_TRUE(IsExact(builder, RandomShape(builder, kind, random)));
      });
}

bool MovesVertices(const Builder& builder) {
  return builder.kind == Kind::kChange &&
         builder.change == Change::kTranslateVertices;
}

std::vector<Builder> AllButVertices() {
  std::vector<Builder> builders = BuildersAndChanges();
  std::erase_if(builders, MovesVertices);
  return builders;
}
INSTANTIATE_TEST_SUITE_P(, FitExactTest, ::testing::ValuesIn(AllButVertices()),
                         BuilderNames());

class TranslateVerticesTest : public ::testing::TestWithParam<Builder> {};

// Against vertices that are really moved, and rounded.
TEST_P(TranslateVerticesTest, EnclosesMovedVertices) {
  const Builder& builder = GetParam();
  const Builder& points = BuilderOf(Kind::kTriangle, builder.dims);
  const std::size_t first = builder.first_argument();
  std::size_t exact_moves_that_cut = 0;
  ForEachSample(60, 300, 1, [&](PointKind kind, Random& random) {
    const Shape vertices = RandomShape(points, kind, random);
    Shape shape = RandomShape(builder, kind, random);
    for (std::size_t k = 0; k < builder.dims; ++k) {
      if (kind == PointKind::kCancelling) {
        shape.Set(first + k, shape.floats[first + k] + vertices.floats[k]);
      }
    }
    SetPlanesOfVertices(builder, vertices, shape);
    bool cuts = false;
    ASSERT_TRUE(EnclosesMovedVertices(builder, vertices, shape,
                                      Try(builder, shape), &cuts));
    exact_moves_that_cut += cuts ? 1 : 0;
  });
  // Otherwise the other call would do.
  EXPECT_TRUE(builder.part == Part::kAabb || exact_moves_that_cut > 0);
}

TEST_P(TranslateVerticesTest, PlanesWithoutABoundStaySo) {
  const Builder& builder = GetParam();
  ForEachSample(61, 100, 1, [&](PointKind kind, Random& random) {
    const Shape shape = RandomShape(builder, kind, random);
    const Planes moved = builder.Build(shape);
    for (std::size_t p = 0; p < builder.first_argument(); ++p) {
      const float plane = shape.floats[p];
      if (std::fabs(plane) == std::numeric_limits<float>::max()) {
        ASSERT_EQ(moved[p], plane);
      }
    }
  });
}

std::vector<Builder> VertexChanges() {
  std::vector<Builder> changes = Changes();
  std::erase_if(changes, [](const Builder& b) { return !MovesVertices(b); });
  return changes;
}
INSTANTIATE_TEST_SUITE_P(, TranslateVerticesTest,
                         ::testing::ValuesIn(VertexChanges()), BuilderNames());

// Neighbours both have the point where they meet, and nothing is left out.
TEST(FitPiecesExactTest, ManyPieces) {
  for (bool is_double : {false, true}) {
    const Builder& builder = BuilderOf(Kind::kPieces, 3, is_double);
    ForEachSample(36, 20, 1000, [&](PointKind kind, Random& random) {
      const Shape shape = RandomShape(builder, kind, random);
      const ExactNumbers numbers(builder, shape);
      std::vector<Aabo3> pieces(1 + random() % 1000);
      Segment3 segment;
      Segment<3, double> wide;
      for (std::size_t k = 0; k < 3; ++k) {
        segment.a[k] = shape.floats[k];
        segment.b[k] = shape.floats[k + 3];
        wide.a[k] = shape.doubles[k];
        wide.b[k] = shape.doubles[k + 3];
      }
      is_double ? BoundSegmentPieces(wide, pieces)
                : BoundSegmentPieces(segment, pieces);
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        ExactHull hull(3);
        for (std::size_t end : {i, i + 1}) {
          const mpq_class share = mpq_class(end) / mpq_class(pieces.size());
          ExactPoint point;
          for (std::size_t k = 0; k < 3; ++k) {
            point.push_back(numbers[k] + share * (numbers[k + 3] - numbers[k]));
          }
          hull.AddPoint(point);
        }
        ASSERT_TRUE(hull.IsEnclosedBy(pieces[i].min.data(), kWithinOneUlp))
            << i << " of " << pieces.size();
      }
    });
  }
}

}  // namespace
}  // namespace halfspace::testing

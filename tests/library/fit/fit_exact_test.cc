// Every builder against the exact extremes of its shape.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/exact_shapes.h"
#include "tests/library/fit/random_shapes.h"

namespace halfspace::testing {
namespace {

class FitExactTest : public ::testing::TestWithParam<Builder> {};

TEST_P(FitExactTest, EnclosesAndIsAsTightAsPromised) {
  const Builder& builder = GetParam();
  const bool is_round =
      builder.kind == Kind::kSphere || builder.kind == Kind::kCapsule;
  const std::size_t bound_values = 2 * (builder.dims + 1);
  ForEachSample(
      20, is_round ? 1000 : 200, builder.results(),
      [&](PointKind kind, Random& random) {
        const Shape shape = RandomShape(builder, kind, random);
        const Planes bounds = builder.Build(shape);
        const Looseness loose =
            is_round ? RoundD(builder.Number(shape, builder.roles.size() - 1))
            : builder.kind == Kind::kPieces ? kWithinOneUlp
                                            : kTightest;
        for (std::size_t i = 0; i < builder.results(); ++i) {
          ASSERT_TRUE(HullOf(builder, shape, i)
                          .IsEnclosedBy(&bounds[i * bound_values], loose))
              << "result " << i;
        }
      });
}

std::vector<Builder> AllButFrusta() {
  std::vector<Builder> builders = Builders();
  std::erase_if(builders, [](const Builder& builder) {
    return builder.kind == Kind::kFrustum;
  });
  return builders;
}
INSTANTIATE_TEST_SUITE_P(, FitExactTest, ::testing::ValuesIn(AllButFrusta()),
                         BuilderNames());

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

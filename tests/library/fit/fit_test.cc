// Every builder, and every change of a bound: random and special numbers
// against exact arithmetic, in every floating-point mode; hard cases by hand;
// and errors.
#include "halfspace/fit.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dispatch/outward.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/exact_answers.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/exact.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

// The outcome is exact, and the same in every floating-point mode of the
// caller.
void ExpectExact(const Builder& builder, const Shape& shape) {
  const Outcome outcome = Try(builder, shape);
  ASSERT_TRUE(IsExact(builder, shape, outcome));
  for (FpMode mode : kFpModes) {
    Outcome again;
    RunIn(mode, [&] { again = Try(builder, shape, outcome.status); });
    ASSERT_TRUE(again.is_refused == outcome.is_refused &&
                SameBits(again.planes, outcome.planes) &&
                again.status.first_everything ==
                    outcome.status.first_everything)
        << "mode " << static_cast<int>(mode);
  }
}

class FitExactTest : public ::testing::TestWithParam<Builder> {};

TEST_P(FitExactTest, EnclosesAndIsAsTightAsPromised) {
  const Builder& builder = GetParam();
  const bool is_round =
      builder.kind == Kind::kSphere || builder.kind == Kind::kCapsule;
  ForEachSample(20, is_round ? 1000 : 200, [&](PointKind kind, Random& random) {
    Shape shape = RandomShape(builder, kind, random);
    if (OneIn(4, random)) Spoil(builder, shape, random);
    ExpectExact(builder, shape);
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
                         ::testing::PrintToStringParamName());

// Against vertices that are really moved, and rounded.
TEST(TranslateVerticesTest, EnclosesMovedVertices) {
  for (const Builder& builder : Changes()) {
    if (!MovesVertices(builder)) continue;
    SCOPED_TRACE(builder.name);
    const Builder& points = BuilderOf(Kind::kTriangle, builder.dims);
    const std::size_t first = builder.first_argument();
    ForEachSample(60, 300, [&](PointKind kind, Random& random) {
      const Shape vertices = RandomShape(points, kind, random);
      Shape shape = RandomShape(builder, kind, random);
      const Planes planes = builder.Build(shape);
      for (std::size_t p = 0; p < first; ++p) {
        // Planes without a bound stay so.
        if (std::fabs(shape.floats[p]) == std::numeric_limits<float>::max()) {
          ASSERT_EQ(planes[p], shape.floats[p]);
        }
      }
      for (std::size_t k = 0; k < builder.dims; ++k) {
        if (kind == PointKind::kCancelling) {
          shape.Set(first + k, shape.floats[first + k] + vertices.floats[k]);
        }
      }
      SetPlanesOfVertices(builder, vertices, shape);
      ASSERT_TRUE(
          EnclosesMovedVertices(builder, vertices, shape, Try(builder, shape)));
    });
  }
}

// Neighbours both have the point where they meet, and nothing is left out.
TEST(FitPiecesExactTest, ManyPieces) {
  for (bool is_double : {false, true}) {
    const Builder& builder = BuilderOf(Kind::kPieces, 3, is_double);
    ForEachSample(36, 20, [&](PointKind kind, Random& random) {
      const Shape shape = RandomShape(builder, kind, random);
      std::vector<Aabo3> pieces(1 + random() % 1000);
      Segment3 segment;
      Segment<3, double> wide;
      std::memcpy(&segment, shape.floats.data(), sizeof(segment));
      std::memcpy(&wide, shape.doubles.data(), sizeof(wide));
      is_double ? BoundSegmentPieces(wide, pieces)
                : BoundSegmentPieces(segment, pieces);
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        ASSERT_TRUE(HullOf(builder, shape, i, pieces.size())
                        .IsEnclosedBy(pieces[i].min.data(),
                                      LooseBy(WeightOf(builder, shape))))
            << i << " of " << pieces.size();
      }
    });
  }
}

// Shapes and bounds that floats cannot bound become Everything() or an error,
// and are counted.

class FitSpecialTest : public ::testing::TestWithParam<Builder> {};

// Special values, and those around what can be bounded, as each number; the
// others are one or zero. (Infinity times zero can be anything.)
TEST_P(FitSpecialTest, NumbersThatCannotBeBounded) {
  const Builder& builder = GetParam();
  for (std::size_t i = 0; i < builder.roles.size(); ++i) {
    std::vector<double> values = {0x1p125, 0x1.00002p125, 0x1p126,
                                  0x1.000002p126, 1e37};
    if (builder.IsDouble(i)) {
      values.insert(values.end(), kSpecialValues<double>.begin(),
                    kSpecialValues<double>.end());
    } else {
      values.insert(values.end(), kSpecialValues<float>.begin(),
                    kSpecialValues<float>.end());
    }
    for (double value : values) {
      for (double sign : {1.0, -1.0}) {
        if (MovesVertices(builder) && std::isfinite(value)) continue;
        for (Shape shape : {ShapeOfOnes(builder), Shape()}) {
          SCOPED_TRACE(::testing::Message()
                       << sign * value << " as number " << i);
          shape.Set(i, sign * value);
          ExpectExact(builder, shape);
          if (HasFatalFailure()) return;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, FitSpecialTest,
                         ::testing::ValuesIn(BuildersAndChanges()),
                         ::testing::PrintToStringParamName());

TEST(FitLimitTest, NoPoints) {
  FitStatus status;
  const float unread = detail::kInf<float>;
  EXPECT_EQ(BoundPoints<3>({nullptr, 0}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundPoints(PointsSoa3{}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundPoints(Points<3, double>{}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundPoints(Points3{&unread, 7}, {}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundPoints(PointsSoa3{{}, 7}, {}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundTransformed(Points3{}, Affine3{}, &status), Aabo3::Empty());
  BoundSegmentPieces(Segment3{}, {}, &status);
  EXPECT_EQ(status.results, 6u);
  EXPECT_EQ(status.everything, 0u);
}

// The wrappers of the calls above.
TEST(FitKnownTest, OnePointAndStrideZero) {
  const Aabo3 bound{{1, 2, 3, -6}, {1, 2, 3, -6}};
  const Point3 point = {1, 2, 3};
  EXPECT_EQ(BoundPoint<3>(point), bound);
  EXPECT_EQ(BoundPoints(Points3{point.data(), 50, 0}), bound);
  EXPECT_EQ((BoundPoint<3, double>({1, 2, 3})), bound);
}

// What builders refuse of points, pieces and planes, and how they say it. What
// they refuse of numbers is in exact_answers.h.

class FitPointErrorsTest : public ::testing::Test {
 protected:
  ~FitPointErrorsTest() override { EXPECT_EQ(status_.results, 0u); }

  std::array<float, 5> point_ = {1, 1, 1, 1, 1};
  FitStatus status_;
};

TEST_F(FitPointErrorsTest, PointsThatCannotBeRead) {
  const auto refused = [&](const auto& points, std::string_view expected,
                           std::string_view given) {
    EXPECT_REFUSED((BoundPoints(points, &status_)), "BoundPoints", expected,
                   given);
  };
  refused(Points3{nullptr, 3}, "points.coords: expected 3 points",
          "got a null pointer");
  refused(Points3{Misaligned(point_.data()), 1}, "points.coords: expected",
          "aligned to 4 bytes, got a misaligned");
  alignas(8) std::array<float, 4> room{};
  const auto* half = reinterpret_cast<const double*>(&room[1]);
  refused(Points<3, double>{half, 1}, "points.coords: expected",
          "aligned to 8 bytes");
  const std::array<double, 3> ones = {1, 1, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string argument = "points.coords[" + std::to_string(k) + "]";
    PointsSoa<3, double> soa{.coords = {}, .count = 1};
    soa.coords.fill(ones.data());
    soa.coords[k] = nullptr;
    refused(soa, argument, "1 points, got a null");
    soa.coords[k] = half;
    refused(soa, argument, "aligned to 8 bytes");
  }
  EXPECT_REFUSED((BoundTransformed(Points3{nullptr, 2}, Affine3{}, &status_)),
                 "BoundTransformed", "points.coords: expected 2 points",
                 "null");
  // Before the first point is read, or this would crash. Of count and stride,
  // the larger is to blame.
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
  refused(Points3{point_.data(), kMost}, "points.count: expected",
          "got " + std::to_string(kMost));
  refused(Points3{point_.data(), 3, kMost / 4},
          "points.stride: expected a stride with which 3",
          "got " + std::to_string(kMost / 4));
}

TEST_F(FitPointErrorsTest, IndicesThatCannotBeRead) {
  const std::array<std::uint32_t, 3> zeros{};
  // Before any is read: the one point there is lies at index 0.
  const auto check = [&](const auto& points) {
    using Indices = std::span<const std::uint32_t>;
    const std::uint32_t* const none = nullptr;
    EXPECT_REFUSED((BoundPoints(points, Indices(none, 2), &status_)),
                   "BoundPoints", "2 indices", "a null pointer");
    EXPECT_REFUSED(
        (BoundPoints(points, Indices(Misaligned(zeros.data()), 2), &status_)),
        "BoundPoints", "aligned to 4", "misaligned");
    for (std::uint32_t bad : {1u, 0xffffffffu}) {
      const std::array<std::uint32_t, 3> indices = {0, 0, bad};
      EXPECT_REFUSED((BoundPoints(points, indices, &status_)), "BoundPoints",
                     "indices[2]: expected less than", "1",
                     "got " + std::to_string(bad));
    }
  };
  check(Points3{point_.data(), 1});
  check(PointsSoa3{{point_.data(), point_.data(), point_.data()}, 1});
  EXPECT_REFUSED((BoundPoints(Points3{nullptr, 0}, zeros)),
                 "indices[0]: expected less than", "0, got 0");
}

// Refused before the first is written, or this would crash.
TEST_F(FitPointErrorsTest, PiecesThatCannotBeWritten) {
  std::array<Aabo3, 3> room;
  const auto refused = [&](Aabo3* pieces, std::size_t count,
                           std::string_view expected) {
    EXPECT_REFUSED(
        (BoundSegmentPieces(Segment3{}, std::span(pieces, count), &status_)),
        "BoundSegmentPieces", "pieces: expected", expected);
  };
  refused(room.data(), (std::size_t{1} << 24) + 1,
          "at most 2^24 pieces, got 16777217");
  refused(nullptr, 2, "room for 2, got a null pointer");
  refused(Misaligned(room.data()), 2, "aligned to 4 bytes, got a misaligned");
}

// Sums of products of doubles that are next to nothing: random shapes have too
// few of them. Products are from 2^-2148 on, and some cancel.
TEST(OutwardSumTest, EnclosesProductsNextToNothing) {
  Random random(6);
  for (std::size_t i = 0; i < Scaled(100'000); ++i) {
    dispatch::OutwardSum sum;
    mpq_class exact = 0;
    mpq_class weight = 0;
    const auto add_product = [&](double a, double b) {
      sum.AddProduct(a, b);
      const mpq_class product = Exact(a) * Exact(b);
      exact += product;
      weight += abs(product);
    };
    const auto number = [&](int least, int most) {
      const int exponent = RandomExponent(least, most, random);
      return std::ldexp(
          WithMoreBits(RandomSign(random) * RandomMantissa(random), random),
          exponent);
    };
    // From one line on, or around the smallest double and its half.
    const int range = OneIn(2, random) ? 1074 : 530;
    for (int p = 0; p < 2; ++p) {
      const double a = number(-range, p == 0 ? 40 : -500);
      double b = number(-range, p == 0 ? 40 : -500);
      add_product(a, b);
      // Its opposite, or nearly.
      if (OneIn(3, random)) b = std::nextafter(b, 1.0);
      if (OneIn(2, random)) add_product(a, -b);
    }
    const double divisor = 1.0 + static_cast<double>(random() % 9);
    const dispatch::OutwardSum part = sum.DividedBy(divisor);
    const Looseness loose = LooseBy(weight);
    ASSERT_TRUE(IsBelow(sum.Down(), exact, 0, loose.slack)) << i;
    ASSERT_TRUE(IsAbove(sum.Up(), exact, 0, loose.slack)) << i;
    exact /= Exact(divisor);
    ASSERT_TRUE(IsBelow(part.Down(), exact, 0, loose.slack)) << i;
    ASSERT_TRUE(IsAbove(part.Up(), exact, 0, loose.slack)) << i;
  }
}

// If doubles hold everything, nothing is lost.
TEST(OutwardSumTest, IsExactIfDoublesAre) {
  const OrientedBox3 box = {
      {1, 2, 3}, {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}, {1, 2, 3}};
  EXPECT_EQ(BoundOrientedBox(box), (Aabo3{{-1, 1, 0, -12}, {3, 3, 6, 0}}));
  std::array<Aabo3, 3> pieces;
  BoundSegmentPieces(Segment3{{0, 0, 0}, {3, -3, 0}}, pieces);
  EXPECT_EQ(pieces[1], (Aabo3{{1, -2, 0, 0}, {2, -1, 0, 0}}));
}

}  // namespace
}  // namespace halfspace::testing

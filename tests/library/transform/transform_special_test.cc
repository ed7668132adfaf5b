// Special values in bounds of bounds.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/transform.h"
#include "tests/library/support/dims.h"

namespace halfspace::testing {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kMax = std::numeric_limits<float>::max();

template <typename Bound>
class TransformSpecialTest : public ::testing::Test {
 protected:
  using Move = Point<Bound::kDimensions>;

  static Move MoveBy(float by) {
    Move move;
    move.fill(by);
    return move;
  }

  // visit(call) for each call; call(bound, status) is the changed bound.
  template <typename Visit>
  static void ForEachCall(Visit visit) {
    visit([](const Bound& b, FitStatus* s) { return Merge(b, b, s); });
    visit([](const Bound& b, FitStatus* s) { return Inflate(b, 1.f, s); });
    visit([](const Bound& b, FitStatus* s) { return InflateByBox(b, 1.f, s); });
    visit([](const Bound& b, FitStatus* s) {
      return Translate(b, MoveBy(1.f), s);
    });
    visit([](const Bound& b, FitStatus* s) { return Scale(b, 0.5f, s); });
    visit([](const Bound& b, FitStatus* s) { return Scale(b, 0.f, s); });
    visit(
        [](const Bound& b, FitStatus* s) { return Sweep(b, MoveBy(1.f), s); });
    if constexpr (detail::HasMin<Bound> && detail::HasMax<Bound>) {
      visit([](const Bound& b, FitStatus* s) { return Scale(b, -1.f, s); });
      visit([](const Bound& b, FitStatus* s) {
        return TranslateVertices(b, MoveBy(1.f), s);
      });
    }
  }

  // A bound of one point, with `min` or -`min` put into every plane in turn:
  // visit(bound).
  template <typename Visit>
  static void ForEachPlane(float min, Visit visit) {
    for (std::size_t k = 0; k < Bound::kAxes; ++k) {
      Bound bound{};
      if constexpr (detail::HasMin<Bound>) {
        bound.min[k] = min;
        visit(bound);
        bound.min[k] = 0.f;
      }
      if constexpr (detail::HasMax<Bound>) {
        bound.max[k] = -min;
        visit(bound);
      }
    }
  }
};

#if defined(HALFSPACE_TEST_ONLY_3D)
using AllBounds = ::testing::Types<UpSimplex3, DownSimplex3, Aabb3, Aabo3>;
#else
using AllBounds = ::testing::Types<UpSimplex2, UpSimplex3, UpSimplex4,
                                   DownSimplex2, DownSimplex3, DownSimplex4,
                                   Aabb2, Aabb3, Aabb4, Aabo2, Aabo3, Aabo4>;
#endif
TYPED_TEST_SUITE(TransformSpecialTest, AllBounds);

// What engines initialise boxes to: Everything() turned over.
template <typename Bound>
Bound Untouched() {
  Bound bound;
  if constexpr (detail::HasMin<Bound>) bound.min.fill(kMax);
  if constexpr (detail::HasMax<Bound>) bound.max.fill(-kMax);
  return bound;
}

TYPED_TEST(TransformSpecialTest, EmptyStaysEmpty) {
  FitStatus status;
  std::size_t calls = 0;
  for (const auto& empty : {TypeParam::Empty(), Untouched<TypeParam>()}) {
    EXPECT_TRUE(IsEmpty(empty));
    this->ForEachCall([&](auto call) {
      EXPECT_EQ(call(empty, &status), TypeParam::Empty());
      ++calls;
    });
  }
  EXPECT_EQ(status.results, calls);
  EXPECT_EQ(status.everything, 0u);
}

TYPED_TEST(TransformSpecialTest, EmptyIsTheIdentityOfMerge) {
  constexpr auto kEverything = TypeParam::Everything();
  for (const auto& empty : {TypeParam::Empty(), Untouched<TypeParam>()}) {
    this->ForEachPlane(-5.f, [&](const TypeParam& bound) {
      EXPECT_EQ(Merge(bound, empty), bound);
      EXPECT_EQ(Merge(empty, bound), bound);
    });
    EXPECT_EQ(Merge(empty, kEverything), kEverything);
    EXPECT_EQ(Merge(kEverything, empty), kEverything);
    EXPECT_EQ(Merge(empty, TypeParam::Empty()), TypeParam::Empty());
    EXPECT_EQ(Merge(empty, empty), TypeParam::Empty());
  }
}

TYPED_TEST(TransformSpecialTest, IntersectionOfSpecialValues) {
  constexpr auto kEmpty = TypeParam::Empty();
  for (const auto& empty : {kEmpty, Untouched<TypeParam>()}) {
    EXPECT_EQ(Intersection(empty, TypeParam{}), kEmpty);
    EXPECT_EQ(Intersection(TypeParam{}, empty), kEmpty);
    EXPECT_EQ(Intersection(empty, TypeParam::Everything()), kEmpty);
    EXPECT_EQ(Intersection(empty, empty), kEmpty);
  }
  this->ForEachPlane(-5.f, [&](const TypeParam& bound) {
    EXPECT_EQ(Intersection(bound, TypeParam::Everything()), bound);
    EXPECT_EQ(Intersection(TypeParam::Everything(), bound), bound);
  });
  // A NaN is no limit, on either side.
  this->ForEachPlane(kNan, [&](const TypeParam& bound) {
    EXPECT_EQ(Intersection(bound, TypeParam{}), TypeParam{});
    EXPECT_EQ(Intersection(TypeParam{}, bound), TypeParam{});
  });
}

// Some planes do not make it empty.
TYPED_TEST(TransformSpecialTest, EmptyOnAllPlanesOrNotAtAll) {
  this->ForEachPlane(kMax, [&](TypeParam bound) {
    EXPECT_FALSE(IsEmpty(bound));
    bound = Untouched<TypeParam>();
    if constexpr (detail::HasMin<TypeParam>) bound.min[0] = kInfinity;
    EXPECT_TRUE(IsEmpty(bound));
    if constexpr (detail::HasMin<TypeParam>) {
      bound.min[1] = kNan;
    } else {
      bound.max[1] = kNan;
    }
    EXPECT_FALSE(IsEmpty(bound));
  });
}

TYPED_TEST(TransformSpecialTest, EverythingStaysEverything) {
  FitStatus status;
  this->ForEachCall([&](auto call) {
    EXPECT_EQ(call(TypeParam::Everything(), &status), TypeParam::Everything());
  });
  EXPECT_EQ(status.everything, status.results);
  EXPECT_EQ(Merge(TypeParam{}, TypeParam::Everything()),
            TypeParam::Everything());
}

// Only the plane in question: the others are changed as ever.
TYPED_TEST(TransformSpecialTest, PlaneWithoutABoundKeepsToItself) {
  this->ForEachPlane(-kMax, [&](const TypeParam& bound) {
    FitStatus status;
    this->ForEachCall([&](auto call) {
      EXPECT_NE(call(bound, &status), TypeParam::Everything());
    });
    EXPECT_EQ(status.everything, 0u);
    EXPECT_EQ(Scale(bound, 0.5f), bound);
    EXPECT_EQ(Merge(bound, TypeParam{}), bound);
    EXPECT_EQ(Merge(TypeParam{}, bound), bound);
  });
}

// As the value of one plane: a NaN, an infinity on either side, what is too
// large, and the unbounded on the wrong side.
TYPED_TEST(TransformSpecialTest, OtherValuesGiveEverything) {
  const float too_large = std::nextafter(0x1p126f, kInfinity);
  for (float bad : {kNan, -kNan, kInfinity, -kInfinity, kMax, too_large,
                    -too_large, std::nextafter(-kMax, 0.f)}) {
    this->ForEachPlane(bad, [&](const TypeParam& bound) {
      FitStatus status;
      this->ForEachCall([&](auto call) {
        EXPECT_EQ(call(bound, &status), TypeParam::Everything()) << bad;
      });
      EXPECT_EQ(status.everything, status.results);
      EXPECT_EQ(Merge(bound, TypeParam{}), TypeParam::Everything()) << bad;
      EXPECT_EQ(Merge(TypeParam{}, bound), TypeParam::Everything()) << bad;
      EXPECT_EQ(Merge(TypeParam::Empty(), bound), TypeParam::Everything());
    });
  }
}

TYPED_TEST(TransformSpecialTest, LargestValuesAreBounded) {
  this->ForEachPlane(-0x1p126f, [&](const TypeParam& bound) {
    EXPECT_EQ(Merge(bound, TypeParam{}), bound);
    EXPECT_EQ(Scale(bound, 1.f), bound);
    EXPECT_EQ(Inflate(bound, 0.f), bound);
    EXPECT_EQ(InflateByBox(bound, 0.f), bound);
    EXPECT_EQ(Translate(bound, this->MoveBy(0.f)), bound);
    EXPECT_EQ(Sweep(bound, this->MoveBy(0.f)), bound);
    // And one float farther they are not.
    EXPECT_EQ(Scale(bound, 0x1.000002p0f), TypeParam::Everything());
    EXPECT_EQ(Inflate(bound, 0x1p103f), TypeParam::Everything());
    EXPECT_EQ(InflateByBox(bound, 0x1p103f), TypeParam::Everything());
  });
}

TYPED_TEST(TransformSpecialTest, MovesAndSizesThatAreNotFinite) {
  constexpr auto kEverything = TypeParam::Everything();
  const TypeParam bound{};
  FitStatus status;
  for (float bad : {kNan, kInfinity, -kInfinity, kMax, -kMax}) {
    for (std::size_t k = 0; k < TypeParam::kDimensions; ++k) {
      auto move = this->MoveBy(0.f);
      move[k] = bad;
      EXPECT_EQ(Translate(bound, move, &status), kEverything) << bad;
      EXPECT_EQ(Sweep(bound, move, &status), kEverything) << bad;
      if constexpr (detail::HasMin<TypeParam> && detail::HasMax<TypeParam>) {
        EXPECT_EQ(TranslateVertices(bound, move, &status), kEverything);
      }
      EXPECT_EQ(Translate(TypeParam::Empty(), move), TypeParam::Empty());
    }
  }
  EXPECT_EQ(Inflate(bound, kInfinity, &status), kEverything);
  EXPECT_EQ(InflateByBox(bound, kInfinity, &status), kEverything);
  EXPECT_EQ(Scale(bound, kInfinity, &status), kEverything);
  EXPECT_EQ(status.everything, status.results);
  // Of nothing there is nothing to change.
  constexpr auto kEmpty = TypeParam::Empty();
  EXPECT_EQ(Inflate(kEmpty, kInfinity), kEmpty);
  EXPECT_EQ(InflateByBox(kEmpty, kInfinity), kEmpty);
  EXPECT_EQ(Scale(kEmpty, kInfinity), kEmpty);
}

template <typename Dims>
class CircumscribeSpecialTest : public ::testing::Test {};
TYPED_TEST_SUITE(CircumscribeSpecialTest, AllDims, DimsNames);

TYPED_TEST(CircumscribeSpecialTest, SpecialValues) {
  using Up = UpSimplex<TypeParam::value>;
  using Down = DownSimplex<TypeParam::value>;
  FitStatus status;
  EXPECT_EQ(Circumscribe(Up::Empty(), &status), Down::Empty());
  EXPECT_EQ(Circumscribe(Down::Empty(), &status), Up::Empty());
  EXPECT_EQ(Circumscribe(Untouched<Up>(), &status), Down::Empty());
  EXPECT_EQ(Circumscribe(Untouched<Down>(), &status), Up::Empty());
  EXPECT_EQ(status.everything, 0u);
  EXPECT_EQ(Circumscribe(Up::Everything(), &status), Down::Everything());
  EXPECT_EQ(Circumscribe(Down::Everything(), &status), Up::Everything());
  for (float bad : {kNan, kInfinity, -kInfinity, kMax, -0x1.8p126f}) {
    for (std::size_t k = 0; k < Up::kAxes; ++k) {
      Up up{};
      up.min[k] = bad;
      EXPECT_EQ(Circumscribe(up, &status), Down::Everything()) << bad;
      Down down{};
      down.max[k] = -bad;
      EXPECT_EQ(Circumscribe(down, &status), Up::Everything()) << bad;
    }
  }
  EXPECT_EQ(status.results, status.everything + 4);
  EXPECT_EQ(status.first_everything, 4u);
}

}  // namespace
}  // namespace halfspace::testing

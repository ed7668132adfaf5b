// Queries by shapes: what the tests of one bound after another keep, on every
// target and of every kind of world; and never less than what touches.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/shape_reference.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/misaligned.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <typename View>
typename View::Query QueryOf(const Aabo<View::Bound::kDimensions>& bound) {
  if constexpr (!HasMaxima<View>) {
    return bound.down();
  } else if constexpr (View::Bound::kAxes == View::Bound::kDimensions) {
    return bound.aabb();
  } else {
    return bound;
  }
}
// What else is tested of a shape: nothing, but of what is taken for its bound.
template <typename View, typename Shape>
typename View::Query BoundOf(const Shape& shape) {
  constexpr int kDims = View::Bound::kDimensions;
  if constexpr (!std::is_same_v<Shape, std::vector<HalfSpace<kDims>>>) {
    if (IsBound<View>(shape)) {
      if constexpr (std::is_same_v<Shape, Point<kDims>>) {
        return QueryOf<View>(BoundSphere(Sphere<kDims>{shape, 0}));
      }
      if constexpr (std::is_same_v<Shape, Sphere<kDims>>) {
        return QueryOf<View>(BoundSphere(shape));
      }
      return View::Query::Everything();
    }
  }
  typename View::Query query{};
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    OpposingValue<View>(query, p) = IsMinPlane<View>(p) ? kInf : -kInf;
  }
  return query;
}

// A few shapes of each kind.
template <int kDims>
using Shapes =
    std::tuple<std::vector<Point<kDims>>, std::vector<Sphere<kDims>>,
               std::vector<Segment<kDims>>, std::vector<Capsule<kDims>>,
               std::vector<std::vector<HalfSpace<kDims>>>>;

// Calls visit(shape) for each.
template <int kDims, typename Visit>
void ForEachShape(const Shapes<kDims>& shapes, const Visit& visit) {
  std::apply(
      [&](const auto&... kinds) {
        const auto visit_kind = [&](const auto& kind) {
          for (const auto& shape : kind) visit(shape);
        };
        (visit_kind(kinds), ...);
      },
      shapes);
}

template <int kDims>
Shapes<kDims> SomeShapes(std::size_t count, Random& random) {
  std::uniform_real_distribution<float> coordinate(-60.0f, 60.0f);
  const auto point = [&] {
    Point<kDims> p;
    for (float& x : p) x = coordinate(random);
    return p;
  };
  Shapes<kDims> shapes;
  auto& [points, spheres, segments, capsules, fronts] = shapes;
  for (std::size_t i = 0; i < count; ++i) {
    const float radius = std::ldexp(1.0f, static_cast<int>(i % 9) - 2);
    points.push_back(point());
    spheres.push_back({point(), i == 0 ? 0.0f : radius});
    segments.push_back({point(), point()});
    if (i % 4 == 1) segments.back().b[0] = segments.back().a[0];
    if (i % 4 == 2) segments.back().b = segments.back().a;
    capsules.push_back({point(), point(), radius / 4});
    fronts.emplace_back();
    for (std::size_t f = 0; f < i % 7; ++f) {
      HalfSpace<kDims> half_space{point(), 0};
      if (f % 3 == 1) half_space.normal[1] = 0;
      // In front of a place near the middle.
      for (float n : half_space.normal) {
        half_space.offset += std::abs(n) * (f % 2 == 0 ? 20.0f : 55.0f);
      }
      fronts.back().push_back(half_space);
    }
  }
  return shapes;
}

// Some of them Empty(), Everything(), or with a NaN.
template <typename View>
World<View> WithSpecialObjects(std::size_t count) {
  using Bound = typename View::Bound;
  World<View> world;
  Spread<View> spread(1.0f);
  for (std::size_t i = 0; i < count; ++i) {
    Bound bound = i % 97 == 0   ? Bound::Empty()
                  : i % 97 == 1 ? Bound::Everything()
                                : spread.NextObject();
    if (i % 97 == 2) StoredValue<View>(bound, i % kPlanes<View>) = kNan;
    world.Push(bound);
  }
  return world;
}

template <typename View, typename Shape>
void ExpectFinds(const Bvh<View>& bvh, const Shape& shape, const Ids& expected,
                 const QueryOptions& options) {
  Ids ids(bvh.size());
  ASSERT_EQ(Survivors(bvh, shape, ids, options), expected.size());
  ids.resize(expected.size());
  ASSERT_EQ(InOrder(ids), expected);
  ASSERT_EQ(CountSurvivors(bvh, shape, options), expected.size());
  const auto any = AnySurvivor(bvh, shape, options);
  ASSERT_EQ(any.has_value(), !expected.empty());
  if (any) {
    ASSERT_TRUE(std::binary_search(expected.begin(), expected.end(), *any));
  }
  Ids visited;
  ForEachSurvivor(
      bvh, shape,
      [&](Span<const std::uint32_t> some) {
        visited.insert(visited.end(), some.begin(), some.end());
      },
      options);
  ASSERT_EQ(InOrder(visited), expected);
  // Twice in one call, the second time without room for all.
  const std::vector<Shape> two(2, shape);
  ids.resize(expected.size() * 3 / 2);
  std::vector<std::size_t> offsets(3);
  ASSERT_EQ(SurvivorsOfEach(bvh, two, ids, offsets, options),
            2 * expected.size());
  ASSERT_EQ(offsets, (std::vector<std::size_t>{0, expected.size(),
                                               2 * expected.size()}));
  ids.resize(expected.size());
  ASSERT_EQ(InOrder(ids), expected);
}

// Flat scans find the same.
template <typename View>
void ExpectScansFind(
    const World<View>& world,
    const std::vector<HalfSpace<View::Bound::kDimensions>>& half_spaces,
    const Ids& expected, Target target) {
  const Options options = {.target = target};
  Ids ids(world.size());
  ASSERT_EQ(Survivors(world, half_spaces, ids, options), expected.size());
  ids.resize(expected.size());
  ASSERT_EQ(ids, expected);
  ids.clear();
  ForEachSurvivor(
      world, half_spaces,
      [&](Span<const std::uint32_t> some) {
        ids.insert(ids.end(), some.begin(), some.end());
      },
      options);
  ASSERT_EQ(ids, expected);
  ASSERT_EQ(CountSurvivors(world.view(), half_spaces, options),
            expected.size());
  const auto any = AnySurvivor(world, half_spaces, options);
  ASSERT_EQ(any.has_value(), !expected.empty());
  if (any) {
    ASSERT_EQ(*any, expected.front());
  }
  // Any range, with bits past its end.
  const std::size_t begin = world.size() / 3;
  std::vector<std::uint64_t> mask(MaskWords(world.size() - begin), 0x5555);
  SurvivorMask(world, half_spaces, mask,
               {.target = target, .range = {.begin = begin}});
  std::vector<std::uint64_t> expected_mask(mask.size());
  for (std::uint32_t i : expected) {
    if (i < begin) continue;
    expected_mask[(i - begin) / 64] |= std::uint64_t{1} << (i - begin) % 64;
  }
  ASSERT_EQ(mask, expected_mask);
  RejectMask(world, half_spaces, mask,
             {.target = target, .range = {.begin = begin}});
  for (std::uint64_t& word : expected_mask) word = ~word;
  ASSERT_EQ(mask, expected_mask);
}
template <typename View, typename Shape>
void ExpectScansFind(const World<View>&, const Shape&, const Ids&, Target) {}

template <typename View>
Ids Expected(const World<View>& world, std::span<const std::uint32_t> ids,
             const auto& shape) {
  Ids found(world.size());
  found.resize(Survivors(world, BoundOf<View>(shape), found));
  Ids expected;
  for (std::uint32_t i : found) {
    if (IsTouched<View>(world.Get(i), shape)) {
      expected.push_back(ids.empty() ? i : ids[i]);
    }
  }
  return InOrder(expected);
}

template <typename View>
void ExpectSameEverywhere(const World<View>& world,
                          const Shapes<View::Bound::kDimensions>& shapes) {
  const Bvh<View> tight(world.view());
  const Bvh<View> fast(world.view(), {.quality = BuildQuality::kFast});
  ForEachShape(shapes, [&](const auto& shape) {
    const Ids expected = Expected<View>(world, {}, shape);
    for (Target target : TargetsUnderTest()) {
      ExpectScansFind(world, shape, expected, target);
      for (const auto* bvh : {&tight, &fast}) {
        ExpectFinds(*bvh, shape, expected, {.target = target});
        if (::testing::Test::HasFatalFailure()) {
          FAIL() << world.size() << " objects, " << target.name();
        }
      }
    }
  });
}

template <typename Case>
class BvhShapesTest : public ::testing::Test {};
TYPED_TEST_SUITE(BvhShapesTest, BvhCases, CaseNames);

TYPED_TEST(BvhShapesTest, FindWhatTheTestsOfEachBoundKeep) {
  using View = typename TypeParam::View;
  constexpr int kDims = View::Bound::kDimensions;
  Random random(1);
  std::vector<std::size_t> sizes = {0, 1, 63, 64, 65, 4097};
  if (Scaled(10) > 1) sizes.push_back(20'000);
  for (std::size_t i = 0; i < Scaled(3); ++i) sizes.push_back(random() % 9000);
  for (std::size_t size : sizes) {
    ExpectSameEverywhere<View>(
        Spread<View>(1.0f, size).Objects(size),
        SomeShapes<kDims>(2 + Scaled(size > 10'000 ? 18 : 10), random));
    if (this->HasFatalFailure()) return;
  }
}

// Of objects, of shapes, and of both.
TYPED_TEST(BvhShapesTest, FindWhatTheTestsKeepOfSpecialValues) {
  using View = typename TypeParam::View;
  constexpr int kDims = View::Bound::kDimensions;
  Random random(2);
  for (std::size_t round = 0; round < Scaled(40); ++round) {
    World<View> world;
    Spread<View> spread(20.0f, round);
    const auto any = [&](float value) {
      return random() % 8 == 0 ? SpecialValue<float>(random) : value;
    };
    for (std::size_t i = 0; i < 300; ++i) {
      auto bound = round % 4 == 0 && i % 3 == 0 ? View::Bound::Empty()
                                                : spread.NextObject();
      for (std::size_t p = 0; p < kPlanes<View> && i % 2 == 0; ++p) {
        StoredValue<View>(bound, p) = any(StoredValue<View>(bound, p));
      }
      world.Push(bound);
    }
    Shapes<kDims> shapes = SomeShapes<kDims>(6, random);
    auto& [points, spheres, segments, capsules, fronts] = shapes;
    for (auto& point : points) {
      for (float& x : point) x = any(x);
    }
    for (auto& sphere : spheres) {
      for (float& x : sphere.center) x = any(x);
      sphere.radius = any(sphere.radius);
      if (!(sphere.radius >= 0)) sphere.radius = kInf;
    }
    for (auto& segment : segments) {
      for (float& x : segment.a) x = any(x);
      for (float& x : segment.b) x = any(x);
    }
    for (auto& capsule : capsules) {
      for (float& x : capsule.a) x = any(x);
      for (float& x : capsule.b) x = any(x);
      capsule.radius = any(capsule.radius);
      if (!(capsule.radius >= 0)) capsule.radius = 0x1p127f;
    }
    for (auto& half_spaces : fronts) {
      for (auto& half_space : half_spaces) {
        for (float& x : half_space.normal) x = any(x);
        half_space.offset = any(half_space.offset);
      }
    }
    ExpectSameEverywhere<View>(world, shapes);
    if (this->HasFatalFailure()) FAIL() << "round " << round;
  }
}

// A shape that a builder cannot bound keeps what a scan with Everything()
// keeps, whichever of its numbers is the bad one; and so do huge ones that it
// can.
TYPED_TEST(BvhShapesTest, AreEverythingIfTheyCannotBeBounded) {
  using View = typename TypeParam::View;
  constexpr int kDims = View::Bound::kDimensions;
  constexpr float kMost = std::numeric_limits<float>::max();
  constexpr float kTooLarge = 0x1.000002p125f;
  const World<View> world = WithSpecialObjects<View>(4200);
  const Bvh<View> bvh(world.view());
  Ids all(world.size());
  all.resize(Survivors(world, View::Query::Everything(), all));
  ASSERT_LT(all.size(), world.size());
  const auto expect_all = [&](const auto& shape) {
    for (Target target : TargetsUnderTest()) {
      ExpectFinds(bvh, shape, all, {.target = target});
      if (::testing::Test::HasFatalFailure()) FAIL() << target.name();
    }
  };
  const auto expect_all_with_bad_numbers = [&](auto shape, std::size_t values,
                                               bool has_radius) {
    for (float bad :
         {kNan, kInf, -kInf, kMost, -kMost, kTooLarge, -kTooLarge}) {
      for (std::size_t v = 0; v < values; ++v) {
        if (has_radius && v + 1 == values && !(bad > 0)) continue;
        auto bad_shape = shape;
        reinterpret_cast<float*>(&bad_shape)[v] = bad;
        expect_all(bad_shape);
        if (::testing::Test::HasFatalFailure()) {
          FAIL() << values << " numbers, " << bad << " for number " << v;
        }
      }
    }
  };
  expect_all_with_bad_numbers(Sphere<kDims>{{}, 1}, kDims + 1, true);
  expect_all_with_bad_numbers(Segment<kDims>{}, 2 * kDims, false);
  expect_all_with_bad_numbers(Capsule<kDims>{{}, {}, 1}, 2 * kDims + 1, true);
  expect_all(Sphere<kDims>{{}, 0x1p120f});
  expect_all(Capsule<kDims>{{}, {}, 0x1p120f});
}

// Alone it keeps every object, also those that are Empty().
TYPED_TEST(BvhShapesTest, KeepWhatTheOtherHalfSpacesKeepIfOneIsUnusable) {
  using View = typename TypeParam::View;
  constexpr int kDims = View::Bound::kDimensions;
  using HalfSpaces = std::vector<HalfSpace<kDims>>;
  const World<View> world = WithSpecialObjects<View>(4200);
  const Bvh<View> bvh(world.view());
  Ids all(world.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  HalfSpace<kDims> good{{}, 10};
  good.normal[0] = 1;
  good.normal[1] = -0.5f;
  const Ids expected = Expected<View>(world, {}, HalfSpaces{good});
  ASSERT_LT(expected.size(), all.size());
  // The same half-space.
  HalfSpaces huge = {good};
  for (float& x : huge[0].normal) x *= 0x1p124f;
  huge[0].offset *= 0x1p124f;
  for (Target target : TargetsUnderTest()) {
    const QueryOptions options = {.target = target};
    ExpectFinds(bvh, HalfSpaces{}, all, options);
    ExpectScansFind(world, HalfSpaces{}, all, target);
    ExpectFinds(bvh, huge, expected, options);
    for (float value : {kNan, kInf, -kInf}) {
      for (std::size_t v = 0; v <= kDims; ++v) {
        HalfSpace<kDims> bad = good;
        reinterpret_cast<float*>(&bad)[v] = value;
        ExpectFinds(bvh, HalfSpaces{bad}, all, options);
        ExpectFinds(bvh, HalfSpaces{good, bad}, expected, options);
        if (this->HasFatalFailure()) {
          FAIL() << value << " for number " << v << ", " << target.name();
        }
      }
    }
  }
}

TYPED_TEST(BvhShapesTest, KnowErasedObjectsAndMasks) {
  using View = typename TypeParam::View;
  constexpr int kDims = View::Bound::kDimensions;
  Random random(3);
  Spread<View> spread(1.0f, 5);
  Bvh<View> bvh(spread.Objects(5000));
  Ids masks(5000);
  World<View> world;
  Ids ids;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    masks[i] = 1u << i % 3;
    const auto bound = spread.NextObject();
    if (i % 7 == 0) {
      bvh.Erase(i);
      continue;
    }
    bvh.Set(i, bound);
    if (i % 3 == 1) continue;
    world.Push(bound);
    ids.push_back(i);
  }
  bvh.SetMasks(masks);
  ForEachShape(SomeShapes<kDims>(9, random), [&](const auto& shape) {
    const Ids expected = Expected<View>(world, ids, shape);
    for (Target target : TargetsUnderTest()) {
      ExpectFinds(bvh, shape, expected, {.mask = 1 | 4, .target = target});
    }
  });
}

// Shapes of integers, times a power of two, and objects that touch them in a
// point of integers: in all rounding modes, and with subnormals flushed.
TYPED_TEST(BvhShapesTest, NeverRejectWhatTouches) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  constexpr int kDims = Bound::kDimensions;
  Random random(4);
  for (std::size_t round = 0; round < Scaled(400); ++round) {
    // Up to what a builder can bound, and beyond.
    const int exponent = static_cast<int>(random() % 256) - 150;
    const auto integer = [&](std::uint64_t most) {
      return 16 * (static_cast<double>(random() % (2 * most + 1)) -
                   static_cast<double>(most));
    };
    const auto scaled = [&](double x) {
      return static_cast<float>(std::ldexp(x, exponent));
    };
    std::array<double, kDims> a;
    std::array<double, kDims> b;
    for (double& x : a) x = integer(round % 2 == 0 ? 1000 : 100'000);
    for (std::size_t k = 0; k < kDims; ++k) {
      b[k] = random() % 4 == 0 ? a[k] : integer(100'000);
    }
    // A corner of the sphere with radius 13 or 5.
    const double size = static_cast<double>(random() % 5'000);
    const double radius = size * (kDims == 3 ? 13 : 5);
    constexpr std::array<double, 3> kCorner = {3, 4, 12};
    Capsule<kDims> capsule;
    Sphere<kDims> sphere;
    sphere.radius = capsule.radius = scaled(radius);
    World<View> on_box;
    World<View> on_segment;
    World<View> on_capsule;
    World<View> on_sphere;
    // A point, which the bound may exceed in directions that do not matter.
    const auto bound_of = [&](const std::array<double, kDims>& p) {
      Bound bound{};
      double sum = 0;
      for (double x : p) sum -= x;
      const std::uint64_t more = random() % 4 == 0 ? 0 : random();
      for (std::size_t v = 0; v < kPlanes<View>; ++v) {
        const std::size_t k = v % Bound::kAxes;
        double value = k < kDims ? p[k] : sum;
        if ((more >> v & 1) != 0) {
          value += IsMinPlane<View>(v) ? -size - 50 : size + 50;
        }
        const float rounded = scaled(value);
        // Of sums that have too many bits.
        StoredValue<View>(bound, v) =
            std::ldexp(double{rounded}, -exponent) == value ? rounded
            : IsMinPlane<View>(v) ? std::nextafter(rounded, -kInf)
                                  : std::nextafter(rounded, kInf);
      }
      return bound;
    };
    for (std::size_t k = 0; k < kDims; ++k) {
      capsule.a[k] = sphere.center[k] = scaled(a[k]);
      capsule.b[k] = scaled(b[k]);
    }
    // Subnormals have no room for all integers.
    bool is_exact = true;
    for (std::size_t k = 0; k < kDims; ++k) {
      is_exact &= std::ldexp(double{capsule.a[k]}, -exponent) == a[k] &&
                  std::ldexp(double{capsule.b[k]}, -exponent) == b[k];
    }
    is_exact &= std::ldexp(double{capsule.radius}, -exponent) == radius;
    if (!is_exact) continue;
    std::vector<std::vector<HalfSpace<kDims>>> fronts;
    World<View> on_fronts;
    OrientedBox<kDims> box;
    std::array<std::array<double, kDims>, kDims> box_axes;
    box.center = sphere.center;
    for (std::size_t axis = 0; axis < kDims; ++axis) {
      for (std::size_t k = 0; k < kDims; ++k) {
        box_axes[axis][k] = round % 5 == 0 && k != axis ? 0 : integer(100);
        box.axes[axis][k] = static_cast<float>(box_axes[axis][k]);
      }
      box.half_extents[axis] = scaled(2);
    }
    for (std::size_t i = 0; i < 150; ++i) {
      const double t = static_cast<double>(random() % 17) / 16;
      std::array<double, kDims> p;
      std::array<double, kDims> beside;
      std::array<double, kDims> corner;
      // A corner of a box with axes at any angles.
      std::array<double, kDims> in_box = a;
      for (std::size_t axis = 0; axis < kDims; ++axis) {
        const double side = random() % 2 == 0 ? 2 : -2;
        for (std::size_t k = 0; k < kDims; ++k) {
          in_box[k] += side * box_axes[axis][k];
        }
      }
      for (std::size_t k = 0; k < kDims; ++k) {
        const double away =
            (random() % 2 == 0 ? size : -size) * kCorner[(k + i) % kDims];
        p[k] = a[k] + t * (b[k] - a[k]);
        beside[k] = p[k] + away;
        corner[k] = a[k] + away;
      }
      on_box.Push(bound_of(in_box));
      on_segment.Push(bound_of(p));
      on_capsule.Push(bound_of(beside));
      on_sphere.Push(bound_of(corner));
    }
    // In front of planes through a point.
    std::vector<HalfSpace<kDims>> half_spaces(random() % 7);
    for (auto& half_space : half_spaces) {
      double offset = 0;
      for (std::size_t k = 0; k < kDims; ++k) {
        half_space.normal[k] = static_cast<float>(random() % 9) - 4;
        offset -= half_space.normal[k] * a[k];
      }
      half_space.offset = scaled(offset);
    }
    for (std::size_t i = 0; i < 150; ++i) on_fronts.Push(bound_of(a));
    const Segment<kDims> segment = {capsule.a, capsule.b};
    const auto expect_all = [&](const World<View>& world, const auto& shape) {
      const Bvh<View> bvh(world.view());
      for (Target target : TargetsUnderTest()) {
        for (int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
          std::size_t kept;
          {
            const RoundingMode rounding(mode);
            kept = CountSurvivors(bvh, shape, {.target = target});
          }
          ASSERT_EQ(kept, world.size())
              << "round " << round << ", times 2^" << exponent << ", "
              << target.name() << ", mode " << mode;
        }
        std::size_t kept;
        {
          const FlushDenormals flush;
          kept = CountSurvivors(bvh, shape, {.target = target});
        }
        ASSERT_EQ(kept, world.size()) << "flushed, times 2^" << exponent;
      }
    };
    expect_all(on_box, box);
    expect_all(on_segment, segment);
    expect_all(on_segment, capsule);
    expect_all(on_capsule, capsule);
    expect_all(on_sphere, sphere);
    expect_all(on_fronts, half_spaces);
    if (this->HasFatalFailure()) return;
  }
}

// What is far from a diagonal segment is rejected, though its bound is not; and
// what is in a corner of a sphere's.
TEST(BvhShapesKnownTest, RejectWhatTheirBoundsKeep) {
  AabbWorld3 world;
  world.Push({{0, 0, 0}, {1, 1, 1}});
  world.Push({{9, 0, 0}, {10, 1, 1}});
  world.Push({{9, 9, 9}, {10, 10, 10}});
  world.Push({{5.6f, 5.1f, 5.1f}, {6, 6, 5.5f}});
  const AabbBvh3 bvh(world);
  const auto found = [&](const auto& shape) {
    Ids ids(4);
    ids.resize(Survivors(bvh, shape, ids));
    return InOrder(ids);
  };
  EXPECT_EQ(found(Segment3{{0, 0, 0}, {10, 10, 10}}), (Ids{0, 2}));
  EXPECT_EQ(found(Capsule3{{0, 0, 0}, {10, 10, 10}, 0.5f}), (Ids{0, 2, 3}));
  EXPECT_EQ(found(Sphere3{{10, 10, 10}, 4.0f}), (Ids{2}));
  EXPECT_EQ(found(Sphere3{{10, 10, 10}, 9.0f}), (Ids{2, 3}));
  const HalfSpace3 half_spaces[] = {{{1, 0, 0}, -6}, {{0, -1, 0}, 6}};
  EXPECT_EQ(found(half_spaces), (Ids{1, 3}));
  EXPECT_EQ(found(std::vector<HalfSpace3>()), (Ids{0, 1, 2, 3}));
  EXPECT_EQ(found(Point3{10, 1, 0.5f}), Ids{1});
  EXPECT_EQ(found(Point3{10, 1.0001f, 0.5f}), Ids{});
  // Turned by 45 degrees about z; its corner (9.9, 5) is beside object 3.
  const float h = 3.5f;
  OrientedBox3 box = {{4.9f, 5, 5}, {{{1, 1, 0}, {-1, 1, 0}, {0, 0, 1}}}, {}};
  box.half_extents = {h, h, 1};
  EXPECT_EQ(found(box), Ids{3});
  box.center = {0, 10, 5};
  EXPECT_EQ(found(box), Ids{});  // though object 3 is in its bound
  box.half_extents = {h, h, kNan};
  EXPECT_EQ(found(box), (Ids{0, 1, 2, 3}));
  // While the radius has a square.
  const Point3 corner = {0x1.4p63f, 0x1.4p63f, 0x1.4p63f};
  const std::vector<Aabb3> bounds = {{corner, corner}, {{}, corner}};
  const AabbBvh3 large((std::span<const Aabb3>(bounds)));
  EXPECT_EQ(CountSurvivors(large, Sphere3{{}, 0x1.8p63f}), 1u);
  EXPECT_EQ(CountSurvivors(large, Sphere3{{}, 0x1.2p64f}), 2u);
}

TEST(BvhShapesErrorsTest, RefuseWhatIsNoShape) {
  const AabbBvh3 bvh(Spread<AabbView3>(4.0f).Objects(100));
  Ids ids(100);
  for (float radius : {-1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_TRUE(Refuses(
        [&] {
          (void)Survivors(bvh, Sphere3{{0, 0, 0}, radius}, ids);
        },
        {"Survivors", "radius"}));
    EXPECT_TRUE(Refuses(
        [&] {
          (void)CountSurvivors(bvh, Capsule3{{0, 0, 0}, {1, 1, 1}, radius});
        },
        {"CountSurvivors", "radius"}));
  }
  const std::vector<HalfSpace3> many(65);
  EXPECT_TRUE(Refuses([&] { (void)AnySurvivor(bvh, many); },
                      {"AnySurvivor", "half-spaces", "64", "65"}));
  EXPECT_TRUE(Refuses(
      [&] { (void)AnySurvivor(bvh, Span<const HalfSpace3>(nullptr, 1)); },
      {"AnySurvivor", "half-spaces", "null"}));
}

TEST(RejectShapesErrorsTest, RefuseWhatIsWrong) {
  const AabbWorld3 world = Spread<AabbView3>(4.0f).Objects(100);
  using HalfSpaces = Span<const HalfSpace3>;
  const std::vector<HalfSpace3> many(65);
  Canaried<std::uint32_t> canaried_ids;
  Canaried<std::uint64_t> canaried_mask;
  const Span<std::uint32_t> ids = canaried_ids.Reset(100);
  const Span<std::uint64_t> mask = canaried_mask.Reset(2);
  for (const auto& wrong :
       {std::pair{HalfSpaces(many), "65"},
        std::pair{HalfSpaces(nullptr, 1), "null"},
        std::pair{HalfSpaces(Misaligned(many.data()), 1), "misaligned"}}) {
    const HalfSpaces bad = wrong.first;
    const char* const given = wrong.second;
    EXPECT_TRUE(Refuses([&] { (void)Survivors(world, bad, ids); },
                        {"Survivors", "half-spaces", given}));
    EXPECT_TRUE(Refuses([&] { (void)CountSurvivors(world, bad); },
                        {"CountSurvivors", "half-spaces", given}));
    EXPECT_TRUE(Refuses([&] { (void)AnySurvivor(world, bad); },
                        {"AnySurvivor", "half-spaces", given}));
    EXPECT_TRUE(Refuses([&] { SurvivorMask(world, bad, mask); },
                        {"SurvivorMask", "half-spaces", given}));
  }
  // What all calls of reject.h refuse.
  const HalfSpaces one(many.data(), 1);
  EXPECT_TRUE(Refuses(
      [&] {
        SurvivorMask(world, one, {mask.data(), 1});
      },
      {"SurvivorMask", "mask", "at least 2 words", "got 1"}));
  EXPECT_TRUE(Refuses(
      [&] {
        (void)Survivors(world, one, ids, {.range = {2, 1}});
      },
      {"Survivors", "options.range.end"}));
  AabbView3 no_planes = world.view();
  no_planes.max[1] = nullptr;
  EXPECT_TRUE(Refuses([&] { (void)CountSurvivors(no_planes, one); },
                      {"CountSurvivors", "world.max[1]", "null"}));
  EXPECT_TRUE(canaried_ids.IntactBut(0));
  EXPECT_TRUE(canaried_mask.IntactBut(0));
}

// Whatever is wrong, and also where the shapes before it are right.
TEST(BvhShapesErrorsTest, NothingIsWrittenBeforeAllIsChecked) {
  const AabbBvh3 bvh(Spread<AabbView3>(4.0f).Objects(100));
  Canaried<std::uint32_t> canaried_ids;
  Canaried<std::size_t> canaried_offsets;
  const Span<std::uint32_t> ids = canaried_ids.Reset(100);
  const Span<std::size_t> offsets = canaried_offsets.Reset(4);
  const auto refused = [&](const auto& queries, Span<std::uint32_t> to_ids,
                           Span<std::size_t> to_offsets,
                           std::string_view argument, std::string_view given,
                           const QueryOptions& options = {}) {
    EXPECT_TRUE(Refuses(
        [&] {
          (void)SurvivorsOfEach(bvh, queries, to_ids, to_offsets, options);
        },
        {"SurvivorsOfEach: ", argument, "expected", "got", given}));
    EXPECT_TRUE(canaried_ids.IntactBut(0)) << argument << ", " << given;
    EXPECT_TRUE(canaried_offsets.IntactBut(0)) << argument << ", " << given;
  };
  const auto queries_refused = [&](const auto& queries,
                                   std::string_view argument,
                                   std::string_view given) {
    refused(queries, ids, offsets, argument, given);
  };
  const Sphere3 sphere = {{0, 0, 0}, 100};
  const Capsule3 capsule = {{0, 0, 0}, {1, 1, 1}, 100};
  for (float radius : {-1.0f, kNan}) {
    const char* const given = radius < 0 ? "-1" : "nan";
    queries_refused(std::array{sphere, Sphere3{{}, radius}}, "radius", given);
    queries_refused(std::array{capsule, capsule, Capsule3{{}, {}, radius}},
                    "radius", given);
  }
  using HalfSpaces = Span<const HalfSpace3>;
  const std::vector<HalfSpace3> many(65);
  const HalfSpace3* const none = nullptr;
  for (const auto& [bad, given] :
       {std::pair{HalfSpaces(many), "65"},
        std::pair{HalfSpaces(none, 1), "null"},
        std::pair{HalfSpaces(Misaligned(many.data()), 1), "misaligned"}}) {
    queries_refused(std::array{HalfSpaces(), HalfSpaces(many.data(), 1), bad},
                    "half-spaces", given);
  }
  const auto lists_refused = [&](const auto& queries) {
    using Query = std::decay_t<decltype(queries[0])>;
    const Span<const Query> good(queries);
    const Query* const no_queries = nullptr;
    queries_refused(Span<const Query>(no_queries, 3), "queries", "null");
    queries_refused(Span<const Query>(Misaligned(queries.data()), 2), "queries",
                    "misaligned");
    std::uint32_t* const no_ids = nullptr;
    refused(good, {no_ids, 9}, offsets, "ids", "null");
    refused(good, {Misaligned(ids.data()), 9}, offsets, "ids", "misaligned");
    std::size_t* const no_offsets = nullptr;
    refused(good, ids, {no_offsets, 4}, "offsets", "null");
    refused(good, ids, {Misaligned(offsets.data()), 4}, "offsets",
            "misaligned");
    refused(good, ids, {offsets.data(), 3}, "offsets", "3");
    refused(good, ids, offsets, "options.target", "no target",
            {.target = Target::FromHighwayBit(3)});
  };
  lists_refused(std::array{sphere, sphere, sphere});
  lists_refused(std::array{HalfSpaces(), HalfSpaces(), HalfSpaces()});
  lists_refused(std::vector<Aabb3>(3, Aabb3::Everything()));
  // Aligned to its floats is not enough for a list of lists.
  const std::array<HalfSpaces, 3> lists;
  const auto* const shifted = reinterpret_cast<const HalfSpaces*>(
      reinterpret_cast<const float*>(lists.data()) + 1);
  queries_refused(Span<const HalfSpaces>(shifted, 2), "queries", "misaligned");
}

}  // namespace
}  // namespace halfspace::testing

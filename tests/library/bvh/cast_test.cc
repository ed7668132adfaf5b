// Ray casts and box casts against exact fractions, and the functions that they
// call. Their order is tested in nearest_test.cc.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <span>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/inputs.h"

namespace halfspace::testing {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

struct Fraction {
  std::int64_t number;
  std::int64_t of;  // positive

  double Value() const {
    return static_cast<double>(number) / static_cast<double>(of);
  }
  friend bool operator<(const Fraction& a, const Fraction& b) {
    return a.number * b.of < b.number * a.of;
  }
};

Fraction Quotient(std::int64_t a, std::int64_t b) {
  return b < 0 ? Fraction{-a, -b} : Fraction{a, b};
}

// The coordinates of a box on all axes of a bound: of D as well.
template <int kDims>
struct MovedBox {
  std::array<std::int64_t, kDims + 1> low{};
  std::array<std::int64_t, kDims + 1> high{};
  std::array<std::int64_t, kDims + 1> direction{};

  void SetD() {
    low[kDims] = high[kDims] = direction[kDims] = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      low[kDims] -= high[k];
      high[kDims] -= low[k];
      direction[kDims] -= direction[k];
    }
  }
};

struct Entry {
  Fraction enters{0, 1};
  Fraction leaves;
  bool is_missed = false;  // at all t
  double slack = 0;        // of t, by what is rounded

  bool IsTouched() const { return !is_missed && !(leaves < enters); }
};

// `planes` has all minima, then all maxima.
template <typename View, int kDims>
Entry ExactEntry(std::span<const std::int64_t> planes,
                 const MovedBox<kDims>& box, std::int64_t max_t) {
  Entry entry;
  entry.leaves = {max_t, 1};
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    const std::size_t k = p % View::Bound::kAxes;
    const bool is_min = IsMinPlane<View>(p);
    const std::int64_t gap = planes[p] - (is_min ? box.high[k] : box.low[k]);
    const std::int64_t speed = box.direction[k];
    if (speed == 0) {
      entry.is_missed |= is_min ? gap > 0 : gap < 0;
      continue;
    }
    const Fraction t = Quotient(gap, speed);
    if (is_min == (speed > 0)) {
      entry.enters = std::max(entry.enters, t);
    } else {
      entry.leaves = std::min(entry.leaves, t);
    }
    const std::int64_t size =
        std::abs(planes[p]) + std::abs(box.low[k]) + std::abs(box.high[k]);
    entry.slack =
        std::max(entry.slack, static_cast<double>(size) * 0x1p-20 /
                                  std::abs(static_cast<double>(speed)));
  }
  entry.slack += entry.enters.Value() * 0x1p-18;
  return entry;
}

template <typename Case>
class BvhCastTest : public ::testing::Test {};
TYPED_TEST_SUITE(BvhCastTest, BvhCases, CaseNames);

// Boxes, rays and objects of integers, times powers of two. The sizes of
// objects differ by a factor of 1000, and some are far away from the others.
TYPED_TEST(BvhCastTest, FindsWhatIsTouchedWhereItIsTouched) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  constexpr int kDims = Bound::kDimensions;
  Random random(11);
  std::size_t touched = 0;
  for (std::size_t round = 0; round < Scaled(150); ++round) {
    const int exponent = static_cast<int>(random() % 230) - 149;
    const int t_exponent = static_cast<int>(random() % 41) - 20;
    // The offsets are moved outward by 2^-124, which is much of small sizes.
    const bool is_exact = exponent > -90 && exponent - t_exponent > -90;
    const auto integer = [&](std::int64_t most) {
      return static_cast<std::int64_t>(random() % (2 * most + 1)) - most;
    };
    const auto scaled = [&](std::int64_t x) {
      return std::ldexp(static_cast<float>(x), exponent);
    };
    std::vector<std::vector<std::int64_t>> planes;
    std::vector<Bound> bounds;
    for (std::size_t i = 0; i < 300; ++i) {
      MovedBox<kDims> box;
      const std::int64_t size = std::int64_t{1} << random() % 11;
      for (std::size_t k = 0; k < kDims; ++k) {
        box.low[k] = integer(i % 50 == 0 ? 60'000 : 1000);
        box.high[k] = box.low[k] + static_cast<std::int64_t>(random() % size);
      }
      box.SetD();
      // A corner less.
      if (random() % 2 == 0) box.low[kDims] += size / 2;
      if (box.low[kDims] > box.high[kDims]) box.low[kDims] = box.high[kDims];
      auto& values = planes.emplace_back();
      auto& bound = bounds.emplace_back();
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        const std::size_t k = p % Bound::kAxes;
        values.push_back(IsMinPlane<View>(p) ? box.low[k] : box.high[k]);
        StoredValue<View>(bound, p) = scaled(values.back());
      }
    }
    const Bvh<View> bvh((std::span<const Bound>(bounds)));
    for (std::size_t q = 0; q < 6; ++q) {
      MovedBox<kDims> moved;
      Aabb<kDims> box;
      Point<kDims> direction;
      const bool is_ray = q % 2 == 0;
      for (std::size_t k = 0; k < kDims; ++k) {
        moved.low[k] = integer(1500);
        moved.high[k] =
            moved.low[k] +
            (is_ray ? 0 : static_cast<std::int64_t>(random() % 100));
        moved.direction[k] = random() % 4 == 0 ? 0 : integer(300);
        box.min[k] = scaled(moved.low[k]);
        box.max[k] = scaled(moved.high[k]);
        direction[k] = std::ldexp(static_cast<float>(moved.direction[k]),
                                  exponent - t_exponent);
      }
      moved.SetD();
      const std::int64_t max_t = q < 2 ? 1'000'000 : integer(10) + 10;
      const float float_max_t =
          q < 2 ? kInf : std::ldexp(static_cast<float>(max_t), t_exponent);
      for (Target target : TargetsUnderTest()) {
        std::map<std::uint32_t, float> found;
        const auto add = [&](std::uint32_t id, float t) {
          ASSERT_TRUE(found.emplace(id, t).second) << "twice";
        };
        constexpr std::array kModes = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD,
                                       FE_TOWARDZERO};
        {
          const RoundingMode mode(kModes[round % kModes.size()]);
          const SearchOptions options = {.target = target};
          if (is_ray) {
            RayCast(bvh, Ray<kDims>{box.min, direction, float_max_t}, add,
                    options);
          } else {
            BoxCast(bvh, box, direction, float_max_t, add, options);
          }
        }
        for (std::uint32_t id = 0; id < bounds.size(); ++id) {
          const Entry entry = ExactEntry<View>(planes[id], moved, max_t);
          const auto hit = found.find(id);
          const bool is_found = hit != found.end();
          if (entry.IsTouched()) {
            ++touched;
            ASSERT_TRUE(is_found) << "round " << round << ", " << id;
            const double t = std::ldexp(double{hit->second}, -t_exponent);
            // Without a division: exact.
            ASSERT_LE(t * static_cast<double>(entry.enters.of),
                      static_cast<double>(entry.enters.number))
                << "round " << round << ", " << id;
            if (is_exact) {
              ASSERT_GE(t, entry.enters.Value() - entry.slack)
                  << "round " << round << ", " << id;
            }
          } else if (is_found && is_exact) {
            ASSERT_FALSE(entry.is_missed) << "round " << round << ", " << id;
            ASSERT_LE(entry.enters.Value(),
                      entry.leaves.Value() + 2 * entry.slack)
                << "round " << round << ", " << id;
          }
        }
      }
    }
  }
  EXPECT_GT(touched, 0u);
}

// A NaN in a corner of a cast box limits nothing on its axis.
TYPED_TEST(BvhCastTest, ANanOfABoxLimitsNothingOnItsAxis) {
  using View = typename TypeParam::View;
  constexpr int kDims = View::Bound::kDimensions;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  World<View> world;
  for (float x : {-100.0f, 100.0f}) {
    Aabb<kDims> box{};
    box.min[0] = box.max[0] = x;
    world.Push([&] {
      if constexpr (HasMaxima<View>) {
        return typename View::Bound([&] {
          if constexpr (View::Bound::kAxes == kDims) {
            return box;
          } else {
            return BoundAabb(box);
          }
        }());
      } else {
        return BoundAabb(box).up();
      }
    }());
  }
  const Bvh<View> bvh(world.view());
  for (bool is_min : {false, true}) {
    Aabb<kDims> box{};
    (is_min ? box.min : box.max)[0] = kNan;
    std::size_t found = 0;
    BoxCast(bvh, box, Point<kDims>{}, 1.0f,
            [&](std::uint32_t, float) { ++found; });
    EXPECT_EQ(found, 2u) << is_min;
  }
}

TYPED_TEST(BvhCastTest, TheFunctionGetsTheBound) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  constexpr int kDims = Bound::kDimensions;
  Spread<View> spread(5.0f);
  std::vector<Bound> bounds;
  for (std::size_t i = 0; i < 5000; ++i) bounds.push_back(spread.NextObject());
  const Bvh<View> bvh((std::span<const Bound>(bounds)));
  Ray<kDims> ray = {{}, {}, 100};
  for (float& x : ray.direction) x = 1;
  std::size_t count = 0;
  std::size_t of_each = 0;
  const auto check = [&](std::uint32_t id, float, const Bound& bound) {
    ++count;
    EXPECT_EQ(bound, bounds[id]);
  };
  for (Target target : TargetsUnderTest()) {
    const SearchOptions options = {.target = target};
    RayCast(bvh, ray, check, options);
    BoxCast(bvh, Aabb<kDims>{ray.origin, ray.origin}, ray.direction, 1, check,
            options);
    ForEachNearest(bvh, ray.origin, 9.0f, check, options);
    EXPECT_GT(count, of_each);
    of_each = count;
  }
}

TEST(BvhCastKnownTest, Boxes) {
  AabbWorld3 world;
  world.Push({{10, 0, 0}, {11, 1, 1}});
  world.Push({{10, 3, 0}, {11, 4, 1}});
  world.Push({{0, 0, 0}, {1, 1, 1}});
  const AabbBvh3 bvh(world);
  const auto hits = [&](const Aabb3& box, float max_t) {
    std::map<std::uint32_t, float> found;
    BoxCast(bvh, box, {2, 0, 0}, max_t,
            [&](std::uint32_t id, float t) { found[id] = t; });
    return found;
  };
  const auto found = hits({{0, 0, 0}, {2, 2, 1}}, 100);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found.at(2), 0.0f);
  EXPECT_NEAR(found.at(0), 4.0f, 1e-4f);
  EXPECT_LE(found.at(0), 4.0f);
  EXPECT_EQ(hits({{0, 0, 0}, {2, 3, 1}}, 100).size(), 3u);
  EXPECT_EQ(hits({{0, 0, 0}, {2, 3, 1}}, 3.9f).size(), 1u);
  EXPECT_EQ(hits(Aabb3::Empty(), 100).size(), 0u);
  EXPECT_EQ(hits({{0, 1, 0}, {1, 0, 1}}, 100).size(), 0u);
}

// The function runs in the caller's floating-point mode, and may change it. Its
// exceptions end the call.
TEST(BvhCastKnownTest, RunsTheFunctionInTheCallersMode) {
  const AabbBvh3 bvh(Spread<AabbView3>(4.0f).Objects(2000));
  const Ray3 ray = {{-60, -50, -50}, {1, 1, 1}, 100};
  std::vector<float> expected;
  RayCast(bvh, ray, [&](std::uint32_t, float t) { expected.push_back(t); });
  ASSERT_GT(expected.size(), 4u);
  for (int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD}) {
    const RoundingMode rounding(mode);
    std::vector<float> found;
    bool is_callers = true;
    int next = mode;
    RayCast(bvh, ray, [&](std::uint32_t, float t) {
      is_callers = is_callers && std::fegetround() == next;
      found.push_back(t);
      next = found.size() % 2 == 0 ? mode : FE_TOWARDZERO;
      std::fesetround(next);
    });
    EXPECT_TRUE(is_callers);
    EXPECT_EQ(std::fegetround(), next);
    EXPECT_EQ(found, expected);
    std::fesetround(mode);
    std::size_t calls = 0;
    EXPECT_THROW(RayCast(bvh, ray,
                         [&](std::uint32_t, float) {
                           if (++calls == 3) throw calls;
                         }),
                 std::size_t);
    EXPECT_EQ(calls, 3u);
    EXPECT_EQ(std::fegetround(), mode);
  }
}

TEST(BvhCastErrorsTest, RefusesWhatIsNoLimit) {
  const AabbBvh3 bvh(Spread<AabbView3>(4.0f).Objects(100));
  const auto ignore = [](std::uint32_t, float) {};
  for (float bad : {-1.0f, -kInf, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_TRUE(Refuses(
        [&] {
          BoxCast(bvh, Aabb3{}, {1, 0, 0}, bad, ignore);
        },
        {"BoxCast", "max_t"}));
  }
  BoxCast(bvh, Aabb3{}, {1, 0, 0}, -0.0f, ignore);
  EXPECT_TRUE(Refuses(
      [&] {
        BoxCast(bvh, Aabb3{}, {1, 0, 0}, 1, ignore,
                {.target = Target::FromHighwayBit(3)});
      },
      {"BoxCast", "options.target", "no target"}));
}

}  // namespace
}  // namespace halfspace::testing

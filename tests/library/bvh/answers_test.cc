// BVHs of every kind answer as a list of their objects does: in worlds of every
// scene and size, in both orders, on every target. What touches a shape is
// never rejected, in any floating-point mode; and distances of all sizes.
#include "tests/library/bvh/answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <vector>

#include "tests/library/bvh/history.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

class BvhTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, BvhTest, ::testing::ValuesIn(LayoutsOf(false)),
                         LayoutName());

// In one order if the size is even, and in the other if it is odd.
void ExpectAnswersEverywhere(const Scene& scene, const Layout& layout,
                             std::size_t size) {
  const std::vector<Planes> bounds = ObjectsIn(scene, layout, size, size);
  const Objects objects = ObjectsOf(bounds);
  Random random(size);
  const auto bvh = MakeBvh(
      layout, bounds,
      {.quality = size % 2 == 0 ? BuildQuality::kHigh : BuildQuality::kFast});
  const bool is_large = size > 1000;
  HowToAsk how{.targets = TargetsUnderTest(),
               .is_special = scene.is_special || is_large};
  ExpectIsModel(*bvh, objects, how, random);
  if (!is_large) {
    how.mask = random() % 2;  // of all or of none
    how.is_special = true;
    ExpectAnswers(*bvh, objects, how, random);
  }
  if (::testing::Test::HasFailure()) {
    FAIL() << scene.name << ", " << size << " objects";
  }
}

TEST_P(BvhTest, AnswersInWorldsOfEverySize) {
  std::vector<std::size_t> sizes = {0,   1,   2,   63,   64,   65,
                                    127, 128, 129, 4032, 4096, 4097};
  Random random(7);
  for (std::size_t i = 0; i < Scaled(8); ++i) sizes.push_back(random() % 9000);
  for (std::size_t size : sizes) {
    ExpectAnswersEverywhere(Scenes()[0], GetParam(), size);
    if (HasFailure()) return;
  }
}

// The small ones with all their pairs.
TEST_P(BvhTest, AnswersInWorldsOfEveryScene) {
  for (const Scene& scene : Scenes()) {
    const std::size_t rounds = scene.is_special ? Scaled(4) : 1;
    for (std::size_t round = 0; round < rounds; ++round) {
      ExpectAnswersEverywhere(scene, GetParam(), 150 + round);
      if (HasFailure()) return;
    }
    ExpectAnswersEverywhere(scene, GetParam(), 4501);
    if (HasFailure()) return;
  }
}

// Three levels above the objects.
TEST_P(BvhTest, FindsWhatAScanFindsAmongMany) {
  const auto bounds =
      Spheres(GetParam(), 0.2f).Some(64 * 4096 + Scaled(40'000));
  const Objects objects = ObjectsOf(bounds);
  std::vector<Shape> queries;
  for (float radius : {0.0f, 0.5f, 5.0f, 40.0f}) {
    queries.push_back(Spheres(GetParam(), radius, 2).NextQuery());
  }
  const auto bvh = MakeBvh(GetParam(), bounds);
  ExpectFinds(*bvh, objects, queries, {.targets = TargetsUnderTest()});
}

// Blocks whose values are at every place of their scale, and queries at each of
// them and one ulp to both sides: a code that decides too much is found. In
// every floating-point mode. More than one block, as one alone is tested by its
// floats.
TEST_P(BvhTest, CodesDecideOnlyWhatTheyProve) {
  const Layout layout = GetParam();
  // With 252.5 the values are at the ends of codes, where rounding tells.
  struct Scale {
    float base;
    float step;
    float last = 63.0f;
  };
  constexpr Scale kScales[] = {{0.0f, 1.0f},
                               {1.0f, 0x1p-23f},
                               {1.0f, 0.1f},
                               {-100.0f, 3.1f},
                               {0.0f, 0x1p-149f},
                               {0x1p-126f, 0x1p-149f},
                               {-0x1p127f, 0x1.f8p121f},
                               {1.0f, 0.0f},
                               {0x1p99f, 0x1p94f},
                               {0.0f, 3.1f, 252.5f},
                               {0.3f, 0.7f, 252.5f},
                               {-40.0f, 0.9f, 252.5f}};
  for (const Scale& scale : kScales) {
    std::vector<float> values;
    for (std::size_t i = 0; i < 64; ++i) {
      values.push_back(scale.base +
                       (i < 63 ? static_cast<float>(i) : scale.last) *
                           scale.step);
    }
    std::vector<Planes> bounds(128);
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      for (std::size_t p = 0; p < layout.plane_count; ++p) {
        bounds[i][p] = values[(i * 37 + p) % 64];
      }
    }
    std::vector<Shape> queries;
    for (std::size_t p = 0; p < layout.plane_count; ++p) {
      for (float value : values) {
        for (float at : {value, std::nextafter(value, kInf),
                         std::nextafter(value, -kInf)}) {
          Planes query = AllPlanes(layout, kInf);
          query[p] = at;
          queries.push_back(ShapeOf(query));
        }
      }
    }
    const auto count = [&](std::size_t q) {
      const std::size_t p = q / (3 * values.size());
      const float at = queries[q].numbers[p];
      std::size_t kept = 0;
      for (const Planes& bound : bounds) {
        kept += IsMin(layout, p) ? bound[p] <= at : bound[p] >= at;
      }
      return kept;
    };
    constexpr FpMode kModes[] = {FpMode::kDefault, FpMode::kFlushes,
                                 FpMode::kUpward, FpMode::kDownward,
                                 FpMode::kToZero};
    std::vector<std::vector<std::size_t>> expected;
    for (FpMode mode : kModes) {
      auto& counts = expected.emplace_back(queries.size());
      RunIn(mode, [&] {
        for (std::size_t q = 0; q < queries.size(); ++q) counts[q] = count(q);
      });
    }
    for (FpMode build_mode :
         {FpMode::kDefault, FpMode::kUpward, FpMode::kDownward}) {
      std::unique_ptr<AnyBvh> bvh;
      RunIn(build_mode, [&] {
        bvh = MakeBvh(layout, bounds);
        bvh->Reserve(4097);  // a smaller world has no codes
      });
      ASSERT_NE(bvh->levels().codes, nullptr);
      for (std::size_t m = 0; m < std::size(kModes); ++m) {
        for (Target target : TargetsUnderTest()) {
          std::vector<std::size_t> counts(queries.size());
          RunIn(kModes[m],
                [&] { bvh->CountEach(queries, counts, {.target = target}); });
          ASSERT_EQ(counts, expected[m]) << "from " << scale.base << " by "
                                         << scale.step << ", " << target.name();
        }
      }
    }
  }
}

// Shapes of integers, times a power of two, and objects that touch them in a
// point of integers.
TEST_P(BvhTest, NeverRejectsWhatTouchesAShape) {
  const Layout layout = GetParam();
  const std::size_t dims = layout.dims;
  using Exact = std::array<double, 3>;
  Random random(4);
  for (std::size_t round = 0; round < Scaled(400); ++round) {
    // Up to what a builder can bound, and beyond.
    const int exponent = static_cast<int>(random() % 256) - 150;
    // Subnormals have no room for all integers.
    bool is_exact = true;
    const auto scaled = [&](double x) {
      const auto value = static_cast<float>(std::ldexp(x, exponent));
      is_exact &= std::ldexp(double{value}, -exponent) == x;
      return value;
    };
    const auto integer = [&](std::uint64_t most) {
      return 16 * (static_cast<double>(random() % (2 * most + 1)) -
                   static_cast<double>(most));
    };
    Exact a{};
    Exact b{};
    Exact low{};
    Exact high{};
    for (std::size_t k = 0; k < dims; ++k) {
      a[k] = integer(round % 2 == 0 ? 1000 : 100'000);
      b[k] = random() % 4 == 0 ? a[k] : integer(100'000);
      low[k] = std::min(a[k], b[k]);
      high[k] = std::max(a[k], b[k]);
    }
    const double size = static_cast<double>(random() % 5'000);
    // The numbers of points, and of a radius.
    const auto of = [&](std::initializer_list<Exact> points,
                        std::optional<double> radius = {}) {
      std::vector<float> numbers;
      for (const Exact& p : points) {
        for (std::size_t k = 0; k < dims; ++k) numbers.push_back(scaled(p[k]));
      }
      if (radius) numbers.push_back(scaled(*radius));
      return numbers;
    };
    // Of a sphere with corners at 3, 4 and 12, or at 3 and 4.
    const double radius = size * (dims == 3 ? 13 : 5);
    const Shape sphere{Shape::kSphere, of({a}, radius)};
    const Shape capsule{Shape::kCapsule, of({a, b}, radius)};
    const Shape rounded{Shape::kRoundedBox, of({low, high}, radius)};
    Shape box{Shape::kOrientedBox, of({a})};
    std::array<Exact, 3> box_axes{};
    for (std::size_t axis = 0; axis < dims; ++axis) {
      for (std::size_t k = 0; k < dims; ++k) {
        box_axes[axis][k] = round % 5 == 0 && k != axis ? 0 : integer(100);
        box.numbers.push_back(static_cast<float>(box_axes[axis][k]));
      }
    }
    box.numbers.resize(box.numbers.size() + dims, scaled(2));
    if (!is_exact) continue;
    // In front of planes through a point.
    Shape fronts{Shape::kHalfSpaces, {}};
    for (std::size_t i = random() % 7; i-- > 0;) {
      double offset = 0;
      for (std::size_t k = 0; k < dims; ++k) {
        fronts.numbers.push_back(static_cast<float>(random() % 9) - 4);
        offset -= fronts.numbers.back() * a[k];
      }
      fronts.numbers.push_back(scaled(offset));
    }
    // The bound of a point, which it may exceed in directions that do not
    // matter.
    const auto bound_of = [&](const Exact& p) {
      Planes bound{};
      double sum = 0;
      for (std::size_t k = 0; k < dims; ++k) sum -= p[k];
      const std::uint64_t more = random() % 4 == 0 ? 0 : random();
      for (std::size_t v = 0; v < layout.plane_count; ++v) {
        const std::size_t k = v % layout.axes;
        double value = k < dims ? p[k] : sum;
        if ((more >> v & 1) != 0) {
          value += IsMin(layout, v) ? -size - 50 : size + 50;
        }
        const auto nearest = static_cast<float>(std::ldexp(value, exponent));
        // Of sums that have too many bits.
        bound[v] = std::ldexp(double{nearest}, -exponent) == value ? nearest
                   : IsMin(layout, v) ? std::nextafter(nearest, -kInf)
                                      : std::nextafter(nearest, kInf);
      }
      return bound;
    };
    // Objects at points that next() returns.
    const auto expect_keeps = [&](const Shape& shape, const auto& next) {
      std::vector<Planes> bounds(150);
      for (Planes& bound : bounds) bound = bound_of(next());
      const auto bvh = MakeBvh(layout, bounds);
      for (Target target : TargetsUnderTest()) {
        for (FpMode mode : kFpModes) {
          std::size_t kept = 0;
          if (mode == FpMode::kTraps) continue;
          RunIn(mode, [&] { kept = bvh->Count(shape, {.target = target}); });
          ASSERT_EQ(kept, bounds.size())
              << "round " << round << ", times 2^" << exponent << ", "
              << target.name() << ", shape " << shape.kind << ", mode "
              << static_cast<int>(mode);
        }
      }
    };
    const auto at_a = [&] { return a; };
    const auto along = [&] {
      const double t = static_cast<double>(random() % 17) / 16;
      Exact point{};
      for (std::size_t k = 0; k < dims; ++k)
        point[k] = a[k] + t * (b[k] - a[k]);
      return point;
    };
    // A corner of a sphere around a point. `far` is where it is above the
    // point.
    const auto around = [&](const Exact& point, const Exact& far) {
      constexpr Exact kCorner = {3, 4, 12};
      const std::size_t first = random() % dims;
      Exact corner{};
      for (std::size_t k = 0; k < dims; ++k) {
        const double away = size * kCorner[(k + first) % dims];
        corner[k] = random() % 2 == 0 ? far[k] + away : point[k] - away;
      }
      return corner;
    };
    expect_keeps(box, [&] {
      Exact corner = a;
      for (std::size_t axis = 0; axis < dims; ++axis) {
        const double side = random() % 2 == 0 ? 2 : -2;
        for (std::size_t k = 0; k < dims; ++k) {
          corner[k] += side * box_axes[axis][k];
        }
      }
      return corner;
    });
    expect_keeps({Shape::kSegment, of({a, b})}, along);
    expect_keeps(capsule, along);
    expect_keeps(capsule, [&] {
      const Exact point = along();
      return around(point, point);
    });
    expect_keeps(sphere, [&] { return around(a, a); });
    expect_keeps(rounded, [&] { return around(low, high); });
    expect_keeps({Shape::kPoint, of({a})}, at_a);
    expect_keeps(fronts, at_a);
    if (HasFatalFailure()) return;
  }
}

// Points at distances from 2^-76 to beyond 2^64: as near to the exact distances
// as the header says, found up to a limit that is theirs, and the same in all
// modes.
TEST(BvhNearestTest, DistancesOfAllSizesInAllFloatingPointModes) {
  const Layout layout(3, 3, true);
  constexpr std::size_t kPoints = 12;
  Random random(3);
  for (int exponent = -76; exponent <= 64; ++exponent) {
    const auto any = [&] {
      const auto share = static_cast<float>(random() % (1 << 23)) * 0x1p-24f;
      return std::ldexp(0.5f + share, exponent);
    };
    Motion ray;
    ray.place.is_point = true;
    Corner& center = ray.place.min;
    if (exponent % 3 == 0) center = {any(), any(), -any()};
    ray.direction = {any(), -any(), any()};
    ray.max_t = kInf;
    ray.radius = any();
    std::vector<Planes> bounds;
    std::vector<double> exact;
    std::vector<float> limits = {kInf};
    for (std::size_t i = 0; i < kPoints; ++i) {
      Corner p = center;
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        if (i % 4 != k) p[k] += random() % 2 == 0 ? any() : -any();
        const double gap = double{p[k]} - center[k];
        squared += gap * gap;
      }
      bounds.push_back({p[0], p[1], p[2], p[0], p[1], p[2]});
      exact.push_back(std::sqrt(squared));
      // It is found up to the first, and not up to the second.
      const double too_near = (exact[i] - 0x1p-73) / (1 + 0x1p-18);
      limits.push_back(std::nextafter(static_cast<float>(exact[i]), kInf));
      limits.push_back(
          std::max(std::nextafter(static_cast<float>(too_near), -kInf), 0.0f));
    }
    const auto bvh = MakeBvh(layout, bounds);
    using Found = std::vector<std::pair<std::uint32_t, float>>;
    for (Target target : TargetsUnderTest()) {
      const SearchOptions options = {.target = target};
      // In another mode nothing may be computed here.
      const auto answer = [&](FpMode mode) {
        std::vector<Found> answers(limits.size() + 2);
        for (Found& found : answers) found.reserve(kPoints);
        Ids ids(kPoints);
        std::vector<float> distances(kPoints);
        std::size_t at = 0;
        const auto append = [&](std::uint32_t id, float value, const Planes&) {
          answers[at].emplace_back(id, value);
          return Limit{value};
        };
        RunIn(mode, [&] {
          for (float limit : limits) {
            const std::size_t count =
                bvh->Nearest(ray.place, ids, distances, limit, options);
            for (std::size_t i = 0; i < count; ++i) {
              answers[at].emplace_back(ids[i], distances[i]);
            }
            ++at;
          }
          bvh->ForEachNearest(center, kInf, append, options);
          ++at;
          bvh->Cast(ray, append, options);
        });
        return answers;
      };
      const auto answers = answer(FpMode::kDefault);
      for (const auto& [id, distance] : answers[0]) {
        EXPECT_NEAR(distance, exact[id], exact[id] * 0x1p-20 + 0x1p-73);
      }
      for (std::size_t i = 0; i < kPoints; ++i) {
        const auto is_found = [&](std::size_t a) {
          return std::any_of(answers[a].begin(), answers[a].end(),
                             [&](const auto& one) { return one.first == i; });
        };
        const bool is_near = exact[i] <= 0x1p64 * (1 - 0x1p-20);
        if (is_near || exact[i] >= 0x1p64) {
          EXPECT_EQ(is_found(0), is_near) << exact[i];
          EXPECT_EQ(is_found(1 + 2 * i), is_near) << exact[i];
        }
        EXPECT_FALSE(exact[i] > 0x1p-73 && is_found(2 + 2 * i)) << exact[i];
      }
      for (FpMode mode : kFpModes) {
        EXPECT_TRUE(answer(mode) == answers) << static_cast<int>(mode);
      }
      if (HasFailure()) {
        FAIL() << "times 2^" << exponent << ", " << target.name();
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

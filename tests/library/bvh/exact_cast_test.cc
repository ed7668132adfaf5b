// Casts of a Bvh, of each type, against rational arithmetic: no hit is missed,
// and no t is above the exact one. Broad phases give the same (history_test).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/exact.h"

namespace halfspace::testing {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

// One axis of a body and of what moves to it. A plane that limits nothing is
// absent.
struct ExactAxis {
  std::optional<mpq_class> min;
  std::optional<mpq_class> max;
  mpq_class low;  // of what moves
  mpq_class high;
  mpq_class speed;

  // The distance of a point from the body.
  mpq_class GapAt(const mpq_class& t) const {
    const mpq_class at = low + speed * t;
    if (min && at < *min) return *min - at;
    if (max && at > *max) return at - *max;
    return 0;
  }
};

struct Times {
  mpq_class from;
  mpq_class to;

  // The times at which factor * t <= most.
  void Limit(const mpq_class& factor, const mpq_class& most) {
    if (factor > 0) {
      to = std::min<mpq_class>(to, most / factor);
    } else if (factor < 0) {
      from = std::max<mpq_class>(from, most / factor);
    } else if (most < 0) {
      to = from - 1;
    }
  }
  bool IsEmpty() const { return from > to; }
};

// The times at which a point is within a squared distance of the axes, rounded
// inward by 2^-60 of them.
Times TimesWithin(const std::vector<ExactAxis>& axes,
                  const mpq_class& squared_distance, const Times& all) {
  const auto excess = [&](const mpq_class& t) {
    mpq_class sum = -squared_distance;
    for (const ExactAxis& axis : axes) {
      const mpq_class gap = axis.GapAt(t);
      sum += gap * gap;
    }
    return sum;
  };
  // Where it is nearest: between two of these the square is one parabola.
  std::vector<mpq_class> stops = {all.from, all.to};
  for (const ExactAxis& axis : axes) {
    if (axis.speed == 0) continue;
    for (const auto& plane : {axis.min, axis.max}) {
      if (!plane) continue;
      const mpq_class t = (*plane - axis.low) / axis.speed;
      if (t > all.from && t < all.to) stops.push_back(t);
    }
  }
  std::sort(stops.begin(), stops.end());
  mpq_class nearest = all.from;
  mpq_class least = excess(nearest);
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    const mpq_class middle = (stops[i] + stops[i + 1]) / 2;
    mpq_class a = 0;
    mpq_class b = 0;
    for (const ExactAxis& axis : axes) {
      const mpq_class at = axis.low + axis.speed * middle;
      const bool is_below = axis.min && at < *axis.min;
      const bool is_above = axis.max && at > *axis.max;
      if (!is_below && !is_above) continue;
      a += axis.speed * axis.speed;
      b += axis.speed * (axis.low - (is_below ? *axis.min : *axis.max));
    }
    mpq_class t = stops[i + 1];
    if (a != 0) {
      t = std::clamp<mpq_class>(-b / a, stops[i], stops[i + 1]);
    }
    const mpq_class value = excess(t);
    if (value < least) {
      least = value;
      nearest = t;
    }
  }
  if (least > 0) return {1, 0};
  const mpq_class kPrecision = Exact(0x1p60);
  const auto last_within = [&](mpq_class beyond) {
    if (excess(beyond) <= 0) return beyond;
    mpq_class within = nearest;
    for (int i = 0; i < 400; ++i) {
      const mpq_class apart = beyond - within;
      if (abs(apart) * kPrecision < abs(beyond)) break;
      const mpq_class middle = (within + beyond) / 2;
      (excess(middle) <= 0 ? within : beyond) = middle;
    }
    return within;
  };
  return {last_within(all.from), last_within(all.to)};
}

template <int kDims>
struct Moving {
  Aabb<kDims> box;  // or the center of a ball
  Point<kDims> direction;
  float max_t;
  float radius;
};

// The t at which it touches the bound, larger by `margin`.
template <typename Bound, int kDims>
std::optional<mpq_class> ExactEntry(const Bound& bound,
                                    const Moving<kDims>& moving,
                                    const mpq_class& margin = 0) {
  std::vector<ExactAxis> axes(Bound::kAxes);
  for (std::size_t k = 0; k < axes.size(); ++k) {
    if (bound.min[k] == kInf) return std::nullopt;
    if (bound.min[k] > -kInf) axes[k].min = Exact(bound.min[k]) - margin;
    if constexpr (requires { bound.max; }) {
      if (bound.max[k] == -kInf) return std::nullopt;
      if (bound.max[k] < kInf) axes[k].max = Exact(bound.max[k]) + margin;
    }
    if (k < kDims) {
      axes[k].low = Exact(moving.box.min[k]);
      axes[k].high = Exact(moving.box.max[k]);
      axes[k].speed = Exact(moving.direction[k]);
    } else {
      for (std::size_t i = 0; i < kDims; ++i) {
        axes[k].low -= axes[i].high;
        axes[k].high -= axes[i].low;
        axes[k].speed -= axes[i].speed;
      }
    }
  }
  const float most = std::numeric_limits<float>::max();
  Times times = {0, Exact(std::min(moving.max_t, most))};
  if (moving.radius > 0) {
    const Times all = times;
    const mpq_class radius = Exact(moving.radius) + margin;
    const auto limit = [&](const std::vector<ExactAxis>& some, int factor) {
      const Times within = TimesWithin(some, factor * radius * radius, all);
      times.from = std::max(times.from, within.from);
      times.to = std::min(times.to, within.to);
    };
    limit({axes.begin(), axes.begin() + kDims}, 1);
    if (axes.size() > kDims) limit({axes[kDims]}, kDims);
  } else {
    for (const ExactAxis& axis : axes) {
      if (axis.max) times.Limit(axis.speed, *axis.max - axis.low);
      if (axis.min) times.Limit(-axis.speed, axis.high - *axis.min);
    }
  }
  if (times.IsEmpty()) return std::nullopt;
  return times.from;
}

// Where numbers are from.
enum class Scene {
  kUsual,
  kLattice,  // small integers: much touches exactly, and moves along planes
  kTiny,     // subnormals
  kHuge,
  kMixed  // any magnitude
};

class Numbers {
 public:
  Numbers(Scene scene, std::uint64_t seed) : scene_(scene), random_(seed) {}

  std::size_t Next(std::size_t end) { return random_() % end; }
  float Coordinate() {
    switch (scene_) {
      case Scene::kUsual:
        return Unit() * 10;
      case Scene::kLattice:
        return static_cast<float>(Next(9)) - 4;
      case Scene::kTiny:
        return Unit() * 0x1p-140f;
      case Scene::kHuge:
        return Unit() * 0x1p98f;
      case Scene::kMixed:
        break;
    }
    return std::ldexp(Unit(), static_cast<int>(Next(250)) - 148);
  }
  float Size() {
    const float size = std::abs(Coordinate());
    return scene_ == Scene::kUsual ? size / 8 : Next(4) == 0 ? 0 : size;
  }
  float Speed() {
    if (Next(6) == 0) return 0;
    if (scene_ == Scene::kUsual) return Unit();
    return Coordinate();
  }
  // Between -1 and 1.
  float Unit() {
    return static_cast<float>(Next(std::size_t{1} << 24)) * 0x1p-23f - 1;
  }

 private:
  Scene scene_;
  Random random_;
};

template <typename View>
typename View::Bound SomeBound(Numbers& numbers) {
  using Bound = typename View::Bound;

  typename AaboView<Bound::kDimensions>::Bound all;
  for (std::size_t k = 0; k < all.min.size(); ++k) {
    all.min[k] = numbers.Coordinate();
    all.max[k] = all.min[k] + numbers.Size();
    if (numbers.Next(20) == 0) all.max[k] = kInf;
    if (numbers.Next(20) == 0) all.min[k] = -kInf;
  }
  // A D that belongs to the box, for most of them.
  if (numbers.Next(4) != 0) {
    all.min.back() = all.max.back() = 0;
    for (std::size_t k = 0; k < Bound::kDimensions; ++k) {
      all.min.back() -= all.max[k];
      all.max.back() -= all.min[k];
    }
  }
  return ObjectOf<View>(all);
}

template <typename Case>
class ExactCastTest : public ::testing::Test {};
TYPED_TEST_SUITE(ExactCastTest, BvhCases, CaseNames);

TYPED_TEST(ExactCastTest, NoHitIsMissedAndNoneIsLate) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  constexpr int kDims = Bound::kDimensions;
  constexpr std::uint32_t kBodies = 80;  // in two leaves
  enum { kRay, kBox, kBall, kWhats };
  for (const Scene scene : {Scene::kUsual, Scene::kLattice, Scene::kTiny,
                            Scene::kHuge, Scene::kMixed}) {
    Numbers numbers(scene, static_cast<std::uint64_t>(scene));
    std::vector<Bound> bounds;
    for (std::uint32_t id = 0; id < kBodies; ++id) {
      bounds.push_back(SomeBound<View>(numbers));
    }
    const Bvh<View> bodies(bounds);
    const std::size_t casts = 3 + Scaled(30);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < casts * kWhats; ++i) {
      Moving<kDims> moving{};
      const std::size_t what = i % kWhats;
      for (std::size_t k = 0; k < kDims; ++k) {
        moving.box.min[k] = moving.box.max[k] = numbers.Coordinate();
        if (what == kBox) moving.box.max[k] += numbers.Size();
        moving.direction[k] = numbers.Speed();
      }
      if (numbers.Next(10) == 0) moving.direction = {};
      constexpr float kTimes[] = {1, 3, 20, 0, 0x1p-130f, 0x1p60f, kInf};
      moving.max_t = kTimes[numbers.Next(std::size(kTimes))];
      if (what == kBall) moving.radius = numbers.Size();
      const auto cast = [&](const auto& function) {
        if (what == kBox) {
          BoxCast(bodies, moving.box, moving.direction, moving.max_t, function);
        } else if (what == kBall) {
          SphereCast(bodies, Sphere<kDims>{moving.box.min, moving.radius},
                     moving.direction, moving.max_t, function);
        } else {
          RayCast(bodies,
                  Ray<kDims>{moving.box.min, moving.direction, moving.max_t},
                  function);
        }
      };
      std::map<std::uint32_t, float> found;
      float first = kInf;
      cast([&](std::uint32_t id, float t, const Bound&) {
        ASSERT_TRUE(found.emplace(id, t).second);
        first = std::min(first, t);
      });
      float nearest = kInf;
      cast([&](std::uint32_t, float t, const Bound&) {
        nearest = std::min(nearest, t);
        return Limit{nearest};
      });
      ASSERT_EQ(nearest, first);
      for (std::uint32_t id = 0; id < kBodies; ++id) {
        SCOPED_TRACE(::testing::Message() << "scene " << static_cast<int>(scene)
                                          << ", cast " << i << ", body " << id);
        const auto entry = ExactEntry(bounds[id], moving);
        const auto t = found.find(id);
        if (entry) {
          ++hits;
          ASSERT_NE(t, found.end()) << entry->get_d();
          ASSERT_LE(Exact(t->second), *entry) << entry->get_d();
        }
        // Nothing is found by more than what is rounded off.
        if (scene != Scene::kUsual || t == found.end()) continue;
        const auto early = ExactEntry(bounds[id], moving, Exact(0x1p-14));
        ASSERT_TRUE(early);
        ASSERT_GE(Exact(t->second), *early * (1 - Exact(0x1p-17)))
            << t->second << " " << early->get_d();
      }
    }
    EXPECT_GT(hits, 0);
  }
}

}  // namespace
}  // namespace halfspace::testing

// Bodies of every kind for the tests of broad phases, and what a broad phase
// should answer: a list of its bodies, and Bvhs and loops over it.
#ifndef HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_BODIES_H_
#define HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_BODIES_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/cases.h"

namespace halfspace::testing {

using BroadPhaseCases =
    Tested<::testing::Types<Whole<AabbView2>, Whole<AabbView3>,
                            Whole<AaboView2>, Whole<AaboView3>>>;

// In order.
using IdPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

template <typename View>
struct BodyModel {
  using Bound = typename View::Bound;
  struct Object {
    Bound bound;
    BodyMasks masks;
  };
  std::map<std::uint32_t, Object> objects;
  bool (*keep)(void*, std::uint32_t, std::uint32_t, bool) = nullptr;

  // A Bvh of the bodies that a mask finds, and their ids.
  struct Masked {
    Bvh<View> bvh;
    Ids ids;
  };
  Masked Found(std::uint64_t mask) const {
    std::vector<Bound> bounds;
    Ids ids;
    for (const auto& [id, object] : objects) {
      if (~mask != 0 && (object.masks.category & mask) == 0) continue;
      ids.push_back(id);
      bounds.push_back(object.bound);
    }
    return {Bvh<View>(bounds), ids};
  }

  // The rule in words: no plane of one is beyond the opposite one of the other
  // by more than the margin.
  static bool Overlap(const Bound& a, const Bound& b, double margin) {
    for (std::size_t k = 0; k < Bound::kAxes; ++k) {
      const double own =
          k < Bound::kDimensions ? margin : Bound::kDimensions * margin;
      if (IsMoreApart(a.min[k], b.max[k], own)) return false;
      if (IsMoreApart(b.min[k], a.max[k], own)) return false;
    }
    return true;
  }
  // Exact: if the difference is rounded to the margin, the rest decides, which
  // is that of the value that is closer to zero.
  static bool IsMoreApart(double min, double max, double margin) {
    const double difference = min - max;
    if (difference != margin) return difference > margin;
    return std::abs(min) > std::abs(max) ? min - difference > max
                                         : min > max + difference;
  }
  static bool MasksMatch(const BodyMasks& a, const BodyMasks& b) {
    return (a.category & b.collides_with) != 0 &&
           (b.category & a.collides_with) != 0;
  }

  IdPairs Pairs(double margin = 0) const {
    return PairsOf(margin, [&](std::uint32_t a, std::uint32_t b) {
      return MasksMatch(objects.at(a).masks, objects.at(b).masks);
    });
  }
  // With the filter's say in what matches.
  template <typename Match>
  IdPairs PairsOf(double margin, const Match& match) const {
    IdPairs pairs;
    for (auto a = objects.begin(); a != objects.end(); ++a) {
      for (auto b = std::next(a); b != objects.end(); ++b) {
        if (!Overlap(a->second.bound, b->second.bound, margin)) continue;
        const bool matches = match(a->first, b->first);
        if (keep == nullptr ? matches
                            : keep(nullptr, a->first, b->first, matches)) {
          pairs.emplace_back(a->first, b->first);
        }
      }
    }
    return pairs;
  }
};

// A filter: some pairs in spite of their masks, and some not.
inline bool KeepsSome(void* /*context*/, std::uint32_t a, std::uint32_t b,
                      bool masks_match) {
  return (a + b) % 8 == 0 ? !masks_match : masks_match;
}

// Bounds of every kind: small ones that move, and each that is special.
template <typename View>
class BodyMaker {
 public:
  using Bound = typename View::Bound;

  explicit BodyMaker(std::uint64_t seed)
      : random_(seed), small_(1.0f, seed), large_(15.0f, seed) {}

  Bound Next() {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    Bound bound = small_.NextObject();
    const std::size_t plane = random_() % kPlanes<View>;
    switch (random_() % 24) {
      case 0:
        return Bound::Everything();
      case 1:
        return Bound::Empty();
      case 2:  // a wall, or half of one
        bound.min[plane % Bound::kAxes] = -kInf;
        if (plane % 2 == 0) bound.max[plane % Bound::kAxes] = kInf;
        return bound;
      case 3:  // all at infinity
        for (auto* planes : {&bound.min, &bound.max}) planes->fill(kInf);
        return bound;
      case 4:
        StoredValue<View>(bound, plane) = kNan;
        return bound;
      case 5:  // inverted
        std::swap(bound.min[0], bound.max[0]);
        return bound;
      case 6:
        return large_.NextObject();
      case 7:
      case 8:
        return coincident_;
      default:
        return bound;
    }
  }

  // Moves by up to a quarter of a small body's size, or somewhere else.
  Bound Moved(Bound bound) {
    if (random_() % 4 == 0) return Next();
    for (std::size_t k = 0; k < Bound::kAxes; ++k) {
      const float step = static_cast<float>(random_() % 100) / 200 - 0.25f;
      bound.min[k] += step;
      bound.max[k] += step;
    }
    return bound;
  }

  BodyMasks Masks() {
    constexpr std::uint64_t kBits[] = {0, 1, 2, std::uint64_t{1} << 40};
    BodyMasks masks;
    if (random_() % 3 == 0) masks.category = kBits[random_() % 4];
    if (random_() % 3 == 0) {
      masks.collides_with = 1 | kBits[random_() % 4];
    }
    return masks;
  }

  Random& random() { return random_; }
  std::size_t Below(std::size_t end) { return random_() % end; }

 private:
  Random random_;
  Spread<View> small_;
  Spread<View> large_;
  Bound coincident_ = small_.NextObject();
};

template <typename View>
void ExpectSameBounds(const typename View::Bound& a,
                      const typename View::Bound& b) {
  const auto bits = [](const typename View::Bound& bound) {
    return std::bit_cast<std::array<std::uint32_t, kPlanes<View>>>(bound);
  };
  ASSERT_EQ(bits(a), bits(b));
}

// All that finds by a query or a shape. Each body is found once, with its own
// bound.
template <typename View, typename Query>
void ExpectFindsSame(const BroadPhase<View>& bodies,
                     const BodyModel<View>& model,
                     const typename BodyModel<View>::Masked& masked,
                     const Query& query, std::uint64_t mask) {
  Ids expected;
  ForEachSurvivor(masked.bvh, query, [&](Span<const std::uint32_t> some) {
    for (const std::uint32_t i : some) expected.push_back(masked.ids[i]);
  });
  Ids found;
  bodies.ForEach(query, mask,
                 [&](std::uint32_t id, const typename View::Bound& bound) {
                   found.push_back(id);
                   ExpectSameBounds<View>(bound, model.objects.at(id).bound);
                 });
  ASSERT_EQ(InOrder(found), InOrder(expected));
  // And stops.
  std::size_t calls = 0;
  bodies.ForEach(query, mask, [&](std::uint32_t, const auto&) {
    ++calls;
    return Visit::kStop;
  });
  ASSERT_EQ(calls, expected.empty() ? 0 : 1);
}

// Two functions that cast the same ray or box.
template <typename View, typename BodiesCast, typename BvhCast>
void ExpectCastsSame(const BodyModel<View>& model,
                     const typename BodyModel<View>::Masked& masked,
                     const BodiesCast& cast_bodies, const BvhCast& cast_bvh) {
  std::map<std::uint32_t, float> expected;
  float first = std::numeric_limits<float>::infinity();
  cast_bvh(masked.bvh, [&](std::uint32_t i, float t) {
    expected[masked.ids[i]] = t;
    first = std::min(first, t);
  });
  std::map<std::uint32_t, float> found;
  cast_bodies(
      [&](std::uint32_t id, float t, const typename View::Bound& bound) {
        ASSERT_TRUE(found.emplace(id, t).second) << id;
        ExpectSameBounds<View>(bound, model.objects.at(id).bound);
      });
  ASSERT_EQ(found, expected);
  float nearest = std::numeric_limits<float>::infinity();
  cast_bodies([&](std::uint32_t, float t, const auto&) {
    EXPECT_LE(t, nearest + 0x1p-100f);  // see BoxCast()
    nearest = std::min(nearest, t);
    return Limit{nearest};
  });
  ASSERT_EQ(nearest, first);
  std::size_t calls = 0;
  cast_bodies([&](std::uint32_t, float, const auto&) {
    ++calls;
    return Visit::kStop;
  });
  ASSERT_EQ(calls, expected.empty() ? 0 : 1);
}

// What a broad phase says of its bodies without a query.
template <typename View>
void ExpectHasBodies(const BroadPhase<View>& bodies,
                     const BodyModel<View>& model) {
  ASSERT_TRUE(bodies.Validate());
  ASSERT_EQ(bodies.size(), model.objects.size());
  const auto all = bodies.Bounds();
  for (std::uint32_t id = 0; id < bodies.max_ids(); ++id) {
    const auto object = model.objects.find(id);
    ASSERT_EQ(bodies.Has(id), object != model.objects.end()) << id;
    if (object == model.objects.end()) continue;
    const auto& bound = object->second.bound;
    ExpectSameBounds<View>(bodies.Get(id), bound);
    ASSERT_EQ(bodies.MasksOf(id), object->second.masks);
    constexpr float kInf = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < View::Bound::kAxes; ++k) {
      ASSERT_LE(all.min[k], std::isnan(bound.min[k]) ? -kInf : bound.min[k]);
      ASSERT_GE(all.max[k], std::isnan(bound.max[k]) ? kInf : bound.max[k]);
    }
  }
  const BroadPhaseStatistics statistics = bodies.Statistics();
  ASSERT_EQ(statistics.bodies, model.objects.size());
  ASSERT_LE(statistics.pending, std::min<std::size_t>(bodies.size(), 256));
}

// Every query of a broad phase.
template <typename View>
void ExpectIsModel(const BroadPhase<View>& bodies, const BodyModel<View>& model,
                   std::uint64_t seed) {
  constexpr int kDims = View::Bound::kDimensions;
  Random random(seed);
  ExpectHasBodies(bodies, model);
  const std::uint64_t mask = std::array<std::uint64_t, 4>{
      ~std::uint64_t{0}, 1, 2, std::uint64_t{1} << 40 | 2}[random() % 4];
  const auto masked = model.Found(mask);
  const auto near = [&](float radius) {
    return Spread<View>(radius, random()).NextQuery();
  };
  const auto point = [&] {
    Point<kDims> p;
    for (float& x : p) x = static_cast<float>(random() % 1000) / 10 - 50;
    return p;
  };
  const auto shapes = [&](const auto& query) {
    ExpectFindsSame(bodies, model, masked, query, mask);
  };
  shapes(View::Query::Everything());
  for (const float radius : {0.5f, 5.0f, 30.0f}) {
    shapes(near(radius));
    shapes(Sphere<kDims>{point(), radius});
    shapes(Capsule<kDims>{point(), point(), radius});
  }
  shapes(point());
  shapes(Segment<kDims>{point(), point()});
  OrientedBox<kDims> box{};
  box.center = point();
  for (std::size_t k = 0; k < kDims; ++k) {
    box.axes[k][k] = 0.8f;
    box.axes[k][(k + 1) % kDims] = k == 0 ? 0.6f : -0.6f;
    box.half_extents[k] = static_cast<float>(random() % 20);
  }
  shapes(box);
  std::vector<HalfSpace<kDims>> half_spaces(random() % 4);
  for (auto& half_space : half_spaces) {
    half_space.normal = point();
    half_space.offset = static_cast<float>(random() % 1000);
  }
  shapes(half_spaces);

  Ray<kDims> ray;
  ray.origin = point();
  ray.direction = point();
  ray.max_t = random() % 2 == 0 ? 1.0f : 0.2f;
  ExpectCastsSame(
      model, masked,
      [&](const auto& function) { bodies.ForEachCast(ray, mask, function); },
      [&](const Bvh<View>& bvh, const auto& function) {
        RayCast(bvh, ray, function);
      });
  Aabb<kDims> moving;
  moving.min = moving.max = point();
  for (float& x : moving.max) x += 3;
  ExpectCastsSame(
      model, masked,
      [&](const auto& function) {
        bodies.ForEachCast(moving, ray.direction, 0.5f, mask, function);
      },
      [&](const Bvh<View>& bvh, const auto& function) {
        BoxCast(bvh, moving, ray.direction, 0.5f, function);
      });
}

// `masks` are those of the call, one for each element of the set, or none.
template <typename View>
void ExpectPairsOfSet(const BroadPhase<View>& bodies,
                      const BodyModel<View>& model, const Ids& set,
                      const std::vector<std::uint64_t>& masks, float margin) {
  std::vector<bool> is_in(bodies.max_ids());
  for (const std::uint32_t id : set) is_in[id] = true;
  const auto wants = [&](std::uint32_t id, std::uint32_t other) {
    const std::uint64_t category = model.objects.at(other).masks.category;
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (set[i] != id) continue;
      if (~masks[i] == 0 || (category & masks[i]) != 0) return true;
    }
    return false;
  };
  IdPairs expected;
  const IdPairs all =
      masks.empty()
          ? model.Pairs(margin)
          : model.PairsOf(margin, [&](std::uint32_t a, std::uint32_t b) {
              return wants(a, b) || wants(b, a);
            });
  for (const auto& [a, b] : all) {
    if (is_in[a] || is_in[b]) expected.emplace_back(a, b);
  }
  IdPairs found;
  const auto list = [&](std::uint32_t a, std::uint32_t b) {
    ASSERT_TRUE(is_in[a]);
    found.emplace_back(std::min(a, b), std::max(a, b));
  };
  if (masks.empty()) {
    bodies.ForEachPairOf(set, margin, list);
  } else {
    bodies.ForEachPairOf(set, masks, margin, list);
  }
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found, expected);
}

// The pairs that the events of UpdatePairs() add up to.
class PairsByEvents {
 public:
  template <typename View>
  void Update(BroadPhase<View>& bodies) {
    bodies.UpdatePairs(
        [&](std::uint32_t a, std::uint32_t b) {
          is_right_ &= pairs_.emplace(a, b).second;
        },
        [&](std::uint32_t a, std::uint32_t b) {
          is_right_ &= pairs_.erase({a, b}) == 1;
        });
  }

  IdPairs pairs() const {
    EXPECT_TRUE(is_right_) << "a pair began or ended twice";
    return {pairs_.begin(), pairs_.end()};
  }

 private:
  bool is_right_ = true;
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_BODIES_H_

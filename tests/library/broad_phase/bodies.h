// Bodies of every kind for the tests of broad phases, and the answers that a
// broad phase should give: those of a Bvh of a list of its bodies.
#ifndef HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_BODIES_H_
#define HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_BODIES_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/cases.h"

namespace halfspace::testing {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

using BroadPhaseCases =
    Tested<::testing::Types<Whole<AabbView2>, Whole<AabbView3>,
                            Whole<AaboView2>, Whole<AaboView3>>>;

// In order.
using IdPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

inline IdPairs PairsFrom(Span<const IdPair> pairs) {
  IdPairs list;
  for (const IdPair& pair : pairs) list.emplace_back(pair.a, pair.b);
  return list;
}

// Ids or pairs that a call found, and the bits of what it said of them.
using Answers = std::vector<std::array<std::uint32_t, 3>>;

inline std::uint32_t WordOf(float value) {
  return std::bit_cast<std::uint32_t>(value == 0 ? 0 : value);
}

// How objects of a world are called: here as the bodies.
struct OwnNames {
  static std::uint32_t Of(std::uint32_t object) { return object; }
  static std::uint32_t At(std::uint32_t body) { return body; }
};

// A Bvh of bodies, in the order of their ids.
template <typename View>
struct Reference {
  Bvh<View> bvh;
  Ids ids;

  std::uint32_t Of(std::uint32_t object) const { return ids.at(object); }
  std::uint32_t At(std::uint32_t body) const {
    return static_cast<std::uint32_t>(
        std::lower_bound(ids.begin(), ids.end(), body) - ids.begin());
  }
};

template <typename View>
struct BodyModel {
  using Bound = typename View::Bound;
  struct Object {
    Bound bound;
    BodyMasks masks;
    Bound seen;  // by queries
  };
  std::map<std::uint32_t, Object> objects;
  bool moves_wait = false;
  bool (*keep)(void*, std::uint32_t, std::uint32_t, bool) = nullptr;

  void Insert(std::uint32_t id, const Bound& bound,
              const BodyMasks& masks = {}) {
    objects[id] = {bound, masks, bound};
  }
  void Move(std::uint32_t id, const Bound& bound) {
    Object& object = objects.at(id);
    object.bound = bound;
    if (!moves_wait) object.seen = bound;
  }
  void Update() {
    for (auto& [id, object] : objects) object.seen = object.bound;
  }

  Reference<View> Seen() const {
    std::vector<Bound> bounds;
    Ids ids;
    std::vector<std::uint32_t> categories;
    for (const auto& [id, object] : objects) {
      ids.push_back(id);
      bounds.push_back(object.seen);
      categories.push_back(object.masks.category);
    }
    Reference<View> reference{Bvh<View>(bounds), std::move(ids)};
    reference.bvh.SetMasks(categories);
    return reference;
  }

  // Those of UpdatePairs(), after Update().
  IdPairs Pairs() const {
    const Reference<View> reference = Seen();
    IdPairs pairs;
    ForEachPair(reference.bvh, [&](Span<const IdPair> some) {
      for (const IdPair& pair : some) {
        const auto [low, high] = std::minmax(pair.a, pair.b);
        const std::uint32_t a = reference.Of(low);
        const std::uint32_t b = reference.Of(high);
        const BodyMasks& of_a = objects.at(a).masks;
        const BodyMasks& of_b = objects.at(b).masks;
        const bool matches = (of_a.category & of_b.collides_with) != 0 &&
                             (of_b.category & of_a.collides_with) != 0;
        if (keep == nullptr ? matches : keep(nullptr, a, b, matches)) {
          pairs.emplace_back(a, b);
        }
      }
    });
    std::sort(pairs.begin(), pairs.end());
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
    constexpr std::uint32_t kBits[] = {0, 1, 2, std::uint32_t{1} << 31};
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

// What all calls of one query find.
template <typename World, typename Names, typename Query>
Answers FoundBy(const World& world, const Names& names, const Query& query,
                const QueryOptions& options) {
  Ids found;
  ForEachSurvivor(
      world, query,
      [&](Span<const std::uint32_t> some) {
        found.insert(found.end(), some.begin(), some.end());
      },
      options);
  std::size_t calls = 0;
  ForEachSurvivor(
      world, query,
      [&](Span<const std::uint32_t>) {
        ++calls;
        return Visit::kStop;
      },
      options);
  EXPECT_EQ(calls, found.empty() ? 0 : 1);
  EXPECT_EQ(CountSurvivors(world, query, options), found.size());
  Ids listed(found.size() + 1);
  const std::size_t skip = found.size() / 3;
  EXPECT_EQ(Survivors(world, query, listed, options), found.size());
  listed.resize(found.size());
  EXPECT_EQ(InOrder(listed), InOrder(found));
  Ids rest(found.size() / 2);
  EXPECT_EQ(Survivors(world, query, rest, options, skip), found.size());
  for (std::size_t i = 0; i < rest.size() && skip + i < listed.size(); ++i) {
    EXPECT_EQ(rest[i], listed[skip + i]);
  }
  const auto any = AnySurvivor(world, query, options);
  EXPECT_EQ(any.has_value(), !found.empty());
  if (any.has_value()) {
    EXPECT_NE(std::find(found.begin(), found.end(), *any), found.end());
  }
  Answers answers;
  for (const std::uint32_t object : found) {
    answers.push_back({names.Of(object), 0, 0});
  }
  return answers;
}

// What a cast finds, of all hits and of the nearest. `cast` takes a function.
template <typename View, typename Names, typename Cast>
Answers HitBy(const Names& names, const Cast& cast) {
  Answers answers;
  float first = std::numeric_limits<float>::infinity();
  cast([&](std::uint32_t object, float t, const typename View::Bound& bound) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < View::Bound::kAxes; ++k) {
      bits = 31 * bits + std::bit_cast<std::uint32_t>(bound.min[k]);
      if constexpr (HasMaxima<View>) {
        bits = 31 * bits + std::bit_cast<std::uint32_t>(bound.max[k]);
      }
    }
    answers.push_back({names.Of(object), WordOf(t), bits});
    first = std::min(first, t);
  });
  float nearest = std::numeric_limits<float>::infinity();
  cast([&](std::uint32_t, float t, const auto&) {
    EXPECT_LE(t, nearest + 0x1p-100f);  // see RayCast()
    nearest = std::min(nearest, t);
    return Limit{nearest};
  });
  EXPECT_EQ(nearest, first);
  std::size_t calls = 0;
  cast([&](std::uint32_t, float, const auto&) {
    ++calls;
    return Visit::kStop;
  });
  EXPECT_EQ(calls, answers.empty() ? 0 : 1);
  return answers;
}

// Calls visit(ask) for questions of every kind. ask(world, names) returns the
// answers of a broad phase or of a Bvh. `ids` are those of some bodies.
// is_finite(id) says whether a body has a bound without an infinity.
template <typename View, typename IsFinite, typename Visit>
void ForEachQuestion(std::uint64_t seed, const Ids& ids,
                     const IsFinite& is_finite, const Visit& visit) {
  constexpr int kDims = View::Bound::kDimensions;
  Random random(seed);
  QueryOptions options;
  options.mask = std::array<std::uint32_t, 4>{
      ~std::uint32_t{0}, 1, 2, std::uint32_t{1} << 31 | 2}[random() % 4];
  SearchOptions search;
  search.mask = options.mask;
  const auto near = [&](float radius) {
    return Spread<View>(radius, random()).NextQuery();
  };
  const auto point = [&] {
    Point<kDims> p;
    for (float& x : p) x = static_cast<float>(random() % 1000) / 10 - 50;
    return p;
  };
  const auto find = [&](const auto& query) {
    visit([&](const auto& world, const auto& names) {
      return FoundBy(world, names, query, options);
    });
  };
  find(View::Query::Everything());
  for (const float radius : {0.5f, 5.0f, 30.0f}) find(near(radius));
  find(Sphere<kDims>{point(), 5});
  find(Capsule<kDims>{point(), point(), 9});
  find(point());
  find(Segment<kDims>{point(), point()});
  OrientedBox<kDims> box{};
  box.center = point();
  for (std::size_t k = 0; k < kDims; ++k) {
    box.axes[k][k] = 0.8f;
    box.axes[k][(k + 1) % kDims] = k == 0 ? 0.6f : -0.6f;
    box.half_extents[k] = static_cast<float>(random() % 20);
  }
  find(box);
  std::vector<HalfSpace<kDims>> half_spaces(1 + random() % 3);
  for (auto& half_space : half_spaces) {
    half_space.normal = point();
    half_space.offset = static_cast<float>(random() % 1000);
  }
  find(half_spaces);

  const std::vector<typename View::Query> several = {near(3), near(20),
                                                     near(200), near(1)};
  visit([&](const auto& world, const auto& names) {
    std::vector<std::size_t> offsets(several.size() + 1);
    Ids found(several.size() * (ids.size() + world.size()));
    EXPECT_LE(SurvivorsOfEach(world, several, found, offsets, options),
              found.size());
    Answers answers;
    for (std::uint32_t q = 0; q < several.size(); ++q) {
      for (std::size_t i = offsets[q]; i < offsets[q + 1]; ++i) {
        answers.push_back({names.Of(found[i]), q, 0});
      }
    }
    return answers;
  });

  const auto nearest = [&](const auto& of) {
    for (const std::size_t most : {std::size_t{5}, std::size_t{100'000}}) {
      visit([&](const auto& world, const auto& names) {
        const float limit = most == 5 ? kInfinity : 40.0f;
        Ids found(std::min(most, world.size() + 1));
        std::vector<float> distances(found.size());
        const std::size_t count =
            KNearest(world, of, found, distances, limit, search);
        Answers answers;
        for (std::size_t i = 0; i < count; ++i) {
          // Which of those that are equally far is found depends on the order.
          answers.push_back(
              {most == 5 ? 0 : names.Of(found[i]), WordOf(distances[i]), 0});
        }
        return answers;
      });
    }
  };
  nearest(point());
  Aabb<kDims> moving;
  moving.min = moving.max = point();
  for (float& x : moving.max) x += 3;
  nearest(moving);

  const Ray<kDims> ray{point(), point(), random() % 2 == 0 ? 1.0f : 0.2f};
  const Sphere<kDims> ball{point(), 2.5f};
  visit([&](const auto& world, const auto& names) {
    return HitBy<View>(
        names, [&](const auto& call) { RayCast(world, ray, call, search); });
  });
  visit([&](const auto& world, const auto& names) {
    return HitBy<View>(names, [&](const auto& call) {
      RayCast(world, ray, 1.5f, call, search);
    });
  });
  visit([&](const auto& world, const auto& names) {
    return HitBy<View>(names, [&](const auto& call) {
      BoxCast(world, moving, ray.direction, 0.5f, call, search);
    });
  });
  visit([&](const auto& world, const auto& names) {
    return HitBy<View>(names, [&](const auto& call) {
      SphereCast(world, ball, ray.direction, ray.max_t, call, search);
    });
  });

  Ids set;
  for (std::size_t i = 0; i < 3 + random() % 100 && !ids.empty(); ++i) {
    set.push_back(ids[random() % ids.size()]);
  }
  std::vector<std::uint32_t> wanted;
  if (random() % 2 == 0) {
    for (std::size_t i = 0; i < set.size(); ++i) {
      wanted.push_back(random() % 4 == 0 ? ~std::uint32_t{0} : random() % 4);
    }
  }
  PairOptions pair_options;
  pair_options.mask = options.mask;
  pair_options.wanted = wanted;
  if (random() % 2 == 0) pair_options.margin = 0.7f;
  visit([&](const auto& world, const auto& names) {
    Ids named;
    for (const std::uint32_t id : set) named.push_back(names.At(id));
    std::vector<IdPair> found(PairsOf(world, named, {}, pair_options));
    EXPECT_EQ(PairsOf(world, named, found, pair_options), found.size());
    std::size_t next = 0;
    ForEachPairOf(
        world, named,
        [&](Span<const IdPair> some) {
          for (const IdPair& pair : some) EXPECT_EQ(pair, found.at(next++));
        },
        pair_options);
    EXPECT_EQ(next, found.size());
    Answers answers;
    for (const IdPair& pair : found) {
      EXPECT_NE(std::find(named.begin(), named.end(), pair.a), named.end());
      // Everything() grown by a margin ends at infinity, where others begin. It
      // depends on the order which of two bounds is grown.
      if (pair_options.margin != 0 &&
          !(is_finite(names.Of(pair.a)) && is_finite(names.Of(pair.b)))) {
        continue;
      }
      const std::uint32_t a = names.Of(pair.a);
      const std::uint32_t b = names.Of(pair.b);
      answers.push_back({std::min(a, b), std::max(a, b), 0});
    }
    return answers;
  });
}

// A broad phase answers as a Bvh does.
template <typename View, typename Ask>
void ExpectAnswer(const BroadPhase<View>& bodies,
                  const Reference<View>& reference, const Ask& ask) {
  Answers found = ask(bodies, OwnNames());
  Answers expected = ask(reference.bvh, reference);
  std::sort(found.begin(), found.end());
  std::sort(expected.begin(), expected.end());
  Answers wrong;  // by one of them alone
  std::set_symmetric_difference(found.begin(), found.end(), expected.begin(),
                                expected.end(), std::back_inserter(wrong));
  ASSERT_EQ(wrong, Answers()) << found.size() << " of " << expected.size();
}

template <typename View>
void ExpectAnswers(const BroadPhase<View>& bodies, const BodyModel<View>& model,
                   std::uint64_t seed) {
  const Reference<View> reference = model.Seen();
  ASSERT_EQ(bodies.size(), reference.ids.size());
  std::size_t question = 0;
  const auto is_finite = [&](std::uint32_t id) {
    const auto& bound = model.objects.at(id).seen;
    const auto is_infinite = [](float x) { return std::isinf(x); };
    return std::none_of(bound.min.begin(), bound.min.end(), is_infinite) &&
           std::none_of(bound.max.begin(), bound.max.end(), is_infinite);
  };
  ForEachQuestion<View>(seed, reference.ids, is_finite, [&](const auto& ask) {
    SCOPED_TRACE(question++);
    ExpectAnswer(bodies, reference, ask);
  });
  const auto all = bodies.Bounds();
  for (const auto& [id, object] : model.objects) {
    ASSERT_TRUE(bodies.Has(id)) << id;
    ExpectSameBounds<View>(bodies.Get(id), object.bound);
    ASSERT_EQ(bodies.MasksOf(id), object.masks);
    ASSERT_LT(id, bodies.id_limit());
    for (std::size_t k = 0; k < View::Bound::kAxes; ++k) {
      const float min = object.seen.min[k];
      const float max = object.seen.max[k];
      ASSERT_LE(all.min[k], std::isnan(min) ? -kInfinity : min);
      ASSERT_GE(all.max[k], std::isnan(max) ? kInfinity : max);
    }
  }
}

// Two broad phases answer the same, in the same order.
template <typename View>
void ExpectSameOrder(const BroadPhase<View>& a, const BroadPhase<View>& b,
                     const Ids& ids, std::uint64_t seed) {
  const auto is_finite = [](std::uint32_t) { return true; };
  ForEachQuestion<View>(seed, ids, is_finite, [&](const auto& ask) {
    ASSERT_EQ(ask(a, OwnNames()), ask(b, OwnNames()));
  });
  ASSERT_EQ(PairsFrom(a.pairs()), PairsFrom(b.pairs()));
  ASSERT_EQ(PairsFrom(a.began()), PairsFrom(b.began()));
  ASSERT_EQ(PairsFrom(a.ended()), PairsFrom(b.ended()));
  ASSERT_EQ(a.id_limit(), b.id_limit());
}

// With the calls that run alone.
template <typename View>
void ExpectIsModel(const BroadPhase<View>& bodies, BodyModel<View>& model,
                   std::uint64_t seed) {
  ExpectAnswers(bodies, model, seed);
  ASSERT_TRUE(bodies.Validate());
  model.Update();
  ASSERT_EQ(bodies.Statistics().bodies, model.objects.size());
}

// The pairs that the events of UpdatePairs() add up to.
class PairsByEvents {
 public:
  template <typename View>
  void Add(const BroadPhase<View>& bodies) {
    for (const IdPair& pair : bodies.ended()) {
      is_right_ &= pairs_.erase({pair.a, pair.b}) == 1;
    }
    for (const IdPair& pair : bodies.began()) {
      is_right_ &= pairs_.emplace(pair.a, pair.b).second;
    }
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

// Searches for the nearest objects: those of a sorted list of all, in its
// order, on every target and of every kind of world.

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/shape_reference.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kMost = std::numeric_limits<float>::max();

struct Found {
  std::uint32_t id;
  float value;
  friend bool operator==(const Found&, const Found&) = default;
};

// All objects with a key up to a limit, by key and then in the world's order.
template <typename View, typename KeyOf>
std::vector<Found> Expected(const Bvh<View>& bvh,
                            std::span<const typename View::Bound> bounds,
                            float limit, const KeyOf& key_of) {
  std::vector<Found> found;
  for (std::uint32_t id : bvh.ids()) {
    if (id == kNoId) continue;
    const float key = key_of(PlanesOf<View>(bounds[id]));
    if (key <= std::min(limit, kMost)) found.push_back({id, key});
  }
  std::stable_sort(
      found.begin(), found.end(),
      [](const Found& a, const Found& b) { return a.value < b.value; });
  return found;
}

// The squared distance up to which objects are found.
float SquaredLimit(float distance) {
  const double squared = double{distance} * distance;
  return static_cast<float>(
      std::min(squared * (1 + 0x1p-20) + 0x1p-148, double{kMost}));
}

template <typename View>
float SquaredDistanceOf(const PlaneValues<View>& planes,
                        const Aabb<View::Bound::kDimensions>& query) {
  float sum = 0;
  for (std::size_t k = 0; k < query.min.size(); ++k) {
    float gap = planes[k] - query.max[k];
    if (!(gap > 0)) gap = 0;
    if constexpr (HasMaxima<View>) {
      const float above = query.min[k] - planes[View::Bound::kAxes + k];
      if (above > gap) gap = above;
    }
    sum = sum + gap * gap;
  }
  return sum;
}

// Of a point, both corners of the query are the point.
template <typename View>
std::vector<Found> ExpectedNearest(const Bvh<View>& bvh,
                                   std::span<const typename View::Bound> bounds,
                                   const Aabb<View::Bound::kDimensions>& query,
                                   float max_distance) {
  return Expected(bvh, bounds, SquaredLimit(max_distance),
                  [&](const PlaneValues<View>& planes) {
                    return SquaredDistanceOf<View>(planes, query);
                  });
}

// A line's objects in the order of a search: of the children of a node those
// that the line enters first, and then in the world's order.
template <typename View>
class NearFirst {
 public:
  NearFirst(const Bvh<View>& bvh, std::span<const typename View::Bound> bounds,
            const detail::Line& line)
      : ids_(bvh.ids()), bounds_(bounds), line_(line) {
    std::size_t objects = 64;
    while (objects < ids_.size()) objects *= 64;
    if (!ids_.empty()) Visit(0, objects);
  }

  const std::vector<Found>& found() const { return found_; }

 private:
  struct Child {
    float enters;
    std::size_t slot;
  };

  // The slots from `first` on, of a node of so many.
  void Visit(std::size_t first, std::size_t objects) {
    const std::size_t step = objects / 64;
    std::vector<Child> children;
    for (std::size_t i = 0; i < 64 && first + i * step < ids_.size(); ++i) {
      const std::size_t slot = first + i * step;
      const float enters = EntryOf(PlanesOfSlots(slot, step), line_);
      if (enters <= kMost) children.push_back({enters, slot});
    }
    std::stable_sort(
        children.begin(), children.end(),
        [](const Child& a, const Child& b) { return a.enters < b.enters; });
    for (const Child& child : children) {
      if (step > 1) {
        Visit(child.slot, step);
      } else if (ids_[child.slot] != kNoId) {
        found_.push_back({ids_[child.slot], child.enters});
      }
    }
  }

  PlaneValues<View> PlanesOfSlots(std::size_t first, std::size_t count) const {
    PlaneValues<View> of_all;
    for (std::size_t p = 0; p < of_all.size(); ++p) {
      of_all[p] = IsMinPlane<View>(p) ? kInf : -kInf;
    }
    for (std::size_t s = first; s < std::min(first + count, ids_.size()); ++s) {
      if (ids_[s] == kNoId) continue;
      const auto values = PlanesOf<View>(bounds_[ids_[s]]);
      if (count == 1) return values;
      for (std::size_t p = 0; p < values.size(); ++p) {
        // What is no number limits nothing.
        const float outermost = IsMinPlane<View>(p) ? -kInf : kInf;
        const float value = std::isnan(values[p]) ? outermost : values[p];
        of_all[p] = IsMinPlane<View>(p) ? std::min(of_all[p], value)
                                        : std::max(of_all[p], value);
      }
    }
    return of_all;
  }

  Span<const std::uint32_t> ids_;
  std::span<const typename View::Bound> bounds_;
  detail::Line line_;
  std::vector<Found> found_;
};

template <typename View>
std::vector<Found> ExpectedAlong(
    const Bvh<View>& bvh, std::span<const typename View::Bound> bounds,
    const Aabb<View::Bound::kDimensions>& box,
    const Point<View::Bound::kDimensions>& direction, float max_t,
    float radius) {
  double low[3] = {};
  double high[3] = {};
  double directions[3] = {};
  for (std::size_t k = 0; k < direction.size(); ++k) {
    if (box.min[k] > box.max[k]) return {};
    low[k] = box.min[k];
    high[k] = box.max[k];
    directions[k] = direction[k];
  }
  detail::Line line;
  detail::MakeLine(detail::kLayoutOf<typename View::Bound>, low, high,
                   directions, max_t, radius, line);
  line.max_t = std::min(line.max_t, kMost);
  return NearFirst<View>(bvh, bounds, line).found();
}

template <typename View>
void ExpectNearest(const Bvh<View>& bvh,
                   std::span<const typename View::Bound> bounds,
                   const Point<View::Bound::kDimensions>& point,
                   float max_distance, Target target) {
  const auto squared =
      ExpectedNearest(bvh, bounds, {point, point}, max_distance);
  std::vector<Found> expected = squared;
  for (Found& one : expected) one.value = std::sqrt(one.value);
  const SearchOptions options = {.target = target};
  // With and without distances: of more than 2048 ids alone, half are found at
  // once.
  for (std::size_t room : {1u, 8u, 63u, 64u, 700u, 3000u, 9000u}) {
    Ids ids(room);
    std::vector<float> distances(room);
    const std::size_t count =
        KNearest(bvh, point, ids, distances, max_distance, options);
    ASSERT_EQ(count, std::min(room, expected.size()));
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ((Found{ids[i], distances[i]}), expected[i]) << i;
    }
    Ids alone(room);
    ASSERT_EQ(KNearest(bvh, point, alone, {}, max_distance, options), count);
    ASSERT_TRUE(std::equal(ids.begin(), ids.begin() + count, alone.begin()));
  }
  std::vector<Found> found;
  ForEachNearest(
      bvh, point, max_distance,
      [&](std::uint32_t id, float distance) {
        found.push_back({id, distance});
      },
      options);
  ASSERT_EQ(found, expected);
  // Ends after some, and by a bound that shrinks.
  for (std::size_t some : {1u, 8u, 9u, 30u}) {
    found.clear();
    ForEachNearest(
        bvh, point, max_distance,
        [&](std::uint32_t id, float distance) {
          found.push_back({id, distance});
          return found.size() < some ? Visit::kContinue : Visit::kStop;
        },
        options);
    ASSERT_EQ(found.size(), std::min(some, expected.size()));
    ASSERT_TRUE(std::equal(found.begin(), found.end(), expected.begin()));
    found.clear();
    ForEachNearest(
        bvh, point, max_distance,
        [&](std::uint32_t id, float distance) {
          found.push_back({id, distance});
          return Limit{found.size() < some ? 2 * distance + 1 : distance};
        },
        options);
    float limit = kInf;
    std::size_t count = 0;
    while (count < expected.size()) {
      const float distance = expected[count].value;
      if (squared[count].value > SquaredLimit(limit)) break;
      ++count;
      limit = std::min(limit, count < some ? 2 * distance + 1 : distance);
    }
    ASSERT_EQ(found.size(), count);
    ASSERT_TRUE(std::equal(found.begin(), found.end(), expected.begin()));
  }
}

// Boxes, and several points or boxes in one call.
template <typename View>
void ExpectNearestToBoxes(const Bvh<View>& bvh,
                          std::span<const typename View::Bound> bounds,
                          const Aabb<View::Bound::kDimensions>& box,
                          float max_distance, Target target) {
  constexpr int kDims = View::Bound::kDimensions;
  const SearchOptions options = {.target = target};
  const std::vector<Aabb<kDims>> boxes = {
      box, {box.min, box.min}, Aabb<kDims>::Empty(), box};
  const std::vector<Point<kDims>> points = {box.max, box.min, box.max};
  const auto expect_row = [&](const Aabb<kDims>& query, std::size_t k,
                              const std::uint32_t* ids,
                              const float* distances) {
    const auto expected =
        ExpectedNearest<View>(bvh, bounds, query, max_distance);
    for (std::size_t i = 0; i < k; ++i) {
      const Found one =
          i < expected.size()
              ? Found{expected[i].id, std::sqrt(expected[i].value)}
              : Found{kNoId, kInf};
      ASSERT_EQ((Found{ids[i], distances[i]}), one) << i;
    }
  };
  for (std::size_t k : {0u, 1u, 9u, 2100u}) {
    Ids ids(boxes.size() * k);
    std::vector<float> distances(ids.size());
    KNearestOfEach(bvh, Span<const Aabb<kDims>>(boxes), k, ids, distances,
                   max_distance, options);
    for (std::size_t q = 0; q < boxes.size(); ++q) {
      expect_row(boxes[q], k, ids.data() + q * k, distances.data() + q * k);
    }
    Ids alone(ids.size());
    KNearestOfEach(bvh, boxes, k, alone, {}, max_distance, options);
    ASSERT_EQ(alone, ids);
    ids.resize(k);
    distances.resize(k);
    const std::size_t count =
        KNearest(bvh, box, ids, distances, max_distance, options);
    std::fill(ids.begin() + count, ids.end(), kNoId);
    std::fill(distances.begin() + count, distances.end(), kInf);
    expect_row(box, k, ids.data(), distances.data());
    ids.resize(points.size() * k);
    distances.resize(points.size() * k);
    KNearestOfEach(bvh, points, k, ids, distances, max_distance, options);
    for (std::size_t q = 0; q < points.size(); ++q) {
      expect_row({points[q], points[q]}, k, ids.data() + q * k,
                 distances.data() + q * k);
    }
    if (::testing::Test::HasFatalFailure()) FAIL() << k << " of each";
  }
}

// call(function) casts.
template <typename Call>
void ExpectFound(const Call& call, const std::vector<Found>& expected) {
  std::vector<Found> found;
  call([&](std::uint32_t id, float t) { found.push_back({id, t}); });
  ASSERT_EQ(found, expected);
  for (std::size_t some : {1u, 5u}) {
    found.clear();
    call([&](std::uint32_t id, float t) {
      found.push_back({id, t});
      return found.size() < some ? Visit::kContinue : Visit::kStop;
    });
    ASSERT_EQ(found.size(), std::min(some, expected.size()));
    ASSERT_TRUE(std::equal(found.begin(), found.end(), expected.begin()));
  }
  // The closest, by limits of which some are farther than the last.
  float limit = kInf;
  std::vector<Found> within;
  const auto next_limit = [&](float t) {
    return within.size() % 3 == 2 ? kInf : within.size() % 3 == 1 ? t : 2 * t;
  };
  for (const Found& one : expected) {
    if (one.value > limit + detail::kApartOnLine) continue;
    within.push_back(one);
    limit = std::min(limit, next_limit(one.value));
  }
  const std::vector<Found> expected_within = std::move(within);
  within.clear();
  call([&](std::uint32_t id, float t) {
    within.push_back({id, t});
    return Limit{next_limit(t)};
  });
  ASSERT_EQ(within, expected_within);
}

template <typename View>
void ExpectAlong(const Bvh<View>& bvh,
                 std::span<const typename View::Bound> bounds,
                 const Ray<View::Bound::kDimensions>& ray, float radius,
                 Target target) {
  const SearchOptions options = {.target = target};
  ExpectFound(
      [&](auto&& function) { RayCast(bvh, ray, radius, function, options); },
      ExpectedAlong(bvh, bounds, {ray.origin, ray.origin}, ray.direction,
                    ray.max_t, radius));
  Aabb<View::Bound::kDimensions> box = {ray.origin, ray.origin};
  for (std::size_t k = 0; k < box.min.size(); ++k) {
    box.max[k] += static_cast<float>(k) * radius;
  }
  ExpectFound(
      [&](auto&& function) {
        BoxCast(bvh, box, ray.direction, ray.max_t, function, options);
      },
      ExpectedAlong(bvh, bounds, box, ray.direction, ray.max_t, 0));
}

template <typename View>
void ExpectAll(const Bvh<View>& bvh,
               std::span<const typename View::Bound> bounds, Random& random,
               bool is_special = false) {
  constexpr int kDims = View::Bound::kDimensions;
  std::uniform_real_distribution<float> coordinate(-60.0f, 60.0f);
  const auto any = [&] {
    return is_special && random() % 6 == 0 ? SpecialValue<float>(random)
                                           : coordinate(random);
  };
  for (Target target : TargetsUnderTest()) {
    for (float limit : {kInf, 30.0f, 0.0f}) {
      Point<kDims> point;
      Ray<kDims> ray;
      for (std::size_t k = 0; k < kDims; ++k) {
        point[k] = any();
        ray.origin[k] = any();
        ray.direction[k] = random() % 5 == 0 ? 0.0f : any();
      }
      ray.max_t = limit == 30.0f ? 0.5f : limit;
      ExpectNearest<View>(bvh, bounds, point, limit, target);
      Aabb<kDims> box = {point, point};
      for (float& x : box.max) x += 10 * std::abs(any());
      ExpectNearestToBoxes<View>(bvh, bounds, box, limit, target);
      ExpectAlong<View>(bvh, bounds, ray, random() % 2 == 0 ? 0.0f : 2.0f,
                        target);
      if (::testing::Test::HasFatalFailure()) {
        FAIL() << bvh.size() << " objects, limit " << limit << ", "
               << target.name();
      }
    }
  }
}

template <typename Case>
class BvhNearestTest : public ::testing::Test {};
TYPED_TEST_SUITE(BvhNearestTest, BvhCases, CaseNames);

TYPED_TEST(BvhNearestTest, IsASortedList) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  Random random(1);
  Spread<View> spread(1.0f);
  const auto one = spread.NextObject();
  using Next = std::function<Bound(std::size_t)>;
  struct Case {
    std::size_t size;
    Next next;
  };
  const Next near = [&](std::size_t) { return spread.NextObject(); };
  std::vector<Case> cases = {
      {0, near},
      {1, near},
      {63, near},
      {64, near},
      {65, near},
      {4097, near},
      {random() % 9000, near},
      {1000, [&](std::size_t) { return one; }},
      {1000, [](std::size_t) { return Bound::Everything(); }},
      {300, [](std::size_t) { return Bound::Empty(); }},
      // A lattice, where many are at the same distance.
      {4500,
       [&](std::size_t i) {
         Bound bound = one;
         for (std::size_t p = 0; p < kPlanes<View>; ++p) {
           const std::size_t k = p % Bound::kAxes;
           StoredValue<View>(bound, p) = static_cast<float>((i >> 4 * k) % 16) +
                                         (IsMinPlane<View>(p) ? 0.0f : 1.0f);
         }
         return bound;
       }},
      {900, [&](std::size_t i) {
         Bound bound = i % 5 == 0 ? Bound::Everything() : spread.NextObject();
         for (std::size_t p = 0; p < kPlanes<View>; ++p) {
           if (random() % 6 == 0) {
             StoredValue<View>(bound, p) = SpecialValue<float>(random);
           }
         }
         return bound;
       }}};
  for (const Case& one_case : cases) {
    std::vector<Bound> bounds;
    for (std::size_t i = 0; i < one_case.size; ++i) {
      bounds.push_back(one_case.next(i));
    }
    for (BuildQuality quality : {BuildQuality::kHigh, BuildQuality::kFast}) {
      const Bvh<View> bvh(std::span<const Bound>(bounds), {.quality = quality});
      ExpectAll<View>(bvh, bounds, random, one_case.size == 900);
      if (this->HasFatalFailure()) return;
    }
  }
}

TYPED_TEST(BvhNearestTest, KnowsErasedObjectsAndMasks) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  Random random(2);
  Spread<View> spread(1.0f);
  std::vector<Bound> bounds;
  for (std::size_t i = 0; i < 5000; ++i) bounds.push_back(spread.NextObject());
  Bvh<View> bvh((std::span<const Bound>(bounds)));
  for (std::uint32_t i = 0; i < 5000; i += 3) bvh.Erase(i);
  for (std::size_t i = 0; i < 700; ++i) {
    const Bound bound = spread.NextObject();
    bounds[bvh.Insert(bound)] = bound;
  }
  ExpectAll<View>(bvh, bounds, random);
  Ids masks(5000);
  for (std::uint32_t i = 0; i < 5000; ++i) masks[i] = 1u << i % 3;
  bvh.SetMasks(masks);
  const Point<Bound::kDimensions> point{};
  auto all = ExpectedNearest<View>(bvh, bounds, {point, point}, 50.0f);
  for (Found& one : all) one.value = std::sqrt(one.value);
  for (Target target : TargetsUnderTest()) {
    std::vector<Found> found;
    ForEachNearest(bvh, point, 50.0f,
                   [&](std::uint32_t id, float distance) {
                     found.push_back({id, distance});
                   },
                   {.mask = 2, .target = target});
    const auto of_mask = [](const std::vector<Found>& any) {
      std::vector<Found> wanted;
      std::copy_if(any.begin(), any.end(), std::back_inserter(wanted),
                   [](const Found& one) { return one.id % 3 == 1; });
      return wanted;
    };
    EXPECT_EQ(found, of_mask(all));
    Ray<Bound::kDimensions> ray = {{}, {}, 50};
    for (float& x : ray.direction) x = 1;
    found.clear();
    RayCast(bvh, ray, 5.0f,
            [&](std::uint32_t id, float t) {
              found.push_back({id, t});
            },
            {.mask = 2, .target = target});
    EXPECT_EQ(found, of_mask(ExpectedAlong<View>(bvh, bounds, {point, point},
                                                 ray.direction, 50, 5)));
    EXPECT_FALSE(found.empty());
  }
}

TEST(BvhNearestKnownTest, Distances) {
  AabbWorld3 world;
  world.Push({{0, 0, 0}, {1, 1, 1}});
  world.Push({{5, 0, 0}, {6, 1, 1}});
  world.Push({{-4, -5, 0}, {-3, -4, 1}});
  const AabbBvh3 bvh(world);
  Ids ids(3);
  std::vector<float> distances(3);
  ASSERT_EQ(KNearest(bvh, {0, 0, 0.5f}, ids, distances), 3u);
  EXPECT_EQ(ids, (Ids{0, 1, 2}));
  EXPECT_EQ(distances, (std::vector<float>{0, 5, 5}));
  EXPECT_EQ(KNearest(bvh, {0, 0, 0}, ids, {}, 4.9f), 1u);
  std::vector<float> entries;
  RayCast(bvh, Ray3{{0.5f, 0.5f, 0.5f}, {2, 0, 0}, kInf},
          [&](std::uint32_t, float t) { entries.push_back(t); });
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0], 0.0f);
  EXPECT_NEAR(entries[1], 2.25f, 1e-5f);
  EXPECT_LE(entries[1], 2.25f);
}

// Points at distances from 2^-76 to beyond 2^64: as near to the exact distances
// as the header says, found up to a limit that is theirs, and the same in all
// modes.
TEST(BvhNearestKnownTest, DistancesOfAllSizesInAllFloatingPointModes) {
  constexpr std::size_t kPoints = 12;
  Random random(3);
  for (int exponent = -76; exponent <= 64; ++exponent) {
    std::uniform_real_distribution<float> share(0.5f, 1.0f);
    const auto any = [&] { return std::ldexp(share(random), exponent); };
    Point3 center{};
    if (exponent % 3 == 0) center = {any(), any(), -any()};
    std::vector<Aabb3> bounds;
    std::vector<double> exact;
    std::vector<float> limits = {kInf};
    for (std::size_t i = 0; i < kPoints; ++i) {
      Point3 p = center;
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        if (i % 4 != k) p[k] += random() % 2 == 0 ? any() : -any();
        const double gap = double{p[k]} - center[k];
        squared += gap * gap;
      }
      bounds.push_back({p, p});
      exact.push_back(std::sqrt(squared));
      // It is found up to the first, and not up to the second.
      const double too_near = (exact[i] - 0x1p-73) / (1 + 0x1p-18);
      limits.push_back(std::nextafter(static_cast<float>(exact[i]), kInf));
      limits.push_back(
          std::max(std::nextafter(static_cast<float>(too_near), -kInf), 0.0f));
    }
    const AabbBvh3 bvh((std::span<const Aabb3>(bounds)));
    const Ray3 ray = {center, {any(), -any(), any()}, kInf};
    const float radius = any();
    for (Target target : TargetsUnderTest()) {
      const SearchOptions options = {.target = target};
      const auto answer = [&] {
        std::vector<std::vector<Found>> answers;
        for (float limit : limits) {
          Ids ids(kPoints);
          std::vector<float> distances(kPoints);
          const std::size_t count =
              KNearest(bvh, center, ids, distances, limit, options);
          auto& found = answers.emplace_back();
          for (std::size_t i = 0; i < count; ++i) {
            found.push_back({ids[i], distances[i]});
          }
        }
        const auto append = [&](std::uint32_t id, float value) {
          answers.back().push_back({id, value});
          return Limit{value};
        };
        answers.emplace_back();
        ForEachNearest(bvh, center, kInf, append, options);
        answers.emplace_back();
        RayCast(bvh, ray, radius, append, options);
        return answers;
      };
      const auto answers = answer();
      for (const Found& one : answers[0]) {
        EXPECT_NEAR(one.value, exact[one.id],
                    exact[one.id] * 0x1p-20 + 0x1p-73);
      }
      for (std::size_t i = 0; i < kPoints; ++i) {
        const auto is_found = [&](std::size_t a) {
          return std::any_of(answers[a].begin(), answers[a].end(),
                             [&](const Found& one) { return one.id == i; });
        };
        const bool is_near = exact[i] <= 0x1p64 * (1 - 0x1p-20);
        if (is_near || exact[i] >= 0x1p64) {
          EXPECT_EQ(is_found(0), is_near) << exact[i];
          EXPECT_EQ(is_found(1 + 2 * i), is_near) << exact[i];
        }
        const bool is_beyond = exact[i] > 0x1p-73;
        EXPECT_FALSE(is_beyond && is_found(2 + 2 * i)) << exact[i];
      }
      std::vector<decltype(answer())> others;
      for (int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        const RoundingMode rounding(mode);
        others.push_back(answer());
        const FlushDenormals flush;
        others.push_back(answer());
      }
      bool is_untouched;
      {
        const TrapExceptions traps;
        others.push_back(answer());
        is_untouched = traps.IsUntouched();
      }
      EXPECT_TRUE(is_untouched);
      for (const auto& other : others) EXPECT_TRUE(other == answers);
      if (HasFailure()) {
        FAIL() << "times 2^" << exponent << ", " << target.name();
      }
    }
  }
}

TEST(BvhNearestErrorsTest, RefusesWhatIsNoLimit) {
  const AabbBvh3 bvh(Spread<AabbView3>(4.0f).Objects(100));
  Ids ids(10);
  std::vector<float> distances(9);
  const auto ignore = [](std::uint32_t, float) {};
  for (float bad : {-1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_TRUE(Refuses([&] { ForEachNearest(bvh, {}, bad, ignore); },
                        {"ForEachNearest", "max_distance"}));
    EXPECT_TRUE(Refuses([&] { (void)KNearest(bvh, {}, ids, {}, bad); },
                        {"KNearest", "max_distance"}));
    EXPECT_TRUE(Refuses(
        [&] {
          RayCast(bvh, Ray3{{}, {}, bad}, ignore);
        },
        {"RayCast", "max_t"}));
    EXPECT_TRUE(Refuses(
        [&] {
          RayCast(bvh, Ray3{{}, {}, 1}, bad, ignore);
        },
        {"RayCast", "radius"}));
  }
  EXPECT_TRUE(Refuses([&] { (void)KNearest(bvh, {}, ids, distances); },
                      {"KNearest", "distances", "10", "9"}));
  const std::vector<Point3> points(3);
  for (std::size_t k : {0u, 3u, 4u, 10u}) {
    EXPECT_TRUE(Refuses([&] { KNearestOfEach(bvh, points, k, ids, {}); },
                        {"KNearestOfEach: ids", "3 queries", "10"}))
        << k;
  }
  EXPECT_TRUE(Refuses(
      [&] { KNearestOfEach(bvh, Span<const Point3>(nullptr, 3), 0, {}, {}); },
      {"KNearestOfEach: queries", "null"}));
  EXPECT_TRUE(Refuses(
      [&] {
        (void)KNearest(bvh, {},
                       {static_cast<std::uint32_t*>(nullptr), std::size_t{4}},
                       {});
      },
      {"KNearest", "ids", "null"}));
}

}  // namespace
}  // namespace halfspace::testing

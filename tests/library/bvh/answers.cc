#include "tests/library/bvh/answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "tests/library/bvh/shape_reference.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

bool HasMask(const Object& object, std::uint32_t mask) {
  return ~mask == 0 || (object.masks & mask) != 0;
}

// Any NaN is as another.
bool AreSame(const Planes& a, const Planes& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](float x, float y) {
    return x == y || (std::isnan(x) && std::isnan(y));
  });
}

// A new BVH of the objects, with their ids.
std::unique_ptr<AnyBvh> NewBvh(const Layout& layout, const Objects& objects) {
  auto bvh = std::make_unique<AnyBvh>(layout, MemoryResource());
  Ids ids;
  BoundList bounds;
  for (const auto& [id, object] : objects) {
    ids.push_back(id);
    bounds.floats.push_back(object.bound);
  }
  bvh->InsertAs(ids, bounds);
  for (const auto& [id, object] : objects) {
    if (~object.masks != 0) bvh->SetMasks(id, object.masks);
  }
  return bvh;
}

// find(values, skip) fills a span from its `skip`-th result on, and returns how
// many there are: `total`. Returns what it finds with space for all. Behind the
// last result it may write within the span.
template <typename T, typename Find>
std::vector<T> ExpectFills(std::size_t total, const Find& find) {
  const auto part = [&](std::size_t skip, std::size_t room) {
    Canaried<T> canaried;
    const std::span<T> space = canaried.Reset(room);
    EXPECT_EQ(find(space, skip), total);
    EXPECT_TRUE(canaried.IntactBut(skip > total ? 0 : room));
    const std::size_t written = std::min(room, total - std::min(skip, total));
    return std::vector<T>(space.begin(),
                          space.begin() + static_cast<std::ptrdiff_t>(written));
  };
  const std::vector<T> all = part(0, total + 3);
  const auto expect_part = [&](std::size_t skip, std::size_t room) {
    const std::vector<T> some = part(skip, room);
    if (all.size() != total || skip > total) return;
    EXPECT_TRUE(std::equal(some.begin(), some.end(),
                           all.begin() + static_cast<std::ptrdiff_t>(skip)));
  };
  expect_part(0, 0);
  expect_part(0, total / 2);
  expect_part(total / 3, 1 + total / 5);
  expect_part(total - total / 7, 70);
  expect_part(static_cast<std::size_t>(-1), 7);
  return all;
}

// Whether a plane separates two bounds by more than a margin, which is 2 or 3
// times as large on D. With a margin and `rounding`, the call allows for such a
// share of all values, and for values that grow beyond the greatest float.
bool AreSeparated(const Layout& layout, const Planes& a, const Planes& b,
                  float margin = 0, double rounding = 0) {
  const auto size = [](float v) {
    return std::isfinite(v) ? std::fabs(static_cast<double>(v)) : 0.0;
  };
  const auto is_beyond = [&](float x, float y, double limit) {
    // Exact: if the difference rounds to the limit, its error decides.
    const auto is_more = [](double high, double low, double by) {
      const double difference = high - low;
      if (difference != by) return difference > by;
      const double part = difference - high;
      return (high - (difference - part)) - (low + part) > 0;
    };
    if (margin == 0 || rounding == 0) return is_more(x, y, limit);
    const double most = size(x) + size(y) + limit;
    const double slack = most * rounding + 0x1p-125;
    return is_more(x, y, limit + slack) &&
           !(std::isinf(x - y) && most + slack > kMost);
  };
  for (std::size_t k = 0; k < layout.axes; ++k) {
    const std::size_t max = layout.first_max + k;
    const double limit = (k < layout.dims ? 1.0 : layout.dims) * margin;
    if (is_beyond(a[k], b[max], limit) || is_beyond(b[k], a[max], limit)) {
      return true;
    }
  }
  return false;
}

// Whether the Euclidean distance of two boxes is greater than a limit, or that
// of octahedra on D than sqrt(dims) times the limit. With `rounding`, by a
// share of 2^-48, and on D by more.
bool AreFar(const Layout& layout, const Planes& a, const Planes& b,
            float within, double rounding) {
  const bool is_loose = rounding != 0;
  const long double limit = within;
  long double on_d = std::sqrt(static_cast<long double>(layout.dims)) * limit;
  on_d = is_loose ? on_d * (1 + 0x1p-17L) + 0x1p-119L : on_d * (1 + 0x1p-60L);
  // The difference of two floats on D can overflow.
  const bool has_d = layout.axes > layout.dims && !(is_loose && on_d > kMost);
  long double squared = 0;
  for (std::size_t k = 0; k < (has_d ? layout.axes : layout.dims); ++k) {
    const std::size_t max = layout.first_max + k;
    long double gap = 0;  // with a NaN, too
    for (const long double apart : {static_cast<long double>(a[k]) - b[max],
                                    static_cast<long double>(b[k]) - a[max]}) {
      if (apart > gap) gap = apart;
    }
    if (k == layout.dims && gap > on_d) return true;
    if (k < layout.dims) squared += gap * gap;
  }
  return squared > limit * limit * (is_loose ? 1 + 0x1p-47L : 1);
}

// A bound of a sphere: on D it is that of the sphere, too. Planes of a query
// are those that a plane is compared with.
Planes BoundOfBall(const Layout& layout, const Corner& center, float radius,
                   bool is_query = false) {
  Planes bound{};
  std::array<float, 4> min;
  std::array<float, 4> max;
  float sum = 0;
  for (std::size_t k = 0; k < layout.dims; ++k) {
    min[k] = center[k] - radius;
    max[k] = center[k] + radius;
    sum += center[k];
  }
  const float on_d = radius * std::sqrt(static_cast<float>(layout.dims));
  min[layout.dims] = -sum - on_d;
  max[layout.dims] = -sum + on_d;
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    const std::size_t k = p % layout.axes;
    bound[p] = IsMin(layout, p) != is_query ? min[k] : max[k];
  }
  return bound;
}

}  // namespace

PairList PairsFrom(Span<const IdPair> pairs) {
  PairList list;
  for (const IdPair& pair : pairs) list.emplace_back(pair.a, pair.b);
  return list;
}

PairList Difference(const PairList& of, const PairList& without) {
  PairList difference;
  std::ranges::set_difference(of, without, std::back_inserter(difference));
  return difference;
}

PairList InOrder(Span<const IdPair> pairs, bool is_one_world) {
  PairList sorted = PairsFrom(pairs);
  for (auto& [a, b] : sorted) {
    if (is_one_world && a > b) std::swap(a, b);
  }
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

PairList PairsIn(const Layout& layout, const Objects& objects) {
  PairList pairs;
  for (auto a = objects.begin(); a != objects.end(); ++a) {
    for (auto b = std::next(a); b != objects.end(); ++b) {
      if (!AreSeparated(layout, a->second.bound, b->second.bound)) {
        pairs.emplace_back(a->first, b->first);
      }
    }
  }
  return pairs;
}

Ids KeptBy(const Layout& layout, const Objects& objects, const Shape& shape,
           std::uint32_t mask) {
  const ShapeReference reference(layout, shape);
  Ids ids;
  for (const auto& [id, object] : objects) {
    if (HasMask(object, mask) && reference.Keeps(object.bound)) {
      ids.push_back(id);
    }
  }
  return ids;
}

namespace {

void ExpectFindsEach(const Searches& world, std::span<const Shape> shapes,
                     const std::vector<Ids>& expected,
                     const QueryOptions& options) {
  std::vector<std::size_t> counts;
  std::size_t total = 0;
  for (std::size_t q = 0; q < shapes.size(); ++q) {
    const Shape& shape = shapes[q];
    const Ids& ids = expected[q];
    counts.push_back(ids.size());
    total += ids.size();
    const Ids found = ExpectFills<std::uint32_t>(
        ids.size(), [&](Span<std::uint32_t> space, std::size_t skip) {
          return world.Find(shape, space, options, skip);
        });
    ASSERT_EQ(InOrder(found), ids) << "shape " << shape.kind;
    ASSERT_EQ(world.Count(shape, options), ids.size());
    const auto any = world.Any(shape, options);
    ASSERT_EQ(any.has_value(), !ids.empty());
    ASSERT_TRUE(!any || std::binary_search(ids.begin(), ids.end(), *any));
    for (const std::size_t most : {std::size_t{2}, std::size_t(-1)}) {
      Ids visited;
      std::size_t calls = 0;
      world.ForEach(
          shape,
          [&](Span<const std::uint32_t> some) {
            EXPECT_FALSE(some.empty());
            visited.insert(visited.end(), some.begin(), some.end());
            return ++calls == most ? Visit::kStop : Visit::kContinue;
          },
          options);
      ASSERT_LE(calls, most);
      ASSERT_TRUE(calls == most || InOrder(visited) == ids);
    }
  }
  std::vector<std::size_t> offsets(shapes.size() + 1);
  Ids all = ExpectFills<std::uint32_t>(
      total, [&](Span<std::uint32_t> space, std::size_t skip) {
        std::fill(offsets.begin(), offsets.end(), 99);
        const std::size_t found =
            world.FindEach(shapes, space, offsets, options, skip);
        EXPECT_EQ(offsets.back(), found);
        return found;
      });
  ASSERT_EQ(offsets[0], 0u);
  for (std::size_t q = 0; q < shapes.size(); ++q) {
    ASSERT_EQ(offsets[q + 1] - offsets[q], counts[q]) << q;
    ASSERT_EQ(InOrder(std::span(all).subspan(offsets[q], counts[q])),
              expected[q])
        << q;
  }
  if (world.bvh != nullptr && shapes[0].kind == Shape::kBound) {
    std::vector<std::size_t> counted(shapes.size(), 99);
    world.CountEach(shapes, counted, options);
    ASSERT_EQ(counted, counts);
  }
}

}  // namespace

void ExpectFinds(const Searches& world, const Objects& objects,
                 std::span<const Shape> shapes, const HowToAsk& how) {
  std::unique_ptr<AnyBvh> other;
  if (shapes[0].kind == Shape::kOrientedBox) {
    other = NewBvh(world.layout, objects);
  }
  std::vector<Ids> expected;
  for (const Shape& shape : shapes) {
    Ids& ids = expected.emplace_back();
    if (other != nullptr) {
      ids.resize(other->Count(shape, {.mask = how.mask}));
      (void)other->Find(shape, ids, {.mask = how.mask}, 0);
      std::sort(ids.begin(), ids.end());
    } else {
      ids = KeptBy(world.layout, objects, shape, how.mask);
    }
  }
  for (Target target : how.targets) {
    SCOPED_TRACE(target.name());
    ExpectFindsEach(world, shapes, expected,
                    {.mask = how.mask, .target = target});
    if (::testing::Test::HasFatalFailure()) return;
  }
}

namespace {

struct Near {
  std::uint32_t id;
  float squared;
};

// The squared distance up to which objects are found.
float SquaredLimit(float distance) {
  const double squared = double{distance} * distance;
  return static_cast<float>(
      std::min(squared * (1 + 0x1p-20) + 0x1p-148, double{kMost}));
}

// Whether an object's box is that of the place. A simplex has minima alone.
bool IsThere(const Layout& layout, const Planes& planes, const Place& place) {
  for (std::size_t k = 0; k < layout.dims; ++k) {
    const Corner& max = place.is_point ? place.min : place.max;
    if (planes[k] != place.min[k]) return false;
    if (layout.has_max && planes[layout.first_max + k] != max[k]) return false;
  }
  return true;
}

std::vector<Near> NearestOf(const Layout& layout, const Objects& objects,
                            const Place& place, float limit,
                            const SearchOptions& options) {
  std::vector<Near> nearest;
  for (const auto& [id, object] : objects) {
    if (options.exclusive && IsThere(layout, object.bound, place)) continue;
    const float squared =
        SquaredDistanceOf(layout, object.bound, place.min.data(),
                          place.is_point ? place.min.data() : place.max.data());
    if (HasMask(object, options.mask) && squared <= SquaredLimit(limit)) {
      nearest.push_back({id, squared});
    }
  }
  std::stable_sort(
      nearest.begin(), nearest.end(),
      [](const Near& a, const Near& b) { return a.squared < b.squared; });
  return nearest;
}

// Which of several objects at one distance comes first is the world's choice.
void ExpectAreNearest(const std::vector<Near>& expected, const Ids& ids,
                      const std::vector<float>& distances) {
  ASSERT_LE(ids.size(), expected.size());
  const Ids sorted = InOrder(ids);
  ASSERT_TRUE(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
  // Each object is at the place of its distance.
  Ids at_same;
  for (std::size_t i = 0, end = 0; i < ids.size(); ++i) {
    if (i == end) {
      at_same.clear();
      for (; end < expected.size() &&
             expected[end].squared == expected[i].squared;
           ++end) {
        at_same.push_back(expected[end].id);
      }
    }
    ASSERT_EQ(distances[i], std::sqrt(expected[i].squared)) << i;
    ASSERT_TRUE(std::binary_search(at_same.begin(), at_same.end(), ids[i]))
        << i;
  }
}

// The rows of several places, of which the first and the last are the same, are
// what the call for one place finds.
void ExpectNearestEach(const Searches& world, const Place& place,
                       float max_distance, const SearchOptions& options) {
  Place other = place;
  for (float& x : other.min) x -= 1;
  const Place places[] = {place, other, place};
  for (std::size_t k : {0u, 1u, 9u, 2100u}) {
    Ids expected(3 * k);
    std::vector<float> nearest(3 * k);
    for (std::size_t q = 0; q < 3; ++q) {
      const auto its_ids = std::span(expected).subspan(q * k, k);
      const auto its_distances = std::span(nearest).subspan(q * k, k);
      const std::size_t count = world.Nearest(places[q], its_ids, its_distances,
                                              max_distance, options);
      std::ranges::fill(its_ids.subspan(count), kNoId);
      std::ranges::fill(its_distances.subspan(count), kInf);
    }
    Ids ids(3 * k, 99);
    std::vector<float> distances(3 * k);
    world.NearestEach(places, k, ids, distances, max_distance, options);
    ASSERT_EQ(ids, expected);
    ASSERT_EQ(distances, nearest);
    world.NearestEach(places, k, ids, {}, max_distance, options);
    ASSERT_EQ(ids, expected);
    if (k > world.size()) break;
  }
}

// All, some, and up to a limit that shrinks.
void ExpectForEachNearest(const Searches& world, const Objects& objects,
                          const Place& place, float max_distance,
                          const SearchOptions& options,
                          const std::vector<Near>& expected) {
  for (std::size_t some : {std::size_t(-1), std::size_t{1}, std::size_t{30}}) {
    for (bool shrinks : {false, true}) {
      Ids ids;
      std::vector<float> distances;
      float limit = max_distance;
      world.ForEachNearest(
          place.min, max_distance,
          [&](std::uint32_t id, float distance, const Planes& bound) {
            EXPECT_TRUE(shrinks || AreSame(bound, objects.at(id).bound));
            ids.push_back(id);
            distances.push_back(distance);
            if (!shrinks) return Limit{ids.size() < some ? kInf : -kInf};
            limit = std::min(limit,
                             ids.size() < some ? 2 * distance + 1 : distance);
            return Limit{limit};
          },
          options);
      ExpectAreNearest(expected, ids, distances);
      if (::testing::Test::HasFatalFailure()) return;
      const std::size_t near =
          std::count_if(expected.begin(), expected.end(), [&](const Near& one) {
            return !shrinks || one.squared <= SquaredLimit(limit);
          });
      ASSERT_EQ(ids.size(), shrinks ? near : std::min(some, near));
    }
  }
}

// The nearest objects, by their distances as computed.
void ExpectNearest(const Searches& world, const Objects& objects,
                   const Place& place, float max_distance, const HowToAsk& how,
                   bool exclusive = false) {
  SearchOptions options;
  options.mask = how.mask;
  options.exclusive = exclusive;
  const std::vector<Near> expected =
      NearestOf(world.layout, objects, place, max_distance, options);
  for (Target target : how.targets) {
    SCOPED_TRACE(target.name());
    options.target = target;
    // With and without distances: of more than 2048 ids alone, half are found
    // at once.
    for (std::size_t room : {1u, 8u, 63u, 64u, 700u, 3000u, 9000u}) {
      Ids ids(room, 99);
      std::vector<float> distances(room);
      const std::size_t count =
          world.Nearest(place, ids, distances, max_distance, options);
      ASSERT_EQ(count, std::min(room, expected.size()));
      Ids alone(room, 99);
      ASSERT_EQ(world.Nearest(place, alone, {}, max_distance, options), count);
      ASSERT_EQ(alone, ids);
      ids.resize(count);
      ExpectAreNearest(expected, ids, distances);
      if (room > expected.size()) break;
    }
    ExpectNearestEach(world, place, max_distance, options);
    if (world.bvh != nullptr && place.is_point) {
      ExpectForEachNearest(world, objects, place, max_distance, options,
                           expected);
    }
  }
}

// What a cast enters up to a limit, by id: a ball as a new world finds it.
std::map<std::uint32_t, float> EntriesOf(const Layout& layout,
                                         const Objects& objects,
                                         const Motion& motion, float max_t,
                                         std::uint32_t mask) {
  std::map<std::uint32_t, float> entries;
  if (motion.kind == Motion::kBall) {
    Motion up_to = motion;
    up_to.max_t = max_t;
    NewBvh(layout, objects)
        ->Cast(up_to,
               [&](std::uint32_t id, float t, const Planes&) {
                 entries[id] = t;
                 return Limit{kInf};
               },
               {.mask = mask, .target = TargetsUnderTest().front()});
    return entries;
  }
  MovingBox moving;
  const Place& place = motion.place;
  for (std::size_t k = 0; k < layout.dims; ++k) {
    moving.low[k] = place.min[k];
    moving.high[k] = place.is_point ? place.min[k] : place.max[k];
    moving.direction[k] = motion.direction[k];
    if (moving.low[k] > moving.high[k]) return entries;
  }
  moving.max_t = max_t;
  if (motion.kind == Motion::kRay) moving.radius = motion.radius;
  for (const auto& [id, object] : objects) {
    const float t = moving.EntryOf(layout, object.bound);
    if (t <= kMost && HasMask(object, mask)) {
      entries[id] = t < MovingBox::kApart ? 0 : t;
    }
  }
  return entries;
}

// Every hit at its t, and with limits all that are nearer.
void ExpectHits(const Searches& world, const Objects& objects,
                const Motion& motion, const HowToAsk& how) {
  const auto expected =
      EntriesOf(world.layout, objects, motion, motion.max_t, how.mask);
  float first = kInf;
  for (const auto& [id, t] : expected) first = std::min(first, t);
  // Without a limit, with that of the nearest, and with others of which some
  // are farther than the last.
  for (std::size_t i = 0; i < 3 * how.targets.size(); ++i) {
    const std::size_t limits = i % 3;
    const SearchOptions options{.mask = how.mask, .target = how.targets[i / 3]};
    SCOPED_TRACE(options.target.name());
    std::map<std::uint32_t, float> found;
    float limit = kInf;
    world.Cast(
        motion,
        [&](std::uint32_t id, float t, const Planes& bound) {
          EXPECT_TRUE(found.emplace(id, t).second) << id;
          EXPECT_LE(t, limit + MovingBox::kApart);
          const auto object = objects.find(id);
          EXPECT_TRUE(object != objects.end() &&
                      AreSame(bound, object->second.bound));
          const float next = limits == 0             ? kInf
                             : limits == 1           ? t
                             : found.size() % 3 == 0 ? kInf
                             : found.size() % 3 == 1 ? 2 * t
                                                     : t;
          limit = std::min(limit, next);
          return Limit{next};
        },
        options);
    // A line that hardly moves is wider the longer it is, and a broad phase
    // casts a second one, up to the limit so far.
    const auto surely =
        limit < motion.max_t
            ? EntriesOf(world.layout, objects, motion, limit, how.mask)
            : expected;
    for (const auto& [id, t] : surely) {
      if (t <= limit) {
        ASSERT_TRUE(found.contains(id)) << id << ", kind " << int{motion.kind};
      }
    }
    for (const auto& [id, t] : found) {
      ASSERT_TRUE(expected.contains(id)) << id << ", kind " << int{motion.kind};
      ASSERT_GE(t, expected.at(id)) << id;
      if (surely.contains(id)) {
        ASSERT_LE(t, surely.at(id)) << id;
      }
    }
    if (limits == 1) {
      ASSERT_EQ(limit, first);
    }
    if (limits != 0) continue;
    std::size_t calls = 0;
    world.Cast(
        motion,
        [&](std::uint32_t, float, const Planes&) {
          ++calls;
          return Limit{-kInf};
        },
        options);
    ASSERT_EQ(calls, expected.empty() ? 0u : 1u);
  }
}

// Which pairs are asked for: of one world or with another one, of all objects
// or of some. A list of ids may have an id twice.
struct PairsAsked {
  const AnyBvh* other = nullptr;
  const Objects* others = nullptr;
  const Ids* ids = nullptr;
  Ids wanted = {};  // of the ids; empty if all are wanted
  float margin = 0;
  float within = 0;
};
// The world is a BVH unless `ids` are of one world.
void ExpectPairs(const Searches& world, const Objects& objects,
                 const PairsAsked& asked, const HowToAsk& how) {
  const bool is_one_world = asked.other == nullptr;
  const Objects& others = is_one_world ? objects : *asked.others;
  std::map<std::uint32_t, Ids> wanted;  // of each id
  for (std::size_t i = 0; asked.ids != nullptr && i < asked.ids->size(); ++i) {
    wanted[(*asked.ids)[i]].push_back(asked.wanted.empty() ? 0xFFFFFFFF
                                                           : asked.wanted[i]);
  }
  struct Listed {
    std::uint32_t id;
    const Object* object;
    const Ids* wanted;  // null if it is not in the set

    bool Wants(const Object& other) const {
      return wanted != nullptr && std::any_of(wanted->begin(), wanted->end(),
                                              [&](std::uint32_t mask) {
                                                return HasMask(other, mask);
                                              });
    }
  };
  const Ids all_wanted = {0xFFFFFFFF};
  const auto listed = [&](const Objects& some) {
    std::vector<Listed> list;
    for (const auto& [id, object] : some) {
      const auto its = wanted.find(id);
      list.push_back({id, &object,
                      asked.ids == nullptr  ? &all_wanted
                      : its == wanted.end() ? nullptr
                                            : &its->second});
    }
    return list;
  };
  PairList must;
  PairList may;
  const std::vector<Listed> bs = listed(others);
  for (const Listed& a : listed(objects)) {
    if (a.wanted == nullptr || !HasMask(*a.object, how.mask)) continue;
    for (const Listed& b : bs) {
      if (is_one_world && (b.wanted != nullptr ? b.id <= a.id : b.id == a.id)) {
        continue;
      }
      if (!HasMask(*b.object, how.mask) ||
          !(a.Wants(*b.object) || (is_one_world && b.Wants(*a.object)))) {
        continue;
      }
      std::pair pair(a.id, b.id);
      if (is_one_world) pair = std::minmax(a.id, b.id);
      const auto is_apart = [&](double rounding) {
        const Planes& x = a.object->bound;
        const Planes& y = b.object->bound;
        return asked.within > 0
                   ? AreFar(world.layout, x, y, asked.within, rounding)
                   : AreSeparated(world.layout, x, y, asked.margin, rounding);
      };
      if (!is_apart(0)) {
        must.push_back(pair);
      } else if ((asked.margin == 0 && asked.within == 0) ||
                 is_apart(0x1p-21)) {
        continue;
      }
      may.push_back(pair);
    }
  }
  std::sort(must.begin(), must.end());
  std::sort(may.begin(), may.end());
  const Span<const std::uint32_t> ids =
      asked.ids == nullptr ? Span<const std::uint32_t>()
                           : Span<const std::uint32_t>(*asked.ids);
  for (Target target : how.targets) {
    PairOptions options{.mask = how.mask,
                        .wanted = asked.wanted,
                        .margin = asked.margin,
                        .within = asked.within,
                        .target = target};
    const auto* const set = asked.ids == nullptr ? nullptr : &ids;
    const auto find = [&](Span<IdPair> pairs) {
      return world.FindPairs(asked.other, set, pairs, options);
    };
    const auto for_each = [&](const Searches::OnPairs& function) {
      world.ForEachPair(asked.other, set, function, options);
    };
    const std::size_t total = find({});
    const auto found =
        ExpectFills<IdPair>(total, [&](Span<IdPair> pairs, std::size_t skip) {
          options.skip = skip;
          const std::size_t all = find(pairs);
          std::size_t left = 0;
          for_each([&](Span<const IdPair> some) {
            left += some.size();
            return Visit::kContinue;
          });
          EXPECT_EQ(left, all - std::min(skip, all));
          return all;
        });
    options.skip = 0;
    const PairList sorted = InOrder(found, is_one_world);
    ASSERT_TRUE(std::adjacent_find(sorted.begin(), sorted.end()) ==
                sorted.end());
    ASSERT_EQ(Difference(must, sorted), PairList())
        << "missed, margin " << asked.margin << ", within " << asked.within;
    ASSERT_EQ(Difference(sorted, may), PairList())
        << "too many, margin " << asked.margin << ", within " << asked.within;
    for (const IdPair& pair : found) {
      if (asked.ids == nullptr) break;
      ASSERT_TRUE(
          (Listed{pair.a, nullptr, &wanted[pair.a]}.Wants(others.at(pair.b))));
    }
    const std::size_t parts =
        world.bvh == nullptr ? 1 : (world.bvh->ids().size() + 63) / 64;
    std::vector<IdPair> visited;
    for (options.begin = 0; options.begin < parts;
         options.begin = options.end) {
      options.end = world.bvh == nullptr ? static_cast<std::size_t>(-1)
                                         : options.begin + 1 + parts / 3;
      for_each([&](Span<const IdPair> some) {
        EXPECT_TRUE(!some.empty() && some.size() <= 256);
        visited.insert(visited.end(), some.begin(), some.end());
        return Visit::kContinue;
      });
    }
    ASSERT_EQ(InOrder(visited, is_one_world), sorted);
    options.begin = 0;
    std::size_t calls = 0;
    for_each([&](Span<const IdPair>) {
      return ++calls < 2 ? Visit::kContinue : Visit::kStop;
    });
    ASSERT_TRUE(calls == 2 || (calls == 0) == found.empty());
    ASSERT_LE(calls, 2u);
  }
}

class Numbers {
 public:
  Numbers(bool is_special, Random& random)
      : is_special_(is_special), random_(random) {}

  // Most are from -60 to 60.
  float Next() {
    const float x = static_cast<float>(random_() % 120'000) / 1000 - 60;
    return is_special_ && random_() % 8 == 0 ? SpecialValue<float>(random_) : x;
  }
  float Radius(float usual) {
    if (!is_special_ || random_() % 8 != 0) return usual;
    const float radius = SpecialValue<float>(random_);
    return radius >= 0 ? radius : kInf;
  }
  void Add(std::size_t count, std::vector<float>& to) {
    while (count-- > 0) to.push_back(Next());
  }
  Corner Point(std::size_t dims) {
    Corner corner{};
    for (std::size_t k = 0; k < dims; ++k) corner[k] = Next();
    return corner;
  }

 private:
  bool is_special_;
  Random& random_;
};

Place SomePlace(const Layout& layout, bool is_point, bool is_special,
                Random& random) {
  Numbers numbers(is_special, random);
  Place place;
  place.is_point = is_point;
  place.min = place.max = numbers.Point(layout.dims);
  if (is_point) return place;
  for (std::size_t k = 0; k < layout.dims; ++k) {
    place.max[k] += std::abs(numbers.Next()) / 2;
  }
  return place;
}

}  // namespace

std::vector<Shape> SomeShapes(const Layout& layout, Shape::Kind kind,
                              std::size_t count, bool is_special,
                              Random& random) {
  Numbers numbers(is_special, random);
  const std::size_t dims = layout.dims;
  std::vector<Shape> shapes(count);
  for (std::size_t i = 0; i < count; ++i) {
    shapes[i].kind = kind;
    auto& all = shapes[i].numbers;
    const float radius = std::ldexp(1.0f, static_cast<int>(random() % 8) - 2);
    switch (kind) {
      case Shape::kBound: {
        const Planes bound =
            BoundOfBall(layout, numbers.Point(dims), 4 * radius, true);
        all.assign(bound.begin(), bound.end());
        if (random() % 16 == 0) {
          all[random() % layout.plane_count] = SpecialValue<float>(random);
        }
        break;
      }
      case Shape::kPoint:
        numbers.Add(dims, all);
        break;
      case Shape::kSphere:
        numbers.Add(dims, all);
        all.push_back(numbers.Radius(random() % 8 == 0 ? 0 : 2 * radius));
        break;
      case Shape::kSegment:
      case Shape::kCapsule:
        numbers.Add(2 * dims, all);
        // Along a plane, or a point.
        if (random() % 4 == 1) all[dims] = all[0];
        if (random() % 4 == 2) std::copy_n(all.begin(), dims, &all[dims]);
        if (kind == Shape::kCapsule) {
          all.push_back(numbers.Radius(radius / 4));
        }
        break;
      case Shape::kRoundedBox:
        numbers.Add(dims, all);
        for (std::size_t k = 0; k < dims; ++k) {
          all.push_back(all[k] +
                        numbers.Radius(random() % 4 == 0 ? 0 : radius));
        }
        all.push_back(numbers.Radius(random() % 8 == 0 ? 0 : 2 * radius));
        break;
      case Shape::kOrientedBox:
        numbers.Add(dims, all);
        for (std::size_t k = 0; k < dims * dims; ++k) {
          all.push_back(numbers.Next() / 60);
        }
        for (std::size_t k = 0; k < dims; ++k) {
          all.push_back(numbers.Radius(8 * radius));
        }
        break;
      case Shape::kHalfSpaces:
        for (std::size_t f = random() % 7; f-- > 0;) {
          float offset = 0;
          for (std::size_t k = 0; k < dims; ++k) {
            const float n = f % 3 == 1 && k == 1 ? 0 : numbers.Next();
            all.push_back(n);
            // In front of a place near the middle.
            offset += std::abs(n) * (f % 2 == 0 ? 20.0f : 55.0f);
          }
          all.push_back(is_special && random() % 8 == 0
                            ? SpecialValue<float>(random)
                            : offset);
        }
    }
  }
  return shapes;
}

Motion SomeMotion(const Layout& layout, Motion::Kind kind, bool is_special,
                  Random& random) {
  Numbers numbers(is_special, random);
  Motion motion;
  motion.kind = kind;
  motion.place = SomePlace(layout, kind != Motion::kBox, is_special, random);
  for (std::size_t k = 0; k < layout.dims; ++k) {
    motion.direction[k] = random() % 5 == 0 ? 0 : numbers.Next();
  }
  constexpr float kTimes[] = {kInf, 0.5f, 1, 0};
  motion.max_t = numbers.Radius(kTimes[random() % 4]);
  motion.radius = numbers.Radius(random() % 2 == 0 ? 0 : 2);
  return motion;
}

void ExpectAnswers(const Searches& world, const Objects& objects,
                   const HowToAsk& how, Random& random) {
  ASSERT_EQ(world.size(), objects.size());
  const Layout& layout = world.layout;
  const auto any_object = [&] {
    auto it = objects.begin();
    std::advance(it, random() % objects.size());
    return it;
  };
  for (int kind = 0; kind <= Shape::kHalfSpaces; ++kind) {
    auto shapes = SomeShapes(layout, static_cast<Shape::Kind>(kind), how.shapes,
                             how.is_special, random);
    if (kind == Shape::kBound) {
      // All, those that exceed a value, and those that touch an object.
      std::vector<Planes> queries = {AllPlanes(layout, kMost),
                                     AllPlanes(layout, 300),
                                     AllPlanes(layout, -kInf)};
      if (!objects.empty()) queries.push_back(any_object()->second.bound);
      for (const Planes& query : queries) {
        shapes.push_back(ShapeOf(query));
      }
    }
    ExpectFinds(world, objects, shapes, how);
    if (::testing::Test::HasFatalFailure()) return;
  }
  for (float limit : {kInf, 30.0f, 0.0f}) {
    const bool is_point = random() % 2 == 0;
    ExpectNearest(world, objects,
                  SomePlace(layout, is_point, how.is_special, random), limit,
                  how);
    if (::testing::Test::HasFatalFailure()) return;
  }
  if (!objects.empty()) {
    const Planes bound = any_object()->second.bound;
    Place place;
    for (std::size_t k = 0; k < layout.dims; ++k) {
      place.min[k] = bound[k];
      place.max[k] = bound[layout.has_max ? layout.first_max + k : k];
    }
    ExpectNearest(world, objects, place, kInf, how, true);
    if (::testing::Test::HasFatalFailure()) return;
  }
  for (Motion::Kind kind : {Motion::kRay, Motion::kBox, Motion::kBall}) {
    ExpectHits(world, objects, SomeMotion(layout, kind, how.is_special, random),
               how);
    if (::testing::Test::HasFatalFailure()) return;
  }
  if (!layout.has_max) return;
  Ids ids;
  PairsAsked asked;
  for (std::size_t i = random() % 40; i-- > 0 && !objects.empty();) {
    ids.push_back(any_object()->first);
    asked.wanted.push_back(random() % 4 == 0 ? 0xFFFFFFFF : random() % 8);
  }
  if (random() % 2 == 0) asked.wanted.clear();
  asked.ids = &ids;

  constexpr float kMargins[] = {0, 0, 0.7f, 7.0f, 1e-30f, 1e-42f, 3e38f};
  (random() % 2 == 0 ? asked.margin : asked.within) = kMargins[random() % 7];

  ExpectPairs(world, objects, asked, how);
}

void ExpectIsModel(const AnyBvh& world, const Objects& objects,
                   const HowToAsk& how, Random& random) {
  const Layout& layout = world.layout;
  Planes all = EmptyOf(layout);
  const auto in_use = [&](std::uint32_t id) { return objects.contains(id); };
  for (std::uint32_t id = 0; id < world.id_limit() + 3; ++id) {
    ASSERT_EQ(world.Has(id), in_use(id)) << id;
  }
  for (const auto& [id, object] : objects) {
    ASSERT_TRUE(world.Has(id)) << id;
    ASSERT_TRUE(AreSame(world.Get(id), object.bound)) << id;
    for (std::size_t p = 0; p < layout.plane_count; ++p) {
      // What is no number limits nothing.
      const float v = object.bound[p];
      if (IsMin(layout, p)) {
        all[p] = std::isnan(v) ? -kInf : std::min(all[p], v);
      } else {
        all[p] = std::isnan(v) ? kInf : std::max(all[p], v);
      }
    }
  }
  ASSERT_EQ(world.Bounds(), all);
  ExpectAnswers(world, objects, how, random);
  if (!layout.has_max || objects.size() > 700 ||
      ::testing::Test::HasFatalFailure()) {
    return;
  }
  PairsAsked asked;

  ExpectPairs(world, objects, asked, how);
  // With another world: of all, or of some.
  Spheres spheres(layout, 6, random());
  const std::vector<Planes> bounds = spheres.Some(random() % 150);
  const auto other = MakeBvh(layout, bounds);
  const Objects others = ObjectsOf(bounds);
  asked.other = other.get();
  asked.others = &others;
  Ids ids;
  if (random() % 2 == 0) {
    for (const auto& [id, object] : objects) {
      if (id % 5 == 0) ids.push_back(id);
    }
    asked.ids = &ids;
  }
  (random() % 2 == 0 ? asked.margin : asked.within) =
      random() % 2 == 0 ? 0 : 0.5f;
  ExpectPairs(world, objects, asked, how);
}

Planes Spheres::Next(bool is_query) {
  Corner center{};
  for (std::size_t k = 0; k < layout_.dims; ++k) {
    center[k] = static_cast<float>(random_() % (1 << 24)) * 0x1p-24f * 100 - 50;
  }
  return BoundOfBall(layout_, center, radius_, is_query);
}
std::vector<Planes> Spheres::Some(std::size_t count) {
  std::vector<Planes> some(count);
  for (Planes& bound : some) bound = Next();
  return some;
}
Shape Spheres::NextQuery() { return ShapeOf(Next(true)); }

namespace {

template <int kExponent>
Planes FewFarAway(const SceneObject& o) {
  Planes bound = o.spheres.Next();
  for (float& value : bound) {
    if (o.i < 10) value *= std::pow(10.0f, static_cast<float>(kExponent));
  }
  return bound;
}
Planes One(const SceneObject& o) { return BoundOfBall(o.layout, {1, 2, 3}, 3); }
Planes AnySphere(const SceneObject& o) { return o.spheres.Next(); }
Planes Everything(const SceneObject& o) { return EverythingOf(o.layout); }
Planes Empty(const SceneObject& o) { return EmptyOf(o.layout); }
// Where all faces coincide.
Planes Cell(const SceneObject& o) {
  Planes bound{};
  for (std::size_t p = 0; p < o.layout.plane_count; ++p) {
    bound[p] = static_cast<float>((o.i >> 4 * (p % o.layout.axes)) % 16) +
               (IsMin(o.layout, p) ? 0.0f : 1.0f);
  }
  return bound;
}
Planes EverythingOrNan(const SceneObject& o) {
  Planes bound = o.spheres.Next();
  for (std::size_t p = 0; p < o.layout.plane_count; ++p) {
    if (o.i % 40 == 7 || o.i % 90 == p) bound[p] = kNan;
  }
  return o.i % 50 == 0   ? EverythingOf(o.layout)
         : o.i % 50 == 1 ? EmptyOf(o.layout)
                         : bound;
}
Planes OfTeapotInStadium(const SceneObject& o) {
  Planes bound = o.spheres.Next();
  for (std::size_t p = 0; o.i % 10 != 0 && p < o.layout.plane_count; ++p) {
    const std::size_t place = o.i % 20 * (p % o.layout.axes + 1) % 20;
    bound[p] = 1e-3f * bound[p] + 5.0f * static_cast<float>(place);
  }
  return bound;
}
// Plane by plane: values that touch, one ulp apart, special, inverted.
Planes OfSpecialValues(const SceneObject& o) {
  Planes bound{};
  for (std::size_t p = 0; p < o.layout.plane_count; ++p) {
    PlaneValueSource<float> source(InputKind::kAdversarial, IsMin(o.layout, p),
                                   static_cast<float>(p) - 3);
    bound[p] = source.Next(o.random);
  }
  return bound;
}
Planes WithSpecialValues(const SceneObject& o) {
  Planes bound = o.spheres.Next();
  for (std::size_t p = 0; o.i % 2 == 0 && p < o.layout.plane_count; ++p) {
    if (o.random() % 8 == 0) bound[p] = SpecialValue<float>(o.random);
  }
  return bound;
}

constexpr Scene kScenes[] = {
    {"spheres", false, &AnySphere},
    {"all the same", false, &One},
    {"everything", false, &Everything},
    {"empty", false, &Empty},
    {"everything and NaN among spheres", true, &EverythingOrNan},
    {"a line", false,
     [](const SceneObject& o) {
       Planes bound = One(o);
       bound[0] = static_cast<float>(o.i);
       return bound;
     }},
    {"a lattice", false, &Cell},
    {"a few far away", false, &FewFarAway<4>},
    {"a few very far away", false, &FewFarAway<30>},
    {"a teapot in a stadium", false, &OfTeapotInStadium},
    {"sizes over six decades", false,
     [](const SceneObject& o) {
       const float decades = static_cast<float>(o.i % 61) / 10.0f - 4.0f;
       return Spheres(o.layout, std::pow(10.0f, decades), o.random()).Next();
     }},
    {"special values", true, &OfSpecialValues},
    {"special values among spheres", true, &WithSpecialValues},
};

}  // namespace

std::span<const Scene> Scenes() { return kScenes; }

std::vector<Planes> ObjectsIn(const Scene& scene, const Layout& layout,
                              std::size_t size, std::uint64_t seed) {
  Spheres spheres(layout, 3, seed);
  Random random(seed);
  std::vector<Planes> objects;
  for (std::size_t i = 0; i < size; ++i) {
    objects.push_back(scene.bound({i, layout, spheres, random}));
  }
  return objects;
}

}  // namespace halfspace::testing

// Calls of a BVH whose bytes were altered. Nothing is compared: pages that
// fault, or a sanitizer, see what is read and written. Changes may be refused.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_ALTERED_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_ALTERED_H_

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "dispatch/bvh/layout.h"
#include "halfspace/detail/pair_events.h"
#include "tests/library/bvh/answers.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {

// Alters a part of a blob of today's format, which must be aligned to 64 bytes,
// as one who knows the parts can: random bytes rarely make two of them agree.
inline void AlterPart(const Layout& layout, std::span<std::byte> blob,
                      Random& random) {
  AnyBvh in_place(layout, {});
  try {
    in_place.Load(blob, true);
  } catch (const std::invalid_argument&) {
    return;
  }
  const detail::BvhLevels& levels = in_place.levels();
  const std::size_t slots = levels.level[0].size;
  if (in_place.Blob().data() != blob.data() || slots == 0) return;
  auto& header = *reinterpret_cast<detail::BvhHeader*>(blob.data());
  const detail::BvhLevel& level = levels.level[random() % levels.count];
  if (level.size == 0) return;
  const std::size_t node = random() % level.size;
  const std::size_t word = node / 64;
  const std::uint64_t bit = std::uint64_t{1} << random() % 64;
  const auto slot = static_cast<std::uint32_t>(random() % slots);
  const auto any = static_cast<std::uint32_t>(
      random() % 2 == 0 ? random() : random() % (header.ids + 2));
  const std::uint32_t id = random() % 2 == 0 ? any : levels.ids[any % slots];
  const bool is_by_id = id < header.id_room;
  const float special = SpecialValue<float>(random);
  switch (random() % 14) {
    case 0:
      levels.ids[slot] = id;
      return;
    case 1:
      if (is_by_id) levels.slots[id] = slot;
      return;
    case 2:  // a free id, and an empty slot
      if (!is_by_id || detail::IsPresent(levels, slot)) return;
      levels.ids[slot] = id;
      levels.slots[id] = slot;
      return;
    case 3:  // an object vanishes, except for its id
      if (!detail::IsPresent(levels, slot) || levels.used == nullptr) return;
      if (levels.ids[slot] >= header.id_room) return;
      detail::AssignBit(levels.level[0].present, slot, false);
      detail::UsedIds(levels.used, header.id_room).Remove(levels.ids[slot]);
      --header.size;
      return;
    case 4:
      if (is_by_id) levels.used[id / 64] ^= bit;
      return;
    case 5:
      level.present[word] ^= bit;
      return;
    case 6:
      if (level.regular != nullptr) level.regular[word] ^= bit;
      return;
    case 7:
      if (level.masks != nullptr) level.masks[node] ^= 1u << any % 32;
      return;
    case 8:
      levels.built[slot / detail::kGroupSlots].cost = special;
      return;
    case 9:
      levels.built[slot / detail::kGroupSlots].objects = random();
      return;
    case 10:
      levels.map->base[any % 8] = special;
      return;
    case 11:
      levels.map->scale[any % 8] = special;
      return;
    case 12: {  // slots in use, objects, ids, and when objects are sorted
      constexpr std::size_t kNumbers[] = {40, 44, 48, 56, 60};
      std::byte* const at = blob.data() + kNumbers[any % 5];
      std::uint32_t number = 0;
      std::memcpy(&number, at, sizeof(number));
      number = random() % 4 == 0 ? any : number + any % 3 - 1;
      std::memcpy(at, &number, sizeof(number));
      return;
    }
    default:
      level.Value(any % layout.plane_count, node) = special;
  }
}

// `good` was not altered.
inline void AskAltered(const AnyBvh& world, const AnyBvh& good,
                       Random& random) {
  const Layout& layout = world.layout;
  std::vector<Shape> shapes = {ShapeOf(AllPlanes(layout, kMost))};
  for (int kind = 0; kind <= Shape::kHalfSpaces; ++kind) {
    shapes.push_back(SomeShapes(layout, static_cast<Shape::Kind>(kind), 1,
                                random() % 2 == 0, random)[0]);
  }
  Ids present;
  for (const std::uint32_t id : world.ids()) {
    if (present.size() < 100 && world.Has(id)) present.push_back(id);
  }
  Ids ids(100);
  Ids near(3);
  std::vector<float> distances(near.size());
  const Place origin = {.is_point = true};
  const auto on_ids = [](Span<const std::uint32_t>) {
    return Visit::kContinue;
  };
  const auto on_hit = [](std::uint32_t, float, const Planes&) {
    return Limit{kInf};
  };
  for (Target target : TargetsUnderTest()) {
    for (const Shape& shape : shapes) {
      (void)world.Find(shape, ids, {.mask = 3, .target = target}, 0);
      (void)world.Count(shape, {.target = target});
      (void)world.Any(shape, {.target = target});
      world.ForEach(shape, on_ids, {.target = target});
    }
    std::vector<std::size_t> offsets(3);
    (void)world.FindEach({shapes.data(), 2}, ids, offsets, {.target = target},
                         0);
    world.CountEach({shapes.data(), 2}, offsets, {.target = target});
    (void)world.Nearest(origin, near, distances, kInf, {.target = target});
    Ids most(world.ids().size());
    (void)world.Nearest(origin, most, {}, kInf, {.target = target});
    world.NearestEach({&origin, 1}, 3, near, distances, 50, {.target = target});
    world.ForEachNearest(Corner{}, kInf, on_hit, {.target = target});
    for (const auto kind : {Motion::kRay, Motion::kBox, Motion::kBall}) {
      world.Cast(SomeMotion(layout, kind, false, random), on_hit,
                 {.target = target});
    }
    if (!layout.has_max) continue;
    std::vector<IdPair> pairs(100);
    (void)world.FindPairs(nullptr, nullptr, pairs, {.target = target});
    (void)world.FindPairs(&good, nullptr, pairs, {.target = target});
    (void)good.FindPairs(&world, nullptr, pairs,
                         {.margin = 1, .target = target});
    // Few ids, and so many that the set is in allocated memory.
    for (const Ids& some : {Ids(3), present}) {
      const Span<const std::uint32_t> set = some;
      try {
        (void)world.FindPairs(nullptr, &set, {},
                              {.margin = 1, .target = target});
        (void)world.FindPairs(&world, &set, {},
                              {.wanted = some, .target = target});
      } catch (const std::invalid_argument&) {
        // There may be no object 0.
      }
    }
  }
  if (layout.has_max && random() % 4 == 0) {
    detail::PairEventsCore events{MemoryResource()};
    events.Update(PairSourcesOf(good), {});
    const Ids few(present.data(), present.data() + present.size() / 8);
    const Span<const std::uint32_t> changed = few;
    events.Update(PairSourcesOf(world, nullptr, &changed), {});
    events.Update(PairSourcesOf(world), {});
  }
  for (const std::uint32_t id : present) (void)world.Get(id);
  (void)world.Bounds();
  (void)world.CostRatio();
  (void)world.Verify();
  (void)world.Blob();
}

inline constexpr std::size_t kAlteredChanges = 17;

inline void ChangeAltered(AnyBvh& world, std::size_t what, const Planes& bound,
                          Random& random) {
  const auto some = static_cast<std::uint32_t>(random() % 720);
  const auto its = world.ids();
  const std::uint32_t id =
      its.empty() || random() % 2 == 0 ? some : its[random() % its.size()];
  const auto several = [&](std::size_t count) {
    return BoundList(std::vector<Planes>(count, bound));
  };
  switch (what) {
    case 0:
      return world.Erase(id);
    case 1:
      return world.Set(id, bound);
    case 2:
      return world.SetMasks(id, 1);
    case 3:
      return world.SetMasks(Ids(world.id_limit(), 3));
    case 4:
      (void)world.RebuildPartial(random() % 9000);
      return;
    case 5:
      return world.Rebuild({});
    case 6: {
      BoundList all = several(world.id_limit());
      if (some % 2 == 0) all.doubles.resize(all.size());
      return world.Refit(all, true, {});
    }
    case 7:
      return world.Refit(several(world.ids().size()), false, {});
    case 8:
      (void)world.Get(id);
      return;
    case 9:
      return some % 16 == 0 ? world.Clear() : world.Reserve(some);
    case 10:
      return world.Erase(Ids{id, some / 2});
    case 11:
      return world.Set(Ids{id, id}, several(2));
    case 12: {
      Ids ids(some % 300);
      return world.Insert(several(ids.size()), ids);
    }
    case 13: {
      Ids ids;
      for (std::uint32_t i = 0; i < 70; ++i) {
        if (!world.Has(some + i * 97)) ids.push_back(some + i * 97);
      }
      return world.InsertAs(ids, several(ids.size()));
    }
    case 14:
      for (std::size_t i = 0; i < some % 80; ++i) (void)world.Insert(bound);
      return;
    case 15: {
      Ids ids;
      for (const std::uint32_t one : its) {
        if (world.Has(one) && random() % 4 == 0) ids.push_back(one);
      }
      return world.Refit(ids, several(world.id_limit()));
    }
    default: {
      const Ids ids(its.begin(), its.end());
      for (const std::uint32_t one : ids) {
        if (world.Has(one)) world.Erase(one);
      }
    }
  }
}

// Loads the bytes again for each change, and for queries. Returns how often
// the bytes or a query were refused.
inline std::size_t UseAltered(const Layout& layout, Span<const std::byte> blob,
                              const MemoryResource& memory, Random& random) {
  std::size_t refused = 0;
  const auto good = MakeBvh(layout, Spheres(layout, 5).Some(70));
  for (std::size_t first = 0; first <= kAlteredChanges; ++first) {
    try {
      auto world = LoadBvh(layout, blob, random() % 2 == 0, memory);
      for (std::size_t step = 0; first < kAlteredChanges && step < 4; ++step) {
        try {
          ChangeAltered(*world, step == 0 ? first : random() % kAlteredChanges,
                        step % 2 == 0 ? EverythingOf(layout) : Planes{},
                        random);
        } catch (const std::invalid_argument&) {
          // A refused change must leave a tree that can be used.
        }
      }
      if (first < kAlteredChanges && random() % 8 != 0) continue;
      AskAltered(*world, *good, random);
      // Stored, and loaded again.
      const auto stored = world->Blob();
      const std::vector<std::byte> bytes(stored.begin(), stored.end());
      world = LoadBvh(layout, bytes, false, memory);
      ChangeAltered(*world, random() % kAlteredChanges, Planes{}, random);
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  return refused;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_ALTERED_H_

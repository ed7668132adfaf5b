// Calls of a BVH whose bytes were altered. Nothing is compared: pages that
// fault, or a sanitizer, see what is read and written. Changes may be refused.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_ALTERED_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_ALTERED_H_

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "tests/library/bvh/answers.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {

inline void AskAltered(const AnyBvh& world, Random& random) {
  const Layout& layout = world.layout;
  std::vector<Shape> shapes = {ShapeOf(AllPlanes(layout, kMost))};
  for (int kind = 0; kind <= Shape::kHalfSpaces; ++kind) {
    shapes.push_back(SomeShapes(layout, static_cast<Shape::Kind>(kind), 1,
                                random() % 2 == 0, random)[0]);
  }
  Ids ids(100);
  Ids near(3);
  for (Target target : TargetsUnderTest()) {
    for (const Shape& shape : shapes) {
      (void)world.Find(shape, ids, {.mask = 3, .target = target}, 0);
      (void)world.Count(shape, {.target = target});
    }
    (void)world.Nearest({.is_point = true}, near, {}, kInf, {.target = target});
    world.Cast(SomeMotion(layout, Motion::kRay, false, random),
               [](std::uint32_t, float, const Planes&) { return Limit{kInf}; },
               {.target = target});
    if (!layout.has_max) continue;
    (void)world.FindPairs(nullptr, nullptr, {}, {.target = target});
    // Few ids, and so many that the set is in allocated memory.
    for (const Ids& some : {near, ids}) {
      const Span<const std::uint32_t> set = some;
      (void)world.FindPairs(nullptr, &set, {}, {.margin = 1, .target = target});
      (void)world.FindPairs(&world, &set, {},
                            {.wanted = some, .target = target});
    }
  }
  (void)world.Bounds();
  (void)world.CostRatio();
  (void)world.Verify();
  (void)world.Blob();
}

inline constexpr std::size_t kAlteredChanges = 15;

inline void ChangeAltered(AnyBvh& world, std::size_t what, const Planes& bound,
                          Random& random) {
  const auto id = static_cast<std::uint32_t>(random() % 720);
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
      return world.SetMasks(Ids(1500, 3));
    case 4:
      (void)world.RebuildPartial(random() % 9000);
      return;
    case 5:
      return world.Rebuild({});
    case 6: {
      BoundList all = several(1500);
      if (id % 2 == 0) all.doubles.resize(1500);
      return world.Refit(all, true, {});
    }
    case 7:
      return world.Refit(several(world.ids().size()), false, {});
    case 8:
      (void)world.Get(id);
      return;
    case 9:
      return id % 16 == 0 ? world.Clear() : world.Reserve(id);
    case 10:
      return world.Erase(Ids{id, id / 2});
    case 11:
      return world.Set(Ids{id, id / 2}, several(2));
    case 12: {
      Ids ids(id % 300);
      return world.Insert(several(ids.size()), ids);
    }
    case 13: {
      Ids ids;
      for (std::uint32_t i = 0; i < 70; ++i) {
        if (!world.Has(id + i * 97)) ids.push_back(id + i * 97);
      }
      return world.InsertAs(ids, several(ids.size()));
    }
    default:
      for (std::uint32_t i = 0; i < 720; ++i) {
        if (world.Has(i)) world.Erase(i);
      }
  }
}

// Loads the bytes again for each change, and for queries. Returns how often
// the bytes or a query were refused.
inline std::size_t UseAltered(const Layout& layout, Span<const std::byte> blob,
                              const MemoryResource& memory, Random& random) {
  std::size_t refused = 0;
  for (std::size_t first = 0; first <= kAlteredChanges; ++first) {
    try {
      const auto world = LoadBvh(layout, blob, random() % 2 == 0, memory);
      for (std::size_t step = 0; first < kAlteredChanges && step < 4; ++step) {
        try {
          ChangeAltered(*world, step == 0 ? first : random() % kAlteredChanges,
                        step % 2 == 0 ? EverythingOf(layout) : Planes{},
                        random);
        } catch (const std::invalid_argument&) {
          // A refused change must leave a tree that can be used.
        }
      }
      if (first == kAlteredChanges || random() % 8 == 0) {
        AskAltered(*world, random);
      }
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  return refused;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_ALTERED_H_

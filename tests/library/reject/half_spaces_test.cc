// Half-spaces as the query of a flat scan: each target, in each number of
// objects, keeps what the inequalities of shape_reference.h keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "halfspace/bvh_shapes.h"
#include "halfspace/kernels.h"
#include "halfspace/reject_shapes.h"
#include "halfspace/targets.h"
#include "tests/library/bvh/shape_reference.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

template <int kDims>
using List = std::vector<HalfSpace<kDims>>;

template <int kDims>
HalfSpace<kDims> RandomHalfSpace(SeededNumbers& random) {
  HalfSpace<kDims> result{};
  const std::uint32_t kind = random.Below(16);
  for (float& component : result.normal) {
    component = kind == 0 ? random.Special() : random.WithExponent(-3, 3);
  }
  // Of two components, of one, of none.
  if (kind < 6) result.normal[random.Below(kDims)] = 0;
  if (kind == 1) result.normal = {};
  if (kind == 2) {
    result.normal = {};
    result.normal[random.Below(kDims)] = random.WithExponent(-3, 3);
  }
  result.offset = kind == 3 ? random.Special() : random.WithExponent(0, 5);
  return result;
}

// Sides of a box, which other half-spaces cut off.
template <int kDims>
void AddBox(SeededNumbers& random, List<kDims>& list) {
  for (std::size_t k = 0; k < kDims; ++k) {
    for (const float sign : {-1.f, 1.f}) {
      HalfSpace<kDims> side{};
      side.normal[k] = sign;
      side.offset = std::abs(random.WithExponent(1, 4));
      list.push_back(side);
    }
  }
}

// Moves a corner to where the sum of a test is about 0.
template <int kDims>
void MoveToFace(const HalfSpace<kDims>& face, const Layout& layout,
                SeededNumbers& random, Planes& planes) {
  const std::size_t moved = random.Below(kDims);
  double rest = face.offset;
  for (std::size_t k = 0; k < kDims; ++k) {
    const bool is_max = layout.has_max && face.normal[k] > 0;
    if (k != moved)
      rest += double{face.normal[k]} * planes[k + (is_max ? layout.axes : 0u)];
  }
  const auto value = static_cast<float>(-rest / face.normal[moved]);
  if (!std::isfinite(value)) return;
  const bool is_max = layout.has_max && face.normal[moved] > 0;
  planes[moved + (is_max ? layout.axes : 0u)] =
      value * (1 + random.WithExponent(-24, -14));
}

// On every target the same objects are inside, all of them survive, and their
// nearest corners are in front: room(i) is by how much, relative to the numbers
// that this is computed of, or NaN.
template <typename View, typename Query, typename Room>
void ExpectInside(const View& view, const Query& query, const Room& room) {
  const std::size_t words = MaskWords(view.size);
  std::vector<std::uint64_t> survivors(words);
  std::vector<std::uint64_t> expected(words);
  ClassifyMasks(view, query, survivors, expected,
                {.target = SupportedTargets().back()});
  std::vector<std::uint64_t> mask(words);
  SurvivorMask(view, query, mask);
  EXPECT_EQ(survivors, mask);
  for (std::size_t i = 0; i < view.size; ++i) {
    const bool is_inside = (expected[i / 64] >> i % 64 & 1) != 0;
    const long double its_room = room(i);
    if (its_room >= 0x1p-16L) {
      ASSERT_TRUE(is_inside) << "object " << i;
    } else if (its_room < -0x1p-16L) {
      ASSERT_FALSE(is_inside) << "object " << i;
    }
    ASSERT_TRUE(!is_inside || (survivors[i / 64] >> i % 64 & 1) != 0);
  }
  for (const Target target : SupportedTargets()) {
    ClassifyMasks(view, query, survivors, mask, {.target = target});
    ASSERT_EQ(mask, expected) << target.name();
  }
}

// Because a component is great (bvh_shapes.h).
template <int kDims>
bool KeepsAll(const HalfSpace<kDims>& face) {
  return std::any_of(face.normal.begin(), face.normal.end(),
                     [](float x) { return std::abs(x) > 0x1p126f; });
}

// Of the corners nearest to each half-space.
template <int kDims, typename NearestOf>
long double RoomOfNearest(const List<kDims>& list, const NearestOf& nearest_of,
                          long double radius) {
  long double least = 1;
  for (const auto& face : list) {
    long double sum = face.offset;
    long double size = std::abs(sum);
    long double squared = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      const long double term = face.normal[k] == 0
                                   ? 0
                                   : static_cast<long double>(face.normal[k]) *
                                         nearest_of(k, face.normal[k] > 0);
      sum += term;
      size += std::abs(term);
      squared += static_cast<long double>(face.normal[k]) * face.normal[k];
    }
    if (KeepsAll(face)) return std::numeric_limits<long double>::quiet_NaN();
    sum -= std::sqrt(squared) * radius;
    const long double room = sum / (size + std::sqrt(squared) * radius);
    if (std::isnan(room)) return room;
    least = std::min(least, room);
  }
  return least;
}

// The calls of kernels.h, on the chosen target.
template <int kDims, typename View>
std::vector<std::uint64_t> Unchecked(const View& view,
                                     const List<kDims>& list) {
  std::vector<std::uint64_t> mask(MaskWords(view.size), 1);
  const HalfSpace<kDims>* const data = list.data();
  if constexpr (std::is_same_v<View, AabbView<2>>) {
    SurvivorsOfBoxes2(view.min.data(), view.size, data, list.size(),
                      mask.data());
  } else if constexpr (std::is_same_v<View, AabbView<3>>) {
    SurvivorsOfBoxes3(view.min.data(), view.size, data, list.size(),
                      mask.data());
  } else if constexpr (std::is_same_v<View, AaboView<2>>) {
    SurvivorsOfOctahedra2(view.min.data(), view.size, data, list.size(),
                          mask.data());
  } else if constexpr (std::is_same_v<View, AaboView<3>>) {
    SurvivorsOfOctahedra3(view.min.data(), view.size, data, list.size(),
                          mask.data());
  } else if constexpr (std::is_same_v<View, SphereView<2>>) {
    SurvivorsOfSpheres2(view.center.data(), view.size, data, list.size(),
                        mask.data());
  } else if constexpr (std::is_same_v<View, SphereView<3>>) {
    SurvivorsOfSpheres3(view.center.data(), view.size, data, list.size(),
                        mask.data());
  } else {
    SurvivorMask(view, list, mask);  // kernels.h has none for simplices
  }
  return mask;
}

template <typename AnyWorld>
void ExpectKeeps(std::uint64_t seed) {
  using Bound = typename AnyWorld::Bound;
  constexpr int kDims = Bound::kDimensions;
  const Layout& layout = detail::kLayoutOf<Bound>;
  SeededNumbers random(seed);
  for (const std::size_t size : {1u, 63u, 64u, 65u, 127u, 300u, 2100u}) {
    List<kDims> list;
    if (random.Below(2) != 0) AddBox<kDims>(random, list);
    for (std::size_t more = random.Below(8); more > 0; --more) {
      list.push_back(RandomHalfSpace<kDims>(random));
    }
    AnyWorld world;
    std::vector<bool> expected;
    Shape shape{Shape::kHalfSpaces, {}};
    for (const auto& face : list) {
      shape.numbers.insert(shape.numbers.end(), face.normal.begin(),
                           face.normal.end());
      shape.numbers.push_back(face.offset);
    }
    const ShapeReference reference(layout, shape);
    for (std::size_t i = 0; i < size; ++i) {
      Planes planes{};
      for (std::size_t p = 0; p < layout.axes; ++p) {
        planes[p] = random.WithExponent(-2, 4);
        if (layout.has_max) {
          planes[p + layout.axes] = planes[p] + random.WithExponent(-6, 1);
        }
      }
      // Wide bounds, whose minima or maxima alone have great numbers.
      const bool is_wide = layout.has_max && random.Below(3) == 0;
      if (is_wide) {
        const float down = std::abs(random.WithExponent(-4, 16));
        const float up = std::abs(random.WithExponent(-4, 16));
        for (std::size_t p = 0; p < layout.axes; ++p) {
          planes[p] = -std::abs(planes[p]) * down;
          planes[p + layout.axes] = std::abs(planes[p + layout.axes]) * up;
        }
      }
      if (random.Below(2) != 0 && !list.empty()) {
        const Planes before = planes;
        MoveToFace<kDims>(
            list[random.Below(static_cast<std::uint32_t>(list.size()))], layout,
            random, planes);
        // Targets may differ about a minimum above its maximum.
        for (std::size_t k = 0; is_wide && k < kDims; ++k) {
          if (planes[k] > planes[k + layout.axes]) planes = before;
        }
      }
      if (random.Below(20) == 0) {
        planes[random.Below(layout.plane_count)] = random.Special();
      }
      Bound bound;
      std::memcpy(&bound, planes.data(), sizeof(bound));
      world.Push(bound);
      expected.push_back(reference.Keeps(planes));
    }
    std::vector<std::uint64_t> all(MaskWords(size));
    SurvivorMask(world, list, all);
    EXPECT_EQ(Unchecked<kDims>(world.view(), list), all);
    if constexpr (detail::HasMax<Bound>) {
      const auto view = world.view();
      ExpectInside(view, list, [&](std::size_t i) -> long double {
        // Not of numbers, or of a minimum above its maximum.
        for (std::size_t k = 0; k < kDims; ++k) {
          const float width = view.max[k][i] - view.min[k][i];
          if (!(width >= 0 && std::isfinite(width))) {
            return std::numeric_limits<long double>::quiet_NaN();
          }
        }
        return RoomOfNearest<kDims>(
            list,
            [&](std::size_t k, bool is_up) {
              return is_up ? view.min[k][i] : view.max[k][i];
            },
            0);
      });
      if (::testing::Test::HasFatalFailure()) return;
    }
    const Range range{random.Below(2) * size / 3, size};
    std::vector<std::uint64_t> mask(MaskWords(size));
    for (const Target target : SupportedTargets()) {
      SCOPED_TRACE(::testing::Message()
                   << target.name() << ", " << size << " objects, "
                   << list.size() << " half-spaces");
      SurvivorMask(world, list, mask, {.target = target, .range = range});
      for (std::size_t i = range.begin; i < size; ++i) {
        const std::size_t bit = i - range.begin;
        ASSERT_EQ((mask[bit / 64] >> bit % 64 & 1) != 0, expected[i])
            << "object " << i;
      }
      EXPECT_EQ(mask[(size - range.begin - 1) / 64] >>
                    ((size - range.begin - 1) % 64) >> 1,
                0u);
    }
  }
}

// Spheres, and a list of half-spaces, a box, a sphere or a rounded box.
template <int kDims>
class SpheresTest {
 public:
  explicit SpheresTest(std::uint64_t seed) : random_(seed) {}

  void Run(std::size_t size) {
    List<kDims> list;
    if (random_.Below(2) != 0) AddBox<kDims>(random_, list);
    for (std::size_t more = random_.Below(8); more > 0; --more) {
      list.push_back(RandomHalfSpace<kDims>(random_));
    }
    // Unit normals, as cameras have.
    if (random_.Below(2) != 0) {
      for (auto& face : list) {
        double squared = 0;
        for (const float x : face.normal) squared += double{x} * x;
        for (float& x : face.normal) {
          x = static_cast<float>(x / std::sqrt(squared));
        }
      }
    }
    RoundedBox<kDims> box;
    for (std::size_t k = 0; k < kDims; ++k) {
      box.box.min[k] = random_.WithExponent(-2, 3);
      box.box.max[k] = box.box.min[k] + std::abs(random_.WithExponent(-3, 3));
    }
    box.radius = std::abs(random_.WithExponent(-3, 2));
    const Sphere<kDims> sphere = {box.box.min, box.radius};
    for (auto& plane : planes_) plane.clear();
    for (std::size_t i = 0; i < size; ++i) Add(list, box);
    SphereView<kDims> view;
    for (std::size_t k = 0; k < kDims; ++k) view.center[k] = planes_[k].data();
    view.radius = planes_[kDims].data();
    view.size = size;
    Expect(view, list, [&](std::size_t i) { return RoomIn(list, i); });
    Expect(view, box, [&](std::size_t i) {
      return RoomTo(box.box.min, box.box.max, box.radius, i);
    });
    Expect(view, box.box, [&](std::size_t i) {
      return RoomTo(box.box.min, box.box.max, 0, i);
    });
    Expect(view, sphere, [&](std::size_t i) {
      return RoomTo(sphere.center, sphere.center, sphere.radius, i);
    });
  }

 private:
  using Exact = long double;

  void Add(const List<kDims>& list, const RoundedBox<kDims>& box) {
    std::array<float, kDims + 1> values;
    for (float& value : values) value = random_.WithExponent(-2, 4);
    values[kDims] = std::abs(random_.WithExponent(-4, 2));
    // To where it just touches.
    if (random_.Below(3) == 0 && !list.empty()) {
      const auto& face =
          list[random_.Below(static_cast<std::uint32_t>(list.size()))];
      double sum = face.offset;
      double squared = 0;
      for (std::size_t k = 0; k < kDims; ++k) {
        sum += double{face.normal[k]} * values[k];
        squared += double{face.normal[k]} * face.normal[k];
      }
      values[kDims] = std::abs(static_cast<float>(
          sum / std::sqrt(squared) * (1 + random_.WithExponent(-24, -16))));
    } else if (random_.Below(2) == 0) {
      Exact distance = 0;
      for (std::size_t k = 0; k < kDims; ++k) {
        distance += Square(Apart(values[k], box.box.min[k], box.box.max[k]));
      }
      values[kDims] = std::max(
          0.f, static_cast<float>((std::sqrt(distance) - box.radius) *
                                  (1 + random_.WithExponent(-24, -16))));
    }
    if (random_.Below(20) == 0)
      values[random_.Below(kDims)] = random_.Special();
    for (std::size_t p = 0; p <= kDims; ++p) planes_[p].push_back(values[p]);
  }

  static Exact Square(Exact x) { return x * x; }
  static Exact Apart(Exact x, Exact low, Exact high) {
    return std::max({low - x, x - high, Exact{0}});
  }

  // How far a sphere reaches beyond what it must touch, relative to the numbers
  // that this is computed of. NaN if a number is no finite float.
  Exact RoomIn(const List<kDims>& list, std::size_t i) const {
    Exact least = 1;
    // The axis-aligned ones are a box.
    Exact size = planes_[kDims][i];
    std::array<Exact, kDims> apart{};
    for (const auto& face : list) {
      Exact sum = face.offset;
      Exact squared = 0;
      Exact magnitude = std::abs(sum);
      std::size_t components = 0;
      std::size_t axis = 0;
      for (std::size_t k = 0; k < kDims; ++k) {
        const Exact term = Exact{face.normal[k]} * planes_[k][i];
        sum += term;
        magnitude += std::abs(term);
        squared += Square(face.normal[k]);
        if (face.normal[k] == 0) continue;
        ++components;
        axis = k;
      }
      if (KeepsAll(face)) return std::numeric_limits<Exact>::quiet_NaN();
      const Exact length = std::sqrt(squared);
      if (components == 1) {
        apart[axis] = std::max(apart[axis], -sum / length);
        size += magnitude / length;
        if (std::isnan(size)) return size;
        continue;
      }
      const Exact reach = length * planes_[kDims][i];
      const Exact room = (sum + reach) / (magnitude + reach);
      if (std::isnan(room)) return room;
      least = std::min(least, room);
    }
    Exact squared = 0;
    for (const Exact gap : apart) squared += Square(gap);
    return std::min(
        least, (planes_[kDims][i] - std::sqrt(squared)) / (size + 0x1p-60L));
  }
  Exact RoomTo(const Point<kDims>& low, const Point<kDims>& high, Exact radius,
               std::size_t i) const {
    Exact squared = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      squared += Square(Apart(planes_[k][i], low[k], high[k]));
      if (!std::isfinite(planes_[k][i])) return planes_[k][i] * Exact{0};
    }
    const Exact reach = Exact{planes_[kDims][i]} + radius;
    return (reach - std::sqrt(squared)) /
           (reach + std::sqrt(squared) + 0x1p-60L);
  }

  template <typename Query, typename Room>
  void Expect(const SphereView<kDims>& view, const Query& query,
              const Room& room) {
    const std::size_t words = MaskWords(view.size);
    std::vector<std::uint64_t> expected(words);
    SurvivorMask(view, query, expected, {.target = SupportedTargets().back()});
    for (std::size_t i = 0; i < view.size; ++i) {
      const Exact its_room = room(i);
      if (its_room >= 0) {
        ASSERT_TRUE(expected[i / 64] >> i % 64 & 1) << "object " << i;
      } else if (its_room < -0x1p-16L) {
        ASSERT_FALSE(expected[i / 64] >> i % 64 & 1) << "object " << i;
      }
    }
    std::vector<std::uint64_t> mask(words);
    for (const Target target : SupportedTargets()) {
      SurvivorMask(view, query, mask, {.target = target});
      ASSERT_EQ(mask, expected) << target.name();
    }
    if constexpr (std::is_same_v<Query, List<kDims>>) {
      EXPECT_EQ(Unchecked<kDims>(view, query), expected);
      ExpectInside(view, query, [&](std::size_t i) -> Exact {
        for (const auto& plane : planes_) {
          if (plane[i] * 0 != 0) return plane[i] * 0;
        }
        return RoomOfNearest<kDims>(
            query, [&](std::size_t k, bool) { return planes_[k][i]; },
            planes_[kDims][i]);
      });
    }
  }

  SeededNumbers random_;
  std::array<std::vector<float>, kDims + 1> planes_;
};

TEST(HalfSpacesTest, OfSpheres) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    for (const std::size_t size : {1u, 63u, 64u, 65u, 127u, 300u, 1100u}) {
#if !defined(HALFSPACE_TEST_ONLY_3D)
      SpheresTest<2>(seed).Run(size);
#endif
      SpheresTest<3>(seed).Run(size);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

// A side beyond all floats rejects nothing, or everything that is finite.
TEST(HalfSpacesTest, SidesBeyondFloats) {
  constexpr float kFar = 3e38f;
  AabbWorld3 world;
  world.Push({{-kFar, 0, 0}, {-kFar, 1, 1}});
  world.Push({{kFar, 0, 0}, {kFar, 1, 1}});
  const auto survivors = [&](float normal, float offset) {
    const List<3> list = {{{normal, 0, 0}, offset}};
    std::uint64_t mask = 0;
    SurvivorMask(world, list, Span<std::uint64_t>(&mask, 1));
    const Bvh<AabbView3> bvh(world);
    EXPECT_EQ(CountSurvivors(bvh, list),
              static_cast<std::size_t>(std::popcount(mask)));
    return mask;
  };
  EXPECT_EQ(survivors(1e-3f, kFar), 3u);
  EXPECT_EQ(survivors(-1e-3f, kFar), 3u);
  EXPECT_EQ(survivors(1, kFar), 3u);
  EXPECT_EQ(survivors(-1, kFar), 3u);
  EXPECT_EQ(survivors(1, 0), 2u);
}

// The walk of a BVH computes in a mode of its own.
TEST(HalfSpacesTest, AFunctionThatThrowsKeepsItsMode) {
  AabbWorld3 world;
  for (int i = 0; i < 5000; ++i) world.Push({{}, {1, 1, 1}});
  const Bvh<AabbView3> bvh(world.view());
  const List<3> all = {{{1, 1, 1}, 0}};
  const auto ask = [&] {
    ForEachSurvivor(bvh, all, [](Span<const std::uint32_t>) {
      EXPECT_EQ(std::fegetround(), FE_TONEAREST);
      std::fesetround(FE_DOWNWARD);
      throw std::runtime_error("in a function");
    });
  };
  EXPECT_THROW(ask(), std::runtime_error);
  EXPECT_EQ(std::fegetround(), FE_DOWNWARD);
  std::fesetround(FE_TONEAREST);
}

TEST(HalfSpacesTest, SeveralFrustaAreRows) {
  SeededNumbers random(1);
  AabbWorld3 world;
  for (int i = 0; i < 100; ++i) {
    Aabb3 box;
    for (std::size_t k = 0; k < 3; ++k) {
      box.min[k] = random.WithExponent(-2, 4);
      box.max[k] = box.min[k] + 1;
    }
    world.Push(box);
  }
  std::vector<Frustum3> frusta(3);
  for (Frustum3& frustum : frusta) {
    for (HalfSpace3& side : frustum) side = RandomHalfSpace<3>(random);
    frustum[3] = {{0, 0, 0}, 1};
  }
  std::vector<std::uint64_t> mask(2);
  std::vector<std::uint64_t> rows(3 * 3 - 1, 7);
  SurvivorMasks(world, frusta, rows, {}, 3);
  for (std::size_t q = 0; q < 3; ++q) {
    SurvivorMask(world, frusta[q], mask);
    EXPECT_EQ(rows[3 * q], mask[0]);
    EXPECT_EQ(rows[3 * q + 1], mask[1]);
    if (q < 2) {
      EXPECT_EQ(rows[3 * q + 2], 7u);
    }
  }
  EXPECT_THROW(
      SurvivorMasks(world, frusta, Span<std::uint64_t>(rows.data(), 4)),
      std::invalid_argument);
  EXPECT_THROW(ClassifyMasks(world, frusta[0], mask, mask),
               std::invalid_argument);
  EXPECT_THROW(ClassifyMasks(world, frusta[0], mask,
                             Span<std::uint64_t>(rows.data(), 1)),
               std::invalid_argument);
}

TEST(HalfSpacesTest, EachTargetKeepsTheSame) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
#if !defined(HALFSPACE_TEST_ONLY_3D)
    ExpectKeeps<AabbWorld2>(seed);
    ExpectKeeps<AaboWorld2>(seed);
    ExpectKeeps<SimplexWorld2>(seed);
#endif
    ExpectKeeps<AabbWorld3>(seed);
    ExpectKeeps<AaboWorld3>(seed);
    ExpectKeeps<SimplexWorld3>(seed);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace halfspace::testing

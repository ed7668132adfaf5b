// Half-spaces as the query of a flat scan: each target, in each number of
// objects, keeps what the inequalities of shape_reference.h keep.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

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
      if (random.Below(2) != 0 && !list.empty()) {
        MoveToFace<kDims>(
            list[random.Below(static_cast<std::uint32_t>(list.size()))], layout,
            random, planes);
      }
      if (random.Below(20) == 0) {
        planes[random.Below(layout.plane_count)] = random.Special();
      }
      Bound bound;
      std::memcpy(&bound, planes.data(), sizeof(bound));
      world.Push(bound);
      expected.push_back(reference.Keeps(planes));
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

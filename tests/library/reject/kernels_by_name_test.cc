// Each function of kernels.h, and so of c/kernels.h, is that of its bound: the
// other tests call them by the tables of KernelsOf().
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "halfspace/kernels.h"

namespace halfspace::testing {
namespace {

template <typename T>
void ExpectSame(const typename Kernels<T>::OfBound& by_name,
                const typename Kernels<T>::OfBound& in_table) {
  constexpr std::size_t kObjects = 3 * 64 + 7;
  constexpr std::size_t kQueries = 3;
  constexpr std::size_t kMostPlanes = 10;
  std::mt19937 random(1);
  std::uniform_real_distribution<T> value(0, 1);
  std::vector<T> values(kMostPlanes * kObjects);
  for (T& v : values) v = value(random);
  std::array<const T*, kMostPlanes> planes;
  for (std::size_t p = 0; p < kMostPlanes; ++p) {
    planes[p] = &values[p * kObjects];
  }
  std::vector<T> queries(kQueries * kMostPlanes);
  for (T& v : queries) v = T{0.5} + value(random) / 4;
  using Masks = std::array<std::uint64_t, kQueries*(kObjects / 64 + 1)>;
  const auto masks_of = [&](const auto& functions) {
    Masks masks{};
    functions.several(planes.data(), kObjects, queries.data(), kQueries,
                      masks.data());
    return masks;
  };
  const auto mask_of = [&](const auto& functions) {
    Masks mask{};
    functions.one(planes.data(), kObjects, queries.data(), mask.data());
    return mask;
  };
  EXPECT_EQ(masks_of(by_name), masks_of(in_table));
  EXPECT_EQ(mask_of(by_name), mask_of(in_table));
}

TEST(KernelsByName, OfFloats) {
  const auto& table = KernelsOf<float>();
  ExpectSame<float>({&SurvivorsOfBoxes3, &SurvivorsOfBoxes3}, table.boxes3);
  ExpectSame<float>({&SurvivorsOfSimplices3, &SurvivorsOfSimplices3},
                    table.simplices3);
  ExpectSame<float>({&SurvivorsOfOctahedra3, &SurvivorsOfOctahedra3},
                    table.octahedra3);
#if !defined(HALFSPACE_TEST_ONLY_3D)  // which a library of 3D alone lacks
  ExpectSame<float>({&SurvivorsOfBoxes2, &SurvivorsOfBoxes2}, table.boxes2);
  ExpectSame<float>({&SurvivorsOfBoxes4, &SurvivorsOfBoxes4}, table.boxes4);
  ExpectSame<float>({&SurvivorsOfSimplices2, &SurvivorsOfSimplices2},
                    table.simplices2);
  ExpectSame<float>({&SurvivorsOfSimplices4, &SurvivorsOfSimplices4},
                    table.simplices4);
  ExpectSame<float>({&SurvivorsOfOctahedra2, &SurvivorsOfOctahedra2},
                    table.octahedra2);
  ExpectSame<float>({&SurvivorsOfOctahedra4, &SurvivorsOfOctahedra4},
                    table.octahedra4);
#endif
}
TEST(KernelsByName, OfDoubles) {
  const auto& table = KernelsOf<double>();
  ExpectSame<double>({&SurvivorsOfBoxes3, &SurvivorsOfBoxes3}, table.boxes3);
#if !defined(HALFSPACE_TEST_ONLY_3D)
  ExpectSame<double>({&SurvivorsOfBoxes2, &SurvivorsOfBoxes2}, table.boxes2);
  ExpectSame<double>({&SurvivorsOfBoxes4, &SurvivorsOfBoxes4}, table.boxes4);
#endif
}

TEST(KernelsByName, NothingIsWrittenWithoutObjectsOrQueries) {
  const float query[6] = {};
  const float* const planes[6] = {};
  std::uint64_t word = 5;
  SurvivorsOfBoxes3(planes, 0, query, &word);
  SurvivorsOfBoxes3(static_cast<const float* const*>(nullptr), 0, nullptr,
                    nullptr);
  SurvivorsOfBoxes3(planes, 0, query, 1, &word);
  const float value = 0;
  const float* const full[6] = {&value, &value, &value, &value, &value, &value};
  SurvivorsOfBoxes3(full, 1, query, 0, &word);
  EXPECT_EQ(word, 5u);
  SurvivorsOfBoxes3(full, 1, query, &word);
  EXPECT_EQ(word, 1u);
}

}  // namespace
}  // namespace halfspace::testing

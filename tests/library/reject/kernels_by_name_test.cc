// Each function of kernels.h, and so of c/kernels.h, is that of its bound: the
// other tests call them by the tables of KernelsOf().
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <type_traits>
#include <vector>

#include "halfspace/kernels.h"
#include "halfspace/targets.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kObjects = 3 * 64 + 7;
constexpr std::size_t kQueries = 3;
constexpr std::size_t kMostPlanes = 10;

template <typename T>
struct Names {
  const char* name;
  void (*one)(const T* const*, std::size_t, const T*, std::uint64_t*) noexcept;
  void (*several)(const T* const*, std::size_t, const T*, std::size_t,
                  std::uint64_t*) noexcept;
  typename Kernels<T>::OfBound Kernels<T>::*table;
};

template <typename T>
void CheckNames(const std::vector<Names<T>>& all) {
  using K = Kernels<T>;
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

  constexpr std::size_t kWords = (kObjects + 63) / 64;
  std::vector<std::vector<std::uint64_t>> seen;
  for (const Names<T>& names : all) {
    SCOPED_TRACE(names.name);
    const auto& table = KernelsOf<T>(ChosenTarget()).*names.table;
    ASSERT_NE(table.one, nullptr);
    std::vector<std::uint64_t> expected(kQueries * kWords);
    std::vector<std::uint64_t> mask(kWords);
    std::vector<std::uint64_t> masks(kQueries * kWords);
    table.several(planes.data(), kObjects, queries.data(), kQueries,
                  expected.data());
    names.several(planes.data(), kObjects, queries.data(), kQueries,
                  masks.data());
    EXPECT_EQ(masks, expected);
    names.one(planes.data(), kObjects, queries.data(), mask.data());
    expected.resize(kWords);
    EXPECT_EQ(mask, expected);
    // An octahedron of 2 dimensions has the planes of a box of 3, and so on.
    if constexpr (std::is_same_v<T, float>) {
      if (names.table == &K::octahedra2 || names.table == &K::octahedra3)
        continue;
    }
    for (const auto& other : seen) EXPECT_NE(mask, other);
    seen.push_back(mask);
  }
}

TEST(KernelsByName, OfFloats) {
  using K = Kernels<float>;
  CheckNames<float>({
    {"boxes3", &SurvivorsOfBoxes3, &SurvivorsOfBoxes3, &K::boxes3},
        {"simplices3", &SurvivorsOfSimplices3, &SurvivorsOfSimplices3,
         &K::simplices3},
        {"octahedra3", &SurvivorsOfOctahedra3, &SurvivorsOfOctahedra3,
         &K::octahedra3},
#if !defined(HALFSPACE_TEST_ONLY_3D)  // which a library of 3D alone lacks
        {"boxes2", &SurvivorsOfBoxes2, &SurvivorsOfBoxes2, &K::boxes2},
        {"boxes4", &SurvivorsOfBoxes4, &SurvivorsOfBoxes4, &K::boxes4},
        {"simplices2", &SurvivorsOfSimplices2, &SurvivorsOfSimplices2,
         &K::simplices2},
        {"simplices4", &SurvivorsOfSimplices4, &SurvivorsOfSimplices4,
         &K::simplices4},
        {"octahedra2", &SurvivorsOfOctahedra2, &SurvivorsOfOctahedra2,
         &K::octahedra2},
        {"octahedra4", &SurvivorsOfOctahedra4, &SurvivorsOfOctahedra4,
         &K::octahedra4},
#endif
  });
}
TEST(KernelsByName, OfDoubles) {
  using K = Kernels<double>;
  CheckNames<double>({
    {"boxes3", &SurvivorsOfBoxes3, &SurvivorsOfBoxes3, &K::boxes3},
#if !defined(HALFSPACE_TEST_ONLY_3D)
        {"boxes2", &SurvivorsOfBoxes2, &SurvivorsOfBoxes2, &K::boxes2},
        {"boxes4", &SurvivorsOfBoxes4, &SurvivorsOfBoxes4, &K::boxes4},
#endif
  });
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

// Typed tests over 2, 3 and 4 dimensions, or those that this build tests.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_DIMS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_DIMS_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

namespace halfspace::testing {

template <int kDims>
using DimsConstant = std::integral_constant<int, kDims>;

#if defined(HALFSPACE_TEST_ONLY_3D)
using AllDims = ::testing::Types<DimsConstant<3>>;
#else
using AllDims =
    ::testing::Types<DimsConstant<2>, DimsConstant<3>, DimsConstant<4>>;
#endif

// The same, for loops.
inline std::vector<std::size_t> TestDims() {
#if defined(HALFSPACE_TEST_ONLY_3D)
  return {3};
#else
  return {2, 3, 4};
#endif
}

struct DimsNames {
  template <typename Dims>
  static std::string GetName(int) {
    return std::to_string(Dims::value) + "D";
  }
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_DIMS_H_

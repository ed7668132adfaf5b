// The dimensions that this build tests.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_DIMS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_DIMS_H_

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace halfspace::testing {

template <int kDims>
using DimsConstant = std::integral_constant<int, kDims>;

// Of each file by itself: rows of tables are compiled for all dimensions that
// the library has.
[[maybe_unused]] static std::vector<std::size_t> TestDims() {
#if defined(HALFSPACE_TEST_ONLY_3D)
  return {3};
#else
  return {2, 3, 4};
#endif
}

// Forgets the rows of other dimensions.
template <typename Row>
std::vector<Row> InDims(const std::vector<std::size_t>& dims,
                        std::vector<Row> rows) {
  std::erase_if(rows, [&](const Row& row) {
    return std::find(dims.begin(), dims.end(), row.layout.dims) == dims.end();
  });
  return rows;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_DIMS_H_

// World sizes that reach every path of the kernels.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_SIZES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_SIZES_H_

#include <algorithm>
#include <cstddef>
#include <vector>

#include "dispatch/scan/prepare.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {

// Every size to four of the widest vectors and one more object, and at least
// to two output words and a tail.
inline std::vector<std::size_t> EverySmallSize() {
  const std::size_t last =
      std::max(4 * MostLanes() + 1, 2 * 64 + MostLanes() + 1);
  std::vector<std::size_t> sizes(last + 1);
  for (std::size_t n = 0; n <= last; ++n) sizes[n] = n;
  return sizes;
}

// Around the 4096 objects that a staged scan takes at a time, and around those
// from which on a few boxes are staged.
inline std::vector<std::size_t> SizesAroundTiles() {
  return {255,
          257,
          511,
          512 + 37,
          1024 + 1,
          4095,
          4096,
          4097,
          4096 + 64 + 1,
          2 * 4096 - 64,
          2 * 4096 + 5 * 64 + 37};
}

// Around where planes are taken page by page, for objects of `record_bytes`;
// and whole pages of words and a part of one beyond, with a tail.
inline std::vector<std::size_t> SizesFromMemory(std::size_t record_bytes) {
  const std::size_t last = dispatch::kInCacheBytes / record_bytes / 64 * 64;
  return {last, last + 64, last + 4096 + 7 * 64 + 37};
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_SIZES_H_

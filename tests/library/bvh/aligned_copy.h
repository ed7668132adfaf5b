// A copy of a blob where Bvh::InPlace() can use it.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_ALIGNED_COPY_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_ALIGNED_COPY_H_

#include <cstddef>
#include <span>
#include <vector>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/span.h"

namespace halfspace::testing {

// 64-byte aligned bytes.
class AlignedCopy {
 public:
  explicit AlignedCopy(Span<const std::byte> bytes)
      : bytes_(bytes.begin(), bytes.end()) {}
  std::span<std::byte> bytes() const { return bytes_; }

 private:
  mutable std::vector<std::byte, detail::BlockAllocator<std::byte>> bytes_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_ALIGNED_COPY_H_

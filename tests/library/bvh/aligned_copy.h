// A blob where Bvh::InPlace() can use it.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_ALIGNED_COPY_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_ALIGNED_COPY_H_

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "halfspace/span.h"

namespace halfspace::testing {

// 64-byte aligned bytes.
class AlignedCopy {
 public:
  explicit AlignedCopy(Span<const std::byte> bytes)
      : memory_(bytes.size() + 64) {
    void* begin = memory_.data();
    std::size_t room = memory_.size();
    std::align(64, bytes.size(), begin, room);
    bytes_ = {static_cast<std::byte*>(begin), bytes.size()};
    std::copy(bytes.begin(), bytes.end(), bytes_.begin());
  }
  AlignedCopy(const AlignedCopy&) = delete;
  AlignedCopy& operator=(const AlignedCopy&) = delete;
  std::span<std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> memory_;
  std::span<std::byte> bytes_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_ALIGNED_COPY_H_

// Temporary memory of a build, a change or a query.
#ifndef HALFSPACE_DISPATCH_BVH_SCRATCH_H_
#define HALFSPACE_DISPATCH_BVH_SCRATCH_H_

#include <cstddef>
#include <vector>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/memory.h"

namespace halfspace::detail {

template <typename T>
using BlockVector = std::vector<T, BlockAllocator<T>>;

// A block from the resource of a world. With 0 bytes it allocates nothing.
class Scratch {
 public:
  Scratch(const MemoryResource& memory, std::size_t bytes)
      : memory_(memory),
        bytes_(bytes),
        data_(bytes == 0
                  ? nullptr
                  : static_cast<std::byte*>(AllocateBlock(memory, bytes))) {}
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    if (data_ != nullptr) FreeBlock(memory_, data_, bytes_);
  }

  std::byte* data() const { return data_; }

 private:
  MemoryResource memory_;
  std::size_t bytes_;
  std::byte* data_;
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_SCRATCH_H_

// Temporary memory of a build, a change or a query.
#ifndef HALFSPACE_DISPATCH_BVH_SCRATCH_H_
#define HALFSPACE_DISPATCH_BVH_SCRATCH_H_

#include <cstddef>
#include <functional>
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

// The temporary memory of a call. The first 8 KB are on the stack: a world of
// 100 bodies otherwise spends a third of a frame in operator new.
class CallMemory {
 public:
  explicit CallMemory(const MemoryResource& memory) : memory_(memory) {}
  CallMemory(const CallMemory&) = delete;
  CallMemory& operator=(const CallMemory&) = delete;

  MemoryResource resource() { return MemoryFrom(*this); }
  void* allocate(std::size_t bytes, std::size_t alignment) {
    if (bytes > kRoom - used_) return AllocateBlock(memory_, bytes);
    std::byte* const block = room_ + used_;
    used_ += (bytes + alignment - 1) / alignment * alignment;
    return block;
  }
  void deallocate(void* block, std::size_t bytes, std::size_t /*alignment*/) {
    const std::less<const void*> is_before;
    if (is_before(block, room_) || !is_before(block, room_ + kRoom)) {
      FreeBlock(memory_, block, bytes);
    }
  }

 private:
  static constexpr std::size_t kRoom = 8192;

  MemoryResource memory_;
  std::size_t used_ = 0;
  alignas(64) std::byte room_[kRoom];
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_SCRATCH_H_

// Internal. The floats of a QuantizedWorld. Not part of the interface.
#ifndef HALFSPACE_DETAIL_RECORDS_H_
#define HALFSPACE_DETAIL_RECORDS_H_

#include <cstddef>
#include <type_traits>
#include <utility>

#include "halfspace/detail/block_memory.h"
#include "halfspace/memory.h"

namespace halfspace::detail {

// An array of bounds in the memory of a resource. Not a std::vector, because
// <vector> adds 7000 lines in C++20. The owner checks indices, and reserves
// memory before it pushes.
template <typename Bound>
class Records {
  static_assert(std::is_trivially_copyable_v<Bound>);

 public:
  explicit Records(const MemoryResource& memory) : memory_(memory) {}
  Records(const Records& other, const MemoryResource& memory)
      : Records(memory) {
    Reserve(other.size_);
    for (; size_ < other.size_; ++size_) data_[size_] = other.data_[size_];
  }
  Records(Records&& other) noexcept : Records(other.memory_) {
    swap(*this, other);
  }
  Records& operator=(Records&&) = delete;
  ~Records() {
    if (data_ != nullptr) FreeBlock(memory_, data_, capacity_ * sizeof(Bound));
  }
  friend void swap(Records& a, Records& b) noexcept {
    std::swap(a.memory_, b.memory_);
    std::swap(a.data_, b.data_);
    std::swap(a.size_, b.size_);
    std::swap(a.capacity_, b.capacity_);
  }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  const Bound* data() const { return data_; }
  Bound& operator[](std::size_t i) { return data_[i]; }
  const Bound& operator[](std::size_t i) const { return data_[i]; }

  void Reserve(std::size_t count) {
    if (count <= capacity_) return;
    constexpr std::size_t kMost = static_cast<std::size_t>(-1) / sizeof(Bound);
    // If the size does not fit the address space, the allocation fails.
    const std::size_t bytes = (count < kMost ? count : kMost) * sizeof(Bound);
    Records more(memory_);
    more.data_ = static_cast<Bound*>(AllocateBlock(memory_, bytes));
    more.capacity_ = count;
    for (; more.size_ < size_; ++more.size_) {
      more.data_[more.size_] = data_[more.size_];
    }
    swap(*this, more);
  }
  void Push(const Bound& bound) { data_[size_++] = bound; }
  void EraseBySwap(std::size_t index) { data_[index] = data_[--size_]; }
  void Clear() { size_ = 0; }

 private:
  MemoryResource memory_;
  Bound* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_RECORDS_H_

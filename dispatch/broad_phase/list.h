// A list of plain values in memory of the caller's resource: what a vector
// does, in less code, and without memory for a few values.
#ifndef HALFSPACE_DISPATCH_BROAD_PHASE_LIST_H_
#define HALFSPACE_DISPATCH_BROAD_PHASE_LIST_H_

#include <cstddef>
#include <type_traits>
#include <utility>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"

namespace halfspace::detail {

class ListMemory {
 public:
  explicit ListMemory(const MemoryResource& memory) : memory_(memory) {}
  ListMemory(const ListMemory&) = delete;
  ListMemory& operator=(const ListMemory&) = delete;
  ~ListMemory();

  // Bytes of the resource's memory.
  std::size_t capacity() const { return data_ == few_ ? 0 : bytes_; }

 protected:
  // Room for `bytes`, and for half as much again as before. Keeps `used`.
  void Grow(std::size_t bytes, std::size_t used);
  void Swap(ListMemory& other);

  static constexpr std::size_t kFewBytes = 256;

  MemoryResource memory_;
  alignas(8) std::byte few_[kFewBytes];
  void* data_ = few_;
  std::size_t bytes_ = kFewBytes;
};

template <typename T>
class List : public ListMemory {
 public:
  static_assert(std::is_trivially_copyable_v<T>);
  using ListMemory::ListMemory;

  std::size_t size() const { return size_; }
  T* data() const { return static_cast<T*>(data_); }
  T* begin() const { return data(); }
  T* end() const { return data() + size_; }
  T& operator[](std::size_t i) const { return data()[i]; }

  void Reserve(std::size_t count) {
    if (count * sizeof(T) > bytes_) {
      Grow(count * sizeof(T), size_ * sizeof(T));
    }
  }
  void Push(T value) {
    Reserve(size_ + 1);
    data()[size_++] = value;
  }
  void Resize(std::size_t count, T value) {
    Reserve(count);
    for (; size_ < count; ++size_) data()[size_] = value;
    size_ = count;
  }
  void Clear() { size_ = 0; }
  // After values were written behind the last one, where there is room.
  void SetSize(std::size_t count) { size_ = count; }
  void Swap(List& other) {
    ListMemory::Swap(other);
    std::swap(size_, other.size_);
  }

 private:
  std::size_t size_ = 0;
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BROAD_PHASE_LIST_H_

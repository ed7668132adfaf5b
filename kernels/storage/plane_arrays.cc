#include "halfspace/detail/plane_arrays.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "kernels/error.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

constexpr std::size_t kGroup = 64;  // objects in one output word
// Planes of a power-of-two capacity would all start in the same cache set, and
// the eight streams of an octahedron would evict each other. An odd number of
// cache lines between planes spreads their starts.
template <typename T>
constexpr std::size_t kStagger = 5 * 64 / sizeof(T);

// The public class, for messages.
template <typename T>
constexpr const char* kOwner =
    std::is_floating_point_v<T> ? "World" : "QuantizedBounds";

const MemoryResource& Checked(const MemoryResource& memory) {
  if ((memory.allocate == nullptr) != (memory.deallocate == nullptr)) {
    kernels::ThrowInvalid("MemoryResource", "allocate and deallocate",
                          "two functions, or none", "one of them");
  }
  return memory;
}

}  // namespace

template <typename T>
PlaneArrays<T>::PlaneArrays(Span<const T> padding, const MemoryResource& memory)
    : memory_(Checked(memory)), planes_(padding.size()) {
  std::copy(padding.begin(), padding.end(), padding_.begin());
}

template <typename T>
PlaneArrays<T>::PlaneArrays(const PlaneArrays& other,
                            const MemoryResource& memory)
    : PlaneArrays(std::span(other.padding_).first(other.planes_), memory) {
  if (other.size_ == 0) return;
  Grow(other.size_);
  size_ = other.size_;
  for (std::size_t p = 0; p < planes_; ++p) {
    std::memcpy(data_ + p * stride_, other.plane(p), size_ * sizeof(T));
  }
}

template <typename T>
PlaneArrays<T>::PlaneArrays(PlaneArrays&& other) noexcept
    : memory_(other.memory_),
      padding_(other.padding_),
      planes_(other.planes_),
      size_(std::exchange(other.size_, 0)),
      capacity_(std::exchange(other.capacity_, 0)),
      stride_(std::exchange(other.stride_, 0)),
      data_(std::exchange(other.data_, nullptr)) {}

template <typename T>
void PlaneArrays<T>::Swap(PlaneArrays& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(padding_, other.padding_);
  std::swap(planes_, other.planes_);
  std::swap(size_, other.size_);
  std::swap(capacity_, other.capacity_);
  std::swap(stride_, other.stride_);
  std::swap(data_, other.data_);
}

template <typename T>
PlaneArrays<T>::~PlaneArrays() {
  Free();
}

template <typename T>
void PlaneArrays<T>::Free() {
  if (data_ == nullptr) return;
  FreeBlock(memory_, data_, stride_ * planes_ * sizeof(T));
}

// Moves to a new block for at least `objects` objects, all beyond size_ padded.
template <typename T>
void PlaneArrays<T>::Grow(std::size_t objects) {
  constexpr std::size_t kMost =
      std::numeric_limits<std::size_t>::max() / sizeof(T) / kMaxPlanes / 2;
  if (objects > kMost) {
    kernels::ThrowInvalid(kOwner<T>, "size",
                          "at most " + std::to_string(kMost) + " objects",
                          std::to_string(objects));
  }
  const std::size_t capacity = (objects + kGroup - 1) / kGroup * kGroup;
  const std::size_t stride = capacity + kStagger<T>;
  T* data =
      static_cast<T*>(AllocateBlock(memory_, stride * planes_ * sizeof(T)));
  for (std::size_t p = 0; p < planes_; ++p) {
    T* to = data + p * stride;
    if (size_ != 0) std::memcpy(to, plane(p), size_ * sizeof(T));
    std::fill(to + size_, to + stride, padding_[p]);
  }
  Free();
  data_ = data;
  capacity_ = capacity;
  stride_ = stride;
}

template <typename T>
void PlaneArrays<T>::Reserve(std::size_t objects) {
  if (objects > capacity_) Grow(objects);
}

template <typename T>
void PlaneArrays<T>::Write(std::size_t index, const T* values) {
  for (std::size_t p = 0; p < planes_; ++p) {
    data_[p * stride_ + index] = values[p];
  }
}

template <typename T>
void PlaneArrays<T>::Assign(const T* records, std::size_t count) {
  kernels::CheckMemory("World::Assign", "bounds", records, count, alignof(T));
  Resize(count);
  for (std::size_t i = 0; i < count; ++i) Write(i, records + i * planes_);
}

template <typename T>
std::size_t PlaneArrays<T>::Push(Span<const T> values) {
  if (size_ == capacity_) Grow(std::max(kGroup, 2 * capacity_));
  Write(size_, values.data());
  return size_++;
}

template <typename T>
void PlaneArrays<T>::CheckIndex(std::size_t index, const char* call) const {
  if (index < size_) return;
  kernels::ThrowInvalid(call, "index",
                        "less than the size, " + std::to_string(size_),
                        std::to_string(index));
}

template <typename T>
void PlaneArrays<T>::Set(std::size_t index, Span<const T> values) {
  CheckIndex(index, "World::Set");
  Write(index, values.data());
}

template <typename T>
void PlaneArrays<T>::Get(std::size_t index, Span<T> values) const {
  CheckIndex(index, "World::Get");
  for (std::size_t p = 0; p < planes_; ++p) values[p] = plane(p)[index];
}

template <typename T>
void PlaneArrays<T>::EraseBySwap(std::size_t index) {
  CheckIndex(index, "World::EraseBySwap");
  --size_;
  for (std::size_t p = 0; p < planes_; ++p) {
    T* values = data_ + p * stride_;
    values[index] = values[size_];
    values[size_] = padding_[p];
  }
}

template <typename T>
void PlaneArrays<T>::Resize(std::size_t objects) {
  if (objects > capacity_) Grow(objects);
  if (objects < size_) {
    for (std::size_t p = 0; p < planes_; ++p) {
      std::fill(plane(p) + objects, plane(p) + size_, padding_[p]);
    }
  }
  size_ = objects;
}

template <typename T>
void PlaneArrays<T>::Clear() {
  Resize(0);
}

template class PlaneArrays<float>;
template class PlaneArrays<double>;
template class PlaneArrays<std::int8_t>;
template class PlaneArrays<std::int16_t>;
template class PlaneArrays<std::int32_t>;

}  // namespace halfspace::detail

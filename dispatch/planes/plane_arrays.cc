#include "halfspace/detail/plane_arrays.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"

namespace halfspace::detail {
namespace {

constexpr std::size_t kGroup = 64;  // objects in one output word
// Planes of a power-of-two capacity would all start in the same cache set, and
// the eight streams of an octahedron would evict each other. An odd number of
// cache lines between planes spreads their starts.
constexpr std::size_t kStaggerBytes = 5 * 64;

const MemoryResource& Checked(const MemoryResource& memory) {
  if ((memory.allocate == nullptr) != (memory.deallocate == nullptr)) {
    dispatch::ThrowInvalid("MemoryResource", "allocate and deallocate",
                           "two functions, or none", "one of them");
  }
  return memory;
}

// Calls run(bytes) with the size of an element as a constant, so that the copy
// of an element is one instruction.
template <typename Run>
void WithBytes(std::size_t bytes, const Run& run) {
  switch (bytes) {
    case 1:
      return run(std::integral_constant<std::size_t, 1>());
    case 2:
      return run(std::integral_constant<std::size_t, 2>());
    case 4:
      return run(std::integral_constant<std::size_t, 4>());
    default:
      return run(std::integral_constant<std::size_t, 8>());
  }
}

// Copies the values of a record to or from the planes.
void Write(std::byte* object, std::size_t stride, std::size_t planes,
           std::size_t element_bytes, const void* record) {
  WithBytes(element_bytes, [&](auto bytes) {
    const auto* from = static_cast<const std::byte*>(record);
    for (std::size_t p = 0; p < planes; ++p, from += bytes) {
      std::memcpy(object + p * stride, from, bytes);
    }
  });
}

void Fill(std::byte* begin, const std::byte* end, const std::byte* value,
          std::size_t element_bytes) {
  WithBytes(element_bytes, [&](auto bytes) {
    std::byte element[bytes];
    std::memcpy(element, value, bytes);
    for (; begin != end; begin += bytes) std::memcpy(begin, element, bytes);
  });
}

}  // namespace

PlaneStore::PlaneStore(const void* padding, std::size_t planes,
                       std::size_t element_bytes, const MemoryResource& memory)
    : memory_(Checked(memory)), element_bytes_(element_bytes), planes_(planes) {
  std::memcpy(padding_.data(), padding, planes * element_bytes);
}

PlaneStore::PlaneStore(const PlaneStore& other, const MemoryResource& memory)
    : PlaneStore(other.padding_.data(), other.planes_, other.element_bytes_,
                 memory) {
  if (other.size_ == 0) return;
  Reserve(other.size_);
  size_ = other.size_;
  for (std::size_t p = 0; p < planes_; ++p) {
    std::memcpy(PlaneAt(p), other.PlaneAt(p), size_ * element_bytes_);
  }
}

PlaneStore::PlaneStore(PlaneStore&& other) noexcept
    : memory_(other.memory_),
      padding_(other.padding_),
      element_bytes_(other.element_bytes_),
      planes_(other.planes_),
      size_(std::exchange(other.size_, 0)),
      capacity_(std::exchange(other.capacity_, 0)),
      stride_(std::exchange(other.stride_, 0)),
      data_(std::exchange(other.data_, nullptr)) {}

void PlaneStore::Swap(PlaneStore& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(padding_, other.padding_);
  std::swap(element_bytes_, other.element_bytes_);
  std::swap(planes_, other.planes_);
  std::swap(size_, other.size_);
  std::swap(capacity_, other.capacity_);
  std::swap(stride_, other.stride_);
  std::swap(data_, other.data_);
}

PlaneStore::~PlaneStore() {
  if (data_ != nullptr) FreeBlock(memory_, data_, stride_ * planes_);
}

// Moves to a new block if it is too small, and pads the planes beyond size_.
void PlaneStore::Reserve(std::size_t objects) {
  if (objects <= capacity_) return;
  const std::size_t most =
      std::numeric_limits<std::size_t>::max() / element_bytes_ / kMaxPlanes / 2;
  if (objects > most) {
    // Only quantized bounds have so small elements.
    dispatch::ThrowInvalid(
        element_bytes_ < sizeof(float) ? "QuantizedBounds" : "World", "size",
        "at most " + std::to_string(most) + " objects",
        std::to_string(objects));
  }
  const std::size_t capacity = (objects + kGroup - 1) / kGroup * kGroup;
  const std::size_t stride = capacity * element_bytes_ + kStaggerBytes;
  auto* const data =
      static_cast<std::byte*>(AllocateBlock(memory_, stride * planes_));
  for (std::size_t p = 0; p < planes_; ++p) {
    std::byte* const to = data + p * stride;
    const std::size_t used = size_ * element_bytes_;
    if (used != 0) std::memcpy(to, PlaneAt(p), used);
    Fill(to + used, to + stride, padding_.data() + p * element_bytes_,
         element_bytes_);
  }
  if (data_ != nullptr) FreeBlock(memory_, data_, stride_ * planes_);
  data_ = data;
  capacity_ = capacity;
  stride_ = stride;
}

void PlaneStore::Assign(const void* records, std::size_t count) {
  dispatch::CheckMemory("World::Assign", "bounds", records, count,
                        element_bytes_);
  Resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Write(
        data_ + i * element_bytes_, stride_, planes_, element_bytes_,
        static_cast<const std::byte*>(records) + i * planes_ * element_bytes_);
  }
}

std::size_t PlaneStore::Push(const void* record) {
  if (size_ == capacity_) Reserve(std::max(kGroup, 2 * capacity_));
  Write(data_ + size_ * element_bytes_, stride_, planes_, element_bytes_,
        record);
  return size_++;
}

void PlaneStore::CheckIndex(std::size_t index, const char* call) const {
  if (index < size_) return;
  dispatch::ThrowInvalid(call, "index",
                         "less than the size, " + std::to_string(size_),
                         std::to_string(index));
}

void PlaneStore::Set(std::size_t index, const void* record) {
  CheckIndex(index, "World::Set");
  Write(data_ + index * element_bytes_, stride_, planes_, element_bytes_,
        record);
}

void PlaneStore::Get(std::size_t index, void* record) const {
  CheckIndex(index, "World::Get");
  WithBytes(element_bytes_, [&](auto bytes) {
    auto* to = static_cast<std::byte*>(record);
    for (std::size_t p = 0; p < planes_; ++p, to += bytes) {
      std::memcpy(to, PlaneAt(p) + index * bytes, bytes);
    }
  });
}

void PlaneStore::EraseBySwap(std::size_t index) {
  CheckIndex(index, "World::EraseBySwap");
  --size_;
  WithBytes(element_bytes_, [&](auto bytes) {
    for (std::size_t p = 0; p < planes_; ++p) {
      std::byte* const plane = PlaneAt(p);
      std::memmove(plane + index * bytes, plane + size_ * bytes, bytes);
      std::memcpy(plane + size_ * bytes, padding_.data() + p * bytes, bytes);
    }
  });
}

void PlaneStore::Resize(std::size_t objects) {
  Reserve(objects);
  for (std::size_t p = 0; p < planes_ && objects < size_; ++p) {
    Fill(PlaneAt(p) + objects * element_bytes_,
         PlaneAt(p) + size_ * element_bytes_,
         padding_.data() + p * element_bytes_, element_bytes_);
  }
  size_ = objects;
}

}  // namespace halfspace::detail

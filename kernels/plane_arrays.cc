#include "halfspace/detail/plane_arrays.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>
#include <string>
#include <utility>

#include "kernels/error.h"

namespace halfspace::detail {
namespace {

constexpr std::size_t kGroup = 64;  // objects in one output word
constexpr std::align_val_t kAlignment{64};

// Planes of a power-of-two capacity would all start in the same cache set, and
// the eight streams of an octahedron would evict each other. One odd number of
// cache lines between them spreads the starts.
constexpr std::size_t kStagger = 5 * 64 / sizeof(float);

float* Allocate(std::size_t floats) {
  return static_cast<float*>(
      ::operator new(floats * sizeof(float), kAlignment));
}

void Free(float* data) { ::operator delete(data, kAlignment); }

}  // namespace

PlaneArrays::PlaneArrays(std::span<const float> padding)
    : planes_(padding.size()) {
  std::copy(padding.begin(), padding.end(), padding_.begin());
}

PlaneArrays::PlaneArrays(const PlaneArrays& other)
    : padding_(other.padding_), planes_(other.planes_) {
  if (other.size_ == 0) return;
  Grow(other.size_);
  size_ = other.size_;
  for (std::size_t p = 0; p < planes_; ++p) {
    std::memcpy(data_ + p * stride_, other.plane(p), size_ * sizeof(float));
  }
}

PlaneArrays::PlaneArrays(PlaneArrays&& other) noexcept
    : padding_(other.padding_),
      planes_(other.planes_),
      size_(std::exchange(other.size_, 0)),
      capacity_(std::exchange(other.capacity_, 0)),
      stride_(std::exchange(other.stride_, 0)),
      data_(std::exchange(other.data_, nullptr)) {}

PlaneArrays& PlaneArrays::operator=(PlaneArrays other) noexcept {
  std::swap(padding_, other.padding_);
  std::swap(planes_, other.planes_);
  std::swap(size_, other.size_);
  std::swap(capacity_, other.capacity_);
  std::swap(stride_, other.stride_);
  std::swap(data_, other.data_);
  return *this;
}

PlaneArrays::~PlaneArrays() { Free(data_); }

// Moves to a new block for at least `objects` objects, all beyond size_ padded.
void PlaneArrays::Grow(std::size_t objects) {
  constexpr std::size_t kMost =
      std::numeric_limits<std::size_t>::max() / sizeof(float) / kMaxPlanes / 2;
  if (objects > kMost) {
    kernels::ThrowInvalid("World", "size",
                          "at most " + std::to_string(kMost) + " objects",
                          std::to_string(objects));
  }
  const std::size_t capacity = (objects + kGroup - 1) / kGroup * kGroup;
  const std::size_t stride = capacity + kStagger;
  float* data = Allocate(stride * planes_);
  for (std::size_t p = 0; p < planes_; ++p) {
    float* to = data + p * stride;
    if (size_ != 0) std::memcpy(to, plane(p), size_ * sizeof(float));
    std::fill(to + size_, to + stride, padding_[p]);
  }
  Free(data_);
  data_ = data;
  capacity_ = capacity;
  stride_ = stride;
}

void PlaneArrays::Reserve(std::size_t objects) {
  if (objects > capacity_) Grow(objects);
}

void PlaneArrays::Write(std::size_t index, const float* values) {
  for (std::size_t p = 0; p < planes_; ++p) {
    data_[p * stride_ + index] = values[p];
  }
}

std::size_t PlaneArrays::Push(std::span<const float> values) {
  if (size_ == capacity_) Grow(std::max(kGroup, 2 * capacity_));
  Write(size_, values.data());
  return size_++;
}

void PlaneArrays::CheckIndex(std::size_t index, const char* call) const {
  if (index < size_) return;
  kernels::ThrowInvalid(call, "index",
                        "less than the size, " + std::to_string(size_),
                        std::to_string(index));
}

void PlaneArrays::Set(std::size_t index, std::span<const float> values) {
  CheckIndex(index, "World::Set");
  Write(index, values.data());
}

void PlaneArrays::Get(std::size_t index, std::span<float> values) const {
  CheckIndex(index, "World::Get");
  for (std::size_t p = 0; p < planes_; ++p) values[p] = plane(p)[index];
}

void PlaneArrays::EraseBySwap(std::size_t index) {
  CheckIndex(index, "World::EraseBySwap");
  --size_;
  for (std::size_t p = 0; p < planes_; ++p) {
    float* values = data_ + p * stride_;
    values[index] = values[size_];
    values[size_] = padding_[p];
  }
}

void PlaneArrays::Resize(std::size_t objects) {
  if (objects > capacity_) Grow(objects);
  if (objects < size_) {
    for (std::size_t p = 0; p < planes_; ++p) {
      std::fill(plane(p) + objects, plane(p) + size_, padding_[p]);
    }
  }
  size_ = objects;
}

void PlaneArrays::Clear() { Resize(0); }

}  // namespace halfspace::detail

// Internal. Bounds as flat lists of plane values (all minima, then all maxima),
// and the storage behind the owning worlds. Not part of the interface.
#ifndef HALFSPACE_DETAIL_PLANE_ARRAYS_H_
#define HALFSPACE_DETAIL_PLANE_ARRAYS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "halfspace/bounds.h"
#include "halfspace/detail/block_memory.h"
#include "halfspace/export.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"

namespace halfspace::detail {

inline constexpr std::size_t kMaxPlanes = 10;  // Aabo<4>

template <typename Bound>
inline constexpr std::size_t kPlaneCount =
    Bound::kAxes*((HasMin<Bound> ? 1 : 0) + (HasMax<Bound> ? 1 : 0));

template <typename Bound>
using PlaneValues = std::array<typename Bound::Scalar, kPlaneCount<Bound>>;

template <typename Bound>
constexpr PlaneValues<Bound> Planes(const Bound& bound) {
  PlaneValues<Bound> values{};
  std::size_t p = 0;
  if constexpr (HasMin<Bound>) {
    for (auto v : bound.min) values[p++] = v;
  }
  if constexpr (HasMax<Bound>) {
    for (auto v : bound.max) values[p++] = v;
  }
  return values;
}

template <typename Bound>
constexpr Bound BoundOf(const PlaneValues<Bound>& values) {
  Bound bound{};
  std::size_t p = 0;
  if constexpr (HasMin<Bound>) {
    for (auto& v : bound.min) v = values[p++];
  }
  if constexpr (HasMax<Bound>) {
    for (auto& v : bound.max) v = values[p++];
  }
  return bound;
}

// Value i of plane p is planes[p][i * stride]: planes, with a stride of 1, or
// the values of records.
template <typename T>
struct Columns {
  std::array<const T*, kMaxPlanes> planes;
  std::size_t size;
  std::size_t stride;
};

using FloatColumns = Columns<float>;

template <typename View, typename Pointers>
void ListPlanes(const View& view, Pointers& planes) {
  std::size_t p = 0;
  for (const auto* plane : view.min) planes[p++] = plane;
  if constexpr (HasMax<View>) {
    for (const auto* plane : view.max) planes[p++] = plane;
  }
}

template <typename View>
Columns<typename View::Bound::Scalar> ColumnsOf(const View& view) {
  Columns<typename View::Bound::Scalar> columns;
  columns.size = view.size;
  columns.stride = 1;
  ListPlanes(view, columns.planes);
  return columns;
}

template <typename Bound>
const typename Bound::Scalar* RecordsOf(Span<const Bound> bounds) {
  using Scalar = typename Bound::Scalar;
  static_assert(std::is_standard_layout_v<Bound> &&
                    sizeof(Bound) == kPlaneCount<Bound> * sizeof(Scalar),
                "a bound is read as a list of its values");
  return reinterpret_cast<const Scalar*>(bounds.data());
}

template <typename Bound>
Columns<typename Bound::Scalar> ColumnsOf(Span<const Bound> records) {
  constexpr std::size_t kValues = kPlaneCount<Bound>;
  Columns<typename Bound::Scalar> columns;
  columns.size = records.size();
  columns.stride = kValues;
  const auto* values = RecordsOf(records);
  for (std::size_t p = 0; p < kValues; ++p) {
    columns.planes[p] = values == nullptr ? nullptr : values + p;
  }
  return columns;
}

// One allocation of `padding.size()` planes. Each plane is 64-byte aligned;
// elements from size() to the end of the padded plane hold `padding`. Defined
// for float, double, and the quantized bounds of quantized.h and their
// thresholds.
template <typename T>
class HALFSPACE_API PlaneArrays {
 public:
  PlaneArrays(Span<const T> padding, const MemoryResource& memory);
  PlaneArrays(const PlaneArrays& other)
      : PlaneArrays(other, MemoryResource()) {}
  PlaneArrays(const PlaneArrays& other, const MemoryResource& memory);
  PlaneArrays(PlaneArrays&& other) noexcept;
  // Two operators, and not one that takes its argument by value: assignments
  // that a compiler writes would take that for one that never throws.
  PlaneArrays& operator=(const PlaneArrays& other) {
    return AssignCopy(*this, other);
  }
  PlaneArrays& operator=(PlaneArrays&& other) {
    return AssignMove(*this, other);
  }
  ~PlaneArrays();
  friend void swap(PlaneArrays& a, PlaneArrays& b) noexcept { a.Swap(b); }

  const MemoryResource& memory() const { return memory_; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  T* plane(std::size_t p) { return data_ + p * stride_; }
  const T* plane(std::size_t p) const { return data_ + p * stride_; }

  void Reserve(std::size_t objects);
  // Replaces the content by `count` records, each a value of every plane, which
  // may not be its own.
  void Assign(const T* records, std::size_t count);
  std::size_t Push(Span<const T> values);
  void Set(std::size_t index, Span<const T> values);
  void Get(std::size_t index, Span<T> values) const;
  void EraseBySwap(std::size_t index);
  void Resize(std::size_t objects);
  void Clear();

  // Throws, in the name of `call`, unless `index` is below size().
  void CheckIndex(std::size_t index, const char* call) const;

 private:
  void Write(std::size_t index, const T* values);
  void Grow(std::size_t objects);
  void Free();
  void Swap(PlaneArrays& other) noexcept;

  MemoryResource memory_;
  std::array<T, kMaxPlanes> padding_{};
  std::size_t planes_ = 0;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;  // a multiple of 64
  std::size_t stride_ = 0;    // elements from one plane to the next
  T* data_ = nullptr;
};

extern template class PlaneArrays<float>;
extern template class PlaneArrays<double>;
extern template class PlaneArrays<std::int8_t>;
extern template class PlaneArrays<std::int16_t>;
extern template class PlaneArrays<std::int32_t>;

// Object `i` of a view.
template <typename View>
typename View::Bound BoundAt(const View& view, std::size_t i) {
  typename View::Bound bound{};
  for (std::size_t k = 0; k < view.min.size(); ++k) {
    bound.min[k] = view.min[k][i];
    if constexpr (HasMax<View>) bound.max[k] = view.max[k][i];
  }
  return bound;
}

// A view of the planes, or, if they are not const, the planes to be written.
template <typename View, typename Arrays>
View ViewOf(Arrays& planes) {
  View view;
  std::size_t p = 0;
  if constexpr (HasMin<View>) {
    for (auto& plane : view.min) plane = planes.plane(p++);
  }
  if constexpr (HasMax<View>) {
    for (auto& plane : view.max) plane = planes.plane(p++);
  }
  view.size = planes.size();
  return view;
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_PLANE_ARRAYS_H_

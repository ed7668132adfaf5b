// Internal. The memory of owners, bounds as flat lists of plane values (all
// minima, then all maxima), and the storage behind the owning worlds. Not part
// of the interface.
#ifndef HALFSPACE_DETAIL_PLANE_ARRAYS_H_
#define HALFSPACE_DETAIL_PLANE_ARRAYS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "halfspace/bounds.h"
#include "halfspace/export.h"
#include "halfspace/memory.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"

namespace halfspace::detail {

// At least 64-byte aligned. Throws std::bad_alloc.
HALFSPACE_API void* AllocateBlock(const MemoryResource& memory,
                                  std::size_t bytes);
HALFSPACE_API void FreeBlock(const MemoryResource& memory, void* block,
                             std::size_t bytes);

// The allocator of these blocks for std::vector.
template <typename T>
class BlockAllocator {
 public:
  using value_type = T;
  using propagate_on_container_swap = std::true_type;
  using is_always_equal = std::false_type;

  BlockAllocator() = default;
  explicit BlockAllocator(const MemoryResource& memory) : memory_(memory) {}
  template <typename U>
  explicit BlockAllocator(const BlockAllocator<U>& other)
      : memory_(other.memory()) {}

  const MemoryResource& memory() const { return memory_; }

  T* allocate(std::size_t count) {
    return static_cast<T*>(AllocateBlock(memory_, count * sizeof(T)));
  }
  void deallocate(T* block, std::size_t count) {
    FreeBlock(memory_, block, count * sizeof(T));
  }
  BlockAllocator select_on_container_copy_construction() const { return {}; }

  friend bool operator==(const BlockAllocator& a, const BlockAllocator& b) {
    return a.memory_ == b.memory_;
  }
  friend bool operator!=(const BlockAllocator& a, const BlockAllocator& b) {
    return !(a == b);
  }

 private:
  MemoryResource memory_;
};

// The assignments of all owners, which keep their resource, and are as they
// were if there is no memory.
template <typename Owner>
Owner& AssignCopy(Owner& to, const Owner& from) {
  Owner copy(from, to.memory());
  swap(to, copy);
  return to;
}
template <typename Owner>
Owner& AssignMove(Owner& to, Owner& from) {
  const bool is_copied = to.memory() != from.memory();
  if (is_copied) AssignCopy(to, from);
  Owner taken(std::move(from));  // leaves it empty
  if (!is_copied) swap(to, taken);
  return to;
}

inline constexpr std::size_t kMaxPlanes = 10;  // Aabo<4>

template <typename Bound>
inline constexpr std::size_t kPlaneCount =
    Bound::kAxes*((HasMin<Bound> ? 1 : 0) + (HasMax<Bound> ? 1 : 0));

// The planes of a type of bound: minima of X, Y, ..., and of D if there is one
// axis more than dimensions, and as many maxima or none.
//
// The planes of spheres are the coordinates of centers, and radii. Spheres are
// no k-DOPs, and only flat scans by shapes know them.
struct PlaneLayout {
  enum Kind : std::uint8_t { kSimplex, kAabb, kAabo, kSphere };

  constexpr PlaneLayout() = default;
  constexpr PlaneLayout(std::size_t dim_count, std::size_t axis_count,
                        bool with_max)
      : dims(static_cast<std::uint8_t>(dim_count)),
        axes(static_cast<std::uint8_t>(axis_count)),
        has_max(with_max),
        kind(!with_max                 ? kSimplex
             : axis_count == dim_count ? kAabb
                                       : kAabo),
        plane_count(
            static_cast<std::uint8_t>(with_max ? 2 * axis_count : axis_count)),
        first_max(with_max ? axes : std::uint8_t{0}) {}

  static constexpr PlaneLayout OfSpheres(std::size_t dims) {
    PlaneLayout layout(dims, dims + 1, false);
    layout.kind = kSphere;
    return layout;
  }

  friend constexpr bool operator==(const PlaneLayout& a, const PlaneLayout& b) {
    return a.dims == b.dims && a.axes == b.axes && a.kind == b.kind;
  }

  std::uint8_t dims = 0;
  std::uint8_t axes = 0;
  bool has_max = false;
  Kind kind = kSimplex;
  std::uint8_t plane_count = 0;
  // The first maximum among the planes, 0 without maxima, and among the values
  // of a query. A query of simplices has maxima alone.
  std::uint8_t first_max = 0;
};

template <typename Bound>
inline constexpr PlaneLayout kLayoutOf = {Bound::kDimensions, Bound::kAxes,
                                          HasMax<Bound>};

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

// Floats or doubles in the caller's memory: value c of element i is
// column[c][i * stride]. Planes, with a stride of 1, or the values of records.
struct Columns {
  std::array<const void*, kMaxPlanes> column;
  std::size_t size;
  std::size_t stride;
  bool is_double;

  const float* floats(std::size_t c) const {
    return static_cast<const float*>(column[c]);
  }
  const double* doubles(std::size_t c) const {
    return static_cast<const double*>(column[c]);
  }
  std::size_t scalar_bytes() const {
    return is_double ? sizeof(double) : sizeof(float);
  }
};

// Without the columns.
template <typename Scalar>
Columns ColumnsOf(std::size_t size, std::size_t stride) {
  static_assert(std::is_same_v<Scalar, float> ||
                std::is_same_v<Scalar, double>);
  Columns columns;
  columns.size = size;
  columns.stride = stride;
  columns.is_double = std::is_same_v<Scalar, double>;
  return columns;
}

template <typename Planes, typename Pointers>
void ListPlanes(const Planes& from, Pointers& planes) {
  std::size_t p = 0;
  for (const auto* plane : from.min) planes[p++] = plane;
  if constexpr (HasMax<Planes>) {
    for (const auto* plane : from.max) planes[p++] = plane;
  }
}

template <typename View>
Columns ColumnsOf(const View& view) {
  Columns columns = ColumnsOf<typename View::Bound::Scalar>(view.size, 1);
  ListPlanes(view, columns.column);
  return columns;
}

template <int kDims, typename Scalar>
Columns ColumnsOf(const Boxes<kDims, Scalar>& boxes) {
  Columns columns = ColumnsOf<Scalar>(boxes.count, boxes.stride);
  ListPlanes(boxes, columns.column);
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

// Rows of so many values, one after another.
template <typename Scalar>
Columns ColumnsOfRows(const Scalar* rows, std::size_t size,
                      std::size_t values) {
  Columns columns = ColumnsOf<Scalar>(size, values);
  for (std::size_t v = 0; v < values; ++v) {
    columns.column[v] = rows == nullptr ? nullptr : rows + v;
  }
  return columns;
}

template <typename Bound>
Columns ColumnsOf(Span<const Bound> records) {
  return ColumnsOfRows(RecordsOf(records), records.size(), kPlaneCount<Bound>);
}

// The rows, if elements are rows of floats, or null.
inline const float* RowsOf(const Columns& columns, std::size_t values) {
  if (columns.is_double || (columns.stride != values && columns.size > 1)) {
    return nullptr;
  }
  const float* const rows = columns.floats(0);
  for (std::size_t v = 1; v < values; ++v) {
    if (columns.floats(v) != rows + v) return nullptr;
  }
  return rows;
}

// Writes elements begin ... begin + count - 1, one after another, as floats:
// `values` of each. The first `minima` of them are rounded down if they are
// doubles, the others up.
HALFSPACE_API void ReadRecords(const Columns& columns, std::size_t values,
                               std::size_t minima, std::size_t begin,
                               std::size_t count, float* records);

// One allocation of planes, whose elements have 1, 2, 4 or 8 bytes. Each plane
// is 64-byte aligned; elements from size() to the end of the padded plane hold
// `padding`, a value of every plane. Records are a value of every plane, too.
// Not a template, as each instance would repeat and export all of it.
class HALFSPACE_API PlaneStore {
 public:
  PlaneStore(const void* padding, std::size_t planes, std::size_t element_bytes,
             const MemoryResource& memory);
  PlaneStore(const PlaneStore& other) : PlaneStore(other, MemoryResource()) {}
  PlaneStore(const PlaneStore& other, const MemoryResource& memory);
  PlaneStore(PlaneStore&& other) noexcept;
  // Two operators, and not one that takes its argument by value: assignments
  // that a compiler writes would take that for one that never throws.
  PlaneStore& operator=(const PlaneStore& other) {
    return AssignCopy(*this, other);
  }
  PlaneStore& operator=(PlaneStore&& other) { return AssignMove(*this, other); }
  ~PlaneStore();
  friend void swap(PlaneStore& a, PlaneStore& b) noexcept { a.Swap(b); }

  const MemoryResource& memory() const { return memory_; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }

  void Reserve(std::size_t objects);
  // Replaces the content by `count` records, which may not be its own.
  void Assign(const void* records, std::size_t count);
  std::size_t Push(const void* record);
  void Set(std::size_t index, const void* record);
  void Get(std::size_t index, void* record) const;
  void EraseBySwap(std::size_t index);
  void Resize(std::size_t objects);

  // Throws, in the name of `call`, unless `index` is below size().
  void CheckIndex(std::size_t index, const char* call) const;

  std::byte* PlaneAt(std::size_t p) const { return data_ + p * stride_; }

 private:
  void Swap(PlaneStore& other) noexcept;

  MemoryResource memory_;
  std::array<std::byte, kMaxPlanes * sizeof(double)> padding_{};
  std::size_t element_bytes_;
  std::size_t planes_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;  // a multiple of 64
  std::size_t stride_ = 0;    // bytes from one plane to the next
  std::byte* data_ = nullptr;
};

template <typename T>
class PlaneArrays : public PlaneStore {
 public:
  PlaneArrays(Span<const T> padding, const MemoryResource& memory)
      : PlaneStore(padding.data(), padding.size(), sizeof(T), memory) {}
  PlaneArrays(const PlaneArrays& other, const MemoryResource& memory)
      : PlaneStore(other, memory) {}

  T* plane(std::size_t p) { return reinterpret_cast<T*>(PlaneAt(p)); }
  const T* plane(std::size_t p) const {
    return reinterpret_cast<const T*>(PlaneAt(p));
  }
};

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

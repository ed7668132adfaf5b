// Internal. The quantizer, a map from floats to levels, the planes of quantized
// bounds as worlds for the calls, and the floats of a QuantizedWorld. Not part
// of the interface.
#ifndef HALFSPACE_DETAIL_QUANTIZED_H_
#define HALFSPACE_DETAIL_QUANTIZED_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/detail/scan.h"
#include "halfspace/export.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"

namespace halfspace::detail {

// Levels are stored less half their range, because x86 compares only signed
// bytes. Those of minima are stored in reverse, so that the lesser stored level
// rejects in every plane; detail/vectors-inl.h says why.
template <typename Element>
using StoredElement = std::make_signed_t<Element>;

// Number i of `count` indices that are spread evenly below `size`. The place of
// each within its part follows the golden ratio, because equal steps could be a
// multiple of the period of objects in the order of a grid.
constexpr std::size_t SampledIndex(std::size_t i, std::size_t count,
                                   std::size_t size) {
  const std::size_t part = size / count;
  const std::uint64_t within = i * std::uint64_t{0x9e3779b97f4a7c15} >> 32;
  const std::uint64_t rest = std::uint64_t{i} * (size % count) / count;
  return i * part + static_cast<std::size_t>(rest + (part * within >> 32));
}

// A monotone map from floats to levels for every plane. The rank of a value is
// the number of the plane's thresholds that it reaches (a minimum) or exceeds
// (a maximum). Both sides of a test go through the same map, so a pair that the
// floats keep is kept, whatever the thresholds are.
//
// Floats are compared as integers in the order of floats, with both zeros and
// all subnormals at 0, so that the floating-point mode of the caller changes
// nothing.
class HALFSPACE_API Quantizer {
 public:
  // No thresholds: one level for everything.
  Quantizer(const PlaneLayout& layout, const MemoryResource& memory);
  Quantizer(const Quantizer& other, const MemoryResource& memory)
      : layout_(other.layout_), thresholds_(other.thresholds_, memory) {}

  const MemoryResource& memory() const { return thresholds_.memory(); }
  std::size_t planes() const { return layout_.plane_count; }

  // One with thresholds at `levels` - 1 quantiles of every plane.
  Quantizer Trained(const Columns& floats, std::size_t levels) const;

  // Encodes `count` values of plane `p`, `stride` floats apart. A NaN gets the
  // level that never rejects.
  template <typename Stored>
  void EncodeObjects(std::size_t p, const float* values, std::size_t stride,
                     std::size_t count, Stored* levels) const;

  // Encodes one object: a value for each plane.
  template <typename Stored>
  void EncodeObject(const float* values, Stored* levels) const;

  // Encodes a query. Values and levels are in the order of detail::Scan.
  template <typename Stored>
  void EncodeQuery(const float* values, Stored* levels) const;

  // The rank that a stored level of plane `p` stands for.
  template <typename Stored>
  std::uint32_t RankOf(std::size_t p, Stored stored) const {
    const auto level = p < layout_.axes ? static_cast<Stored>(~stored) : stored;
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(level) -
                                      std::numeric_limits<Stored>::min());
  }

  // The upper eight bits of a rank.
  std::size_t BucketOf(std::size_t rank) const {
    const std::size_t levels = thresholds_.size() + 1;
    return rank * 256 / (levels < 256 ? 256 : levels);
  }

 private:
  friend void swap(Quantizer& a, Quantizer& b) noexcept {
    std::swap(a.layout_, b.layout_);
    swap(a.thresholds_, b.thresholds_);
  }

  PlaneLayout layout_;
  // For each plane ascending, as ordered integers. Their number is one less
  // than a power of two, so that every search takes the same steps. Not a
  // std::vector, because a caller's flags may give that another layout.
  PlaneArrays<std::int32_t> thresholds_;
};

// The levels of one world, and the quantizer that encoded them. Not a template,
// as PlaneStore.
class HALFSPACE_API QuantizedPlanes {
 public:
  // A level takes 1 or 2 bytes.
  QuantizedPlanes(const PlaneLayout& layout, std::size_t level_bytes,
                  const MemoryResource& memory);
  QuantizedPlanes(const QuantizedPlanes& other) = default;
  QuantizedPlanes(const QuantizedPlanes& other, const MemoryResource& memory)
      : quantizer_(other.quantizer_, memory),
        level_bytes_(other.level_bytes_),
        levels_(other.levels_, memory),
        pairs_then_(other.pairs_then_) {}
  QuantizedPlanes(QuantizedPlanes&& other) noexcept = default;
  // Assigns levels and quantizer, or neither if memory cannot be had: they mean
  // nothing without each other.
  QuantizedPlanes& operator=(const QuantizedPlanes& other) {
    return AssignCopy(*this, other);
  }
  QuantizedPlanes& operator=(QuantizedPlanes&& other) {
    return AssignMove(*this, other);
  }
  ~QuantizedPlanes() = default;
  friend void swap(QuantizedPlanes& a, QuantizedPlanes& b) noexcept {
    swap(a.quantizer_, b.quantizer_);
    std::swap(a.level_bytes_, b.level_bytes_);
    swap(a.levels_, b.levels_);
    a.pairs_then_.swap(b.pairs_then_);
  }

  const MemoryResource& memory() const { return levels_.memory(); }
  std::size_t size() const { return levels_.size(); }
  const Quantizer& quantizer() const { return quantizer_; }
  template <typename Stored>
  const Stored* plane(std::size_t p) const {
    return reinterpret_cast<const Stored*>(levels_.PlaneAt(p));
  }

  void Requantize(const Columns& floats);
  void Reserve(std::size_t objects) { levels_.Reserve(objects); }
  std::size_t Push(Span<const float> values);
  void Set(std::size_t index, Span<const float> values);
  void EraseBySwap(std::size_t index);
  void CheckIndex(std::size_t index, const char* call) const {
    levels_.CheckIndex(index, call);
  }
  void Clear() { levels_.Resize(0); }
  bool Fits() const;
  // How many objects may be added, with any values, before Fits() can become
  // false; at most size().
  std::size_t Room() const;

 private:
  Quantizer quantizer_;
  std::size_t level_bytes_;
  PlaneStore levels_;
  std::array<double, kMaxPlanes> pairs_then_{};
};

template <typename FloatView, typename Element>
struct QuantizedView {
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Stored = StoredElement<Element>;

  explicit QuantizedView(const QuantizedPlanes& quantized)
      : QuantizedView(quantized,
                      std::make_index_sequence<kPlaneCount<Bound>>()) {}

  const QuantizedView& view() const { return *this; }

  std::array<const Stored*, kPlaneCount<Bound>> planes;
  std::size_t size;
  const Quantizer* quantizer;

 private:
  // Without a loop, so that compilers copy no array.
  template <std::size_t... kPlane>
  QuantizedView(const QuantizedPlanes& quantized,
                std::index_sequence<kPlane...>)
      : planes{quantized.template plane<Stored>(kPlane)...},
        size(quantized.size()),
        quantizer(&quantized.quantizer()) {}
};

// Floats is a view of planes, or a list of records.
template <typename FloatView, typename Element, typename Floats>
struct RefinedView : QuantizedView<FloatView, Element> {
  RefinedView(const QuantizedView<FloatView, Element>& quantized,
              const Floats& of_floats)
      : QuantizedView<FloatView, Element>(quantized), floats(of_floats) {}

  const RefinedView& view() const { return *this; }

  Floats floats;
};

template <typename Stored>
void EncodeQueries(const Scan& scan, std::size_t first, std::size_t count,
                   void* quantized) {
  const std::size_t values = scan.type->plane_count;
  const float* from = static_cast<const float*>(scan.queries) + first * values;
  auto* to = static_cast<Stored*>(quantized);
  for (std::size_t q = 0; q < count; ++q) {
    scan.quantizer->EncodeQuery(from, to);
    from += values;
    to += values;
  }
}

// An array of bounds in the memory of a resource. Not a std::vector, because
// <vector> adds 7000 lines in C++20. The owner checks indices, and reserves
// memory before it pushes.
template <typename Bound>
class BoundArray {
  static_assert(std::is_trivially_copyable_v<Bound>);

 public:
  explicit BoundArray(const MemoryResource& memory) : memory_(memory) {}
  BoundArray(const BoundArray& other, const MemoryResource& memory)
      : BoundArray(memory) {
    Reserve(other.size_);
    for (; size_ < other.size_; ++size_) data_[size_] = other.data_[size_];
  }
  BoundArray(BoundArray&& other) noexcept : BoundArray(other.memory_) {
    swap(*this, other);
  }
  BoundArray& operator=(BoundArray&&) = delete;
  ~BoundArray() {
    if (data_ != nullptr) FreeBlock(memory_, data_, capacity_ * sizeof(Bound));
  }
  friend void swap(BoundArray& a, BoundArray& b) noexcept {
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
    BoundArray more(memory_);
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

#endif  // HALFSPACE_DETAIL_QUANTIZED_H_

// Internal. The quantizer, a map from floats to levels, and the planes of
// quantized bounds. Not part of the interface.
#ifndef HALFSPACE_DETAIL_QUANTIZER_H_
#define HALFSPACE_DETAIL_QUANTIZER_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include "halfspace/detail/plane_arrays.h"
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
  Quantizer(std::size_t minima, std::size_t maxima,
            const MemoryResource& memory);
  Quantizer(const Quantizer& other, const MemoryResource& memory)
      : minima_(other.minima_),
        planes_(other.planes_),
        thresholds_(other.thresholds_, memory) {}

  const MemoryResource& memory() const { return thresholds_.memory(); }
  std::size_t planes() const { return planes_; }

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
    const auto level = p < minima_ ? static_cast<Stored>(~stored) : stored;
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
    std::swap(a.minima_, b.minima_);
    std::swap(a.planes_, b.planes_);
    swap(a.thresholds_, b.thresholds_);
  }

  std::size_t minima_;
  std::size_t planes_;
  // For each plane ascending, as ordered integers. Their number is one less
  // than a power of two, so that every search takes the same steps. Not a
  // std::vector, because a caller's flags may give that another layout.
  PlaneArrays<std::int32_t> thresholds_;
};

// The levels of one world, and the quantizer that encoded them.
template <typename Stored>
class HALFSPACE_API QuantizedPlanes {
 public:
  QuantizedPlanes(std::size_t minima, std::size_t maxima,
                  const MemoryResource& memory);
  QuantizedPlanes(const QuantizedPlanes& other) = default;
  QuantizedPlanes(const QuantizedPlanes& other, const MemoryResource& memory)
      : quantizer_(other.quantizer_, memory),
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
    swap(a.levels_, b.levels_);
    a.pairs_then_.swap(b.pairs_then_);
  }

  const MemoryResource& memory() const { return levels_.memory(); }
  std::size_t size() const { return levels_.size(); }
  const Quantizer& quantizer() const { return quantizer_; }
  const PlaneArrays<Stored>& planes() const { return levels_; }

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
  using Values = std::array<Stored, kMaxPlanes>;
  Values Encoded(Span<const float> values) const;
  // Fractions of the objects.
  struct Crowd {
    double pairs = 0.0;    // of all pairs, those that share a level
    double fullest = 0.0;  // objects that have the most frequent level
  };
  Crowd CrowdOf(std::size_t plane) const;

  Quantizer quantizer_;
  PlaneArrays<Stored> levels_;
  std::array<double, kMaxPlanes> pairs_then_{};
};

extern template class QuantizedPlanes<std::int8_t>;
extern template class QuantizedPlanes<std::int16_t>;

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_QUANTIZER_H_

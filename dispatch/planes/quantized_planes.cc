#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "dispatch/errors/memory_checks.h"
#include "halfspace/detail/quantized.h"

namespace halfspace::detail {
namespace {

// The padding is never read, so its values do not matter.
template <typename Stored>
PlaneArrays<Stored> NoPlanes(std::size_t planes, const MemoryResource& memory) {
  const std::array<Stored, kMaxPlanes> padding{};
  return {std::span(padding).first(planes), memory};
}

// An ideal quantizer puts one object in 256 on each level. One that is four
// times as crowded rejects with two bits less.
double MostPairs(double times, double pairs_then) {
  return times * (pairs_then + 1.0 / 256);
}

}  // namespace

template <typename Stored>
QuantizedPlanes<Stored>::QuantizedPlanes(std::size_t minima, std::size_t maxima,
                                         const MemoryResource& memory)
    : quantizer_(minima, maxima, memory),
      levels_(NoPlanes<Stored>(minima + maxima, memory)) {}

template <typename Stored>
void QuantizedPlanes<Stored>::Requantize(const Columns& floats) {
  constexpr const char* kCall = "QuantizedBounds::Requantize";
  const std::size_t planes = quantizer_.planes();
  if (floats.stride != 1) {
    dispatch::CheckMemory(kCall, "bounds", floats.column[0], floats.size,
                          alignof(float));
  }
  for (std::size_t p = 0; p < planes && floats.size != 0; ++p) {
    dispatch::CheckPointer(
        kCall, floats.column[p], alignof(float),
        [&] { return "floats, plane " + std::to_string(p); },
        [&] {
          return "a plane of " + std::to_string(floats.size) + " floats";
        });
  }
  // Before a plane is read, so that a size that no memory can have is refused
  // here.
  PlaneArrays<Stored> levels = NoPlanes<Stored>(planes, memory());
  levels.Reserve(std::max(floats.size, levels_.capacity()));
  levels.Resize(floats.size);
  Quantizer quantizer =
      quantizer_.Trained(floats, std::size_t{1} << (8 * sizeof(Stored)));
  for (std::size_t p = 0; p < planes; ++p) {
    quantizer.EncodeObjects(p, floats.floats(p), floats.stride, floats.size,
                            levels.plane(p));
  }
  quantizer_ = std::move(quantizer);
  levels_ = std::move(levels);
  for (std::size_t p = 0; p < planes; ++p) pairs_then_[p] = CrowdOf(p).pairs;
}

template <typename Stored>
auto QuantizedPlanes<Stored>::Encoded(Span<const float> values) const
    -> Values {
  Values levels{};
  quantizer_.EncodeObject(values.data(), levels.data());
  return levels;
}

template <typename Stored>
std::size_t QuantizedPlanes<Stored>::Push(Span<const float> values) {
  const Values levels = Encoded(values);
  return levels_.Push(levels.data());
}

template <typename Stored>
void QuantizedPlanes<Stored>::Set(std::size_t index, Span<const float> values) {
  CheckIndex(index, "QuantizedBounds::Set");
  const Values levels = Encoded(values);
  levels_.Set(index, levels.data());
}

template <typename Stored>
void QuantizedPlanes<Stored>::EraseBySwap(std::size_t index) {
  CheckIndex(index, "QuantizedBounds::EraseBySwap");
  levels_.EraseBySwap(index);
}

// Judged by the upper eight bits of the levels of up to 1024 objects.
template <typename Stored>
auto QuantizedPlanes<Stored>::CrowdOf(std::size_t plane) const -> Crowd {
  const std::size_t count = std::min<std::size_t>(size(), 1024);
  if (count == 0) return {};
  std::array<std::uint32_t, 256> histogram{};
  for (std::size_t i = 0; i < count; ++i) {
    const Stored level = levels_.plane(plane)[SampledIndex(i, count, size())];
    ++histogram[quantizer_.BucketOf(quantizer_.RankOf(plane, level))];
  }
  std::uint32_t pairs = 0;
  std::uint32_t fullest = 0;
  for (const std::uint32_t bucket : histogram) {
    pairs += bucket * bucket;
    fullest = std::max(fullest, bucket);
  }
  const auto all = static_cast<double>(count);
  return {.pairs = pairs / (all * all), .fullest = fullest / all};
}

template <typename Stored>
bool QuantizedPlanes<Stored>::Fits() const {
  for (std::size_t p = 0; p < quantizer_.planes(); ++p) {
    if (CrowdOf(p).pairs > MostPairs(4.0, pairs_then_[p])) return false;
  }
  return true;
}

template <typename Stored>
std::size_t QuantizedPlanes<Stored>::Room() const {
  double room = 1.0;
  for (std::size_t p = 0; p < quantizer_.planes(); ++p) {
    // Less than Fits() allows, because that will sample other objects.
    const double most = MostPairs(3.5, pairs_then_[p]);
    const Crowd crowd = CrowdOf(p);
    if (crowd.pairs >= most) return 0;
    if (most >= 1.0) continue;
    // The worst case: x times as many objects are added, all of them with the
    // most frequent level. Then pairs + 2 fullest x + x^2 = most (1 + x)^2.
    const double half = most - crowd.fullest;
    const double root =
        std::sqrt(half * half + (1.0 - most) * (most - crowd.pairs));
    room = std::min(room, (half + root) / (1.0 - most));
  }
  return static_cast<std::size_t>(room * static_cast<double>(size()));
}

template class QuantizedPlanes<std::int8_t>;
template class QuantizedPlanes<std::int16_t>;

}  // namespace halfspace::detail

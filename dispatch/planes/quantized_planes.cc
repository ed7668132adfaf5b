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

// Calls function(level) with a level of the stored type.
template <typename Function>
auto WithLevel(std::size_t bytes, const Function& function) {
  return bytes == 1 ? function(std::int8_t{}) : function(std::int16_t{});
}

// The padding is never read, so its values do not matter.
PlaneStore NoPlanes(std::size_t planes, std::size_t level_bytes,
                    const MemoryResource& memory) {
  const std::array<std::int16_t, kMaxPlanes> padding{};
  return {padding.data(), planes, level_bytes, memory};
}

// An ideal quantizer of 256 levels puts a 256th of the objects on each level.
// If levels are four times as crowded, the bounds reject as if they had two
// bits less.
double MostPairs(double times, double pairs_then) {
  return times * (pairs_then + 1.0 / 256);
}

// As fractions of the objects.
struct Crowd {
  double pairs = 0.0;    // of all pairs, those that share a level
  double fullest = 0.0;  // objects that have the most frequent level
};

// Uses the upper eight bits of the levels of up to 1024 objects.
Crowd CrowdOf(const QuantizedPlanes& quantized, std::size_t level_bytes,
              std::size_t plane) {
  const std::size_t size = quantized.size();
  const std::size_t count = std::min<std::size_t>(size, 1024);
  if (count == 0) return {};
  std::array<std::uint32_t, 256> histogram{};
  const Quantizer& quantizer = quantized.quantizer();
  WithLevel(level_bytes, [&](auto none) {
    const auto* const levels = quantized.plane<decltype(none)>(plane);
    for (std::size_t i = 0; i < count; ++i) {
      const auto level = levels[SampledIndex(i, count, size)];
      ++histogram[quantizer.BucketOf(quantizer.RankOf(plane, level))];
    }
  });
  std::uint32_t pairs = 0;
  std::uint32_t fullest = 0;
  for (const std::uint32_t bucket : histogram) {
    pairs += bucket * bucket;
    fullest = std::max(fullest, bucket);
  }
  const auto all = static_cast<double>(count);
  return {.pairs = pairs / (all * all), .fullest = fullest / all};
}

// Calls function(levels) with the levels of one object.
template <typename Function>
auto WithLevels(const Quantizer& quantizer, std::size_t level_bytes,
                const float* values, const Function& function) {
  return WithLevel(level_bytes, [&](auto level) {
    std::array<decltype(level), kMaxPlanes> levels{};
    quantizer.EncodeObject(values, levels.data());
    return function(levels.data());
  });
}

}  // namespace

QuantizedPlanes::QuantizedPlanes(const PlaneLayout& layout,
                                 std::size_t level_bytes,
                                 const MemoryResource& memory)
    : quantizer_(layout, memory),
      level_bytes_(level_bytes),
      levels_(NoPlanes(layout.plane_count, level_bytes, memory)) {}

void QuantizedPlanes::Requantize(const Columns& floats) {
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
  // Allocates before a plane is read, so that a size that fits no memory fails
  // here.
  PlaneStore levels = NoPlanes(planes, level_bytes_, memory());
  levels.Reserve(std::max(floats.size, levels_.capacity()));
  levels.Resize(floats.size);
  Quantizer quantizer =
      quantizer_.Trained(floats, std::size_t{1} << (8 * level_bytes_));
  WithLevel(level_bytes_, [&](auto level) {
    for (std::size_t p = 0; p < planes; ++p) {
      quantizer.EncodeObjects(
          p, floats.floats(p), floats.stride, floats.size,
          reinterpret_cast<decltype(level)*>(levels.PlaneAt(p)));
    }
  });
  quantizer_ = std::move(quantizer);
  levels_ = std::move(levels);
  for (std::size_t p = 0; p < planes; ++p) {
    pairs_then_[p] = CrowdOf(*this, level_bytes_, p).pairs;
  }
}

std::size_t QuantizedPlanes::Push(Span<const float> values) {
  return WithLevels(quantizer_, level_bytes_, values.data(),
                    [&](const auto* levels) { return levels_.Push(levels); });
}

void QuantizedPlanes::Set(std::size_t index, Span<const float> values) {
  CheckIndex(index, "QuantizedBounds::Set");
  WithLevels(quantizer_, level_bytes_, values.data(),
             [&](const auto* levels) { levels_.Set(index, levels); });
}

void QuantizedPlanes::EraseBySwap(std::size_t index) {
  CheckIndex(index, "QuantizedBounds::EraseBySwap");
  levels_.EraseBySwap(index);
}

bool QuantizedPlanes::Fits() const {
  for (std::size_t p = 0; p < quantizer_.planes(); ++p) {
    if (CrowdOf(*this, level_bytes_, p).pairs > MostPairs(4.0, pairs_then_[p]))
      return false;
  }
  return true;
}

std::size_t QuantizedPlanes::Room() const {
  double room = 1.0;
  for (std::size_t p = 0; p < quantizer_.planes(); ++p) {
    // Less than Fits() allows, because Fits() will sample other objects.
    const double most = MostPairs(3.5, pairs_then_[p]);
    const Crowd crowd = CrowdOf(*this, level_bytes_, p);
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

}  // namespace halfspace::detail

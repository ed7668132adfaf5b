// Worlds and queries to test quantized bounds with.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_QUANTIZED_CASES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_QUANTIZED_CASES_H_

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "halfspace/detail/plane_arrays.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/inputs.h"

namespace halfspace::testing {

enum class QuantizedInputKind {
  kUniform,
  kClustered,  // most in a few small places, some everywhere
  kEqualObjects,
  kAnyValues,      // anything at all in one plane of four
  kSpecialBounds,  // Everything(), Empty() and a few usual ones
  kSubnormals,     // and both zeros, and the smallest normal numbers
  kNanPlanes,      // every other plane has nothing but NaN
};

inline constexpr std::array kQuantizedInputKinds = {
    QuantizedInputKind::kUniform,       QuantizedInputKind::kClustered,
    QuantizedInputKind::kEqualObjects,  QuantizedInputKind::kAnyValues,
    QuantizedInputKind::kSpecialBounds, QuantizedInputKind::kSubnormals,
    QuantizedInputKind::kNanPlanes,
};

inline const char* NameOf(QuantizedInputKind kind) {
  constexpr std::array kNames = {
      "uniform",        "clustered",  "equal objects", "any values",
      "special bounds", "subnormals", "NaN planes"};
  return kNames[static_cast<std::size_t>(kind)];
}

namespace internal {

inline float UniformIn(float from, float to, Random& random) {
  return std::uniform_real_distribution<float>(from, to)(random);
}

// Not far from zero, where some machines see nothing else.
inline float NearlyZero(Random& random) {
  const auto magnitude = static_cast<std::uint32_t>(random() % 0x01000000u);
  return std::bit_cast<float>(magnitude | (OneIn(2, random) ? 0x80000000u : 0));
}

// The values of a bound's planes.
inline void FillQuantizedBound(const detail::PlaneLayout& layout,
                               QuantizedInputKind kind, Random& random,
                               float* values) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kMost = std::numeric_limits<float>::max();
  const bool is_special =
      kind == QuantizedInputKind::kSpecialBounds && !OneIn(4, random);
  // Of a minimum: Everything() or Empty().
  const float special = !is_special        ? 0.f
                        : OneIn(2, random) ? -kMost
                                           : kInfinity;
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    const bool is_min = p < layout.axes;
    if (is_special) {
      values[p] = is_min ? special : -special;
      continue;
    }
    const float middle =
        kind == QuantizedInputKind::kClustered && !OneIn(8, random)
            ? 10.f * static_cast<float>(random() % 5) +
                  UniformIn(0.f, 1e-3f, random)
            : UniformIn(-100.f, 100.f, random);
    const float half = UniformIn(0.f, 30.f, random);
    float value = is_min ? middle - half : middle + half;
    if (kind == QuantizedInputKind::kAnyValues && OneIn(4, random)) {
      value = SpecialValue<float>(random);
    }
    if (kind == QuantizedInputKind::kSubnormals) value = NearlyZero(random);
    if (kind == QuantizedInputKind::kNanPlanes && p % 2 != 0) value = kNan;
    values[p] = value;
  }
}

}  // namespace internal

// The values of `count` bounds, one bound after another.
inline std::vector<float> MakeQuantizedValues(const detail::PlaneLayout& layout,
                                              QuantizedInputKind kind,
                                              std::size_t count,
                                              Random& random) {
  const std::size_t planes = layout.plane_count;
  std::vector<float> values(count * planes);
  for (std::size_t i = 0; i < count; ++i) {
    internal::FillQuantizedBound(layout, kind, random, &values[i * planes]);
  }
  if (kind == QuantizedInputKind::kEqualObjects) {
    for (std::size_t i = planes; i < values.size(); ++i) {
      values[i] = values[i - planes];
    }
  }
  return values;
}

// Queries that a part of the bounds survive. A value that may reject is the
// value of a bound, a neighbour of it, or a special value.
inline std::vector<float> MakeQuantizedQueries(
    const detail::PlaneLayout& layout, const std::vector<float>& bounds,
    std::size_t count, Random& random) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::size_t planes = layout.plane_count;
  const std::size_t objects = bounds.size() / planes;
  std::vector<float> queries(count * planes);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const std::size_t p = i % planes;
    float& value = queries[i - p + OpposingValue(layout, p)];
    const float stored =
        objects == 0 ? 0.f : bounds[random() % objects * planes + p];
    switch (random() % 12) {
      case 0:
        value = SpecialValue<float>(random);
        break;
      case 1:
        value = std::nextafter(stored, kInfinity);
        break;
      case 2:
        value = std::nextafter(stored, -kInfinity);
        break;
      case 3:
      case 4:
      case 5:
        value = stored;
        break;
      default:
        value = p < layout.axes ? 1e35f : -1e35f;
    }
  }
  return queries;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_QUANTIZED_CASES_H_

// Worlds and queries to test quantized bounds with, for typed tests: each shape
// in 2, 3 and 4 dimensions, with quantized bounds of one and of two bytes.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_QUANTIZED_CASES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_QUANTIZED_CASES_H_

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "halfspace/quantized.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/inputs.h"

namespace halfspace::testing {

template <typename TheView, typename TheElement>
struct QuantizedCase {
  using View = TheView;
  using Element = TheElement;
};

struct QuantizedCaseNames {
  template <typename Case>
  static std::string GetName(int) {
    return NameOf(Whole<typename Case::View>()) + "Uint" +
           std::to_string(8 * sizeof(typename Case::Element));
  }
};

template <int... kDims>
using QuantizedCasesOf =
    ::testing::Types<QuantizedCase<SimplexView<kDims>, std::uint8_t>...,
                     QuantizedCase<AabbView<kDims>, std::uint8_t>...,
                     QuantizedCase<AaboView<kDims>, std::uint8_t>...,
                     QuantizedCase<SimplexView<kDims>, std::uint16_t>...,
                     QuantizedCase<AabbView<kDims>, std::uint16_t>...,
                     QuantizedCase<AaboView<kDims>, std::uint16_t>...>;
using QuantizedCases = std::conditional_t<kTestsOnly3d, QuantizedCasesOf<3>,
                                          QuantizedCasesOf<2, 3, 4>>;

// For what is the same code for all shapes: one of each, and both sizes.
using FewQuantizedCases =
    ::testing::Types<QuantizedCase<SimplexView3, std::uint8_t>,
                     QuantizedCase<AabbView3, std::uint16_t>,
                     QuantizedCase<AaboView3, std::uint8_t>,
                     QuantizedCase<AaboView3, std::uint16_t>>;

enum class QuantizedInputKind {
  kUniform,
  kClustered,       // most in a few small places, some everywhere
  kOutliers,        // one in fifty a huge number away
  kConstantPlanes,  // every other plane has one value
  kEqualObjects,
  kAnyValues,      // anything at all in one plane of four
  kSpecialBounds,  // Everything(), Empty() and a few usual ones
  kSubnormals,     // and both zeros, and the smallest normal numbers
  kNanPlanes,      // every other plane has nothing but NaN
};

inline constexpr std::array kQuantizedInputKinds = {
    QuantizedInputKind::kUniform,       QuantizedInputKind::kClustered,
    QuantizedInputKind::kOutliers,      QuantizedInputKind::kConstantPlanes,
    QuantizedInputKind::kEqualObjects,  QuantizedInputKind::kAnyValues,
    QuantizedInputKind::kSpecialBounds, QuantizedInputKind::kSubnormals,
    QuantizedInputKind::kNanPlanes,
};

inline const char* NameOf(QuantizedInputKind kind) {
  constexpr std::array kNames = {
      "uniform",         "clustered",     "outliers",
      "constant planes", "equal objects", "any values",
      "special bounds",  "subnormals",    "NaN planes"};
  return kNames[static_cast<std::size_t>(kind)];
}

namespace internal {

inline float UniformIn(float from, float to, Random& random) {
  return std::uniform_real_distribution<float>(from, to)(random);
}

// The middle of an object on one axis.
inline float QuantizedMiddle(QuantizedInputKind kind, Random& random) {
  switch (kind) {
    case QuantizedInputKind::kClustered:
      return OneIn(8, random) ? UniformIn(-100.f, 100.f, random)
                              : 10.f * static_cast<float>(random() % 5) +
                                    UniformIn(0.f, 1e-3f, random);
    case QuantizedInputKind::kOutliers:
      return OneIn(50, random) ? (OneIn(2, random) ? 1e30f : -1e30f)
                               : UniformIn(-100.f, 100.f, random);
    default:
      return UniformIn(-100.f, 100.f, random);
  }
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
    const bool is_odd = p % 2 != 0;
    const bool is_min = p < layout.axes;
    if (is_special) {
      values[p] = is_min ? special : -special;
      continue;
    }
    const float middle = QuantizedMiddle(kind, random);
    const float half = UniformIn(0.f, 30.f, random);
    float value = is_min ? middle - half : middle + half;
    if (kind == QuantizedInputKind::kAnyValues && OneIn(4, random)) {
      value = SpecialValue<float>(random);
    }
    if (kind == QuantizedInputKind::kSubnormals) value = NearlyZero(random);
    if (kind == QuantizedInputKind::kConstantPlanes && is_odd) value = 7.f;
    if (kind == QuantizedInputKind::kNanPlanes && is_odd) value = kNan;
    values[p] = value;
  }
}

// Fills a query that a part of `count` bounds survive. Where it may reject, its
// value is that of one of them, a neighbour of it, or special.
inline void FillQuantizedQuery(const detail::PlaneLayout& layout,
                               const float* bounds, std::size_t count,
                               Random& random, float* query) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    const bool is_min = p < layout.axes;
    float& value = query[OpposingValue(layout, p)];
    const float stored =
        count == 0 ? 0.f : bounds[random() % count * layout.plane_count + p];
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
        value = is_min ? 1e35f : -1e35f;
    }
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

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_QUANTIZED_CASES_H_

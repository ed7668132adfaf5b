// The floats and doubles that break careless compares and sums.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_SPECIAL_VALUES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_SPECIAL_VALUES_H_

#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

namespace halfspace::testing {

constexpr double DoubleOf(std::uint64_t bits) {
  return std::bit_cast<double>(bits);
}

// By their bits, so that no compiler flag can change them.
template <typename T>
inline constexpr std::array<T, 20> kSpecialValues;

template <>
inline constexpr std::array<float, 20> kSpecialValues<float> = {
    std::bit_cast<float>(0x00000000u),  // 0
    std::bit_cast<float>(0x80000000u),  // -0
    std::bit_cast<float>(0x00000001u),  // smallest subnormal
    std::bit_cast<float>(0x80000001u),
    std::bit_cast<float>(0x007fffffu),  // largest subnormal
    std::bit_cast<float>(0x807fffffu),
    std::bit_cast<float>(0x00800000u),  // smallest normal
    std::bit_cast<float>(0x80800000u),
    std::bit_cast<float>(0x3f800000u),  // 1
    std::bit_cast<float>(0xbf800000u),
    std::bit_cast<float>(0x3f800001u),  // next after 1
    std::bit_cast<float>(0xbf800001u),
    std::bit_cast<float>(0x3f7fffffu),  // next before 1
    std::bit_cast<float>(0x7f7fffffu),  // largest
    std::bit_cast<float>(0xff7fffffu),
    std::bit_cast<float>(0x7f800000u),  // infinity
    std::bit_cast<float>(0xff800000u),
    std::bit_cast<float>(0x7fc00000u),  // quiet NaN
    std::bit_cast<float>(0xffc00001u),  // negative NaN with a payload
    std::bit_cast<float>(0x7f800001u),  // signalling NaN
};

template <>
inline constexpr std::array<double, 20> kSpecialValues<double> = {
    DoubleOf(0x0000000000000000),  // 0
    DoubleOf(0x8000000000000000),  // -0
    DoubleOf(0x0000000000000001),  // smallest subnormal
    DoubleOf(0x8000000000000001),
    DoubleOf(0x000fffffffffffff),  // largest subnormal
    DoubleOf(0x800fffffffffffff),
    DoubleOf(0x0010000000000000),  // smallest normal
    DoubleOf(0x8010000000000000),
    DoubleOf(0x3ff0000000000000),  // 1
    DoubleOf(0xbff0000000000000),
    DoubleOf(0x3ff0000000000001),  // next after 1
    DoubleOf(0xbff0000000000001),
    DoubleOf(0x3fefffffffffffff),  // next before 1
    DoubleOf(0x7fefffffffffffff),  // largest
    DoubleOf(0xffefffffffffffff),
    DoubleOf(0x7ff0000000000000),  // infinity
    DoubleOf(0xfff0000000000000),
    DoubleOf(0x7ff8000000000000),  // quiet NaN
    DoubleOf(0xfff8000000000001),  // negative NaN with a payload
    DoubleOf(0x7ff0000000000001),  // signalling NaN
};

// The unsigned integer that holds the bits of T.
template <typename T>
using BitsOf =
    std::conditional_t<std::is_same_v<T, float>, std::uint32_t, std::uint64_t>;

// a > b from the bits alone: no floating-point unit, hence no rounding,
// flushing or compiler flag takes part. False if either is NaN.
template <typename T>
constexpr bool IsGreater(T a, T b) {
  using Integer = BitsOf<T>;
  constexpr Integer kInfinity = sizeof(T) == 4
                                    ? Integer{0x7f800000u}
                                    : static_cast<Integer>(0x7ff0000000000000u);
  constexpr Integer kMagnitude = static_cast<Integer>(~Integer{0}) >> 1;
  const auto a_bits = std::bit_cast<Integer>(a);
  const auto b_bits = std::bit_cast<Integer>(b);
  if ((a_bits & kMagnitude) > kInfinity) return false;
  if ((b_bits & kMagnitude) > kInfinity) return false;
  const auto ordered = [](Integer bits) {
    const auto magnitude = static_cast<std::int64_t>(bits & kMagnitude);
    return bits > kMagnitude ? -magnitude : magnitude;
  };
  return ordered(a_bits) > ordered(b_bits);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_SPECIAL_VALUES_H_

// The floats that break careless compares and sums.
#ifndef HALFSPACE_TESTS_LIBRARY_SPECIAL_VALUES_H_
#define HALFSPACE_TESTS_LIBRARY_SPECIAL_VALUES_H_

#include <array>
#include <bit>
#include <cstdint>

namespace halfspace::testing {

// By their bits, so that no compiler flag can change them.
inline constexpr std::array<float, 20> kSpecialValues = {
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

// a > b from the bits alone: no floating-point unit, hence no rounding,
// flushing or compiler flag takes part. False if either is NaN.
constexpr bool IsGreater(float a, float b) {
  constexpr std::uint32_t kInfinity = 0x7f800000u;
  constexpr std::uint32_t kMagnitude = 0x7fffffffu;
  const auto a_bits = std::bit_cast<std::uint32_t>(a);
  const auto b_bits = std::bit_cast<std::uint32_t>(b);
  if ((a_bits & kMagnitude) > kInfinity) return false;
  if ((b_bits & kMagnitude) > kInfinity) return false;
  const auto ordered = [](std::uint32_t bits) {
    const auto magnitude = static_cast<std::int64_t>(bits & kMagnitude);
    return bits > kMagnitude ? -magnitude : magnitude;
  };
  return ordered(a_bits) > ordered(b_bits);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SPECIAL_VALUES_H_

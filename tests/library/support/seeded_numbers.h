// Numbers that are the same on every machine and with every standard library:
// integer arithmetic alone, floats by their bits. (The distributions of the
// standard library differ between its implementations.)
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_SEEDED_NUMBERS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_SEEDED_NUMBERS_H_

#include <bit>
#include <cstddef>
#include <cstdint>

#include "tests/library/support/special_values.h"

namespace halfspace::testing {

// SplitMix64 (Steele, Lea, Flood 2014).
class SeededNumbers {
 public:
  explicit SeededNumbers(std::uint64_t seed) : state_(seed) {}

  std::uint64_t Bits() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t bits = state_;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    return bits ^ (bits >> 31);
  }

  // 0 <= result < n.
  std::uint32_t Below(std::uint32_t n) {
    return static_cast<std::uint32_t>(((Bits() >> 32) * n) >> 32);
  }

  template <typename T = float>
  T Special() {
    return kSpecialValues<T>[Below(
        static_cast<std::uint32_t>(kSpecialValues<T>.size()))];
  }

  // Halves from -8 to 8: shapes made of them often touch.
  float OnGrid() { return 0.5f * static_cast<float>(Below(33)) - 8.f; }

  // Of either sign, with all bits of the mantissa, and least <= exponent <=
  // most; exponent -127 makes subnormals.
  float WithExponent(int least, int most) {
    const auto range = static_cast<std::uint32_t>(most - least + 1);
    const auto biased = static_cast<std::uint32_t>(least + 127) + Below(range);
    const auto sign_and_mantissa =
        static_cast<std::uint32_t>(Bits()) & 0x807fffffu;
    return std::bit_cast<float>(sign_and_mantissa | (biased << 23));
  }

  // What builders are given: sums of these round in every way there is, and one
  // in 256 cannot be bounded.
  float Coordinate() {
    const std::uint32_t kind = Below(256);
    if (kind == 0) return Special();
    if (kind < 100) return OnGrid();
    if (kind < 200) return WithExponent(-4, 3);
    if (kind < 230) return WithExponent(-30, 10);
    if (kind < 245) return WithExponent(-127, 100);
    return WithExponent(-127, -127);
  }

  // Not negative, not NaN, finite.
  float Length() {
    const float length = Below(2) == 0 ? OnGrid() : WithExponent(-40, 2);
    return length < 0.f ? -length : length;
  }

 private:
  std::uint64_t state_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_SEEDED_NUMBERS_H_

// Reads a fuzzer's bytes as numbers. Every sequence of bytes is an input: past
// its end there are only zeros.
#ifndef HALFSPACE_TESTS_FUZZ_BYTES_H_
#define HALFSPACE_TESTS_FUZZ_BYTES_H_

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "tests/library/support/special_values.h"

namespace halfspace::testing {

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : left_(data, size) {}

  std::uint8_t Byte() {
    if (left_.empty()) return 0;
    const std::uint8_t byte = left_.front();
    left_ = left_.subspan(1);
    return byte;
  }

  std::uint32_t Word() {
    std::uint32_t word = 0;
    for (int i = 0; i < 4; ++i) word = word << 8 | Byte();
    return word;
  }

  // 0 ... end - 1, for an `end` of at most 2^16.
  std::size_t Below(std::size_t end) {
    const std::size_t high = end > 256 ? Byte() : 0;
    return (high << 8 | Byte()) % end;
  }

  // Any float. Few bytes make those that are likely to matter: special values,
  // the neighbours of earlier ones, short ones of any size, short ones whose
  // sums are exact, and long ones whose sums round.
  float Float() {
    const std::uint8_t how = Byte();
    earlier_.push_back(Make(how % 4, how / 4));
    return earlier_.back();
  }

  // Any double: those that are floats, sums that float cannot hold, raw bits.
  double Double() {
    switch (Below(4)) {
      case 0:
      case 1:
        return Float();
      case 2: {
        const double high = Float();
        const double low = Float();
        return high + low;
      }
      default: {
        const std::uint64_t high = Word();
        return std::bit_cast<double>(high << 32 | Word());
      }
    }
  }

  template <typename Scalar>
  Scalar Number() {
    if constexpr (std::is_same_v<Scalar, float>) {
      return Float();
    } else {
      return Double();
    }
  }

  template <typename Scalar, std::size_t kCount>
  void Fill(std::array<Scalar, kCount>& numbers) {
    for (Scalar& number : numbers) number = Number<Scalar>();
  }

  // What was not read yet.
  std::span<const std::uint8_t> Rest() const { return left_; }

 private:
  static constexpr int kLeastExponent = -149;  // up to 106, by a byte

  float Make(int kind, std::size_t detail) {
    switch (kind) {
      case 0:
        return std::bit_cast<float>(Word());
      case 1:
        return kSpecialValues<float>[detail % kSpecialValues<float>.size()];
      case 2:
        return earlier_.empty() ? 0.f : Neighbour(detail % 4, detail / 4);
      default:
        if (detail < 16) return Short(static_cast<int>(detail) - 8);
        if (detail < 32) return Long(static_cast<int>(detail) - 24);
        return Short(kLeastExponent + Byte());
    }
  }

  float Short(int exponent) {
    const auto mantissa = static_cast<std::int8_t>(Byte());
    return std::ldexp(static_cast<float>(mantissa), exponent);
  }

  // A full mantissa, of any sign.
  float Long(int exponent) {
    constexpr std::uint32_t kOne = 0x3f800000;
    constexpr std::uint32_t kSignAndFraction = 0x807fffff;
    const std::uint32_t bits = kOne | (Word() & kSignAndFraction);
    return std::ldexp(std::bit_cast<float>(bits), exponent);
  }

  float Neighbour(std::size_t which, std::size_t back) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const float value = earlier_[earlier_.size() - 1 - back % earlier_.size()];
    switch (which) {
      case 0:
        return value;
      case 1:
        return -value;
      case 2:
        return std::nextafter(value, kInfinity);
      default:
        return std::nextafter(value, -kInfinity);
    }
  }

  std::span<const std::uint8_t> left_;
  std::vector<float> earlier_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_BYTES_H_

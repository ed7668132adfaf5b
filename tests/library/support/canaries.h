// Memory that notices a write past its end.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_CANARIES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_CANARIES_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace halfspace::testing {

// `size` elements between canaries that can be looked at again.
template <typename T>
class Canaried {
 public:
  static constexpr T kCanary = [] {
    std::array<std::uint8_t, sizeof(T)> bytes{};
    for (std::uint8_t& byte : bytes) byte = 0xc5;
    return std::bit_cast<T>(bytes);
  }();
  static constexpr std::size_t kEach = 64;  // more than any vector is long

  // All of it, the usable part too, becomes canaries.
  std::span<T> Reset(std::size_t size) {
    elements_.assign(size + 2 * kEach, kCanary);
    return std::span<T>(elements_).subspan(kEach, size);
  }

  // Nothing outside the first `used` usable elements was written.
  bool IntactBut(std::size_t used) const {
    const auto is_canary = [](T value) { return value == kCanary; };
    const auto begin = elements_.begin() + kEach;
    return std::all_of(elements_.begin(), begin, is_canary) &&
           std::all_of(begin + static_cast<std::ptrdiff_t>(used),
                       elements_.end(), is_canary);
  }

 private:
  std::vector<T> elements_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_CANARIES_H_

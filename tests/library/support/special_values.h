// The floats and doubles that break careless compares and sums.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_SPECIAL_VALUES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_SPECIAL_VALUES_H_

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace halfspace::testing {

// The unsigned integer that holds the bits of T.
template <typename T>
using BitsOf =
    std::conditional_t<std::is_same_v<T, float>, std::uint32_t, std::uint64_t>;

template <typename T>
inline constexpr BitsOf<T> kInfinityBits =
    sizeof(T) == 4 ? BitsOf<T>{0x7f800000u}
                   : static_cast<BitsOf<T>>(0x7ff0000000000000u);

// By their bits, so that no compiler flag can change them.
template <typename T>
constexpr std::array<T, 20> MakeSpecialValues() {
  constexpr BitsOf<T> kSign = ~(~BitsOf<T>{0} >> 1);
  constexpr BitsOf<T> kInfinite = kInfinityBits<T>;
  constexpr BitsOf<T> kOne =
      kInfinite / 2 - kInfinite / 2 % (kInfinite & -kInfinite);
  constexpr BitsOf<T> kNormal = kInfinite & -kInfinite;  // the smallest
  constexpr BitsOf<T> kQuiet = kNormal / 2;
  constexpr BitsOf<T> kBits[] = {
      0,                               // 0
      kSign,                           // -0
      1,                               // smallest subnormal
      kSign | 1,                       // the same, negative
      kNormal - 1,                     // largest subnormal
      kSign | (kNormal - 1),           // the same, negative
      kNormal,                         // smallest normal
      kSign | kNormal,                 // the same, negative
      kOne,                            // 1
      kSign | kOne,                    // the same, negative
      kOne + 1,                        // next after 1
      kSign | (kOne + 1),              // the same, negative
      kOne - 1,                        // next before 1
      kInfinite - 1,                   // largest
      kSign | (kInfinite - 1),         // the same, negative
      kInfinite,                       // infinity
      kSign | kInfinite,               // the same, negative
      kInfinite | kQuiet,              // quiet NaN
      kSign | kInfinite | kQuiet | 1,  // negative NaN with a payload
      kInfinite | 1,                   // signalling NaN
  };
  std::array<T, 20> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::bit_cast<T>(kBits[i]);
  }
  return values;
}
template <typename T>
inline constexpr std::array<T, 20> kSpecialValues = MakeSpecialValues<T>();

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_SPECIAL_VALUES_H_

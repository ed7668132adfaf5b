// Checks of numbers that several calls share. They compare bits, as a compare
// of floats traps at a NaN in some programs, and so need no floating-point
// mode.
#ifndef HALFSPACE_DISPATCH_ERRORS_NUMBER_CHECKS_H_
#define HALFSPACE_DISPATCH_ERRORS_NUMBER_CHECKS_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>

#include "dispatch/errors/error.h"

namespace halfspace::dispatch {

template <typename Scalar>
using BitsOf = std::conditional_t<sizeof(Scalar) == sizeof(std::uint32_t),
                                  std::uint32_t, std::uint64_t>;
template <typename Scalar>
inline constexpr auto kInfinityBits =
    std::bit_cast<BitsOf<Scalar>>(std::numeric_limits<Scalar>::infinity());

// Throws unless the length is 0 or more, which infinity is.
template <typename Scalar>
void CheckLength(std::string_view call, std::string_view argument,
                 Scalar length) {
  const auto bits = std::bit_cast<BitsOf<Scalar>>(length);
  // All other numbers with a sign are above infinity.
  if (bits <= kInfinityBits<Scalar> || bits << 1 == 0) return;
  ThrowInvalid(call, argument, "a number that is not negative",
               detail::NumberText(length));
}

// The same, and throws at infinity.
template <typename Scalar>
void CheckFiniteLength(std::string_view call, std::string_view argument,
                       Scalar length) {
  const auto bits = std::bit_cast<BitsOf<Scalar>>(length);
  if (bits < kInfinityBits<Scalar> || bits << 1 == 0) return;
  ThrowInvalid(call, argument, "a finite number that is not negative",
               detail::NumberText(length));
}

// The objects of a BVH and their ids are fewer: others have no place in a list
// of blocks to visit.
inline constexpr std::size_t kMostObjects = std::size_t{1} << 31;
// Throws unless one BVH can have so many objects.
inline void CheckObjectCount(std::string_view call, std::string_view argument,
                             std::size_t objects) {
  if (objects < kMostObjects) return;
  ThrowInvalid(call, argument, "fewer than 2^31 objects in all",
               std::to_string(objects));
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_ERRORS_NUMBER_CHECKS_H_

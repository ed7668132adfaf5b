// Checks of numbers that several calls share. Those that are right cost a few
// compares.
#ifndef HALFSPACE_DISPATCH_ERRORS_NUMBER_CHECKS_H_
#define HALFSPACE_DISPATCH_ERRORS_NUMBER_CHECKS_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "dispatch/errors/error.h"

namespace halfspace::dispatch {

// Throws unless the number is finite and not negative, or -0. A number that
// `may_be_infinite` can also be infinity. Compares bits, as a compare with a
// NaN may trap.
inline void CheckNotNegative(std::string_view call, std::string_view argument,
                             float value, bool may_be_infinite = false) {
  constexpr auto kInfinity =
      std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity());
  constexpr auto kNegativeZero = std::bit_cast<std::uint32_t>(-0.0f);
  const auto bits = std::bit_cast<std::uint32_t>(value);
  if (bits < kInfinity || bits == kNegativeZero) return;
  if (may_be_infinite && bits == kInfinity) return;
  ThrowInvalid(call, argument,
               may_be_infinite ? "a number that is not negative"
                               : "a finite number that is not negative",
               Shortest(value));
}

// Throws unless one BVH can have so many objects.
inline constexpr std::size_t kTooManyObjects = std::size_t{1} << 31;
inline void CheckObjectCount(std::string_view call, std::string_view argument,
                             std::size_t objects) {
  if (objects < kTooManyObjects) return;
  ThrowInvalid(call, argument, "fewer than 2^31 objects in all",
               std::to_string(objects));
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_ERRORS_NUMBER_CHECKS_H_

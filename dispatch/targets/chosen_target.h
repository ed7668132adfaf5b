// The place of a target in every list of kernels.
#ifndef HALFSPACE_DISPATCH_TARGETS_CHOSEN_TARGET_H_
#define HALFSPACE_DISPATCH_TARGETS_CHOSEN_TARGET_H_

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "halfspace/targets.h"

namespace halfspace::dispatch {

// The index of a target among the compiled ones, best first; of the chosen one
// for a default handle. Throws (error.h), in the name of `call`, if
// it is not supported here or the choice failed.
std::size_t ResolveIndex(Target target, const char* call);

// One more than what has been resolved, by the index of the target's bit, the
// default handle last; else 0.
extern std::array<std::atomic<std::uint8_t>, 65> resolved_indices;

inline constexpr std::size_t kUnknownTarget = ~std::size_t{0};

// The same if it has been resolved before, else kUnknownTarget.
inline std::size_t KnownIndexOf(Target target) {
  const auto bit = static_cast<std::uint64_t>(target.highway_bit());
  // No std::has_single_bit: the baseline of x86 has no popcnt.
  if ((bit & (bit - 1)) != 0) [[unlikely]]
    return kUnknownTarget;
  return std::size_t{
             resolved_indices[static_cast<std::size_t>(std::countr_zero(bit))]
                 .load(std::memory_order_relaxed)} -
         1;
}

// The same as ResolveIndex, without a call if it has been resolved before.
inline std::size_t IndexOf(Target target, const char* call) {
  const std::size_t known = KnownIndexOf(target);
  return known != kUnknownTarget ? known : ResolveIndex(target, call);
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_TARGETS_CHOSEN_TARGET_H_

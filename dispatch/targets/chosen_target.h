// The index of a target in every table of kernels, and the vectors that it uses
// for one query.
#ifndef HALFSPACE_DISPATCH_TARGETS_CHOSEN_TARGET_H_
#define HALFSPACE_DISPATCH_TARGETS_CHOSEN_TARGET_H_

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "halfspace/targets.h"

namespace halfspace::dispatch {

// The index of a target among the compiled targets, best first. A default
// handle stands for the chosen target. Throws (error.h), in the name of `call`,
// if the machine does not support the target or the choice failed.
std::size_t ResolveIndex(Target target, const char* call);

// For the bit of each target, 1 more than its index if it was resolved before,
// and else 0. The last element is for the default handle.
extern std::array<std::atomic<std::uint8_t>, 65> resolved_indices;

inline constexpr std::size_t kUnknownTarget = ~std::size_t{0};

// The index if it was resolved before, and else kUnknownTarget.
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

// Returns ResolveIndex(), without a call if the target was resolved before.
inline std::size_t IndexOf(Target target, const char* call) {
  const std::size_t known = KnownIndexOf(target);
  return known != kUnknownTarget ? known : ResolveIndex(target, call);
}

// Whether vectors of 512 bits are the faster ones for one query
// (detect_targets.h). False until a target was resolved: a thread that reads an
// old value gets the same words, only slower.
extern std::atomic<bool> wide_vectors_pay;
inline bool WideVectorsPay() {
  return wide_vectors_pay.load(std::memory_order_relaxed);
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_TARGETS_CHOSEN_TARGET_H_

// All targets of this build, with their kernels, and the one that was chosen.
#ifndef HALFSPACE_DISPATCH_REGISTRY_H_
#define HALFSPACE_DISPATCH_REGISTRY_H_

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "dispatch/fit_table.h"
#include "dispatch/kernel_table.h"
#include "halfspace/targets.h"

namespace halfspace::dispatch {

// The kernels of a target in `dims` dimensions, the chosen one for a default
// handle. Throws std::invalid_argument, in the name of `call`, if the target is
// not supported here or the choice failed.
const KernelTable& ResolveKernels(Target target, int dims,
                                  std::string_view call);

// What has been resolved, by the index of the target's bit, the default handle
// last, and the dimensions; else null.
using ResolvedKernels =
    std::array<std::array<std::atomic<const KernelTable*>, 3>, 65>;
extern ResolvedKernels resolved_kernels;

// The same as ResolveKernels, which costs a call 2 ns more.
inline const KernelTable& KernelsFor(Target target, int dims,
                                     std::string_view call) {
  const auto bit = static_cast<std::uint64_t>(target.highway_bit());
  // No std::has_single_bit: the baseline of x86 has no popcnt.
  if ((bit & (bit - 1)) == 0) [[likely]] {
    const KernelTable* known =
        resolved_kernels[static_cast<std::size_t>(std::countr_zero(bit))]
                        [static_cast<std::size_t>(dims - 2)]
                            .load(std::memory_order_acquire);
    if (known != nullptr) [[likely]]
      return *known;
  }
  return ResolveKernels(target, dims, call);
}

// The same for the bulk builders.
const FitTable& FitKernelsFor(Target target, int dims, std::string_view call);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_REGISTRY_H_

// Visits the targets of this build at compile time, so that no list of targets
// but Highway's own exists.
#ifndef HALFSPACE_DISPATCH_FOR_EACH_TARGET_H_
#define HALFSPACE_DISPATCH_FOR_EACH_TARGET_H_

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "hwy/detect_targets.h"

namespace halfspace::dispatch {

inline constexpr std::size_t kTargetBits = 63;  // Highway leaves bit 63 alone

template <std::int64_t kTarget>
using TargetConstant = std::integral_constant<std::int64_t, kTarget>;

namespace detail {

template <std::size_t kBit, typename Visit>
constexpr void VisitTarget(const Visit& visit) {
  constexpr std::int64_t kTarget = std::int64_t{1} << kBit;
  if constexpr ((HWY_TARGETS & kTarget) != 0) visit(TargetConstant<kTarget>());
}

template <typename Visit, std::size_t... kBit>
constexpr void VisitTargets(const Visit& visit, std::index_sequence<kBit...>) {
  (VisitTarget<kBit>(visit), ...);
}

}  // namespace detail

// Calls visit(TargetConstant<target>()) for every compiled target, best first.
template <typename Visit>
constexpr void ForEachCompiledTarget(const Visit& visit) {
  detail::VisitTargets(visit, std::make_index_sequence<kTargetBits>());
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_FOR_EACH_TARGET_H_

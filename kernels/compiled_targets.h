// Visits the targets of this build at compile time, so that no list of targets
// but Highway's own exists.
#ifndef HALFSPACE_KERNELS_COMPILED_TARGETS_H_
#define HALFSPACE_KERNELS_COMPILED_TARGETS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "hwy/detect_targets.h"

namespace halfspace::kernels {

inline constexpr std::size_t kTargetBits = 63;  // Highway leaves bit 63 alone

template <std::int64_t kTarget>
using TargetConstant = std::integral_constant<std::int64_t, kTarget>;

namespace internal {

template <std::size_t kBit, typename Visit>
constexpr void VisitTarget(const Visit& visit) {
  constexpr std::int64_t kTarget = std::int64_t{1} << kBit;
  if constexpr ((HWY_TARGETS & kTarget) != 0) visit(TargetConstant<kTarget>());
}

template <typename Visit, std::size_t... kBit>
constexpr void VisitTargets(const Visit& visit, std::index_sequence<kBit...>) {
  (VisitTarget<kBit>(visit), ...);
}

}  // namespace internal

// Calls visit(TargetConstant<target>()) for every compiled target, best first.
template <typename Visit>
constexpr void ForEachCompiledTarget(const Visit& visit) {
  internal::VisitTargets(visit, std::make_index_sequence<kTargetBits>());
}

// How many there are. Lists of kernels have an entry for each, best first.
inline constexpr std::size_t kCompiledTargets = [] {
  std::size_t count = 0;
  ForEachCompiledTarget([&count](auto) { ++count; });
  return count;
}();

// get(TargetConstant<target>()) of each, in that order.
template <typename Entry, typename Get>
constexpr std::array<Entry, kCompiledTargets> OfEachTarget(const Get& get) {
  std::array<Entry, kCompiledTargets> entries{};
  std::size_t i = 0;
  ForEachCompiledTarget([&](auto target) { entries[i++] = get(target); });
  return entries;
}

// float32 lanes of a vector; executes an instruction of that target. Defined in
// kernels/scan/words.cc, because SVE has to ask the hardware.
template <std::int64_t kHighwayBit>
std::size_t LanesOf();

}  // namespace halfspace::kernels

namespace halfspace::detail {

// The entry of a target in a table of kernels. Each target's pass over
// kernels/table.cc.in specialises it.
template <std::int64_t kTarget, typename Table>
inline constexpr auto kEntryOf = nullptr;

template <typename Kernels, typename Table>
inline constexpr auto kOfEachTarget = kernels::OfEachTarget<Kernels>(
    [](auto target) { return kEntryOf<target(), Table>; });

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_COMPILED_TARGETS_H_

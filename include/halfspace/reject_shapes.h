// Half-spaces, for example a frustum: which of the stored bounds could be in
// front of all of them?
//
//   const std::array<HalfSpace3, 6> frustum = ...;
//   indices.resize(halfspace::Survivors(world, frustum, indices));
//
// Every call takes
//   world        a view or an owning world of floats in 2 or 3 dimensions
//                (world.h); may be empty
//   half_spaces  up to 64 HalfSpace<d> (shapes.h)
//   options      as in reject.h; the schedule has no effect
//
// An object survives if the corner of its bound that is foremost along the
// normal of each half-space is in front of it. For an AABO it is the corner of
// its box. These are the objects that the queries of bvh_shapes.h find.
// bvh_shapes.h says what is exact, and what half-spaces with a NaN, an infinity
// or a tiny component do. An empty list of half-spaces keeps every object.
//
// Errors: as RejectMask() in reject.h. There must be at most 64 half-spaces,
// and the pointer to them must not be null or misaligned.
//
// Floating-point mode: as in bvh_shapes.h. A call can raise inexact, overflow,
// underflow and invalid. A program that enables floating-point traps must
// disable these four during a call.
//
// Thread safety: as in reject.h, with 6 KiB more stack.
//
// Cost: with six half-spaces about 1 ns per object with AVX-512 and 3 ns with
// SSE4, which is five to eleven times the cost of a box query (a Xeon, family
// 6, model 167). From about 500 objects on, a BVH is faster.
//
// Source: the support function of a box is common knowledge.
#ifndef HALFSPACE_REJECT_SHAPES_H_
#define HALFSPACE_REJECT_SHAPES_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "halfspace/detail/reject_shapes.h"
#include "halfspace/reject.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"

namespace halfspace {

namespace detail {

// A type only if `HalfSpaces` is a list of half-spaces for a view of planes, or
// for a world that owns them.
template <typename AnyWorld, typename HalfSpaces,
          typename = typename AnyWorld::Planes>
using IfHalfSpacesOf = std::enable_if_t<std::is_convertible_v<
    const HalfSpaces&, Span<const HalfSpace<AnyWorld::Bound::kDimensions>>>>;

template <typename AnyWorld>
HalfSpaceList ListOf(
    Span<const HalfSpace<AnyWorld::Bound::kDimensions>> half_spaces) {
  constexpr std::size_t kDims = AnyWorld::Bound::kDimensions;
  static_assert(kDims <= 3, "half-spaces are for 2 and 3 dimensions");
  static_assert(sizeof(half_spaces[0]) == (kDims + 1) * sizeof(float),
                "half-spaces are read as a list of their values");
  return {reinterpret_cast<const float*>(half_spaces.data()),
          half_spaces.size()};
}

template <typename View>
Scan ScanOfBounds(const View& view) {
  static_assert(std::is_same_v<typename View::Bound::Scalar, float>,
                "half-spaces are for worlds of floats");
  return ScanOf(view, nullptr, 0);
}

}  // namespace detail

// Writes the survivor mask, as SurvivorMask() in reject.h.
template <typename AnyWorld, typename HalfSpaces,
          typename = detail::IfHalfSpacesOf<AnyWorld, HalfSpaces>>
void SurvivorMask(const AnyWorld& world, const HalfSpaces& half_spaces,
                  Span<std::uint64_t> mask, const Options& options = {}) {
  detail::FrontMask(detail::ScanOfBounds(world.view()),
                    detail::ListOf<AnyWorld>(half_spaces), mask, options);
}

// Writes the indices of the survivors and returns their number, as Survivors()
// in reject.h.
template <typename AnyWorld, typename HalfSpaces,
          typename = detail::IfHalfSpacesOf<AnyWorld, HalfSpaces>>
[[nodiscard]] std::size_t Survivors(const AnyWorld& world,
                                    const HalfSpaces& half_spaces,
                                    Span<std::uint32_t> indices,
                                    const Options& options = {}) {
  return detail::FrontSurvivors(detail::ScanOfBounds(world.view()),
                                detail::ListOf<AnyWorld>(half_spaces), indices,
                                options);
}

// Returns the number of survivors.
template <typename AnyWorld, typename HalfSpaces,
          typename = detail::IfHalfSpacesOf<AnyWorld, HalfSpaces>>
[[nodiscard]] std::size_t CountSurvivors(const AnyWorld& world,
                                         const HalfSpaces& half_spaces,
                                         const Options& options = {}) {
  return detail::FrontCount(detail::ScanOfBounds(world.view()),
                            detail::ListOf<AnyWorld>(half_spaces), options);
}

// Returns the index of the first survivor, as AnySurvivor() in reject.h.
template <typename AnyWorld, typename HalfSpaces,
          typename = detail::IfHalfSpacesOf<AnyWorld, HalfSpaces>>
[[nodiscard]] std::optional<std::size_t> AnySurvivor(
    const AnyWorld& world, const HalfSpaces& half_spaces,
    const Options& options = {}) {
  const std::size_t first =
      detail::FrontAny(detail::ScanOfBounds(world.view()),
                       detail::ListOf<AnyWorld>(half_spaces), options);
  if (first == detail::kNoSurvivor) return std::nullopt;
  return first;
}

}  // namespace halfspace

#endif  // HALFSPACE_REJECT_SHAPES_H_

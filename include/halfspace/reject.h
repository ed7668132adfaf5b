// One query: which of the stored bounds could it touch?
//
//   std::vector<std::uint32_t> indices(world.size());
//   indices.resize(halfspace::Survivors(world, query, indices));
//
// A call tests every object of a world against the query. It rejects an object
// if one of the planes separates the object from the query:
//
//   simplex   object.min[k] > query.max[k]  for some k in X, Y, ..., D
//   AABB      object.min[k] > query.max[k]  or  object.max[k] < query.min[k]
//             for some k in X, Y, ...
//   AABO      as AABB, for some k in X, Y, ..., D
//
// All other objects survive. Bounds that only touch survive. A compare with a
// NaN never rejects; the other planes still can. The results are bit-identical
// on every target, schedule and compiler.
//
// Every call takes
//   world    a view or an owning world (world.h), or a world of quantized
//            bounds (quantized.h); may be empty
//   query    the world's Query type: DownSimplex, Aabb or Aabo; or half-spaces
//            (reject_shapes.h)
//   options  schedule, target and range of objects; the defaults fit most uses
// RejectMask() documents the errors and the floating-point mode of all calls.
// reject_many.h has the calls for several queries.
//
// Thread safety: all calls are reentrant. They allocate nothing, take no lock
// and keep no state. A call uses at most 8 KiB of stack.
//
// Cost: a call starts with a load and an indirect call. Then it does one
// compare per plane and object, about as fast as memory delivers the planes
// (docs/performance.md has figures).
//
// Source: "The Bounding Simplex: A SIMD-Era Rejection Primitive" (the tests,
// and the early-out in SIMD, which schedules control).
#ifndef HALFSPACE_REJECT_H_
#define HALFSPACE_REJECT_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "halfspace/bounds.h"
#include "halfspace/detail/scan.h"
#include "halfspace/mask.h"  // IWYU pragma: export
#include "halfspace/span.h"
#include "halfspace/target.h"
#include "halfspace/visit.h"
#include "halfspace/world.h"

namespace halfspace {

// The order in which a call tests planes. A staged schedule tests some planes
// of every object first. It tests the other planes only for groups of objects
// that still have a survivor. The schedule changes the cost, never the result.
// A simplex is always tested flat.
enum class Schedule : std::uint8_t {
  // AABB and AABO: chooses among the schedules below while it runs, by how many
  // groups of the objects before still had a survivor. Few objects are tested
  // flat. Several queries of an AABO are tested as by kStaged, and with AVX-512
  // those of an AABB as by kFlat. Quantized bounds: an AABB is tested flat, an
  // AABO as by kStaged. `./bench.sh --details kernels` compares the schedules.
  kAuto,
  // Tests every plane of every object, without a branch.
  kFlat,
  // AABB: the planes of half of the axes (2 of 3), then those of one axis after
  // the other. AABO: the minima (the up simplex), then the maxima (the down
  // simplex). Quantized bounds: as kAuto.
  kStaged,
  // AABB and AABO: the two planes of one axis, then those of the next axis.
  // Quantized bounds: as kAuto.
  kStagedByAxis,
};

// Objects begin ... end - 1 of a world. `begin` must not be greater than `end`.
// Both may be greater than the size of the world: they are then taken as the
// size.
//
// A range costs as much as a world that has only these objects. The cells of a
// grid or the leaves of a tree can therefore be ranges of one world.
//
// Threads can share the work of one call: give each thread a range. If every
// range begins at a multiple of 64, the threads can write one mask together. A
// thread then passes the words of the mask from word begin / 64 on.
struct Range {
  std::size_t begin = 0;
  std::size_t end = std::numeric_limits<std::size_t>::max();
};

// Options of all calls of reject.h and reject_many.h.
struct Options {
  Schedule schedule = Schedule::kAuto;
  Target target = {};  // by default, the chosen target (targets.h)
  Range range = {};    // by default, the whole world
};

// Writes the reject mask: 1 = rejected.
//
// Masks: a mask has one bit for each of the n objects of `options.range`.
// Object `begin + i` is bit i % 64 of word i / 64. `mask.size()` must be at
// least MaskWords(n). The call does not touch any words after these. The bits
// after the last object are 1 in a reject mask and 0 in a survivor mask.
//
// Errors of all calls in this header (error.h). A call checks its arguments
// before it writes anything.
// - The query, the planes and the outputs must not be null or misaligned. The
//   planes of an empty world and an output without elements may be null.
// - `mask` must have room for the objects of the range.
// - An output must not overlap the planes or the query.
// - `options.range` must not end before it begins.
// - `options.schedule` must be one of the enumerators.
// - `options.target` must be supported on this machine.
// Code that is compiled with -fno-exceptions can link and call the library if
// it sets an error handler.
//
// Floating-point mode, for all calls in this header: the rounding mode has no
// effect. If the thread flushes subnormal inputs (DAZ, which a program that is
// linked with fast-math may set), a subnormal in a plane or a query counts as
// 0. An object can then survive that would otherwise be rejected. An object
// that would otherwise survive still survives.
//
// If the thread traps floating-point exceptions, a NaN or a subnormal in a
// plane or a query may trap on some targets and not on others. No other value
// traps. Mask the traps around calls on such values. (Builders never trap:
// fit.h.)
//
// Cost: a reject mask takes one more pass over the mask than a survivor mask.
template <typename AnyWorld, typename Query = typename AnyWorld::Query,
          typename Asked = detail::AskedOf<AnyWorld, Query>>
void RejectMask(const AnyWorld& world, const Query& query,
                Span<std::uint64_t> mask, const Options& options = {}) {
  detail::Ask(Asked::Of(world.view(), query), "RejectMask",
              [&](detail::Scan&& scan) {
                detail::RejectMask(std::move(scan), mask, options);
              });
}

// Writes the survivor mask: 1 = survives. Layout and errors: as RejectMask().
// SetBits (mask.h) goes through its bits.
template <typename AnyWorld, typename Query = typename AnyWorld::Query,
          typename Asked = detail::AskedOf<AnyWorld, Query>>
void SurvivorMask(const AnyWorld& world, const Query& query,
                  Span<std::uint64_t> mask, const Options& options = {}) {
  detail::Ask(Asked::Of(world.view(), query), "SurvivorMask",
              [&](detail::Scan&& scan) {
                detail::SurvivorMask(std::move(scan), mask, options);
              });
}

// Writes the indices of the survivors in ascending order and returns the number
// of survivors. Indices are positions in the world, also with a range.
//
// `indices` may be shorter than the result. The call then fills `indices`, and
// still returns the number of all survivors. To fetch a long result in pieces,
// pass the number of survivors that you have as `skip`. They are not written.
//
// Errors: as RejectMask(). The world must have at most 2^32 objects.
template <typename AnyWorld, typename Query = typename AnyWorld::Query,
          typename Asked = detail::AskedOf<AnyWorld, Query>>
[[nodiscard]] std::size_t Survivors(const AnyWorld& world, const Query& query,
                                    Span<std::uint32_t> indices,
                                    const Options& options = {},
                                    std::size_t skip = 0) {
  return detail::Ask(
      Asked::Of(world.view(), query), "Survivors", [&](detail::Scan&& scan) {
        return detail::Survivors(std::move(scan), indices, options, skip);
      });
}

// Returns the number of survivors. Errors: as RejectMask().
template <typename AnyWorld, typename Query = typename AnyWorld::Query,
          typename Asked = detail::AskedOf<AnyWorld, Query>>
[[nodiscard]] std::size_t CountSurvivors(const AnyWorld& world,
                                         const Query& query,
                                         const Options& options = {}) {
  return detail::Ask(Asked::Of(world.view(), query), "CountSurvivors",
                     [&](detail::Scan&& scan) {
                       return detail::CountSurvivors(std::move(scan), options);
                     });
}

// Returns the index of the first survivor, or std::nullopt if no object
// survives. The index is a position in the world, also with a range. The call
// tests the first 512 objects, then 4096 at a time until one survives.
//
// Errors: as RejectMask().
template <typename AnyWorld, typename Query = typename AnyWorld::Query,
          typename Asked = detail::AskedOf<AnyWorld, Query>>
[[nodiscard]] std::optional<std::size_t> AnySurvivor(
    const AnyWorld& world, const Query& query, const Options& options = {}) {
  const std::size_t first = detail::Ask(
      Asked::Of(world.view(), query), "AnySurvivor", [&](detail::Scan&& scan) {
        return detail::AnySurvivor(std::move(scan), options);
      });
  if (first == detail::kNoSurvivor) return std::nullopt;
  return first;
}

// Calls function(Span<const std::uint32_t> indices) with 1 to 256 survivors at
// a time, in ascending order, until it has all. The call tests 4096 objects or
// more and passes what survived before it goes on, so it needs no memory for
// the result. The indices are valid until the function returns.
//
// The function returns nothing or a Visit (visit.h). Visit::kStop ends the
// call. An exception of the function ends the call and reaches the caller.
//
// Errors: as Survivors().
template <typename AnyWorld, typename Function,
          typename Query = typename AnyWorld::Query,
          typename Asked = detail::AskedOf<AnyWorld, Query>>
void ForEachSurvivor(const AnyWorld& world, const Query& query,
                     Function&& function, const Options& options = {}) {
  detail::Callback call{function};
  detail::Ask(Asked::Of(world.view(), query), "ForEachSurvivor",
              [&](detail::Scan&& scan) {
                detail::ForEachSurvivor(std::move(scan), &decltype(call)::Run,
                                        &call, options);
              });
}

}  // namespace halfspace

#endif  // HALFSPACE_REJECT_H_

// The calls: which of the stored bounds could one query touch?
//
// Each call tests every object of a world against one query. An object is
// rejected iff one of its planes proves it separated from the query:
//
//   simplex   object.min[k] > query.max[k]  for a k in X, Y, ..., D
//   AABB      object.min[k] > query.max[k]  or  object.max[k] < query.min[k]
//             for a k in X, Y, ...
//   AABO      the same for a k in X, Y, ..., D
//
// and survives otherwise. The compares are strict and ordered: bounds that only
// touch survive, and a NaN on either side never rejects. The answer depends on
// neither target nor schedule nor compiler, bit for bit.
//
// Floating-point mode: rounding does not matter. Where the thread flushes
// subnormal inputs (DAZ, as a program linked with fast-math may), those in
// planes and queries of floats count as 0, which may keep an object that would
// else be rejected, and never rejects one that would be kept. Where it traps
// floating-point exceptions, a NaN or a subnormal in planes or queries may be
// trapped, on some targets and not on others, and no other value is: mask the
// traps around calls on such values. (No builder is trapped: fit.h.)
//
// Every call takes
//   world    a view or an owning world of world.h, of floats or of doubles, or
//            a quantized one of quantized.h
//   query    the world's Query type: DownSimplex, Aabb or Aabo
//   options  schedule, target, and the range of objects; the defaults are right
// reject_many.h has the same for many queries.
//
// Masks: object i is bit i % 64 of word i / 64; MaskWords(n) words in all.
// Words past those are not touched, and bits past object n - 1 in the last one
// never show a survivor: they are 1 in a reject mask, 0 in a survivor mask. A
// range of objects writes the words of the range and no others; indices are the
// world's, not the range's.
//
// Errors (error.h), before anything is written: a null or misaligned plane or
// output in a world that is not empty, a mask span too short for the world, an
// output that overlaps a plane or a query, more than 2^32 objects with 32-bit
// indices, a range that begins or ends between multiples of 64 or ends before
// it begins, a target that is not supported here. Code compiled with
// -fno-exceptions can link and call, and sets a handler. An empty world is
// fine.
//
// Thread safety: reentrant; no allocation, no lock, no state. Stack: 8 KiB are
// enough for every call here (7 are used on x86), over floats or quantized
// bounds. Cost: a load and an indirect call, then one compare per plane and
// object, at the speed of the planes' memory (docs/performance.md has figures).
// A reject mask is a survivor mask turned over: one more pass over the mask.
//
// Source: "The Bounding Simplex: A SIMD-Era Rejection Primitive" (the tests,
// and the early-out under SIMD that schedules are about).
#ifndef HALFSPACE_REJECT_H_
#define HALFSPACE_REJECT_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "halfspace/bounds.h"
#include "halfspace/detail/scan.h"
#include "halfspace/span.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"

namespace halfspace {

// When to stop testing a group of objects that are all rejected already. It
// changes the cost, never the answer. A simplex is always tested flat.
enum class Schedule : std::uint8_t {
  kAuto,          // the shape's measured best: see docs/design.md
  kFlat,          // every plane of every object, without a branch
  kStaged,        // AABB: as kStagedByAxis. AABO: up simplex, then down simplex
  kStagedByAxis,  // after the two planes (the interval) of each axis of a box
                  // or an octahedron of floats or doubles; of quantized bounds,
                  // as kAuto
};

// Objects begin ... end - 1 of a world, for threads that share one call's work:
// each takes a range and the same outputs. `begin` is a multiple of 64, so that
// no two share a word of a mask; `end` too, unless it is the world's size. What
// lies past the world does not count.
struct Range {
  std::size_t begin = 0;
  std::size_t end = std::numeric_limits<std::size_t>::max();
};

struct Options {
  Schedule schedule = Schedule::kAuto;
  Target target = {};     // the chosen target
  Range range = {};       // the whole world
  Target* ran = nullptr;  // if it is not null, is told which target runs
};

// Words of a mask over n objects.
constexpr std::size_t MaskWords(std::size_t objects) {
  return objects / 64 + (objects % 64 != 0 ? 1 : 0);
}

// Writes the reject mask: 1 = rejected, and 1 past the last object.
//   mask  at least MaskWords(world size) words
template <typename AnyWorld>
void RejectMask(const AnyWorld& world, const typename AnyWorld::Query& query,
                Span<std::uint64_t> mask, const Options& options = {}) {
  detail::RejectMask(detail::ScanOfOne(world, query), mask, options);
}

// Writes the survivor mask: 1 = survives, and 0 past the last object.
//   mask  at least MaskWords(world size) words
template <typename AnyWorld>
void SurvivorMask(const AnyWorld& world, const typename AnyWorld::Query& query,
                  Span<std::uint64_t> mask, const Options& options = {}) {
  detail::SurvivorMask(detail::ScanOfOne(world, query), mask, options);
}

// Writes the indices of the survivors, ascending, and returns how many there
// are. A span that is too short is no error: the first indices that fit are
// written, nothing past the span, and the full count is returned.
template <typename AnyWorld>
[[nodiscard]] std::size_t Survivors(const AnyWorld& world,
                                    const typename AnyWorld::Query& query,
                                    Span<std::uint32_t> indices,
                                    const Options& options = {}) {
  return detail::Survivors(detail::ScanOfOne(world, query), indices, options);
}

// Counts the survivors.
template <typename AnyWorld>
[[nodiscard]] std::size_t CountSurvivors(const AnyWorld& world,
                                         const typename AnyWorld::Query& query,
                                         const Options& options = {}) {
  return detail::CountSurvivors(detail::ScanOfOne(world, query), options);
}

// The index of the first survivor, if there is one. Looks at the first 512
// objects, then at 4096 after 4096, until there is a survivor.
template <typename AnyWorld>
[[nodiscard]] std::optional<std::size_t> AnySurvivor(
    const AnyWorld& world, const typename AnyWorld::Query& query,
    const Options& options = {}) {
  const std::size_t first =
      detail::AnySurvivor(detail::ScanOfOne(world, query), options);
  if (first == detail::kNoSurvivor) return std::nullopt;
  return first;
}

}  // namespace halfspace

#endif  // HALFSPACE_REJECT_H_

// The calls for one query: which of the stored bounds could it touch?
//
// A call tests every object of a world against the query. An object is rejected
// iff one of its planes proves that it is separated from the query:
//
//   simplex   object.min[k] > query.max[k]  for a k in X, Y, ..., D
//   AABB      object.min[k] > query.max[k]  or  object.max[k] < query.min[k]
//             for a k in X, Y, ...
//   AABO      the same for a k in X, Y, ..., D
//
// Otherwise it survives. The compares are strict and ordered: bounds that only
// touch survive, and a NaN on either side never rejects. The answer is the same
// on every target, schedule and compiler, bit for bit.
//
// Floating-point mode: rounding does not matter. If the thread flushes
// subnormal inputs (DAZ, which a program linked with fast-math may set), those
// in planes and queries of floats count as 0. That may keep an object that
// would be rejected otherwise, and never rejects one that would be kept. If the
// thread traps floating-point exceptions, a NaN or a subnormal in planes or
// queries may trap, on some targets and not on others; no other value does.
// Mask the traps around calls on such values. (Builders never trap: fit.h.)
//
// Every call takes
//   world    a view or an owning world of world.h (floats or doubles), or a
//            quantized one of quantized.h
//   query    the world's Query type: DownSimplex, Aabb or Aabo
//   options  schedule, target, and the range of objects; the defaults are right
// reject_many.h has the calls for several queries.
//
// Masks: object i of the world, or of the range in the options, is bit i % 64
// of word i / 64; a mask of n objects has MaskWords(n) words. Words after those
// are not touched. Bits after object n - 1 in the last word never show a
// survivor: they are 1 in a reject mask, 0 in a survivor mask. Indices are
// always those of the world, also with a range.
//
// Errors (error.h): a violated precondition is found before anything is
// written. The preconditions: no query, and in a world that is not empty no
// plane and no output, is null or misaligned; a mask has room for the objects
// of the range; an output overlaps neither a plane nor a query; with 32-bit
// indices a world has at most 2^32 objects; a range does not end before it
// begins; the schedule is one of the enumerators; the target is supported here.
// An empty world is valid. Code compiled with -fno-exceptions can link and
// call, and sets a handler.
//
// Thread safety: reentrant; no allocation, no lock, no state. Stack: every call
// here uses at most 8 KiB (7 on x86), over floats or quantized bounds. Cost: a
// load and an indirect call, then one compare per plane and object, at the
// speed of the planes' memory (docs/performance.md has figures). A reject mask
// is made from a survivor mask, by one more pass over the mask.
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

// When to stop testing a group of objects that have all been rejected. It
// changes the cost, never the answer. A simplex is always tested flat.
enum class Schedule : std::uint8_t {
  kAuto,          // the shape's measured best: see docs/design.md
  kFlat,          // every plane of every object, without a branch
  kStaged,        // AABB: as kStagedByAxis. AABO: up simplex, then down simplex
  kStagedByAxis,  // after the two planes of each axis of a box or an octahedron
                  // of floats or doubles; of quantized bounds, as kAuto
};

// Objects begin ... end - 1 of a world, as far as it has them: an end beyond
// the world is taken as its size, and a range that begins there is empty. A
// range costs what a world of its objects would: the cells of a grid or the
// leaves of a tree are ranges of one world. Threads share the work of one call
// by taking a range each; if these begin at multiples of 64 objects, each
// thread writes its words of one mask, from word begin / 64 on.
struct Range {
  std::size_t begin = 0;
  std::size_t end = std::numeric_limits<std::size_t>::max();
};

struct Options {
  Schedule schedule = Schedule::kAuto;
  Target target = {};     // by default, the chosen one (targets.h)
  Range range = {};       // by default, the whole world
  Target* ran = nullptr;  // if not null, receives the target that ran

  // RejectMasks and SurvivorMasks only: words from one row to the next. 0
  // stands for the words of a row; with more, a range is a part of larger rows.
  std::size_t row_words = 0;
};

// Words of a mask over n objects.
constexpr std::size_t MaskWords(std::size_t objects) {
  return objects / 64 + (objects % 64 != 0 ? 1 : 0);
}

// Writes the reject mask: 1 = rejected, and 1 past the last object.
//   mask  at least MaskWords(objects of the range) words
template <typename AnyWorld>
void RejectMask(const AnyWorld& world, const typename AnyWorld::Query& query,
                Span<std::uint64_t> mask, const Options& options = {}) {
  detail::RejectMask(detail::ScanOfOne(world, query), mask, options);
}

// Writes the survivor mask: 1 = survives, and 0 past the last object.
//   mask  at least MaskWords(objects of the range) words
template <typename AnyWorld>
void SurvivorMask(const AnyWorld& world, const typename AnyWorld::Query& query,
                  Span<std::uint64_t> mask, const Options& options = {}) {
  detail::SurvivorMask(detail::ScanOfOne(world, query), mask, options);
}

// Writes the indices of the survivors, ascending, and returns how many there
// are. A span that is too short is no error: it receives the first indices, and
// the full count is returned.
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

// The index of the first survivor, if there is one. Tests the first 512
// objects, then 4096 at a time until one survives.
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

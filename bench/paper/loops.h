// The loops of the paper's experiments, which are compiled for each target as
// the library's kernels are.
//
// Planes are in the kernels' order, all minima, then all maxima; so are the
// values of a query. Masks are of `size` objects, a multiple of 64.
#ifndef HALFSPACE_BENCH_PAPER_LOOPS_H_
#define HALFSPACE_BENCH_PAPER_LOOPS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "bench/base/shape.h"
#include "bench/worlds/working_set.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

// One half-space test.
struct Plane {
  std::size_t object;  // index of the stored plane
  std::size_t query;   // index of the query's value
  bool is_min;         // rejects if object > query; else if object < query
};

// Half-space `axis` of a shape with so many: the stored minimum and the query's
// maximum, which comes after its minima; or the other way round.
constexpr Plane MinOf(std::size_t axis, std::size_t axes) {
  return {axis, axes + axis, true};
}
constexpr Plane MaxOf(std::size_t axis, std::size_t axes) {
  return {axes + axis, axis, false};
}

// The order of the paper: a box axis by axis, an octahedron simplex by
// simplex.
inline constexpr std::array<Plane, 4> kSimplexOrder = {
    MinOf(0, 0), MinOf(1, 0), MinOf(2, 0), MinOf(3, 0)};
inline constexpr std::array<Plane, 6> kAabbOrder = {MinOf(0, 3), MaxOf(0, 3),
                                                    MinOf(1, 3), MaxOf(1, 3),
                                                    MinOf(2, 3), MaxOf(2, 3)};
inline constexpr std::array<Plane, 8> kAaboOrder = {
    MinOf(0, 4), MinOf(1, 4), MinOf(2, 4), MinOf(3, 4),
    MaxOf(0, 4), MaxOf(1, 4), MaxOf(2, 4), MaxOf(3, 4)};
// A flat box, with its minima first.
inline constexpr std::array<Plane, 6> kFlatAabbOrder = {
    MinOf(0, 3), MinOf(1, 3), MinOf(2, 3),
    MaxOf(0, 3), MaxOf(1, 3), MaxOf(2, 3)};

// A constant: no std::array function may be called from per-target code.
template <const auto& kOrder, std::size_t kIndex>
inline constexpr Plane kPlaneOf = kOrder[kIndex];

// The paper's schedule: after every half-space, a batch of `width` objects that
// are all rejected skips the rest. `width` is a power of two from the target's
// lane count to kWidestGate, `size` a multiple of kWidestGate. Writes the
// reject mask.
inline constexpr std::size_t kWidestGate = kSetStep;
using GatedScan = void (*)(ShapeKind shape, std::size_t width,
                           const float* const* planes, const float* query,
                           std::size_t size, std::uint64_t* mask);

// All half-spaces at once, or the same work in groups of 16 objects: after each
// stage of one or two planes, a group without a survivor skips the rest.
enum class Way : std::size_t {
  kFlat,
  kBranches,  // a group after the other, with a branch after each stage
  kLists,     // a stage after the other. The groups that are left are listed,
              // without a branch
};
constexpr const char* NameOf(Way way) {
  constexpr const char* kNames[] = {"flat", "branches", "lists"};
  return kNames[static_cast<std::size_t>(way)];
}

// Scans boxes or simplices with the vectors that the library uses for one
// query. `planes_of_stage` is 1 or 2. Writes the reject mask.
using StagedScan = void (*)(ShapeKind shape, Way way,
                            std::size_t planes_of_stage,
                            const float* const* planes, const float* query,
                            std::size_t size, std::uint64_t* mask);

// Spheres: planes and query are x, y, z, radius, aligned to 64 bytes. Rejects
// by the squared distance of the centers. Writes the survivor mask.
using SphereScan = void (*)(const float* const* planes, const float* query,
                            std::size_t size, std::uint64_t* mask);

struct PaperLoops {
  GatedScan gated = nullptr;
  SphereScan spheres = nullptr;
  StagedScan staged = nullptr;  // and where vectors have no known length
};

// The target must be supported.
PaperLoops PaperLoopsFor(Target target);

// A case of the paper's schedule.
inline Case GatedCase(WorkingSet& set, ShapeKind shape, Target target,
                      std::size_t width) {
  return set.LoopCase(
      shape, [gated = PaperLoopsFor(target).gated, shape, width](auto... of) {
        gated(shape, width, of...);
      });
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_LOOPS_H_

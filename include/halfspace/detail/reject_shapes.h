// Internal. The calls of reject_shapes.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_REJECT_SHAPES_H_
#define HALFSPACE_DETAIL_REJECT_SHAPES_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/scan.h"
#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace::detail {

// A scan without queries, and `count` half-spaces, each a normal and an offset.
struct FrontScan {
  Scan scan;
  const float* values;
  std::size_t count;
};

HALFSPACE_API void RejectMask(FrontScan&& fronts, Span<std::uint64_t> mask,
                              const Options& options);
HALFSPACE_API void SurvivorMask(FrontScan&& fronts, Span<std::uint64_t> mask,
                                const Options& options);
HALFSPACE_API std::size_t Survivors(FrontScan&& fronts,
                                    Span<std::uint32_t> indices,
                                    const Options& options, std::size_t skip);
HALFSPACE_API std::size_t CountSurvivors(FrontScan&& fronts,
                                         const Options& options);
HALFSPACE_API std::size_t AnySurvivor(FrontScan&& fronts,
                                      const Options& options);
HALFSPACE_API void ForEachSurvivor(FrontScan&& fronts, SomeFunction function,
                                   void* context, const Options& options);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_REJECT_SHAPES_H_

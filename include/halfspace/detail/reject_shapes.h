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

// `count` half-spaces, each a normal and an offset.
struct HalfSpaceList {
  const float* values;
  std::size_t count;
};

// Scans without queries.
HALFSPACE_API void FrontMask(Scan&& scan, const HalfSpaceList& half_spaces,
                             Span<std::uint64_t> mask, const Options& options);
HALFSPACE_API std::size_t FrontSurvivors(Scan&& scan,
                                         const HalfSpaceList& half_spaces,
                                         Span<std::uint32_t> indices,
                                         const Options& options);
HALFSPACE_API std::size_t FrontCount(Scan&& scan,
                                     const HalfSpaceList& half_spaces,
                                     const Options& options);
HALFSPACE_API std::size_t FrontAny(Scan&& scan,
                                   const HalfSpaceList& half_spaces,
                                   const Options& options);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_REJECT_SHAPES_H_

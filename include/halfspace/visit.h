// What a callback returns: whether the search continues, or its new limit.
//
//   ForEachSurvivor(bvh, query, [&](Span<const std::uint32_t> ids) {
//     return ids[0] == wanted ? Visit::kStop : Visit::kContinue;
//   });
//
// A function may also return nothing: the search goes on.
//
// Thread safety: plain values.
#ifndef HALFSPACE_VISIT_H_
#define HALFSPACE_VISIT_H_

#include <cstdint>

namespace halfspace {

enum class Visit : std::uint8_t { kContinue, kStop };

// The new limit of a cast or of a search by distance. Objects beyond it are not
// found from then on. A greater limit than the last one changes nothing.
struct Limit {
  float value;
};

}  // namespace halfspace

#endif  // HALFSPACE_VISIT_H_

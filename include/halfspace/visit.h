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
#include <type_traits>

#include "halfspace/span.h"

namespace halfspace {

enum class Visit : std::uint8_t { kContinue, kStop };

// The new limit of a cast or of a search by distance. Objects beyond it are not
// found from then on. A greater limit than the last one changes nothing.
struct Limit {
  float value;
};

namespace detail {

// Calls the caller's function; returns whether to go on.
template <typename Item, typename Function>
bool CallWithSome(void* function, Span<const Item> items) {
  auto& call = *static_cast<Function*>(function);
  using Result = decltype(call(items));
  static_assert(std::is_void_v<Result> || std::is_same_v<Result, Visit>,
                "the function must return void or Visit (visit.h)");
  if constexpr (std::is_same_v<Result, Visit>) {
    return call(items) == Visit::kContinue;
  } else {
    call(items);
    return true;
  }
}

}  // namespace detail

}  // namespace halfspace

#endif  // HALFSPACE_VISIT_H_

// What a callback returns: whether the search continues, or its new limit.
//
//   ForEachSurvivor(bvh, query, [&](Span<const std::uint32_t> ids) {
//     return ids[0] == wanted ? Visit::kStop : Visit::kContinue;
//   });
//
// A function may also return nothing: the search goes on. Or it returns a bool:
// whether to go on.
//
// Thread safety: plain values.
#ifndef HALFSPACE_VISIT_H_
#define HALFSPACE_VISIT_H_

#include <cstdint>
#include <limits>
#include <type_traits>

#include "halfspace/detail/cxx17.h"  // IWYU pragma: keep

namespace halfspace {

enum class Visit : std::uint8_t { kContinue, kStop };

// The new limit of a cast or of a search by distance. Objects beyond it are not
// found from then on. A greater limit than the last one changes nothing.
struct Limit {
  float value;
};

namespace detail {

// A function of the caller's. Run() has the signature that the library calls,
// with the address of the Callback as `context`. It returns whether to go on
// (bool), or the new limit (float).
template <typename Function>
struct Callback {
  Function function;

  template <typename Answer, typename... Arguments>
  static Answer Run(void* context, Arguments... arguments) {
    auto& function = static_cast<Callback*>(context)->function;
    using Result = decltype(function(arguments...));
    constexpr bool kHasLimit = std::is_same_v<Answer, float>;
    static_assert(
        std::is_void_v<Result> || std::is_same_v<Result, bool> ||
            std::is_same_v<Result, Visit> ||
            (kHasLimit && std::is_same_v<Result, Limit>),
        "the function must return nothing, a bool or a Visit, or, where the "
        "call has a limit, a Limit (visit.h)");
    bool goes_on = true;
    if constexpr (std::is_same_v<Result, Limit>) {
      return function(arguments...).value;
    } else if constexpr (std::is_same_v<Result, Visit>) {
      goes_on = function(arguments...) == Visit::kContinue;
    } else if constexpr (std::is_same_v<Result, bool>) {
      goes_on = function(arguments...);
    } else {
      function(arguments...);
    }
    if constexpr (kHasLimit) {
      constexpr float kInfinity = std::numeric_limits<float>::infinity();
      return goes_on ? kInfinity : -kInfinity;
    } else {
      return goes_on;
    }
  }
};
// It refers to a function that has a name, and owns one that has none.
template <typename Function>
Callback(Function&& function) -> Callback<Function>;

}  // namespace detail

}  // namespace halfspace

#endif  // HALFSPACE_VISIT_H_

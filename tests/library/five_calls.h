// The five calls as a list, for what must hold for each of them.
#ifndef HALFSPACE_TESTS_LIBRARY_FIVE_CALLS_H_
#define HALFSPACE_TESTS_LIBRARY_FIVE_CALLS_H_

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "halfspace/reject.h"
#include "tests/library/canaries.h"

namespace halfspace::testing {

// Room for the masks and lists of small worlds, and proof that nothing was
// written there.
struct CallOutputs {
  static constexpr std::size_t kRoom = 300;

  Canaried<std::uint64_t> mask;
  Canaried<std::uint32_t> indices;

  bool Untouched() const { return mask.IntactBut(0) && indices.IntactBut(0); }
};

// Calls visit(name, call) for each of the five; call() returns the target that
// ran, as the call tells it.
template <typename AnyWorld, typename Visit>
void ForEachCall(const AnyWorld& world, const typename AnyWorld::Query& query,
                 const Options& options, CallOutputs& outputs, Visit visit) {
  const auto mask = outputs.mask.Reset(CallOutputs::kRoom);
  const auto indices = outputs.indices.Reset(CallOutputs::kRoom);
  Options asking = options;
  Target ran;
  asking.ran = &ran;
  const auto visit_call = [&](std::string_view name, auto call) {
    visit(name, [&] {
      ran = {};
      call();
      return ran;
    });
  };
  visit_call("RejectMask", [&] { RejectMask(world, query, mask, asking); });
  visit_call("SurvivorMask", [&] { SurvivorMask(world, query, mask, asking); });
  visit_call("Survivors",
             [&] { std::ignore = Survivors(world, query, indices, asking); });
  visit_call("CountSurvivors",
             [&] { std::ignore = CountSurvivors(world, query, asking); });
  visit_call("AnySurvivor",
             [&] { std::ignore = AnySurvivor(world, query, asking); });
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIVE_CALLS_H_

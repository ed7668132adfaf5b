// The calls of reject.h as a list, for what must hold for each of them.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_CALLS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_CALLS_H_

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "halfspace/reject.h"
#include "tests/library/support/canaries.h"

namespace halfspace::testing {

// Room for the masks and lists of small worlds, and proof that nothing was
// written there.
struct CallOutputs {
  static constexpr std::size_t kRoom = 300;

  Canaried<std::uint64_t> mask;
  Canaried<std::uint32_t> indices;

  std::size_t passed = 0;  // to a function

  bool Untouched() const {
    return mask.IntactBut(0) && indices.IntactBut(0) && passed == 0;
  }
};

// Calls visit(name, call) for each of the six.
template <typename AnyWorld, typename Visit>
void ForEachCall(const AnyWorld& world, const typename AnyWorld::Query& query,
                 const Options& options, CallOutputs& outputs, Visit visit) {
  const auto mask = outputs.mask.Reset(CallOutputs::kRoom);
  const auto indices = outputs.indices.Reset(CallOutputs::kRoom);
  outputs.passed = 0;
  visit("RejectMask", [&] { RejectMask(world, query, mask, options); });
  visit("SurvivorMask", [&] { SurvivorMask(world, query, mask, options); });
  visit("Survivors",
        [&] { std::ignore = Survivors(world, query, indices, options); });
  visit("CountSurvivors",
        [&] { std::ignore = CountSurvivors(world, query, options); });
  visit("AnySurvivor",
        [&] { std::ignore = AnySurvivor(world, query, options); });
  visit("ForEachSurvivor", [&] {
    ForEachSurvivor(
        world, query, [&](const auto& some) { outputs.passed += some.size(); },
        options);
  });
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_CALLS_H_

// The calls of reject.h and reject_many.h as lists, for what must hold for each
// of them.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_CALLS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_CALLS_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <tuple>

#include "halfspace/reject_many.h"
#include "tests/library/support/any_world.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {

// Room for the outputs of small worlds and few queries, and proof that nothing
// was written there and no function was called.
struct CallOutputs {
  static constexpr std::size_t kRoom = 300;

  Canaried<std::uint64_t> words;
  Canaried<std::uint32_t> indices;  // of objects
  Canaried<std::uint32_t> query_indices;
  Canaried<std::size_t> counts;
  std::size_t passed = 0;

  // Only so many of each were written.
  bool IntactBut(std::size_t used_words, std::size_t pairs,
                 std::size_t used_counts) const {
    return words.IntactBut(used_words) && indices.IntactBut(pairs) &&
           query_indices.IntactBut(pairs) && counts.IntactBut(used_counts);
  }
  bool Untouched() const { return IntactBut(0, 0, 0) && passed == 0; }
};

using NamedCall =
    std::function<void(std::string_view name, const std::function<void()>&)>;

// Calls visit(name, call) for each of the six calls of one query.
inline void ForEachCall(const AnyWorld& world, const AnyQueries& query,
                        const Options& options, CallOutputs& outputs,
                        const NamedCall& visit) {
  const auto words = outputs.words.Reset(CallOutputs::kRoom);
  const auto indices = outputs.indices.Reset(CallOutputs::kRoom);
  outputs.query_indices.Reset(0);
  outputs.counts.Reset(0);
  outputs.passed = 0;
  const auto asked = [&] { return world.Asked(query); };
  visit("RejectMask", [&] { detail::RejectMask(asked(), words, options); });
  visit("SurvivorMask", [&] { detail::SurvivorMask(asked(), words, options); });
  visit("Survivors",
        [&] { std::ignore = detail::Survivors(asked(), indices, options, 0); });
  visit("CountSurvivors",
        [&] { std::ignore = detail::CountSurvivors(asked(), options); });
  visit("AnySurvivor",
        [&] { std::ignore = detail::AnySurvivor(asked(), options); });
  visit("ForEachSurvivor", [&] {
    const auto add = [&](Span<const std::uint32_t> some) {
      outputs.passed += some.size();
    };
    detail::Callback call{add};
    detail::ForEachSurvivor(asked(), &decltype(call)::Run, &call, options);
  });
}
// The same for each of the three calls of several queries.
inline void ForEachManyCall(const AnyWorld& world, const AnyQueries& queries,
                            const Options& options, CallOutputs& outputs,
                            const NamedCall& visit) {
  const auto words = outputs.words.Reset(CallOutputs::kRoom);
  const auto indices = outputs.indices.Reset(CallOutputs::kRoom);
  const auto query_indices = outputs.query_indices.Reset(CallOutputs::kRoom);
  const auto counts = outputs.counts.Reset(CallOutputs::kRoom);
  outputs.passed = 0;
  const auto asked = [&] { return world.Asked(queries); };
  visit("SurvivorMasks",
        [&] { detail::SurvivorMasks(asked(), words, options, 0); });
  visit("SurvivorPairs", [&] {
    std::ignore =
        detail::SurvivorPairs(asked(), query_indices, indices, options, 0);
  });
  visit("SurvivorCounts",
        [&] { detail::SurvivorCounts(asked(), counts, options); });
}
// Expects that every call, of one query and of several, refuses in its own name
// and writes nothing.
inline void ExpectAllRefuse(const AnyWorld& world, const AnyQueries& queries,
                            const Options& options, std::string_view argument,
                            std::string_view expected, std::string_view given) {
  CallOutputs outputs;
  const auto check = [&](std::string_view name, const auto& call) {
    EXPECT_TRUE(Refuses(call, {"halfspace: ", name, ": ", argument,
                               ": expected", expected, "got", given}));
  };
  if (queries.count != 0) {
    ForEachCall(world, world.One(queries), options, outputs, check);
    EXPECT_TRUE(outputs.Untouched());
  }
  ForEachManyCall(world, queries, options, outputs, check);
  EXPECT_TRUE(outputs.Untouched());
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_CALLS_H_

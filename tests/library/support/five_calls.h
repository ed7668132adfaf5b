// The five calls as a list, for what must hold for each of them.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_FIVE_CALLS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_FIVE_CALLS_H_

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

  bool Untouched() const { return mask.IntactBut(0) && indices.IntactBut(0); }
};

// Turns calls that take options into visit(name, call), where call() returns
// the target that ran, as the call tells it.
template <typename Visit>
class CallVisitor {
 public:
  CallVisitor(const Options& options, Visit visit)
      : asking_(options), visit_(visit) {
    asking_.ran = &ran_;
  }

  template <typename Call>
  void operator()(std::string_view name, const Call& call) {
    visit_(name, [this, &call] {
      ran_ = {};
      call(asking_);
      return ran_;
    });
  }

 private:
  Options asking_;
  Target ran_;
  Visit visit_;
};

// Calls visit(name, call) for each of the five, as CallVisitor does.
template <typename AnyWorld, typename Visit>
void ForEachCall(const AnyWorld& world, const typename AnyWorld::Query& query,
                 const Options& options, CallOutputs& outputs, Visit visit) {
  const auto mask = outputs.mask.Reset(CallOutputs::kRoom);
  const auto indices = outputs.indices.Reset(CallOutputs::kRoom);
  CallVisitor visit_call(options, visit);
  visit_call("RejectMask",
             [&](const Options& o) { RejectMask(world, query, mask, o); });
  visit_call("SurvivorMask",
             [&](const Options& o) { SurvivorMask(world, query, mask, o); });
  visit_call("Survivors", [&](const Options& o) {
    std::ignore = Survivors(world, query, indices, o);
  });
  visit_call("CountSurvivors", [&](const Options& o) {
    std::ignore = CountSurvivors(world, query, o);
  });
  visit_call("AnySurvivor", [&](const Options& o) {
    std::ignore = AnySurvivor(world, query, o);
  });
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_FIVE_CALLS_H_

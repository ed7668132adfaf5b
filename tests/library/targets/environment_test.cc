// What HALFSPACE_TARGET in the environment does. Each value needs a process of
// its own: ctest runs this executable once for each.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "halfspace/bvh.h"
#include "halfspace/fit_many.h"
#include "halfspace/reject.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/target_that_runs.h"

namespace halfspace::testing {
namespace {

constexpr std::string_view kTriedNames[] = {HALFSPACE_TRIED_NAMES};

// Empty is the same as not set.
std::string Requested() {
  const char* value = std::getenv("HALFSPACE_TARGET");
  return value == nullptr ? "" : value;
}

bool MustBeRefused() {
  return !Requested().empty() && !FindTarget(Requested());
}

// What a builder of many, and a scan of what it built, say and do.
std::string WhatIsDone() {
  const std::array<float, 8> box = {1, 2, 3, 4, 5, 6};
  AaboWorld3 world;
  world.Resize(1);
  try {
    BoundBoxes(Boxes3{.min = {&box[0], &box[1], &box[2]},
                      .max = {&box[3], &box[4], &box[5]},
                      .count = 1},
               world.planes());
    const Target ran = TargetThatRuns(world, Aabo3::Everything(), {});
    const std::size_t survivors = CountSurvivors(world, Aabo3::Everything());
    return std::string(ran.name()) + ' ' + std::to_string(survivors) + ' ' +
           std::to_string(world.Get(0).max[3]);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

// Made before the library is asked for anything, and so gone after all that it
// keeps.
class AtExit {
 public:
  ~AtExit() {
    if (expected.empty() || WhatIsDone() == expected) return;
    std::fprintf(stderr, "after main: %s\nbefore: %s\n", WhatIsDone().c_str(),
                 expected.c_str());
    std::_Exit(1);
  }
  std::string expected;
};
AtExit at_exit;

// Of an emulated CPU, named by the test that starts this program.
TEST(EnvironmentTest, CpuHasTheTargetThatItCanRun) {
  const char* expected = std::getenv("HALFSPACE_TEST_TARGET_OF_CPU");
  if (expected == nullptr) GTEST_SKIP() << "no CPU is emulated";
  EXPECT_EQ(ChosenTarget().name(), expected);
}

TEST(EnvironmentTest, HoldsAfterMainToo) {
  at_exit.expected = WhatIsDone();
  EXPECT_FALSE(at_exit.expected.empty());
}

TEST(EnvironmentTest, EveryCompiledNameIsTried) {
  for (Target target : CompiledTargets()) {
    EXPECT_NE(std::find(std::begin(kTriedNames), std::end(kTriedNames),
                        target.name()),
              std::end(kTriedNames))
        << "add " << target.name() << " to the names in environment.cmake";
  }
}

TEST(EnvironmentTest, CallsRunWhatItNamesOrRefuse) {
  const Target expected = Requested().empty()
                              ? SupportedTargets().front()
                              : FindTarget(Requested()).value_or(Target());
  const AaboWorld3 empty;
  const Aabo3 query = Aabo3::Everything();
  CallOutputs outputs;
  ForEachCall(
      AnyWorld(empty), {&query, 1}, {}, outputs,
      [&](std::string_view name, const auto& call) {
        if (MustBeRefused()) {
          EXPECT_TRUE(Refuses(call, {"HALFSPACE_TARGET", "expected one of ",
                                     "got \"" + Requested() + '"'}))
              << name;
        } else {
          call();
        }
      });
  if (!MustBeRefused()) {
    EXPECT_EQ(TargetThatRuns(empty, query, {}), expected);
  }
  EXPECT_TRUE(outputs.Untouched());
}

// The stored BVH has free places, so an insertion looks for one of them first.
TEST(EnvironmentTest, ChangesOfABvhRunWhatItNamesOrRefuse) {
  std::ifstream file(HALFSPACE_TEST_DATA "/octahedra.5.bvh", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  AaboBvh3 bvh = AaboBvh3::FromBlob(std::as_bytes(std::span(bytes)));
  const std::vector<Aabo3> bounds(8, Aabo3::Everything());
  std::vector<std::uint32_t> ids(bounds.size());
  const std::pair<const char*, std::function<void()>> changes[] = {
      {"Bvh::Insert: ", [&] { bvh.Insert(bounds[0]); }},
      {"Bvh::Insert: ", [&] { bvh.Insert(bounds, ids); }},
      {"Bvh::Set: ", [&] { bvh.Set(0, bounds[0]); }},
      {"Bvh::Erase: ", [&] { bvh.Erase(0); }},
  };
  for (const auto& [name, change] : changes) {
    if (MustBeRefused()) {
      EXPECT_TRUE(Refuses(change, {name, "HALFSPACE_TARGET"})) << name;
    } else {
      change();
    }
  }
}

TEST(EnvironmentTest, AskingDoesNotThrow) {
  const TargetChoice choice = DescribeTargetChoice();
  EXPECT_EQ(choice.requested, Requested());
  if (MustBeRefused()) {
    EXPECT_EQ(choice.target, Target());
    EXPECT_NE(choice.error.find("expected one of "), std::string::npos)
        << choice.error;
    EXPECT_NE(choice.error.find('"' + Requested() + '"'), std::string::npos)
        << choice.error;
    EXPECT_TRUE(Refuses([] { ChosenTarget(); }, {"HALFSPACE_TARGET"}));
  } else {
    EXPECT_EQ(choice.error, "");
    EXPECT_EQ(choice.target, ChosenTarget());
  }
}

// A bad value must not stand in the way of a call that names its target.
TEST(EnvironmentTest, TargetOfTheOptionsComesFirst) {
  const AaboWorld3 empty;
  for (Target target : SupportedTargets()) {
    EXPECT_EQ(TargetThatRuns(empty, Aabo3::Everything(), {.target = target}),
              target);
  }
}

}  // namespace
}  // namespace halfspace::testing

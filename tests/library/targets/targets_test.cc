// Targets: the lists, the names, and that the target asked for is the one that
// runs.
#include "halfspace/targets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/reject.h"
#include "halfspace/world.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

bool Contains(std::span<const Target> targets, Target target) {
  return std::find(targets.begin(), targets.end(), target) != targets.end();
}

std::string SupportedNames() {
  std::string names;
  for (Target target : SupportedTargets()) {
    if (!names.empty()) names += ", ";
    names += target.name();
  }
  return names;
}

std::string LowerCase(std::string_view name) {
  std::string lower(name);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

TEST(TargetsTest, SupportedOnesAreCompiledInTheSameOrder) {
  const auto compiled = CompiledTargets();
  auto from = compiled.begin();
  ASSERT_FALSE(SupportedTargets().empty());
  for (Target target : SupportedTargets()) {
    from = std::find(from, compiled.end(), target);
    ASSERT_NE(from, compiled.end()) << target.name();
  }
}

TEST(TargetsTest, NamesAreUniqueAndFindTheirTarget) {
  std::set<std::string_view> names;
  for (Target target : CompiledTargets()) {
    EXPECT_FALSE(target.name().empty());
    EXPECT_TRUE(names.insert(target.name()).second) << target.name();
  }
  for (Target target : SupportedTargets()) {
    EXPECT_EQ(FindTarget(target.name()), target);
    EXPECT_EQ(TargetByName(target.name()), target);
  }
}

TEST(TargetsTest, PlainFallBackIsAlwaysThere) {
  const Target last = SupportedTargets().back();
  EXPECT_TRUE(last.name() == "SCALAR" || last.name() == "EMU128")
      << last.name();
}

TEST(TargetsTest, LanesAreThoseOfTheInstructionSet) {
  const std::map<std::string_view, std::size_t> known = {
      {"AVX3_DL", 16}, {"AVX3", 16},  {"AVX2", 8},   {"SSE4", 4},
      {"SSSE3", 4},    {"SSE2", 4},   {"NEON", 4},   {"SVE_256", 8},
      {"SVE2_128", 4}, {"EMU128", 4}, {"SCALAR", 1},
  };
  for (Target target : SupportedTargets()) {
    const auto it = known.find(target.name());
    if (it != known.end()) {
      EXPECT_EQ(target.lanes(), it->second) << target.name();
    } else {
      EXPECT_GE(target.lanes(), 4u) << target.name();
    }
    EXPECT_TRUE(target.one_query_lanes() == target.lanes() ||
                (target.lanes() == 16 && target.one_query_lanes() == 8))
        << target.name();
  }
  EXPECT_EQ(Target().lanes(), 0u);
}

TEST(TargetsTest, DefaultHandle) {
  EXPECT_EQ(Target().name(), "auto");
  // The texts end with a null character, also those that are empty.
  EXPECT_STREQ(Target().name().data(), "auto");
  EXPECT_STREQ(Target::FromHighwayBit(3).name().data(), "");
  EXPECT_EQ(Target().highway_bit(), 0);
}

TEST(TargetsTest, HandleOfNoSupportedTargetIsRefused) {
  std::vector<std::int64_t> bits = {3, -1,
                                    std::numeric_limits<std::int64_t>::min()};
  for (int bit = 0; bit < 63; ++bit) {
    const Target target = Target::FromHighwayBit(std::int64_t{1} << bit);
    if (!Contains(SupportedTargets(), target)) {
      bits.push_back(target.highway_bit());
    }
  }
  for (std::int64_t bit : bits) {
    const Target target = Target::FromHighwayBit(bit);
    EXPECT_REFUSED(CountSurvivors(AaboWorld3(), {}, {.target = target}),
                   "options.target", "expected one of " + SupportedNames(),
                   "got");
    EXPECT_EQ(target.lanes(), 0u);
  }
}

// What an error says of a name: unknown, in small letters, or of a target that
// this machine does not support.
TEST(TargetsTest, NamesOfNoSupportedTargetAreRefused) {
  const auto expect = [](std::string_view name, const std::string& why) {
    EXPECT_EQ(FindTarget(name), std::nullopt) << name;
    EXPECT_TRUE(
        Refuses([&] { TargetByName(name); },
                {"TargetByName", "name", "expected one of " + SupportedNames(),
                 "got \"" + std::string(name) + '"', why}));
  };
  for (std::string_view name : {"", "auto", "nonsense", "AVX2 ", "A"}) {
    expect(name, "is unknown or not in this build");
  }
  for (Target target : CompiledTargets()) {
    std::string lower = LowerCase(target.name());
    if (!Contains(SupportedTargets(), target)) {
      expect(target.name(), "this machine does not support");
      expect(lower, "this machine does not support");
      continue;
    }
    const std::string why =
        "case matters: did you mean " + std::string(target.name()) + "?";
    expect(lower, why);
    lower[0] = target.name()[0];
    expect(lower, why);
  }
}

}  // namespace
}  // namespace halfspace::testing

#include "halfspace/targets.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <string>

#include "dispatch/chosen_target.h"
#include "dispatch/detect_targets.h"
#include "dispatch/registry.h"
#include "dispatch/target_table.h"
#include "hwy/highway.h"
#include "hwy/targets.h"
#include "kernels/compiled_targets.h"
#include "kernels/error.h"

namespace halfspace {
namespace dispatch {
namespace {

// One target; all pointers are null if it is not in this build.
struct Entry {
  // In 2, 3, 4 dimensions.
  std::array<const FitTable& (*)(), 3> fit{};
  std::size_t (*lanes)() = nullptr;
};

// By the index of the target's bit.
constexpr std::array<Entry, kernels::kTargetBits> kEntries = [] {
  std::array<Entry, kernels::kTargetBits> entries{};
  kernels::ForEachCompiledTarget([&entries](auto target) {
    constexpr std::int64_t kTarget = target();
    entries[std::countr_zero(static_cast<std::uint64_t>(kTarget))] = {
        {&FitTableOf<kTarget, 2>, &FitTableOf<kTarget, 3>,
         &FitTableOf<kTarget, 4>},
        &kernels::LanesOf<kTarget>};
  });
  return entries;
}();

// A lower bit is a better target, by Highway's convention.
struct TargetList {
  std::array<Target, kernels::kTargetBits> targets;
  std::size_t count = 0;

  explicit TargetList(std::int64_t bits) {
    for (std::int64_t left = bits; left != 0; left &= left - 1) {
      targets[count++] = Target::FromHighwayBit(left & -left);
    }
  }
  std::span<const Target> span() const { return {targets.data(), count}; }
};

// Asked once; the answer must not change under us.
std::int64_t SupportedBits() {
  static const std::int64_t bits = DetectTargets();
  return bits;
}

const Entry* FindEntry(Target target) {
  const auto bit = static_cast<std::uint64_t>(target.highway_bit());
  if (!std::has_single_bit(bit)) return nullptr;
  if ((bit & static_cast<std::uint64_t>(SupportedBits())) == 0) return nullptr;
  return &kEntries[static_cast<std::size_t>(std::countr_zero(bit))];
}

std::string NamesOf(std::span<const Target> targets) {
  std::string names;
  for (Target target : targets) {
    if (!names.empty()) names += ", ";
    names += target.name();
  }
  return names;
}

const char* EnvironmentOverride() {
#if defined(__GLIBC__)
  return secure_getenv("HALFSPACE_TARGET");
#else
  return std::getenv("HALFSPACE_TARGET");
#endif
}

// Of letters without accents, whatever the locale.
bool IsSameButForCase(std::string_view a, std::string_view b) {
  const auto lower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(),
      [&](char left, char right) { return lower(left) == lower(right); });
}

// Empty if `name` is a supported target; else the name and what is wrong.
std::string WhyNot(std::string_view name) {
  if (FindTarget(name)) return {};
  std::string why(1, '"');
  why.append(name).append("\", which ");
  for (Target target : CompiledTargets()) {
    if (!IsSameButForCase(target.name(), name)) continue;
    if (!FindTarget(target.name())) {
      return why.append("this build has but this machine does not support");
    }
    why.append("is unknown, as case matters: did you mean ");
    return why.append(target.name()).append("?");
  }
  return why.append("is unknown or not in this build");
}

std::string ExpectedNames() { return "one of " + NamesOf(SupportedTargets()); }

struct Choice {
  Target target;
  std::string requested;
  std::string error;
};

// Never destroyed: calls may come from other objects' destructors after main,
// and from threads that nobody waits for.
const Choice& TheChoice() {
  static const Choice& choice = *new Choice([] {
    Choice result;
    const char* value = EnvironmentOverride();
    if (value == nullptr || *value == '\0') {
      result.target = SupportedTargets().front();
      return result;
    }
    result.requested = value;
    if (std::string why = WhyNot(value); !why.empty()) {
      result.error = "expected " + ExpectedNames() + ", got " + why;
      return result;
    }
    result.target = *FindTarget(value);
    return result;
  }());
  return choice;
}

[[noreturn]] void ThrowBadChoice(std::string_view call) {
  kernels::ThrowInvalid(call, "HALFSPACE_TARGET", ExpectedNames(),
                        WhyNot(TheChoice().requested));
}

[[noreturn]] void ThrowBadTarget(Target target, std::string_view call) {
  kernels::ThrowInvalid(call, "options.target", ExpectedNames(),
                        target.name().empty() ? "a bit that is no target"
                                              : WhyNot(target.name()));
}

// The target that HALFSPACE_TARGET asks for, or the best one.
Target ChosenFor(std::string_view call) {
  if (!TheChoice().error.empty()) ThrowBadChoice(call);
  return TheChoice().target;
}

// The entry of a target that a caller names, or of the chosen one.
const Entry& EntryOf(Target target, std::string_view call) {
  if (target == Target()) target = ChosenFor(call);
  const Entry* entry = FindEntry(target);
  if (entry == nullptr) ThrowBadTarget(target, call);
  return *entry;
}

std::size_t IndexOf(int dims) { return static_cast<std::size_t>(dims - 2); }

}  // namespace

constinit std::array<std::atomic<std::uint8_t>, 65> resolved_indices{};

std::size_t ResolveIndex(Target target, const char* call) {
  const std::int64_t bit =
      (target == Target() ? ChosenFor(call) : target).highway_bit();
  EntryOf(target, call);
  // Better targets have lower bits, and come before it.
  const std::size_t index = static_cast<std::size_t>(
      std::popcount(static_cast<std::uint64_t>(HWY_TARGETS & (bit - 1))));
  resolved_indices[static_cast<std::size_t>(std::countr_zero(
      static_cast<std::uint64_t>(target.highway_bit())))]
      .store(static_cast<std::uint8_t>(index + 1), std::memory_order_relaxed);
  return index;
}

const FitTable& FitKernelsFor(Target target, int dims, std::string_view call) {
  return EntryOf(target, call).fit[IndexOf(dims)]();
}

}  // namespace dispatch

std::string_view Target::name() const {
  if (*this == Target()) return "auto";
  if (!std::has_single_bit(static_cast<std::uint64_t>(highway_bit_))) return {};
  return hwy::TargetName(highway_bit_);
}

std::size_t Target::lanes() const {
  const dispatch::Entry* entry = dispatch::FindEntry(*this);
  return entry == nullptr ? 0 : entry->lanes();
}

std::span<const Target> CompiledTargets() {
  static const dispatch::TargetList list(HWY_TARGETS);
  return list.span();
}

std::span<const Target> SupportedTargets() {
  static const dispatch::TargetList list(dispatch::SupportedBits());
  return list.span();
}

Target ChosenTarget() {
  const dispatch::Choice& choice = dispatch::TheChoice();
  if (!choice.error.empty()) dispatch::ThrowBadChoice("ChosenTarget");
  return choice.target;
}

detail::TargetChoiceView detail::ViewTargetChoice() {
  const dispatch::Choice& choice = dispatch::TheChoice();
  return {choice.target, choice.requested, choice.error};
}

std::optional<Target> FindTarget(std::string_view name) {
  for (Target target : SupportedTargets()) {
    if (target.name() == name) return target;
  }
  return std::nullopt;
}

Target TargetByName(std::string_view name) {
  if (std::optional<Target> target = FindTarget(name)) return *target;
  kernels::ThrowInvalid("TargetByName", "name", dispatch::ExpectedNames(),
                        dispatch::WhyNot(name));
}

}  // namespace halfspace

#include "halfspace/targets.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <string>

#include "dispatch/errors/error.h"
#include "dispatch/targets/chosen_target.h"
#include "dispatch/targets/detect_targets.h"
#include "hwy/highway.h"
#include "hwy/targets.h"
#include "kernels/compiled_targets.h"

namespace halfspace {
namespace dispatch {
namespace {

// A lower bit is a better target, by Highway's convention.
struct TargetList {
  std::array<Target, kernels::kTargetBits> targets;
  std::size_t count = 0;

  explicit TargetList(std::int64_t bits) {
    for (std::int64_t left = bits; left != 0; left &= left - 1) {
      targets[count++] = Target::FromHighwayBit(left & -left);
    }
  }
  Span<const Target> span() const { return {targets.data(), count}; }
};

// Detected once, because the result must not change during the run.
std::int64_t SupportedBits() {
  static const std::int64_t bits = DetectTargets();
  return bits;
}

bool IsSupported(Target target) {
  const auto bit = static_cast<std::uint64_t>(target.highway_bit());
  return std::has_single_bit(bit) &&
         (bit & static_cast<std::uint64_t>(SupportedBits())) != 0;
}

std::string NamesOf(Span<const Target> targets) {
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

// For ASCII letters, in every locale.
bool IsSameButForCase(std::string_view a, std::string_view b) {
  const auto lower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(),
      [&](char left, char right) { return lower(left) == lower(right); });
}

// Returns "" if `name` is a supported target, and else the name and the reason.
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

[[noreturn]] void ThrowBadTarget(Target target, std::string_view call) {
  dispatch::ThrowInvalid(call, "options.target", ExpectedNames(),
                         target.name().empty() ? "a bit that is no target"
                                               : WhyNot(target.name()));
}

// The target that HALFSPACE_TARGET names, or the best one.
Target ChosenFor(std::string_view call) {
  const Choice& choice = TheChoice();
  if (!choice.error.empty()) {
    dispatch::ThrowInvalid(call, "HALFSPACE_TARGET", ExpectedNames(),
                           WhyNot(choice.requested));
  }
  return choice.target;
}

}  // namespace

constinit std::array<std::atomic<std::uint8_t>, 65> resolved_indices{};
constinit std::atomic<bool> wide_vectors_pay{false};

std::size_t ResolveIndex(Target target, const char* call) {
  const Target runs = target == Target() ? ChosenFor(call) : target;
  if (!IsSupported(runs)) ThrowBadTarget(runs, call);
  wide_vectors_pay.store(DetectWideVectorsPay(), std::memory_order_relaxed);
  // Better targets have lower bits.
  const auto index = static_cast<std::uint8_t>(std::popcount(
      static_cast<std::uint64_t>(HWY_TARGETS & (runs.highway_bit() - 1))));
  const auto named = static_cast<std::uint64_t>(target.highway_bit());
  resolved_indices[static_cast<std::size_t>(std::countr_zero(named))].store(
      static_cast<std::uint8_t>(index + 1), std::memory_order_relaxed);
  return index;
}

}  // namespace dispatch

TargetName Target::name() const {
  if (*this == Target()) return TargetName("auto");
  if (!std::has_single_bit(static_cast<std::uint64_t>(highway_bit_))) {
    return TargetName("");
  }
  return TargetName(hwy::TargetName(highway_bit_));
}

std::size_t Target::lanes() const {
  if (!dispatch::IsSupported(*this)) return 0;
  std::size_t lanes = 0;
  kernels::ForEachCompiledTarget([this, &lanes](auto target) {
    if (highway_bit_ == target()) lanes = kernels::LanesOf<target()>();
  });
  return lanes;
}

std::size_t Target::one_query_lanes() const {
#if HWY_ARCH_X86
  if (!dispatch::DetectWideVectorsPay())
    return std::min<std::size_t>(lanes(), 8);
#endif
  return lanes();
}

Span<const Target> CompiledTargets() {
  static const dispatch::TargetList list(HWY_TARGETS);
  return list.span();
}

Span<const Target> SupportedTargets() {
  static const dispatch::TargetList list(dispatch::SupportedBits());
  return list.span();
}

Target ChosenTarget() { return dispatch::ChosenFor("ChosenTarget"); }

TargetChoice DescribeTargetChoice() {
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
  dispatch::ThrowInvalid("TargetByName", "name", dispatch::ExpectedNames(),
                         dispatch::WhyNot(name));
}

}  // namespace halfspace

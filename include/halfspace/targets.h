// Targets: the instruction sets for which the kernels were compiled.
//
// By default the library uses the best target that this machine supports. Set
// the environment variable HALFSPACE_TARGET to use another one for the whole
// process. Set the target in the options of a call to use another one there.
//
// Targets have the names of Highway: on x86 "AVX3" (AVX-512), "AVX2" and
// "SSE4"; on ARM "NEON", "SVE", "SVE2", "SVE_256" and "SVE2_128"; and one
// portable target, "SCALAR" or "EMU128". Some targets are no faster than the
// next lower one ("SSSE3", "AVX3_DL", and more in newer releases of Highway).
// They are compiled only with -DHALFSPACE_EXTRA_TARGETS=ON.
//
// The library chooses the target once, at the first call that needs it: the
// target that HALFSPACE_TARGET names at that time, or else the best compiled
// target that CPU and operating system support. If the name is unknown or the
// target is not supported here, every call that uses the chosen target fails
// with an error (error.h). The library never falls back to another target.
// Names are case-sensitive: "avx2" is unknown, and the error message suggests
// AVX2. With glibc, set-user-id programs ignore the variable.
//
// There is no function that sets the target of the process. One program can use
// all supported targets, because each call can name its own.
//
// The library detects support on x86 (with gcc and clang) and on aarch64 Linux.
// Elsewhere, the supported targets are the portable one and those that the
// compiler flags of the library allow.
//
// Thread safety: every function here may be called from any thread. Cost: the
// first call detects the CPU (microseconds, up to 0.1 ms in a virtual machine).
// Later calls are a load.
#ifndef HALFSPACE_TARGETS_H_
#define HALFSPACE_TARGETS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace {

// A handle of one target, a plain value. A default-constructed handle stands
// for the chosen target.
class Target {
 public:
  constexpr Target() = default;

  // Returns Highway's name, for example "AVX2", or "auto" for a default handle.
  HALFSPACE_API std::string_view name() const;

  // Returns the number of float lanes of one vector. On SVE the hardware
  // determines it. Returns 0 for a default handle and for a target that is not
  // supported here.
  HALFSPACE_API std::size_t lanes() const;

  // Returns Highway's bit (HWY_AVX2 and so on), or 0 for a default handle. The
  // meaning of a bit can change with the version of Highway. Do not store it:
  // store the name.
  constexpr std::int64_t highway_bit() const { return highway_bit_; }
  static constexpr Target FromHighwayBit(std::int64_t bit) {
    Target target;
    target.highway_bit_ = bit;
    return target;
  }

  friend constexpr bool operator==(Target a, Target b) {
    return a.highway_bit_ == b.highway_bit_;
  }
  friend constexpr bool operator!=(Target a, Target b) { return !(a == b); }

 private:
  std::int64_t highway_bit_ = 0;
};

// The chosen target and the reason.
struct TargetChoice {
  Target target;          // default handle if `error` is not empty
  std::string requested;  // the value of HALFSPACE_TARGET, or empty
  std::string error;      // empty, or why `requested` cannot be used
};

namespace detail {

// TargetChoice without std::string, whose layout depends on the caller's flags.
// The characters are never freed.
struct TargetChoiceView {
  Target target;
  std::string_view requested;
  std::string_view error;
};
HALFSPACE_API TargetChoiceView ViewTargetChoice();

}  // namespace detail

// Returns every target in this build, best first. The span is always valid.
HALFSPACE_API Span<const Target> CompiledTargets();

// Returns the compiled targets that this CPU and operating system support, best
// first. The span is always valid and never empty.
HALFSPACE_API Span<const Target> SupportedTargets();

// Returns the target of calls that name none. Throws (error.h) if
// HALFSPACE_TARGET cannot be used.
HALFSPACE_API Target ChosenTarget();

// As ChosenTarget(), but does not throw. Check TargetChoice::error.
inline TargetChoice DescribeTargetChoice() {
  const detail::TargetChoiceView choice = detail::ViewTargetChoice();
  return {choice.target, std::string(choice.requested),
          std::string(choice.error)};
}

// Returns the supported target with exactly this name, or std::nullopt if there
// is none.
HALFSPACE_API std::optional<Target> FindTarget(std::string_view name);

// As FindTarget(), but throws (error.h) if there is none. The message says
// whether the target is not in this build or not supported on this machine.
HALFSPACE_API Target TargetByName(std::string_view name);

}  // namespace halfspace

#endif  // HALFSPACE_TARGETS_H_

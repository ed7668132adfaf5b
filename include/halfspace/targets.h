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

#include <optional>
#include <string_view>

#include "halfspace/export.h"
#include "halfspace/span.h"
#include "halfspace/target.h"  // IWYU pragma: export

namespace halfspace {

// The name of a target. It is valid for as long as the program runs, and ends
// with a null character.
class TargetName : public std::string_view {
 public:
  constexpr explicit TargetName(std::string_view name)
      : std::string_view(name) {}
};

// The chosen target and the reason. The texts are valid for as long as the
// program runs, and end with a null character.
struct TargetChoice {
  Target target;               // default handle if `error` is not empty
  std::string_view requested;  // the value of HALFSPACE_TARGET, or empty
  std::string_view error;      // empty, or why `requested` cannot be used
};

// Returns every target in this build, best first. The span is always valid.
HALFSPACE_API Span<const Target> CompiledTargets();

// Returns the compiled targets that this CPU and operating system support, best
// first. The span is always valid and never empty.
HALFSPACE_API Span<const Target> SupportedTargets();

// Returns the target of calls that name none. Throws (error.h) if
// HALFSPACE_TARGET cannot be used.
HALFSPACE_API Target ChosenTarget();

// As ChosenTarget(), but does not throw. Check TargetChoice::error.
HALFSPACE_API TargetChoice DescribeTargetChoice();

// Returns the supported target with exactly this name, or std::nullopt if there
// is none.
HALFSPACE_API std::optional<Target> FindTarget(std::string_view name);

// As FindTarget(), but throws (error.h) if there is none. The message says
// whether the target is not in this build or not supported on this machine.
HALFSPACE_API Target TargetByName(std::string_view name);

}  // namespace halfspace

#endif  // HALFSPACE_TARGETS_H_

// Which instruction sets the kernels were compiled for, which of them this
// machine can run, and which one is used.
//
// Targets and their names are Highway's: on x86 "AVX3" (AVX-512), "AVX2" and
// "SSE4"; on ARM "NEON", "SVE", "SVE2", "SVE_256" and "SVE2_128"; and one plain
// fall-back, "SCALAR" or "EMU128". Targets that are no faster than the next one
// below them ("SSSE3", "AVX3_DL", and more in newer releases of Highway) are
// compiled only with -DHALFSPACE_EXTRA_TARGETS=ON.
//
// The choice is made once, at the first call that needs it: the best compiled
// target that CPU and operating system support. The environment variable
// HALFSPACE_TARGET, read at that moment (and, with glibc, ignored by
// set-user-id programs), names another one. A name that is unknown or not
// supported here is an error at the first call, never a silent fall-back. Case
// matters: "avx2" is unknown, and the error suggests AVX2. There is no global
// setter: a call may name another target in its options, and one program can
// use all supported targets.
//
// Support is detected on x86 (with gcc and clang) and on aarch64 Linux.
// Elsewhere the supported targets are the fall-back and those that the
// library's own compiler flags allow.
//
// Thread safety: every function here may be called from any thread. Cost: the
// first call detects the CPU (microseconds, up to 0.1 ms in a virtual machine);
// later ones are a load.
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

// A handle of one target: a plain value. A default-constructed handle means the
// chosen target.
class Target {
 public:
  constexpr Target() = default;

  // Highway's name, for example "AVX2"; "auto" for a default handle.
  HALFSPACE_API std::string_view name() const;

  // float32 lanes of one vector; on SVE the hardware says how many. 0 for a
  // default handle and for a target that is not supported here.
  HALFSPACE_API std::size_t lanes() const;

  // Highway's bit (HWY_AVX2 and so on); 0 for a default handle. Its meaning
  // may change with the version of Highway: do not store it, store the name.
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

// Which target was chosen, and why.
struct TargetChoice {
  Target target;          // default handle when `error` is not empty
  std::string requested;  // the value of HALFSPACE_TARGET, or empty
  std::string error;      // empty, or why `requested` cannot be honoured
};

namespace detail {

// The same without std::string, whose layout depends on the caller's flags. Its
// strings are never destroyed.
struct TargetChoiceView {
  Target target;
  std::string_view requested;
  std::string_view error;
};
HALFSPACE_API TargetChoiceView ViewTargetChoice();

}  // namespace detail

// Every target in this build, best first. The span stays valid.
HALFSPACE_API Span<const Target> CompiledTargets();

// Those of CompiledTargets() that this CPU and system run, best first. The span
// stays valid and is never empty.
HALFSPACE_API Span<const Target> SupportedTargets();

// The target that calls without an explicit one use. Throws (error.h)
// std::invalid_argument if HALFSPACE_TARGET cannot be honoured.
HALFSPACE_API Target ChosenTarget();

// The same without throwing: check `error`.
inline TargetChoice DescribeTargetChoice() {
  const detail::TargetChoiceView choice = detail::ViewTargetChoice();
  return {choice.target, std::string(choice.requested),
          std::string(choice.error)};
}

// The supported target of that exact name; nothing if there is none.
HALFSPACE_API std::optional<Target> FindTarget(std::string_view name);

// The same, but throws (error.h), saying whether this build does
// not have the name or this machine does not support it.
HALFSPACE_API Target TargetByName(std::string_view name);

}  // namespace halfspace

#endif  // HALFSPACE_TARGETS_H_

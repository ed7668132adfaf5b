// Round to nearest, with subnormals and without traps, for the life of an
// object of this class.
//
// A program that was linked with fast-math anywhere flushes subnormals in all
// of its threads, and a bound that lost a subnormal might not enclose its
// shape. A program that traps invalid operations would end at the first NaN.
// Reading the mode costs a few cycles. It is written only if it differs.
//
// Exception flags that a builder raises may stay raised. (They are bits of the
// same register on x86, and of another register on ARM.) No flag is cleared.
#ifndef HALFSPACE_DISPATCH_DEFAULT_FP_MODE_H_
#define HALFSPACE_DISPATCH_DEFAULT_FP_MODE_H_

#include <cstddef>
#include <cstdint>

#include "kernels/compiler.h"

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#elif defined(_M_ARM64) && !defined(__clang__)
#include <intrin.h>
#elif !defined(__aarch64__)
#include <cfenv>
#endif

namespace halfspace::dispatch {

class DefaultFpMode {
 public:
  DefaultFpMode() : saved_(Read()) { Enter(); }
  ~DefaultFpMode() { Exit(); }
  DefaultFpMode(const DefaultFpMode&) = delete;
  DefaultFpMode& operator=(const DefaultFpMode&) = delete;

  // Calls function() in the mode that the thread had. If function() changes the
  // mode, the thread keeps the new one.
  template <typename Function>
  auto Outside(const Function& function) {
    Exit();
    const auto result = function();
    saved_ = Read();
    Enter();
    return result;
  }

 private:
#if defined(__SSE2__) || defined(_M_X64)
  using Register = unsigned;
  // MXCSR: flush to zero, rounding control, masked traps, denormals are zero.
  static constexpr Register kMode = 0x8000 | 0x6000 | 0x1f80 | 0x0040;
  static constexpr Register kDefault = 0x1f80;
  static Register Read() { return _mm_getcsr(); }
  static void Write(Register value) { _mm_setcsr(value); }
#elif defined(__aarch64__) || defined(_M_ARM64)
  using Register = std::uint64_t;
  // FPCR: flush to zero, rounding mode, traps (few machines have any), flush
  // inputs to zero.
  static constexpr Register kMode = 0x0100'0000 | 0x00c0'0000 | 0x9f00 | 1;
  static constexpr Register kDefault = 0;
#if defined(_M_ARM64) && !defined(__clang__)
  static constexpr int kFpcr = 0x5a20;  // op0 3, op1 3, CRn 4, CRm 4, op2 0
  static Register Read() { return _ReadStatusReg(kFpcr); }
  static void Write(Register value) { _WriteStatusReg(kFpcr, value); }
#else
  static Register Read() {
    Register value;
    asm volatile("mrs %0, fpcr" : "=r"(value) : : "memory");
    return value;
  }
  static void Write(Register value) {
    asm volatile("msr fpcr, %0" : : "r"(value) : "memory");
  }
#endif
#else
  // Elsewhere the rounding mode alone.
  using Register = int;
  static constexpr Register kMode = ~0;
  static constexpr Register kDefault = FE_TONEAREST;
  static Register Read() { return std::fegetround(); }
  static void Write(Register value) { std::fesetround(value); }
#endif

  void Enter() {
    if (!IsDefault()) Write((saved_ & ~kMode) | kDefault);
  }
  void Exit() const {
    if (!IsDefault()) Write(saved_);
  }
  bool IsDefault() const { return (saved_ & kMode) == kDefault; }

  Register saved_;
};

// Calls function() in a function that is not inlined, so the compiler cannot
// move its arithmetic out.
template <typename Function>
HALFSPACE_NOINLINE auto CallApart(const Function& function) {
  return function();
}

// Calls function() in the default mode. All code that reads a float belongs in
// it, because the compiler may move arithmetic across a change of mode, and
// even a compare can trap.
template <typename Function>
auto InDefaultFpMode(const Function& function) {
  const DefaultFpMode mode;
  return CallApart(function);
}

// Calls run(count, part) of a Runner, with each part in the default mode,
// because other threads have their own modes.
template <typename Run, typename Part>
void RunInDefaultFpMode(const Run& run, std::size_t count, const Part& part) {
  run(count, [&](std::size_t i) { InDefaultFpMode([&] { return part(i); }); });
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_DEFAULT_FP_MODE_H_

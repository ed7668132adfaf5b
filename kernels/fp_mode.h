// The floating-point mode of a thread: how it rounds, whether it flushes
// subnormals, and what traps.
//
// An object of FpMode rounds as its type says, with subnormals and without
// traps, for its life. (On machines other than x86 and ARM of 64 bits it sets
// the rounding alone.) Reading the mode costs a few cycles. It is written only
// if it differs. The compiler may move arithmetic across a change of mode, so
// all of it belongs in a function that is not inlined.
//
// Exception flags that were raised before stay raised. Those that are raised
// meanwhile may stay or not: they are bits of the same register on x86, and of
// another register on ARM.
#ifndef HALFSPACE_KERNELS_FP_MODE_H_
#define HALFSPACE_KERNELS_FP_MODE_H_

#include <cstdint>

// WebAssembly with emulated SSE2 has no register of modes.
#if (defined(__SSE2__) || defined(_M_X64)) && !defined(__wasm__)
#define HALFSPACE_HAS_MXCSR 1
#include <xmmintrin.h>
#elif defined(_M_ARM64) && !defined(__clang__)
#include <intrin.h>
#elif !defined(__aarch64__)
#include <cfenv>
#endif

namespace halfspace::kernels {

enum class Rounding { kToNearest, kUpward };

// WebAssembly rounds to nearest alone.
#if defined(__wasm__) || (defined(FE_TONEAREST) && !defined(FE_UPWARD))
inline constexpr bool kRoundsUpward = false;
#else
inline constexpr bool kRoundsUpward = true;
#endif

template <Rounding kRounding>
class FpMode {
 public:
  FpMode() : saved_(Read()) { Enter(); }
  ~FpMode() { Exit(); }
  FpMode(const FpMode&) = delete;
  FpMode& operator=(const FpMode&) = delete;

  // Calls function() in the mode that the thread had. If function() changes the
  // mode, the thread keeps the new one, also if function() throws.
  template <typename Function>
  auto Outside(const Function& function) {
    Exit();
    const Reentry reentry{*this};
    return function();
  }

 private:
#if defined(HALFSPACE_HAS_MXCSR)
  using Register = unsigned;
  // MXCSR: flush to zero, rounding control, masked traps, denormals are zero.
  static constexpr Register kMode = 0x8000 | 0x6000 | 0x1f80 | 0x0040;
  static constexpr Register kDuring =
      0x1f80 | (kRounding == Rounding::kUpward ? 0x4000 : 0);
  static Register Read() { return _mm_getcsr(); }
  static void Write(Register value) { _mm_setcsr(value); }
#elif defined(__aarch64__) || defined(_M_ARM64)
  using Register = std::uint64_t;
  // FPCR: flush to zero, rounding mode, traps (few machines have any), flush
  // inputs to zero.
  static constexpr Register kMode = 0x0100'0000 | 0x00c0'0000 | 0x9f00 | 1;
  static constexpr Register kDuring =
      kRounding == Rounding::kUpward ? 0x0040'0000 : 0;
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
#if defined(FE_UPWARD)
  static constexpr Register kDuring =
      kRounding == Rounding::kUpward ? FE_UPWARD : FE_TONEAREST;
#else
  static constexpr Register kDuring = FE_TONEAREST;
#endif
  static Register Read() { return std::fegetround(); }
  static void Write(Register value) { std::fesetround(value); }
#endif

  struct Reentry {
    FpMode& mode;
    ~Reentry() {
      mode.saved_ = Read();
      mode.Enter();
    }
  };

  void Enter() {
    if (!IsOn()) Write((saved_ & ~kMode) | kDuring);
  }
  void Exit() const {
    if (!IsOn()) Write(saved_);
  }
  bool IsOn() const { return (saved_ & kMode) == kDuring; }

  Register saved_;
};

}  // namespace halfspace::kernels

#undef HALFSPACE_HAS_MXCSR

#endif  // HALFSPACE_KERNELS_FP_MODE_H_

// Runs a scope, or a call, in another floating-point mode of the thread.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_FP_MODES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_FP_MODES_H_

#include <gtest/gtest.h>

#include <cfenv>
#include <cstdint>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace halfspace::testing {

namespace internal {

// The register of the modes: which bits flush subnormals, and which of them are
// set or not so that every exception of <cfenv>, and a subnormal operand, is a
// SIGFPE. (Those that say what was raised are not.)
#if defined(__SSE2__)
using FpBits = unsigned;
inline FpBits ReadFpBits() { return _mm_getcsr(); }
inline void WriteFpBits(FpBits bits) { _mm_setcsr(bits); }
inline constexpr FpBits kFlush = 0x8040;
inline constexpr FpBits kTrap = 0;
inline constexpr FpBits kNoTrap = 0x1fbf;
#elif defined(__aarch64__)
using FpBits = std::uint64_t;
inline FpBits ReadFpBits() {
  FpBits bits;
  asm volatile("mrs %0, fpcr" : "=r"(bits));
  return bits;
}
inline void WriteFpBits(FpBits bits) {
  asm volatile("msr fpcr, %0" : : "r"(bits) : "memory");
}
inline constexpr FpBits kFlush = FpBits{1} << 24;
inline constexpr FpBits kTrap = 0x9f00;
inline constexpr FpBits kNoTrap = 0;
#else
using FpBits = unsigned;
inline FpBits ReadFpBits() { return 0; }
inline void WriteFpBits(FpBits) {}
inline constexpr FpBits kFlush = 0;
inline constexpr FpBits kTrap = 0;
inline constexpr FpBits kNoTrap = 0;
#endif

class FpScope {
 public:
  explicit FpScope(FpBits set, FpBits clear = 0) {
    WriteFpBits((saved_ | set) & ~clear);
    given_ = ReadFpBits();
  }
  FpScope(const FpScope&) = delete;
  FpScope& operator=(const FpScope&) = delete;
  ~FpScope() { WriteFpBits(saved_); }

  // Of the bits, as many as the machine has are as they were set.
  bool IsUntouched() const { return ReadFpBits() == given_; }

 private:
  FpBits saved_ = ReadFpBits();
  FpBits given_ = 0;
};

}  // namespace internal

// Subnormal floats are flushed to zero, as inputs and as results. Programs can
// run so without asking: a library that was linked with fast-math switches it
// on for the whole process.
class FlushDenormals : public internal::FpScope {
 public:
  static constexpr bool kAvailable = internal::kFlush != 0;
  FlushDenormals() : FpScope(internal::kFlush) {}

  // By what it does: half of the smallest normal is subnormal.
  static bool IsOn() {
    volatile float smallest_normal = 0x1p-126f;
    volatile float half = smallest_normal * 0.5f;
    return half == 0.f;
  }
};

// Results are rounded as one of <cfenv>'s modes says.
class RoundingMode {
 public:
  explicit RoundingMode(int mode) { std::fesetround(mode); }
  ~RoundingMode() { std::fesetround(saved_); }
  RoundingMode(const RoundingMode&) = delete;
  RoundingMode& operator=(const RoundingMode&) = delete;

 private:
  int saved_ = std::fegetround();
};

// The floating-point mode of a caller.
enum class FpMode { kDefault, kFlushes, kUpward, kDownward, kToZero, kTraps };
inline constexpr FpMode kFpModes[] = {FpMode::kDefault, FpMode::kFlushes,
                                      FpMode::kUpward,  FpMode::kDownward,
                                      FpMode::kToZero,  FpMode::kTraps};

// Expects that the call leaves the mode as it was. (valgrind has no flushing
// and no traps.)
template <typename Call>
void RunIn(FpMode mode, const Call& call) {
  bool is_left = false;
  if (mode == FpMode::kTraps) {
    const internal::FpScope traps(internal::kTrap, internal::kNoTrap);
    call();
    is_left = traps.IsUntouched();
  } else if (mode == FpMode::kFlushes) {
    const FlushDenormals flush;
    const bool was_on = FlushDenormals::IsOn();
    call();
    is_left = FlushDenormals::IsOn() == was_on;
  } else {
    int rounding = FE_TONEAREST;
#if defined(FE_UPWARD)  // not in WebAssembly
    if (mode == FpMode::kUpward) rounding = FE_UPWARD;
    if (mode == FpMode::kDownward) rounding = FE_DOWNWARD;
    if (mode == FpMode::kToZero) rounding = FE_TOWARDZERO;
#endif
    const RoundingMode scope(rounding);
    const int given = std::fegetround();
    call();
    is_left = std::fegetround() == given;
  }
  EXPECT_TRUE(is_left) << "the call changed mode " << static_cast<int>(mode);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_FP_MODES_H_

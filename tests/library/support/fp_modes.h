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

// Subnormal floats are flushed to zero, as inputs and as results. Programs can
// run so without asking: a library that was linked with fast-math switches it
// on for the whole process.
class FlushDenormals {
 public:
  // By what it does: half of the smallest normal is subnormal.
  static bool IsOn() {
    volatile float smallest_normal = 0x1p-126f;
    volatile float half = smallest_normal * 0.5f;
    return half == 0.f;
  }

#if defined(__SSE2__)
  static constexpr bool kAvailable = true;
  FlushDenormals() { _mm_setcsr(saved_ | kFlushResults | kFlushInputs); }
  ~FlushDenormals() { _mm_setcsr(saved_); }

 private:
  static constexpr unsigned kFlushResults = 0x8000;
  static constexpr unsigned kFlushInputs = 0x0040;
  unsigned saved_ = _mm_getcsr();
#elif defined(__aarch64__)
  static constexpr bool kAvailable = true;
  FlushDenormals() {
    asm volatile("mrs %0, fpcr" : "=r"(saved_));
    const std::uint64_t flushing = saved_ | kFlush;
    asm volatile("msr fpcr, %0" : : "r"(flushing) : "memory");
  }
  ~FlushDenormals() { asm volatile("msr fpcr, %0" : : "r"(saved_) : "memory"); }

 private:
  static constexpr std::uint64_t kFlush = std::uint64_t{1} << 24;
  std::uint64_t saved_ = 0;
#else
  static constexpr bool kAvailable = false;
  FlushDenormals() = default;
#endif

 public:
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
};

// Every exception of <cfenv>, and a subnormal operand, is a SIGFPE; none has
// been raised yet.
class TrapExceptions {
 public:
#if defined(__SSE2__)
  TrapExceptions() { _mm_setcsr(saved_ & ~(kMasks | kRaised)); }
  ~TrapExceptions() { _mm_setcsr(saved_); }

  // On, and nothing raised.
  static bool IsUntouched() { return (_mm_getcsr() & (kMasks | kRaised)) == 0; }

 private:
  static constexpr unsigned kMasks = 0x1f80;
  static constexpr unsigned kRaised = 0x003f;
  unsigned saved_ = _mm_getcsr();
#elif defined(__aarch64__)
  TrapExceptions() {
    asm volatile("mrs %0, fpcr" : "=r"(saved_));
    asm volatile("msr fpcr, %0" : : "r"(saved_ | kTraps) : "memory");
    asm volatile("mrs %0, fpcr" : "=r"(given_));
  }
  ~TrapExceptions() { asm volatile("msr fpcr, %0" : : "r"(saved_) : "memory"); }

  // As many as the machine has are on.
  bool IsUntouched() const {
    std::uint64_t now;
    asm volatile("mrs %0, fpcr" : "=r"(now));
    return now == given_;
  }

 private:
  static constexpr std::uint64_t kTraps = 0x9f00;
  std::uint64_t saved_ = 0;
  std::uint64_t given_ = 0;
#else
  TrapExceptions() = default;
  static bool IsUntouched() { return true; }
#endif

 public:
  TrapExceptions(const TrapExceptions&) = delete;
  TrapExceptions& operator=(const TrapExceptions&) = delete;
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
    const TrapExceptions traps;
    const bool was_untouched = traps.IsUntouched();
    call();
    is_left = traps.IsUntouched() == was_untouched;
  } else if (mode == FpMode::kFlushes) {
    const FlushDenormals flush;
    const bool was_on = FlushDenormals::IsOn();
    call();
    is_left = FlushDenormals::IsOn() == was_on;
  } else {
    const int rounding = mode == FpMode::kUpward     ? FE_UPWARD
                         : mode == FpMode::kDownward ? FE_DOWNWARD
                         : mode == FpMode::kToZero   ? FE_TOWARDZERO
                                                     : FE_TONEAREST;
    const RoundingMode scope(rounding);
    call();
    is_left = std::fegetround() == rounding;
  }
  EXPECT_TRUE(is_left) << "the call changed mode " << static_cast<int>(mode);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_FP_MODES_H_

// Round to nearest, with subnormals, for the life of an object of this class.
//
// A program that was linked with fast-math anywhere flushes subnormals in all
// of its threads, and a bound that lost one would not enclose its shape.
// Reading the mode costs a few cycles; it is written only if it differs.
//
// The compiler may move arithmetic across a change of mode, so the arithmetic
// belongs in a HALFSPACE_NOINLINE function.
#ifndef HALFSPACE_KERNELS_DEFAULT_FP_MODE_H_
#define HALFSPACE_KERNELS_DEFAULT_FP_MODE_H_

#include <cstdint>

#if defined(_MSC_VER)
#define HALFSPACE_NOINLINE __declspec(noinline)
#else
#define HALFSPACE_NOINLINE __attribute__((noinline))
#endif

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#endif

namespace halfspace::kernels {

class DefaultFpMode {
 public:
  DefaultFpMode() : saved_(Read()) {
    if ((saved_ & kDeviations) != 0) Write(saved_ & ~kDeviations);
  }
  ~DefaultFpMode() {
    if ((saved_ & kDeviations) != 0) Write(saved_);
  }
  DefaultFpMode(const DefaultFpMode&) = delete;
  DefaultFpMode& operator=(const DefaultFpMode&) = delete;

 private:
#if defined(__SSE2__) || defined(_M_X64)
  using Register = unsigned;
  // MXCSR: flush to zero, rounding control, denormals are zero.
  static constexpr Register kDeviations = 0x8000 | 0x6000 | 0x0040;
  static Register Read() { return _mm_getcsr(); }
  static void Write(Register value) { _mm_setcsr(value); }
#elif defined(__aarch64__) && defined(__GNUC__)
  using Register = std::uint64_t;
  // FPCR: flush to zero, rounding mode, flush inputs to zero.
  static constexpr Register kDeviations =
      (std::uint64_t{1} << 24) | (std::uint64_t{3} << 22) | 1;
  static Register Read() {
    Register value;
    asm volatile("mrs %0, fpcr" : "=r"(value) : : "memory");
    return value;
  }
  static void Write(Register value) {
    asm volatile("msr fpcr, %0" : : "r"(value) : "memory");
  }
#else
  using Register = unsigned;
  static constexpr Register kDeviations = 0;
  static Register Read() { return 0; }
  static void Write(Register /*value*/) {}
#endif

  const Register saved_;
};

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_DEFAULT_FP_MODE_H_

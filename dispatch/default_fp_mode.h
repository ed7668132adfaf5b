// Work in the default floating-point mode, which fp_mode.h describes.
//
// A program that was linked with fast-math anywhere flushes subnormals in all
// of its threads, and a bound that lost a subnormal might not enclose its
// shape. A program that traps invalid operations would end at the first NaN.
#ifndef HALFSPACE_DISPATCH_DEFAULT_FP_MODE_H_
#define HALFSPACE_DISPATCH_DEFAULT_FP_MODE_H_

#include <cstddef>

#include "kernels/compiler.h"
#include "kernels/fp_mode.h"

namespace halfspace::dispatch {

using DefaultFpMode = kernels::FpMode<kernels::Rounding::kToNearest>;

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

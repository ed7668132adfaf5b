// Finds what a per-target translation unit left behind.
#ifndef HALFSPACE_BENCH_INNER_TARGET_FUNCTION_H_
#define HALFSPACE_BENCH_INNER_TARGET_FUNCTION_H_

#include <cstdint>

#include "halfspace/targets.h"
#include "kernels/compiled_targets.h"

namespace halfspace::bench {

// get(TargetConstant<target>()) of the given target, a function pointer or a
// few; null if it is not compiled.
template <typename Function, typename Get>
Function FunctionOf(Target wanted, const Get& get) {
  Function found{};
  kernels::ForEachCompiledTarget([&](auto target) {
    if (wanted.highway_bit() == target()) found = get(target);
  });
  return found;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INNER_TARGET_FUNCTION_H_

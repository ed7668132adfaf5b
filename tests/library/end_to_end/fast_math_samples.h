// Samples for a caller that is compiled with -ffast-math, made and judged by
// code that is not. Plain functions: nothing inline with arithmetic in it may
// be shared between the two, since the linker keeps only one of each.
#ifndef HALFSPACE_TESTS_LIBRARY_END_TO_END_FAST_MATH_SAMPLES_H_
#define HALFSPACE_TESTS_LIBRARY_END_TO_END_FAST_MATH_SAMPLES_H_

#include <cstddef>

#include "tests/library/fit/every_builder.h"

namespace halfspace::testing {

// How many samples there are.
std::size_t FastMathSamples();

template <int kDims>
const EveryShape<kDims>& FastMathSample(std::size_t i);
template <>
const EveryShape<2>& FastMathSample<2>(std::size_t i);
template <>
const EveryShape<3>& FastMathSample<3>(std::size_t i);
template <>
const EveryShape<4>& FastMathSample<4>(std::size_t i);

// The bits of every bound of sample i, for a caller compiled as usual.
template <int kDims>
Bits ExpectedBits(std::size_t i);
template <>
Bits ExpectedBits<2>(std::size_t i);
template <>
Bits ExpectedBits<3>(std::size_t i);
template <>
Bits ExpectedBits<4>(std::size_t i);

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_END_TO_END_FAST_MATH_SAMPLES_H_

#include "tests/library/end_to_end/fast_math_samples.h"

#include <vector>

#include "tests/library/fit/random_every_shape.h"
#include "tests/library/support/environment.h"

#if defined(__FAST_MATH__)
#error "compile this file without -ffast-math"
#endif

namespace halfspace::testing {
namespace {

template <int kDims>
const std::vector<EveryShape<kDims>>& Samples() {
  static const auto samples = [] {
    std::vector<EveryShape<kDims>> all;
    Random random(90);
    for (PointKind kind : kPointKinds) {
      for (std::size_t i = 0; i < Scaled(30); ++i) {
        all.push_back(RandomEveryShape<kDims>(kind, random));
      }
    }
    return all;
  }();
  return samples;
}

template <int kDims>
Bits BitsOfSample(std::size_t i) {
  return BitsOfEveryBound(Samples<kDims>()[i], TargetsUnderTest());
}

}  // namespace

std::size_t FastMathSamples() { return Samples<3>().size(); }

template <>
const EveryShape<3>& FastMathSample<3>(std::size_t i) {
  return Samples<3>()[i];
}
template <>
Bits ExpectedBits<3>(std::size_t i) {
  return BitsOfSample<3>(i);
}

#if !defined(HALFSPACE_TEST_ONLY_3D)
template <>
const EveryShape<2>& FastMathSample<2>(std::size_t i) {
  return Samples<2>()[i];
}
template <>
const EveryShape<4>& FastMathSample<4>(std::size_t i) {
  return Samples<4>()[i];
}

template <>
Bits ExpectedBits<2>(std::size_t i) {
  return BitsOfSample<2>(i);
}
template <>
Bits ExpectedBits<4>(std::size_t i) {
  return BitsOfSample<4>(i);
}
#endif

}  // namespace halfspace::testing

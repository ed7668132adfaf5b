#include "bench/measure/plane_words.h"

#include "bench/base/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/measure/plane_words.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what it is compiled for.
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

template <size_t... kPlane>
HWY_INLINE void FillWord(std::index_sequence<kPlane...>,
                         const float* const* planes, const float* query,
                         size_t i, bench::PlaneWords& out) {
  const WordTag<float> d;
  constexpr size_t kMinima = sizeof...(kPlane) / 2;
  ((out[kPlane] = ~KeptBits<(kPlane < kMinima ? 1 : 0)>(
        d, LoadAll(), planes + kPlane, i,
        hn::Set(d, query[(kPlane + kMinima) % sizeof...(kPlane)]))),
   ...);
}

void FillPlaneWords(const float* const* planes, const float* query,
                    size_t words, bench::PlaneWords* out) {
  constexpr std::make_index_sequence<bench::kPlaneWordsPlanes> kPlanes{};
  for (size_t w = 0; w < words; ++w) {
    FillWord(kPlanes, planes, query, w * kWordObjects, out[w]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

namespace halfspace::bench {

template <std::int64_t kTarget>
PlaneWordsFunction PlaneWordsOf();

template <>
PlaneWordsFunction PlaneWordsOf<HWY_TARGET>() {
  return &HWY_NAMESPACE::FillPlaneWords;
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {

PlaneWordsFunction PlaneWordsFor(Target target) {
  return FunctionOf<PlaneWordsFunction>(
      target, [](auto t) { return PlaneWordsOf<t()>(); });
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE

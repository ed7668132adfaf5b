#include "bench/plane_words.h"

#include "bench/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/plane_words.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what it is compiled for.
#include "kernels/reject-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

using Shape = kernels::AaboFlat<3>;

template <size_t... kPlane, class D, class... V>
HWY_INLINE void FillWords(std::index_sequence<kPlane...>, D d,
                          const float* const* planes, size_t words,
                          bench::PlaneWords* out, V... query) {
  for (size_t w = 0; w < words; ++w) {
    ((out[w][kernels::kObjectIndex<Shape, kPlane>] =
          BitsRejected<Shape, kWordObjects, kPlane, kPlane + 1>(
              d, LoadAll(), planes, w * kWordObjects, query...)),
     ...);
  }
}

template <size_t... kPlane>
void FillWords(std::index_sequence<kPlane...> all_planes,
               const float* const* planes, const float* query, size_t words,
               bench::PlaneWords* out) {
  const WordTag<float> d;
  FillWords(all_planes, d, planes, words, out,
            hn::Set(d, query[kernels::kQueryIndex<Shape, kPlane>])...);
}

void FillPlaneWords(const float* const* planes, const float* query,
                    size_t words, bench::PlaneWords* out) {
  FillWords(std::make_index_sequence<bench::kPlaneWordsPlanes>(), planes, query,
            words, out);
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

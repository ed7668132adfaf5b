// The test of 64 objects as an inline function, for loops of your own: compiled
// for each target by Highway's foreach_target.h, as Highway's users know it.
//
//   #undef HWY_TARGET_INCLUDE
//   #define HWY_TARGET_INCLUDE "nodes.cc"  // this file
//   #include "hwy/foreach_target.h"
//   #include "halfspace/kernels-inl.h"     // after foreach_target.h
//
//   HWY_BEFORE_NAMESPACE();
//   namespace nodes::HWY_NAMESPACE {
//   std::uint64_t Test(const float* const* planes, const float* query) {
//     namespace hs = halfspace::HWY_NAMESPACE;
//     return hs::SurvivorsOf64Boxes<3>(planes, 0, query);
//   }
//   }
//   HWY_AFTER_NAMESPACE();
//
// The program needs Highway's headers, and for HWY_DYNAMIC_DISPATCH its
// library. Highway runs SSE4 and AVX2 only on CPUs with AES and PCLMULQDQ,
// unless both are compiled with HWY_DISABLE_PCLMUL_AES. docs/kernels.md has a
// whole program.
//
//   SurvivorsOf64Boxes<d>(planes, i, query)      objects i ... i + 63
//   SurvivorsOfFewBoxes<d>(planes, i, n, query)  objects i ... i + n - 1,
//                                                1 <= n <= 63
//   SurvivorsOf64Simplices, SurvivorsOfFewSimplices,
//   SurvivorsOf64Octahedra, SurvivorsOfFewOctahedra
//
// `planes` and `query` are those of kernels.h: of floats, and for boxes also of
// doubles. The result has bit l if object i + l survives. Bits past the last
// object are 0, and nothing past it is read. There are no errors, and no
// checks. In a loop the compiler keeps the query's values in registers. Compile
// without -ffast-math, which may remove the test of NaN. Flat scans test words
// of 64 by the same code. There is no word for half-spaces: they must first be
// made into tests, which takes as long as the test of 100 boxes by six of them.
// kernels.h does both.
#if defined(HALFSPACE_KERNELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_INL_H_
#undef HALFSPACE_KERNELS_INL_H_
#else
#define HALFSPACE_KERNELS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <utility>

#include "halfspace/detail/word-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

template <size_t kMins, size_t kMaxs, typename T, size_t... kPlane>
HWY_INLINE uint64_t SurvivorsOf64(std::index_sequence<kPlane...>,
                                  const T* const* planes, size_t i,
                                  const T* query) {
  const WordTag<T> d;
  const auto values = ValuesOf<kMins, kMaxs>(query);
  return KeptBits<kMins>(d, LoadAll(), planes, i,
                         hn::Set(d, values.template Of<kMins>(kPlane))...);
}
template <size_t kMins, size_t kMaxs, typename T, size_t... kPlane>
HWY_INLINE uint64_t SurvivorsOfFew(std::index_sequence<kPlane...>,
                                   const T* const* planes, size_t i, size_t n,
                                   const T* query) {
  const WordTag<T> d;
  const auto values = ValuesOf<kMins, kMaxs>(query);
  return KeptTail<kMins, false>(
      d, planes, i, i + n, hn::Set(d, values.template Of<kMins>(kPlane))...);
}

template <int kDims, typename T>
HWY_INLINE uint64_t SurvivorsOf64Boxes(const T* const* planes, size_t i,
                                       const T* query) {
  return SurvivorsOf64<kDims, kDims>(std::make_index_sequence<2 * kDims>(),
                                     planes, i, query);
}
template <int kDims, typename T>
HWY_INLINE uint64_t SurvivorsOfFewBoxes(const T* const* planes, size_t i,
                                        size_t n, const T* query) {
  return SurvivorsOfFew<kDims, kDims>(std::make_index_sequence<2 * kDims>(),
                                      planes, i, n, query);
}

template <int kDims, typename T>
HWY_INLINE uint64_t SurvivorsOf64Simplices(const T* const* planes, size_t i,
                                           const T* query) {
  return SurvivorsOf64<kDims + 1, 0>(std::make_index_sequence<kDims + 1>(),
                                     planes, i, query);
}
template <int kDims, typename T>
HWY_INLINE uint64_t SurvivorsOfFewSimplices(const T* const* planes, size_t i,
                                            size_t n, const T* query) {
  return SurvivorsOfFew<kDims + 1, 0>(std::make_index_sequence<kDims + 1>(),
                                      planes, i, n, query);
}

template <int kDims, typename T>
HWY_INLINE uint64_t SurvivorsOf64Octahedra(const T* const* planes, size_t i,
                                           const T* query) {
  return SurvivorsOf64<kDims + 1, kDims + 1>(
      std::make_index_sequence<2 * (kDims + 1)>(), planes, i, query);
}
template <int kDims, typename T>
HWY_INLINE uint64_t SurvivorsOfFewOctahedra(const T* const* planes, size_t i,
                                            size_t n, const T* query) {
  return SurvivorsOfFew<kDims + 1, kDims + 1>(
      std::make_index_sequence<2 * (kDims + 1)>(), planes, i, n, query);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_INL_H_

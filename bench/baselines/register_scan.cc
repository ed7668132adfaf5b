#include "bench/baselines/register_scan.h"

#include <utility>

#include "bench/base/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/baselines/register_scan.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what it is compiled for.
#include "kernels/scan/words-inl.h"

// What asm calls the registers of a vector; not defined where there is none.
#undef HALFSPACE_VECTOR_REGISTER
#if defined(__GNUC__)
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
#define HALFSPACE_VECTOR_REGISTER "+v"
#elif HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
#define HALFSPACE_VECTOR_REGISTER "+x"
#elif HWY_ARCH_ARM_A64 && HWY_TARGET == HWY_NEON
#define HALFSPACE_VECTOR_REGISTER "+w"
#endif
#endif

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#ifdef HALFSPACE_VECTOR_REGISTER

// Brings one register again and again; the compiler must take its value for a
// new one each time, and no instruction is spent on it.
template <class V>
struct SameRegister {
  V& vector;

  template <class D, typename T>
  HWY_INLINE V operator()(D /*d*/, const T* /*from*/) const {
    asm("" : HALFSPACE_VECTOR_REGISTER(vector.raw));
    return vector;
  }
};

template <size_t kMins, size_t kMaxs, class D, size_t... kPlane>
void ScanRegistersAs(std::index_sequence<kPlane...>, D d,
                     const float* const* planes, const float* query,
                     size_t size, uint64_t* mask) {
  auto vector = hn::Zero(d);
  const SameRegister<decltype(vector)> load{vector};
  for (size_t w = 0; w < size / kWordObjects; ++w) {
    mask[w] = KeptBits<kMins>(
        d, load, planes, w * kWordObjects,
        hn::Set(d, query[kPlane < kMins ? kMaxs + kPlane : kPlane - kMins])...);
  }
}

template <size_t kMins, size_t kMaxs, class D>
void ScanRegistersAs(D d, const float* const* planes, const float* query,
                     size_t size, uint64_t* mask) {
  ScanRegistersAs<kMins, kMaxs>(std::make_index_sequence<kMins + kMaxs>(), d,
                                planes, query, size, mask);
}

template <class D>
void ScanRegisters(bench::ShapeKind shape, const float* const* planes,
                   const float* query, size_t size, uint64_t* mask) {
  const D d;
  switch (shape) {
    case bench::ShapeKind::kSimplex:
      return ScanRegistersAs<4, 0>(d, planes, query, size, mask);
    case bench::ShapeKind::kAabb:
      return ScanRegistersAs<3, 3>(d, planes, query, size, mask);
    case bench::ShapeKind::kAabo:
      return ScanRegistersAs<4, 4>(d, planes, query, size, mask);
  }
}

inline constexpr bench::RegisterScans kRegisterScans = {
    &ScanRegisters<OneTag<float>>, &ScanRegisters<WordTag<float>>};

#else  // HALFSPACE_VECTOR_REGISTER

inline constexpr bench::RegisterScans kRegisterScans = {};

#endif  // HALFSPACE_VECTOR_REGISTER

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

namespace halfspace::bench {

template <std::int64_t kTarget>
RegisterScans RegisterScansOf();

template <>
RegisterScans RegisterScansOf<HWY_TARGET>() {
  return HWY_NAMESPACE::kRegisterScans;
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {

RegisterScans RegisterScansFor(Target target) {
  return FunctionOf<RegisterScans>(
      target, [](auto t) { return RegisterScansOf<t()>(); });
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE

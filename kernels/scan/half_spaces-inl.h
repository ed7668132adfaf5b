// The kernels of flat scans for half-spaces. They read a list of planes, so the
// same kernels serve all worlds of floats.
#if defined(HALFSPACE_KERNELS_SCAN_HALF_SPACES_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SCAN_HALF_SPACES_INL_H_
#undef HALFSPACE_KERNELS_SCAN_HALF_SPACES_INL_H_
#else
#define HALFSPACE_KERNELS_SCAN_HALF_SPACES_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/bvh/half_space-inl.h"
#include "kernels/scan/half_spaces.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Tests one vector of objects against all half-spaces. The test ends when all
// objects are behind one half-space.
template <class D, class Load>
HWY_INLINE uint64_t HalfSpaceBits(D d, Load load, const float* const* planes,
                                  const detail::HalfSpaceTests& query,
                                  size_t i) {
  uint64_t kept = ~uint64_t{0} >> (kWordObjects - hn::Lanes(d));
  for (size_t f = 0; f < query.count && kept != 0; ++f) {
    const auto sum =
        HalfSpaceSum(d, query.test[f],
                     [&](const detail::HalfSpaceTest::Term& term)
                         HWY_ATTR { return load(d, planes[term.plane] + i); });
    kept &= ~LaneBits(d, hn::Lt(sum, hn::Zero(d)));
  }
  return kept;
}

HWY_INLINE uint64_t HalfSpaceWord(const float* const* planes,
                                  const detail::HalfSpaceTests& tests,
                                  size_t begin, size_t count) {
  const WordTag<float> d;
  const size_t lanes = hn::Lanes(d);
  uint64_t bits = 0;
  size_t l = 0;
  for (; l + lanes <= count; l += lanes) {
    bits |= HalfSpaceBits(d, LoadAll(), planes, tests, begin + l) << l;
  }
  if (l == count) return bits;
  const LoadFirst load{count - l};
  bits |= HalfSpaceBits(d, load, planes, tests, begin + l) << l;
  return bits & ~(~uint64_t{0} << count);
}

void HalfSpaceMask(const void* pointers, size_t begin, size_t count,
                   const void* query, uint64_t* words) noexcept {
  const auto* planes = static_cast<const float* const*>(pointers);
  const auto& tests = *static_cast<const detail::HalfSpaceTests*>(query);
  for (size_t i = 0; i < count; i += kWordObjects) {
    *words++ = HalfSpaceWord(planes, tests, begin + i,
                             HWY_MIN(kWordObjects, count - i));
  }
}

int64_t HalfSpaceRow(const detail::Scan& scan, const detail::Chunk& chunk) {
  HalfSpaceMask(scan.planes, chunk.begin, chunk.end - chunk.begin,
                chunk.queries, chunk.rows);
  return HWY_TARGET;
}

constexpr detail::TargetKernels MakeHalfSpaceKernels() {
  detail::TargetKernels kernels{};
  kernels.nonzero_words = &FindNonzeroWords;
  kernels.count_bits = &CountBits;
  for (detail::Kernel& kernel : kernels.run) kernel = &HalfSpaceRow;
  kernels.mask_of_minima[0] = kernels.mask_of_minima[1] = &HalfSpaceMask;
  kernels.mask_of_all[0] = kernels.mask_of_all[1] = &HalfSpaceMask;
  kernels.few_objects = kernels.few_octahedra = detail::kFewObjects;
  return kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_HALF_SPACES_INL_H_

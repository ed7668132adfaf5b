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
#include <utility>

#include "hwy/highway.h"
#include "kernels/bvh/half_space_sum-inl.h"
#include "kernels/scan/flat-inl.h"
#include "kernels/scan/half_spaces.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The squared distance of a center from the box is compared with that of the
// sum of the radii. Its error is less than 2^-20, or 2^-120.
template <class D, class Load>
HWY_INLINE hn::Mask<D> IsFar(D d, Load load, const float* const* planes,
                             const detail::HalfSpaceQuery& query, size_t i) {
  const auto zero = hn::Zero(d);
  auto distance = zero;
  for (size_t k = 0; k < query.near_dims; ++k) {
    const auto center = load(d, planes[k] + i);
    const auto below = hn::Sub(hn::Set(d, query.box[k]), center);
    const auto above =
        hn::Sub(center, hn::Set(d, query.box[query.near_dims + k]));
    const auto apart = GreaterOf(above, GreaterOf(below, zero));
    distance = hn::Add(distance, hn::Mul(apart, apart));
  }
  const auto radius = load(d, planes[query.near_dims] + i);
  const auto reach = hn::Add(hn::Mul(hn::Add(radius, hn::Set(d, query.radius)),
                                     hn::Set(d, 1 + 0x1p-18f)),
                             hn::Set(d, 0x1p-59f));
  return hn::Gt(distance, hn::Mul(reach, reach));
}

// The objects of a vector whose foremost corners are in front of all
// half-spaces, or, with kIsNearest, all of their corners. The test ends when
// none is left.
template <bool kIsNearest, class D, class Load>
HWY_INLINE uint64_t HalfSpaceBits(D d, Load load, const float* const* planes,
                                  const detail::HalfSpaceQuery& query,
                                  size_t i) {
  const detail::HalfSpaceTests& tests = query.tests;
  uint64_t kept = ~uint64_t{0} >> (kWordObjects - hn::Lanes(d));
  if (!kIsNearest && query.near_dims != 0) {
    kept &= ~LaneBits(d, IsFar(d, load, planes, query, i));
  }
  const size_t dims =
      kIsNearest ? query.near_dims + tests.box_dims : tests.box_dims;
  for (size_t k = 0; k < dims && kept != 0; ++k) {
    auto min = load(d, planes[k] + i);
    auto max = load(d, planes[tests.max_plane + k] + i);
    const auto low = hn::Set(d, query.box[k]);
    const auto high = hn::Set(d, query.box[dims + k]);
    if constexpr (kIsNearest) {
      if (query.near_dims != 0) {
        const auto radius = load(d, planes[query.near_dims] + i);
        min = hn::Sub(min, radius);
        max = hn::Add(max, radius);
      }
      kept &= LaneBits(d, hn::And(hn::Ge(min, low), hn::Le(max, high)));
    } else {
      kept &= ~LaneBits(d, hn::Or(hn::Gt(min, high), hn::Lt(max, low)));
    }
  }
  for (size_t f = 0; f < tests.count && kept != 0; ++f) {
    const auto sum = HalfSpaceSum(
        d, tests.test[f],
        [&](const detail::HalfSpaceTest::Term& term) HWY_ATTR {
          if constexpr (kIsNearest) {
            const auto value = load(d, planes[term.opposite] + i);
            return term.plane == query.radius_plane ? hn::Neg(value) : value;
          } else {
            return load(d, planes[term.plane] + i);
          }
        });
    // Not Ne(sum, sum), which is false for a NaN on some targets.
    kept &= kIsNearest ? LaneBits(d, hn::Ge(sum, hn::Zero(d)))
                       : ~LaneBits(d, hn::Lt(sum, hn::Zero(d)));
  }
  return kept;
}

// Objects begin ... begin + count - 1, at most 64.
template <bool kIsNearest = false>
HWY_NOINLINE uint64_t HalfSpaceWord(const float* const* planes,
                                    const detail::HalfSpaceQuery& query,
                                    size_t begin, size_t count) {
  const WordTag<float> d;
  const size_t lanes = hn::Lanes(d);
  uint64_t bits = 0;
  size_t l = 0;
  for (; l + lanes <= count; l += lanes) {
    bits |= HalfSpaceBits<kIsNearest>(d, LoadAll(), planes, query, begin + l)
            << l;
  }
  if (l == count) return bits;
  const LoadFirst load{count - l};
  bits |= HalfSpaceBits<kIsNearest>(d, load, planes, query, begin + l) << l;
  return bits & ~(~uint64_t{0} << count);
}

// A test with the pointers that it reads: found once for a call, as a chain of
// loads before each sum doubled its time.
struct FrontTest {
  const float* plane[detail::kMostTerms];
  float factor[detail::kMostTerms];
  float offset;
};

// The sums of one vector. They are those of HalfSpaceSum().
template <size_t... kTerm, class D>
HWY_INLINE hn::Vec<D> SumOf(std::index_sequence<kTerm...>, D d,
                            const float* const* planes, const FrontTest& test,
                            size_t i) {
  auto sum = hn::Set(d, test.offset);
  ((sum = SumUp(d, sum,
                ProductUp(d, hn::LoadU(d, planes[kTerm] + i),
                          hn::Set(d, test.factor[kTerm])))),
   ...);
  return sum;
}

// Lowers the least sums of several vectors, `least`, by those of some tests.
// All tests of spheres read the same planes, kIsShared, which stay in
// registers.
template <size_t kTerms, bool kIsShared, size_t... kVector, class D, class... V>
HWY_INLINE void AddSums(std::index_sequence<kVector...>, D d,
                        const FrontTest* tests, size_t begin, size_t end,
                        size_t i, V&... least) {
  const float* const* const shared = tests[0].plane;
  for (size_t f = begin; f < end; ++f) {
    ((least = LesserOf(SumOf(std::make_index_sequence<kTerms>(), d,
                             kIsShared ? shared : tests[f].plane, tests[f],
                             i + kVector * hn::Lanes(d)),
                       least)),
     ...);
  }
}

// The objects of several vectors that are behind a half-space. `least` are
// vectors of infinity.
template <size_t kTerms, bool kIsShared, size_t... kVector, class D, class... V>
HWY_INLINE uint64_t BehindBits(std::index_sequence<kVector...> vectors, D d,
                               const FrontTest* tests,
                               const detail::HalfSpaceQuery& query, size_t i,
                               size_t* exits, V... least) {
  const size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  size_t begin = 0;
  if (exits != nullptr) {
    begin = query.full_count / 2;
    AddSums<kTerms, kIsShared>(vectors, d, tests, 0, begin, i, least...);
    const uint64_t behind =
        (... | (LaneBits(d, hn::Lt(least, zero)) << (kVector * lanes)));
    const size_t objects = sizeof...(V) * lanes;
    if (behind == ~uint64_t{0} >> (kWordObjects - objects)) {
      *exits += objects;
      return behind;
    }
  }
  AddSums<kTerms, kIsShared>(vectors, d, tests, begin, query.full_count, i,
                             least...);
  if constexpr (!kIsShared) {
    AddSums<kTerms - 1, false>(vectors, d, tests, query.full_count,
                               query.tests.count, i, least...);
  }
  return (... | (LaneBits(d, hn::Lt(least, zero)) << (kVector * lanes)));
}

// As many vectors are tested together as registers hold, so that each factor is
// read once for them.
template <size_t kTerms, bool kIsShared>
HWY_INLINE uint64_t FrontWord(const FrontTest* tests,
                              const detail::HalfSpaceQuery& query, size_t i,
                              size_t* exits) {
  const WordTag<float> d;
  const auto inf = hn::Inf(d);
#if HWY_HAVE_SCALABLE
  constexpr size_t kVectors = 1;
#else
  // With 16 registers two vectors of each shared plane fit.
  constexpr size_t kVectors = kIsShared && hn::MaxLanes(d) < 16 ? 2 : 4;
#endif
  constexpr std::make_index_sequence<kVectors> kNumbers;
  uint64_t behind = 0;
  for (size_t l = 0; l < kWordObjects; l += kVectors * hn::Lanes(d)) {
    uint64_t bits;
    if constexpr (kVectors == 1) {
      bits = BehindBits<kTerms, kIsShared>(kNumbers, d, tests, query, i + l,
                                           exits, inf);
    } else if constexpr (kVectors == 2) {
      bits = BehindBits<kTerms, kIsShared>(kNumbers, d, tests, query, i + l,
                                           exits, inf, inf);
    } else {
      bits = BehindBits<kTerms, kIsShared>(kNumbers, d, tests, query, i + l,
                                           exits, inf, inf, inf, inf);
    }
    behind |= bits << l;
  }
  return ~behind;
}

// The objects of a word that touch a box, whose minima and maxima are `box`.
template <size_t... kAxis>
HWY_INLINE uint64_t TouchingWord(std::index_sequence<kAxis...>,
                                 const float* const* planes,
                                 const detail::HalfSpaceQuery& query,
                                 size_t i) {
  const WordTag<float> d;
  const float* of_box[] = {planes[kAxis]...,
                           planes[query.tests.max_plane + kAxis]...};
  return KeptBits<sizeof...(kAxis)>(
      d, LoadAll(), of_box, i,
      hn::Set(d, query.box[sizeof...(kAxis) + kAxis])...,
      hn::Set(d, query.box[kAxis])...);
}

// The objects of a word that touch the box of the query, if it has one.
HWY_INLINE uint64_t NearWord(const float* const* planes,
                             const detail::HalfSpaceQuery& query, size_t i) {
  if (query.tests.box_dims == 3) {
    return TouchingWord(std::make_index_sequence<3>(), planes, query, i);
  }
  if (query.tests.box_dims == 2) {
    return TouchingWord(std::make_index_sequence<2>(), planes, query, i);
  }
  if (query.near_dims == 0) return ~uint64_t{0};
  const WordTag<float> d;
  uint64_t far = 0;
  for (size_t l = 0; l < kWordObjects; l += hn::Lanes(d)) {
    far |= LaneBits(d, IsFar(d, LoadAll(), planes, query, i + l)) << l;
  }
  return ~far;
}

// Writes the survivors of objects begin ... begin + count - 1, at least 64. The
// words that miss the box are tested no further.
template <size_t kTerms, bool kIsShared>
HWY_NOINLINE void FrontWords(const float* const* planes,
                             const detail::HalfSpaceQuery& query, size_t begin,
                             size_t count, uint64_t* words) {
  FrontTest tests[detail::kMostHalfSpaces];
  for (size_t f = 0; f < query.tests.count; ++f) {
    const detail::HalfSpaceTest& test = query.tests.test[f];
    tests[f].offset = test.offset;
    for (size_t t = 0; t < test.terms; ++t) {
      tests[f].plane[t] = planes[test.term[t].plane];
      tests[f].factor[t] = test.term[t].more;
    }
  }
  // The number of objects of the last eight words that were all rejected
  // halfway. In the order of a curve the next words are similar. In random
  // order the branch takes a sixth of the time, so one run of 16 tries it.
  constexpr size_t kRun = 8;
  size_t exits = 0;
  size_t* counted = nullptr;
  for (size_t w = 0; w * kWordObjects < count; ++w) {
    if (w % kRun == 0) {
      const bool pays = 4 * exits > 3 * kRun * kWordObjects;
      counted = pays || w / kRun % 16 == 1 ? &exits : nullptr;
      exits = 0;
    }
    // The last word begins as many objects earlier as it lacks.
    const size_t end = (w + 1) * kWordObjects;
    const size_t past = end > count ? end - count : 0;
    const size_t i = begin + end - kWordObjects - past;
    uint64_t word = NearWord(planes, query, i);
    if (word != 0 && query.tests.count != 0) {
      word &= FrontWord<kTerms, kIsShared>(tests, query, i, counted);
    }
    words[w] = word >> past;
  }
}

// Clears the bits of objects that have a corner behind a half-space.
void KeepInsides(const float* const* planes,
                 const detail::HalfSpaceQuery& query, size_t begin,
                 size_t count, uint64_t* words) {
  for (size_t i = 0; i < count; i += kWordObjects, ++words) {
    if (*words == 0) continue;
    *words &= HalfSpaceWord<true>(planes, query, begin + i,
                                  HWY_MIN(kWordObjects, count - i));
  }
}

void HalfSpaceMask(const void* pointers, size_t begin, size_t count,
                   const void* values, uint64_t* words) noexcept {
  const auto* planes = static_cast<const float* const*>(pointers);
  const auto& query = *static_cast<const detail::HalfSpaceQuery*>(values);
  const UpwardFpMode mode;
  if (query.only_insides) {
    KeepInsides(planes, query, begin, count, words);
  } else if (query.rejects_all) {
    for (size_t w = 0; w * kWordObjects < count; ++w) words[w] = 0;
  } else if (count < kWordObjects || query.terms == 0) {
    for (size_t i = 0; i < count; i += kWordObjects) {
      *words++ = HalfSpaceWord(planes, query, begin + i,
                               HWY_MIN(kWordObjects, count - i));
    }
  } else if (query.radius_plane != query.kNoPlane) {
    (query.terms == 4
         ? FrontWords<4, true>
         : FrontWords<3, true>)(planes, query, begin, count, words);
  } else {
    (query.terms == 3
         ? FrontWords<3, false>
         : FrontWords<2, false>)(planes, query, begin, count, words);
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

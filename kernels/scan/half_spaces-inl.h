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
#include <limits>
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

// Objects begin ... begin + count - 1, at most 64. What this says is the
// result on every target. Only the vectors of `wanted` objects are tested.
template <bool kIsNearest = false>
HWY_NOINLINE uint64_t HalfSpaceWord(const float* const* planes,
                                    const detail::HalfSpaceQuery& query,
                                    size_t begin, size_t count,
                                    uint64_t wanted = ~uint64_t{0}) {
  const WordTag<float> d;
  const size_t lanes = hn::Lanes(d);
  uint64_t bits = 0;
  size_t l = 0;
  for (; l + lanes <= count; l += lanes) {
    if ((wanted >> l & ~uint64_t{0} >> (kWordObjects - lanes)) == 0) continue;
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

// Tests of spheres are scaled so that this is the factor of the radius.
inline constexpr float kRadiusFactor = 0x1p-3f;

// The greater magnitude. The bits of a greater float are a greater integer, and
// of a NaN the greatest.
template <class VI, class V>
HWY_INLINE VI GreaterSize(VI most, V value) {
  return hn::Max(most, hn::BitCast(hn::DFromV<VI>(), hn::Abs(value)));
}

// Lowers `least` to the sums of a vector, and with kMeasures raises `most` to
// the magnitudes that it reads. Sums are compared as integers, because few
// cores compare and multiply floats at the same time. Of several negative sums
// the nearest to 0 is the least. A NaN is never less than a number of its sign.
template <bool kMeasures, bool kIsSphere, size_t... kTerm, class D, class VI>
HWY_INLINE void AddSum(std::index_sequence<kTerm...>, D d,
                       const float* const* planes, const FrontTest& test,
                       size_t i, VI& least, VI& most) {
  auto sum = hn::Set(d, test.offset);
  if constexpr (kIsSphere) {
    // All tests have this product, so the compiler makes it once.
    sum = hn::Add(hn::Mul(hn::LoadU(d, planes[sizeof...(kTerm)] + i),
                          hn::Set(d, kRadiusFactor)),
                  sum);
  }
  const auto add = [&](const float* plane, float factor) HWY_ATTR {
    const auto value = hn::LoadU(d, plane + i);
    if constexpr (kMeasures) most = GreaterSize(most, value);
    sum = hn::MulAdd(value, hn::Set(d, factor), sum);
  };
  (add(planes[kTerm], test.factor[kTerm]), ...);
  least = hn::Min(least, hn::BitCast(hn::RebindToSigned<D>(), sum));
}

// The greatest magnitudes that the sums of a vector read.
template <size_t kTerms, bool kIsShared, class D>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> SizeOf(
    D d, const float* const* planes, const detail::HalfSpaceQuery& query,
    size_t i) {
  auto most = hn::Zero(hn::RebindToSigned<D>());
  HALFSPACE_UNROLL
  for (size_t t = 0; t < (kIsShared ? 1 : 2) * kTerms; ++t) {
    const size_t p = t < kTerms ? t : query.tests.max_plane + t - kTerms;
    most = GreaterSize(most, hn::LoadU(d, planes[p] + i));
  }
  return most;
}

// Bits of the lanes in which all of `sums` are negative.
template <class D, class V, class... Vs>
HWY_INLINE uint64_t AllNegative(D d, V sums, Vs... more) {
  ((sums = hn::And(sums, more)), ...);
  return LaneBits(d, hn::Lt(sums, hn::Zero(d)));
}

// Whether each sum is so far from 0 that its sign is the verdict. If a number
// of the object is NaN or infinite, no sum is: another one may have been a NaN,
// which is the least only on some machines. With a box around the region,
// `most` is of the box, and infinite products are positive.
template <class D, class VI>
HWY_INLINE hn::Mask<D> IsCertain(D d, VI sum, VI most) {
  const auto slack =
      hn::MulAdd(hn::BitCast(d, most), hn::Set(d, detail::kSumSlack),
                 hn::Set(d, detail::kLeastSlack));
  return hn::Gt(hn::Abs(hn::BitCast(d, sum)), slack);
}

// The argument with this number.
template <size_t kNumber, class V, class... More>
HWY_INLINE V& Nth(V& v, More&... more) {
  if constexpr (kNumber == 0) {
    return v;
  } else {
    return Nth<kNumber - 1>(more...);
  }
}

// The objects of several vectors that are behind a half-space. `unknown` are
// those that HalfSpaceWord() has to decide about. `v` is the least sums of each
// vector, from the greatest integer on, then the greatest sizes, from 0 on.
template <size_t kTerms, bool kIsShared, bool kIsSphere, size_t... kVector,
          class D, class... V>
HWY_INLINE uint64_t BehindBits(std::index_sequence<kVector...>, D d,
                               const float* const* planes,
                               const FrontTest* tests,
                               const detail::HalfSpaceQuery& query, size_t i,
                               size_t* exits, uint64_t& unknown, V... v) {
  using VI = hn::Vec<hn::RebindToSigned<D>>;
  constexpr size_t kVectors = sizeof...(kVector);
  static_assert(sizeof...(V) == 2 * kVectors);
  const hn::RebindToSigned<D> di;
  constexpr std::make_index_sequence<kTerms - (kIsSphere ? 1 : 0)> kNumbers;
  const size_t lanes = hn::Lanes(d);
  const size_t count = query.front_count;
  const uint64_t of_vector = ~uint64_t{0} >> (kWordObjects - lanes);
  // Planes that all sums share are measured after them, while registers hold
  // them. Without fused operations the sums leave no registers for it.
  constexpr bool kMeasuresLast = kIsShared || !HWY_NATIVE_FMA;
  const bool has_size =
      !kIsShared && query.size < std::numeric_limits<float>::infinity();
  size_t f = 0;
  if (has_size) {
    ((Nth<kVectors + kVector>(v...) = hn::BitCast(di, hn::Set(d, query.size))),
     ...);
  } else if (!kMeasuresLast && query.is_paired) {
    for (; f < 2; ++f) {
      (AddSum<true, false>(kNumbers, d, tests[f].plane, tests[f],
                           i + kVector * lanes, Nth<kVector>(v...),
                           Nth<kVectors + kVector>(v...)),
       ...);
    }
  } else if (!kMeasuresLast) {
    ((Nth<kVectors + kVector>(v...) =
          SizeOf<kTerms, false>(d, planes, query, i + kVector * lanes)),
     ...);
  }
  const auto certain = [&](size_t vector, VI sum, VI size) HWY_ATTR {
    if (kMeasuresLast && !has_size) {
      size = SizeOf<kTerms, kIsShared>(d, planes, query, i + vector * lanes);
    }
    return IsCertain(d, sum, size);
  };
  const auto check = [&]() HWY_ATTR {
    auto all = hn::FirstN(d, lanes);
    ((all = hn::And(all, certain(kVector, Nth<kVector>(v...),
                                 Nth<kVectors + kVector>(v...)))),
     ...);
    return hn::AllTrue(d, all);
  };
  bool is_certain = false;
  for (; f < count; ++f) {
    (AddSum<false, kIsSphere>(kNumbers, d, tests[kIsShared ? 0 : f].plane,
                              tests[f], i + kVector * lanes, Nth<kVector>(v...),
                              Nth<kVectors + kVector>(v...)),
     ...);
    if (exits == nullptr || f != count / 2 || f + 1 == count ||
        AllNegative(di, Nth<kVector>(v...)...) != of_vector) {
      continue;
    }
    is_certain = check();
    if (is_certain) {
      *exits += kVectors * lanes;
      break;
    }
  }
  unknown = 0;
  if (HWY_UNLIKELY(!is_certain && !check())) {
    ((unknown |= (~LaneBits(d, certain(kVector, Nth<kVector>(v...),
                                       Nth<kVectors + kVector>(v...))) &
                  of_vector)
                 << (kVector * lanes)),
     ...);
  }
  return (... | (LaneBits(di, hn::Lt(Nth<kVector>(v...), hn::Zero(di)))
                 << (kVector * lanes)));
}

// As many vectors are tested together as registers hold: each factor is read
// once for them, and each plane, if all tests read the same.
template <size_t kTerms, bool kIsShared, bool kIsSphere>
HWY_INLINE uint64_t FrontWord(const float* const* planes,
                              const FrontTest* tests,
                              const detail::HalfSpaceQuery& query, size_t i,
                              size_t* exits) {
  const WordTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  using VI = hn::Vec<decltype(di)>;
  const VI least = hn::Set(di, 0x7fffffff);
  const VI zero = hn::Zero(di);
#if HWY_HAVE_SCALABLE
  constexpr size_t kVectors = 1;
#else
  // With 16 registers two vectors of each shared plane fit.
  constexpr size_t kVectors = kIsShared && hn::MaxLanes(d) < 16 ? 2 : 4;
#endif
  constexpr std::make_index_sequence<kVectors> kNumbers;
  uint64_t behind = 0;
  uint64_t unknown = 0;
  for (size_t l = 0; l < kWordObjects; l += kVectors * hn::Lanes(d)) {
    uint64_t bits;
    uint64_t some;
    if constexpr (kVectors == 1) {
      bits = BehindBits<kTerms, kIsShared, kIsSphere>(
          kNumbers, d, planes, tests, query, i + l, exits, some, least, zero);
    } else if constexpr (kVectors == 2) {
      bits = BehindBits<kTerms, kIsShared, kIsSphere>(
          kNumbers, d, planes, tests, query, i + l, exits, some, least, least,
          zero, zero);
    } else {
      bits = BehindBits<kTerms, kIsShared, kIsSphere>(
          kNumbers, d, planes, tests, query, i + l, exits, some, least, least,
          least, least, zero, zero, zero, zero);
    }
    behind |= bits << l;
    unknown |= some << l;
  }
  if (HWY_UNLIKELY(unknown != 0)) {
    behind &= ~unknown;
    behind |= unknown & ~HalfSpaceWord(planes, query, i, kWordObjects, unknown);
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
template <size_t kTerms, bool kIsShared, bool kIsSphere>
HWY_NOINLINE void FrontWords(const float* const* planes,
                             const detail::HalfSpaceQuery& query, size_t begin,
                             size_t count, uint64_t* words) {
  FrontTest tests[detail::kMostHalfSpaces];
  for (size_t f = 0; f < query.front_count; ++f) {
    const detail::HalfSpaceTest& test = query.tests.test[query.front[f]];
    const float scale =
        kIsSphere ? kRadiusFactor / test.term[test.terms - 1].more : 1;
    tests[f].offset = test.offset * scale;
    for (size_t t = 0; t < kTerms; ++t) {
      tests[f].plane[t] = planes[kIsShared ? t : test.term[0].plane];
      tests[f].factor[t] = 0;
    }
    for (size_t t = 0; t < test.terms; ++t) {
      const detail::HalfSpaceTest::Term& term = test.term[t];
      const size_t to = kIsShared ? term.plane : t;
      tests[f].plane[to] = planes[term.plane];
      tests[f].factor[to] = term.more * scale;
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
    if (word != 0 && query.front_count != 0) {
      word &= FrontWord<kTerms, kIsShared, kIsSphere>(planes, tests, query, i,
                                                      counted);
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
  if (query.is_of_insides) {
    KeepInsides(planes, query, begin, count, words);
  } else if (query.rejects_all) {
    for (size_t w = 0; w * kWordObjects < count; ++w) words[w] = 0;
  } else if (count < kWordObjects) {
    if (count != 0) *words = HalfSpaceWord(planes, query, begin, count);
  } else if (query.radius_plane == 3) {
    FrontWords<4, true, true>(planes, query, begin, count, words);
  } else if (query.radius_plane == 2) {
    FrontWords<3, true, true>(planes, query, begin, count, words);
  } else if (query.is_shared) {
    (query.terms == 3
         ? FrontWords<3, true, false>
         : FrontWords<4, true, false>)(planes, query, begin, count, words);
  } else {
    (query.terms == 2
         ? FrontWords<2, false, false>
         : FrontWords<3, false, false>)(planes, query, begin, count, words);
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

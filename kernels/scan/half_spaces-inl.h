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

// What a word of objects is tested for: their foremost corners are in front of
// all half-spaces, those of simplices too, or all of their corners are.
enum class Corners { kForemost, kForemostOfSimplex, kAll };

// The test of a vector ends when no object is left.
template <Corners kCorners, class D, class Load>
HWY_INLINE uint64_t HalfSpaceBits(D d, Load load, const float* const* planes,
                                  const detail::HalfSpaceQuery& query,
                                  size_t i) {
  constexpr bool kAll = kCorners == Corners::kAll;
  const detail::HalfSpaceTests& tests = query.tests;
  const bool is_sphere = query.radius_plane != query.kNoPlane;
  uint64_t kept = ~uint64_t{0} >> (kWordObjects - hn::Lanes(d));
  if (!kAll && query.near_dims != 0) {
    kept &= ~LaneBits(d, IsFar(d, load, planes, query, i));
  }
  const size_t dims = kAll ? query.near_dims + tests.box_dims : tests.box_dims;
  for (size_t k = 0; k < dims && kept != 0; ++k) {
    auto min = load(d, planes[k] + i);
    auto max = load(d, planes[tests.max_plane + k] + i);
    const auto low = hn::Set(d, query.box[k]);
    const auto high = hn::Set(d, query.box[dims + k]);
    if constexpr (kAll) {
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
    const detail::HalfSpaceTest& test = tests.test[f];
    const size_t terms = test.terms - (kAll && is_sphere ? 1 : 0);
    auto sum = HalfSpaceSum<kCorners == Corners::kForemostOfSimplex>(
        d, test, terms, [&](const detail::HalfSpaceTest::Term& term) HWY_ATTR {
          return load(d, planes[kAll ? term.opposite : term.plane] + i);
        });
    if constexpr (kAll) {
      if (is_sphere) {
        const auto reach = ProductUp(d, load(d, planes[query.radius_plane] + i),
                                     hn::Set(d, test.term[terms].more));
        sum = SumUp(d, sum, hn::Neg(reach));
      }
    }
    // Not Ne(sum, sum), which is false for a NaN on some targets.
    kept &= kAll ? LaneBits(d, hn::Ge(sum, hn::Zero(d)))
                 : ~LaneBits(d, hn::Lt(sum, hn::Zero(d)));
  }
  return kept;
}

// Objects begin ... begin + count - 1, at most 64.
template <Corners kCorners>
HWY_NOINLINE uint64_t HalfSpaceWord(const float* const* planes,
                                    const detail::HalfSpaceQuery& query,
                                    size_t begin, size_t count) {
  const WordTag<float> d;
  const size_t lanes = hn::Lanes(d);
  uint64_t bits = 0;
  size_t l = 0;
  for (; l + lanes <= count; l += lanes) {
    bits |= HalfSpaceBits<kCorners>(d, LoadAll(), planes, query, begin + l)
            << l;
  }
  if (l == count) return bits;
  const LoadFirst load{count - l};
  bits |= HalfSpaceBits<kCorners>(d, load, planes, query, begin + l) << l;
  return bits & ~(~uint64_t{0} << count);
}

// A test with the pointers that it reads: found once for a call, as a chain of
// loads before each sum doubled its time.
struct FrontTest {
  const float* plane[detail::kMostTerms];
  float factor[detail::kMostTerms];
  float offset;
};

// The sums of one vector, without the terms after the first ones. Otherwise
// they are those of HalfSpaceSum().
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

// What the tests of a word read: boxes minima or maxima, spheres the same
// planes, which stay in registers. A radius that all tests multiply by the same
// factor is added once.
enum class Front { kBoxes, kSpheres, kSpheresWithOneRadius };

// Lowers the least sums of several vectors, `least`, by those of some tests.
template <size_t kTerms, Front kFront, size_t... kVector, class D, class... V>
HWY_INLINE void AddSums(std::index_sequence<kVector...>, D d,
                        const FrontTest* tests, size_t begin, size_t end,
                        size_t i, V&... least) {
  const float* const* const shared = tests[0].plane;
  for (size_t f = begin; f < end; ++f) {
    ((least = LesserOf(SumOf(std::make_index_sequence<kTerms>(), d,
                             kFront == Front::kBoxes ? tests[f].plane : shared,
                             tests[f], i + kVector * hn::Lanes(d)),
                       least)),
     ...);
  }
}

// The tests of a call, and what the radius is read from and multiplied by.
struct FrontTests {
  FrontTest test[detail::kMostHalfSpaces];
  const float* radius;
  float radius_factor;
};

// The objects of several vectors with a negative sum. The least of several sums
// is still the least with the radius, because rounding is monotone.
template <Front kFront, size_t... kVector, class D, class... V>
HWY_INLINE uint64_t NegativeBits(std::index_sequence<kVector...>, D d,
                                 const FrontTests& tests, size_t i,
                                 V... least) {
  if constexpr (kFront == Front::kSpheresWithOneRadius) {
    const auto factor = hn::Set(d, tests.radius_factor);
    ((least = SumUp(
          d, least,
          ProductUp(d, hn::LoadU(d, tests.radius + i + kVector * hn::Lanes(d)),
                    factor))),
     ...);
  }
  const auto zero = hn::Zero(d);
  return (... | (LaneBits(d, hn::Lt(least, zero)) << (kVector * hn::Lanes(d))));
}

// The objects of several vectors that are behind a half-space. `least` are
// vectors of infinity.
template <size_t kTerms, Front kFront, size_t... kVector, class D, class... V>
HWY_INLINE uint64_t BehindBits(std::index_sequence<kVector...> vectors, D d,
                               const FrontTests& tests,
                               const detail::HalfSpaceQuery& query, size_t i,
                               size_t* exits, V... least) {
  size_t begin = 0;
  if (exits != nullptr) {
    begin = query.full_count / 2;
    AddSums<kTerms, kFront>(vectors, d, tests.test, 0, begin, i, least...);
    const uint64_t behind =
        NegativeBits<kFront>(vectors, d, tests, i, least...);
    const size_t objects = sizeof...(V) * hn::Lanes(d);
    if (behind == ~uint64_t{0} >> (kWordObjects - objects)) {
      *exits += objects;
      return behind;
    }
  }
  AddSums<kTerms, kFront>(vectors, d, tests.test, begin, query.full_count, i,
                          least...);
  if constexpr (kFront == Front::kBoxes) {
    AddSums<kTerms - 1, kFront>(vectors, d, tests.test, query.full_count,
                                query.tests.count, i, least...);
  }
  return NegativeBits<kFront>(vectors, d, tests, i, least...);
}

// As many vectors are tested together as registers hold, so that each factor is
// read once for them.
template <size_t kTerms, Front kFront>
HWY_INLINE uint64_t FrontWord(const FrontTests& tests,
                              const detail::HalfSpaceQuery& query, size_t i,
                              size_t* exits) {
  const WordTag<float> d;
  const auto inf = hn::Inf(d);
#if HWY_HAVE_SCALABLE
  constexpr size_t kVectors = 1;
#else
  // With 16 registers two vectors of each shared plane fit.
  constexpr size_t kVectors =
      kFront != Front::kBoxes && hn::MaxLanes(d) < 16 ? 2 : 4;
#endif
  constexpr std::make_index_sequence<kVectors> kNumbers;
  uint64_t behind = 0;
  for (size_t l = 0; l < kWordObjects; l += kVectors * hn::Lanes(d)) {
    uint64_t bits;
    if constexpr (kVectors == 1) {
      bits = BehindBits<kTerms, kFront>(kNumbers, d, tests, query, i + l, exits,
                                        inf);
    } else if constexpr (kVectors == 2) {
      bits = BehindBits<kTerms, kFront>(kNumbers, d, tests, query, i + l, exits,
                                        inf, inf);
    } else {
      bits = BehindBits<kTerms, kFront>(kNumbers, d, tests, query, i + l, exits,
                                        inf, inf, inf, inf);
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
template <size_t kTerms, Front kFront>
HWY_NOINLINE void FrontWords(const float* const* planes,
                             const detail::HalfSpaceQuery& query, size_t begin,
                             size_t count, uint64_t* words) {
  FrontTests tests;
  for (size_t f = 0; f < query.tests.count; ++f) {
    const detail::HalfSpaceTest& test = query.tests.test[f];
    tests.test[f].offset = test.offset;
    for (size_t t = 0; t < kTerms && t < test.terms; ++t) {
      tests.test[f].plane[t] = planes[test.term[t].plane];
      tests.test[f].factor[t] = test.term[t].more;
    }
  }
  if (kFront == Front::kSpheresWithOneRadius && query.tests.count != 0) {
    tests.radius = planes[query.radius_plane];
    tests.radius_factor = query.tests.test[0].term[kTerms].more;
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
      word &= FrontWord<kTerms, kFront>(tests, query, i, counted);
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
    *words &= HalfSpaceWord<Corners::kAll>(planes, query, begin + i,
                                           HWY_MIN(kWordObjects, count - i));
  }
}

void HalfSpaceMask(const void* pointers, size_t begin, size_t count,
                   const void* values, uint64_t* words) noexcept {
  const auto* planes = static_cast<const float* const*>(pointers);
  const auto& query = *static_cast<const detail::HalfSpaceQuery*>(values);
  const UpwardFpMode mode;
  const bool is_sphere = query.radius_plane != query.kNoPlane;
  if (query.only_insides) {
    KeepInsides(planes, query, begin, count, words);
  } else if (query.rejects_all) {
    for (size_t w = 0; w * kWordObjects < count; ++w) words[w] = 0;
  } else if (count >= kWordObjects && query.terms != 0) {
    using Words = decltype(&FrontWords<2, Front::kBoxes>);
    constexpr Words kBoxes[] = {&FrontWords<2, Front::kBoxes>,
                                &FrontWords<3, Front::kBoxes>};
    // By the number of dimensions and of terms.
    constexpr Words kSpheres[2][2] = {
        {&FrontWords<2, Front::kSpheresWithOneRadius>,
         &FrontWords<3, Front::kSpheres>},
        {&FrontWords<3, Front::kSpheresWithOneRadius>,
         &FrontWords<4, Front::kSpheres>}};
    const size_t dims = is_sphere ? query.radius_plane : query.terms;
    (is_sphere ? kSpheres[dims - 2][query.terms - dims] : kBoxes[dims - 2])(
        planes, query, begin, count, words);
  } else {
    const bool is_simplex = query.tests.max_plane == 0 && !is_sphere;
    const auto word = is_simplex ? HalfSpaceWord<Corners::kForemostOfSimplex>
                                 : HalfSpaceWord<Corners::kForemost>;
    for (size_t i = 0; i < count; i += kWordObjects) {
      *words++ =
          word(planes, query, begin + i, HWY_MIN(kWordObjects, count - i));
    }
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

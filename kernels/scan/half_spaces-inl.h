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
#include <type_traits>
#include <utility>

#include "hwy/highway.h"
#include "kernels/bvh/half_space-inl.h"
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
// result on every target.
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

// Lowers each of `least`, of objects i, i + lanes, ..., to the sum of its
// vector. Sums are compared as integers, because few cores compare and multiply
// floats at the same time. Of several negative sums the nearest to 0 is the
// least. A NaN is the least only beside sums of the other sign, or other NaNs.
template <size_t... kVector, size_t... kTerm, class D, class... V>
HWY_INLINE void AddSums(std::index_sequence<kVector...>,
                        std::index_sequence<kTerm...>, D d,
                        const FrontTest& test, size_t i, V&... least) {
  const hn::RebindToSigned<D> di;
  const size_t lanes = hn::Lanes(d);
  const float* const from[] = {test.plane[kTerm] + i...};
  const auto sum_of = [&](size_t vector, auto... factor) HWY_ATTR {
    auto sum = hn::Set(d, test.offset);
    ((sum =
          hn::MulAdd(hn::LoadU(d, from[kTerm] + vector * lanes), factor, sum)),
     ...);
    return hn::BitCast(di, sum);
  };
  ((least = hn::Min(least, sum_of(kVector, hn::Set(d, test.factor[kTerm])...))),
   ...);
}

// Raises `most` to the bits of `count` floats, at least 64, as integers.
template <class D, class V>
HWY_INLINE V Raised(D d, const float* from, size_t count, V most) {
  const hn::Repartition<float, D> df;
  const size_t lanes = hn::Lanes(d);
  // Each maximum waits for the one before.
  V other = most;
  size_t i = 0;
  for (; i + 2 * lanes <= count; i += 2 * lanes) {
    most = hn::Max(most, hn::BitCast(d, hn::LoadU(df, from + i)));
    other = hn::Max(other, hn::BitCast(d, hn::LoadU(df, from + i + lanes)));
  }
  for (; i < count; i += lanes) {
    i = HWY_MIN(i, count - lanes);
    most = hn::Max(most, hn::BitCast(d, hn::LoadU(df, from + i)));
  }
  return hn::Max(most, other);
}

// The slack of the sums of objects begin ... begin + count - 1. Of the bits of
// floats as signed integers the greatest is the greatest number, and as
// unsigned ones that of the least, if any is negative, or a NaN.
HWY_NOINLINE float Slack(const float* const* planes,
                         const detail::HalfSpaceQuery& query, size_t begin,
                         size_t count) {
  const hn::RebindToSigned<WordTag<float>> di;
  const hn::RebindToUnsigned<WordTag<float>> du;
  auto high = hn::Zero(di);
  auto low = hn::Zero(du);
  for (size_t p = 0; p < query.terms; ++p) {
    high = Raised(di, planes[query.tests.max_plane + p] + begin, count, high);
  }
  for (size_t p = 0; p < query.terms; ++p) {
    low = Raised(du, planes[p] + begin, count, low);
  }
  const WordTag<float> d;
  const auto most =
      hn::Max(high, hn::BitCast(di, hn::Abs(hn::BitCast(d, low))));
  return hn::GetLane(hn::BitCast(d, hn::MaxOfLanes(di, most))) *
             detail::kSumSlack +
         0x1p-110f;
}

// The bits of the masks of several vectors.
template <size_t... kVector, class D, class... M>
HWY_INLINE uint64_t BitsOf(std::index_sequence<kVector...>, D d, M... masks) {
  return (... | (LaneBits(d, masks) << (kVector * hn::Lanes(d))));
}

// Bits of the lanes in which all of `sums` are negative.
template <class D, class V, class... Vs>
HWY_INLINE uint64_t AllNegative(D d, V sums, Vs... more) {
  ((sums = hn::And(sums, more)), ...);
  return LaneBits(d, hn::Lt(sums, hn::Zero(d)));
}

// The objects that are not behind a half-space. `unknown` are those that
// HalfSpaceWord() has to decide about.
template <size_t kTerms, class D, class... V>
HWY_INLINE uint64_t FrontBits(D d, const FrontTest* tests, size_t count,
                              size_t i, float its_slack, size_t* exits,
                              uint64_t& unknown, V... least) {
  constexpr std::index_sequence_for<V...> kVectors;
  const hn::RebindToSigned<D> di;
  const size_t lanes = hn::Lanes(d);
  const uint64_t all = ~uint64_t{0} >> (kWordObjects - sizeof...(V) * lanes);
  const auto slack = hn::Set(d, its_slack);
  const auto below = hn::Neg(slack);
  for (size_t f = 0; f < count; ++f) {
    AddSums(kVectors, std::make_index_sequence<kTerms>(), d, tests[f], i,
            least...);
    if (exits != nullptr && f == count / 2 &&
        AllNegative(di, least...) == ~uint64_t{0} >> (kWordObjects - lanes) &&
        BitsOf(kVectors, d, hn::Lt(hn::BitCast(d, least), below)...) == all) {
      *exits += sizeof...(V) * lanes;
      break;
    }
  }
  const uint64_t behind =
      BitsOf(kVectors, d, hn::Lt(hn::BitCast(d, least), below)...);
  const uint64_t in_front =
      BitsOf(kVectors, d, hn::Ge(hn::BitCast(d, least), slack)...);
  unknown = ~(behind | in_front) & all;
  return all & ~behind;
}

template <size_t kTerms>
HWY_INLINE uint64_t FrontWord(const float* const* planes,
                              const FrontTest* tests,
                              const detail::HalfSpaceQuery& query, size_t i,
                              float slack, size_t* exits) {
  const WordTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto most = hn::Set(di, 0x7fffffff);
  uint64_t bits = 0;
  uint64_t unknown = 0;
#if HWY_HAVE_SCALABLE
  for (size_t l = 0; l < kWordObjects; l += hn::Lanes(d)) {
    uint64_t some;
    bits |= FrontBits<kTerms>(d, tests, query.front_count, i + l, slack, exits,
                              some, most)
            << l;
    unknown |= some << l;
  }
#else
  // Each factor is read once for as many vectors as registers hold.
  constexpr size_t kLanes = hn::MaxLanes(WordTag<float>());
  constexpr size_t kVectors = kLanes == 8 ? 8 : 4;
  for (size_t l = 0; l < kWordObjects; l += kVectors * kLanes) {
    uint64_t some;
    if constexpr (kVectors == 8) {
      bits |= FrontBits<kTerms>(d, tests, query.front_count, i + l, slack,
                                exits, some, most, most, most, most, most, most,
                                most, most);
    } else {
      bits |= FrontBits<kTerms>(d, tests, query.front_count, i + l, slack,
                                exits, some, most, most, most, most)
              << l;
    }
    unknown |= some << l;
  }
#endif
  if (HWY_UNLIKELY(unknown != 0)) {
    bits &= ~unknown | HalfSpaceWord(planes, query, i, kWordObjects);
  }
  return bits;
}

// How many objects the word that begins at object i lacks.
constexpr size_t PastWord(size_t count, size_t i) {
  return i + kWordObjects > count ? i + kWordObjects - count : 0;
}

// The spheres near the box, of at least 64.
HWY_NOINLINE void NearWords(const float* const* planes,
                            const detail::HalfSpaceQuery& query, size_t begin,
                            size_t count, uint64_t* words) {
  const WordTag<float> d;
  const size_t lanes = hn::Lanes(d);
  for (size_t i = 0; i < count; i += kWordObjects) {
    const size_t past = PastWord(count, i);
    uint64_t far = 0;
    for (size_t l = 0; l < kWordObjects; l += lanes) {
      far |=
          LaneBits(d, IsFar(d, LoadAll(), planes, query, begin + i - past + l))
          << l;
    }
    words[i / kWordObjects] = ~far >> past;
  }
}

// Writes the survivors of objects begin ... begin + count - 1, at least 64 and
// at most a tile. The objects that miss the box are tested no further.
void FrontWords(const float* const* planes, const FrontTest* tests,
                const detail::HalfSpaceQuery& query, size_t begin, size_t count,
                size_t* exits, uint64_t* words) {
  const size_t dims = query.tests.box_dims;
  const float* of_box[6];
  for (size_t k = 0; k < dims; ++k) {
    of_box[k] = planes[k];
    of_box[dims + k] = planes[query.tests.max_plane + k];
  }
  if (dims == 3) {
    FlatMask<3, 3, OneTag<float>>(of_box, begin, count, query.box, words);
  } else if (dims == 2) {
    FlatMask<2, 2, OneTag<float>>(of_box, begin, count, query.box, words);
  } else if (query.near_dims != 0) {
    NearWords(planes, query, begin, count, words);
  } else {
    for (size_t i = 0; i < count; i += kWordObjects) {
      words[i / kWordObjects] = ~uint64_t{0} >> PastWord(count, i);
    }
  }
  if (query.front_count == 0) return;
  const float slack = query.slack < std::numeric_limits<float>::infinity()
                          ? query.slack
                          : Slack(planes, query, begin, count);
  const auto test = [&](auto terms) HWY_ATTR {
    for (size_t i = 0; i < count; i += kWordObjects) {
      uint64_t& word = words[i / kWordObjects];
      if (word == 0) continue;
      const size_t past = PastWord(count, i);
      word &= FrontWord<terms()>(planes, tests, query, begin + i - past, slack,
                                 exits) >>
              past;
    }
  };
  if (query.terms == 2) {
    test(std::integral_constant<size_t, 2>());
  } else if (query.terms == 3) {
    test(std::integral_constant<size_t, 3>());
  } else {
    test(std::integral_constant<size_t, 4>());
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
  // The planes of a tile stay in L1.
  constexpr size_t kTile = 512;
  const auto* planes = static_cast<const float* const*>(pointers);
  const auto& query = *static_cast<const detail::HalfSpaceQuery*>(values);
  if (query.is_of_insides) {
    KeepInsides(planes, query, begin, count, words);
    return;
  }
  // The number of objects of the last tile that were all rejected halfway. In
  // the order of a curve the next tile is similar. In random order the branch
  // takes a sixth of the time, so one tile of 16 tries it.
  size_t exits = 0;
  FrontTest tests[detail::kMostHalfSpaces];
  if (count >= kWordObjects) {
    for (size_t f = 0; f < query.front_count; ++f) {
      const detail::HalfSpaceTest& test = query.tests.test[query.front[f]];
      tests[f].offset = test.offset;
      for (size_t t = 0; t < query.terms; ++t) {
        tests[f].plane[t] = planes[test.term[t].plane];
        tests[f].factor[t] = test.term[t].more;
      }
    }
  }
  for (size_t i = 0; i < count; i += kTile) {
    const size_t objects = HWY_MIN(kTile, count - i);
    if (query.rejects_all) {
      for (size_t w = 0; w * kWordObjects < objects; ++w) words[w] = 0;
    } else if (objects >= kWordObjects) {
      const bool tries = i / kTile % 16 == 1 || 4 * exits > 3 * kTile;
      exits = 0;
      FrontWords(planes, tests, query, begin + i, objects,
                 tries ? &exits : nullptr, words);
    } else {
      *words = HalfSpaceWord(planes, query, begin + i, objects);
    }
    words += kTile / kWordObjects;
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

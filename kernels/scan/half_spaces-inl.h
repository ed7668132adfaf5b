// The kernels of flat scans for half-spaces. They read a list of planes, so the
// same kernels serve all worlds of floats.
#if defined(HALFSPACE_KERNELS_SCAN_HALF_SPACES_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SCAN_HALF_SPACES_INL_H_
#undef HALFSPACE_KERNELS_SCAN_HALF_SPACES_INL_H_
#else
#define HALFSPACE_KERNELS_SCAN_HALF_SPACES_INL_H_
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
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

// One vector of objects. The test ends when none is left.
template <class D, class Load>
HWY_INLINE uint64_t HalfSpaceBits(D d, Load load, const float* const* planes,
                                  const detail::HalfSpaceQuery& query,
                                  size_t i) {
  const detail::HalfSpaceTests& tests = query.tests;
  uint64_t kept = ~uint64_t{0} >> (kWordObjects - hn::Lanes(d));
  if (query.near_dims != 0) {
    kept &= ~LaneBits(d, IsFar(d, load, planes, query, i));
  }
  for (size_t k = 0; k < tests.box_dims && kept != 0; ++k) {
    const auto min = load(d, planes[k] + i);
    const auto max = load(d, planes[tests.max_plane + k] + i);
    kept &= ~LaneBits(d, hn::Or(hn::Gt(min, hn::Set(d, tests.high[k])),
                                hn::Lt(max, hn::Set(d, tests.low[k]))));
  }
  for (size_t f = 0; f < tests.count && kept != 0; ++f) {
    const auto sum =
        HalfSpaceSum(d, tests.test[f],
                     [&](const detail::HalfSpaceTest::Term& term)
                         HWY_ATTR { return load(d, planes[term.plane] + i); });
    kept &= ~LaneBits(d, hn::Lt(sum, hn::Zero(d)));
  }
  return kept;
}

// Objects begin ... begin + count - 1, at most 64. What this says is the
// result on every target.
HWY_NOINLINE uint64_t HalfSpaceWord(const float* const* planes,
                                    const detail::HalfSpaceQuery& query,
                                    size_t begin, size_t count) {
  const WordTag<float> d;
  const size_t lanes = hn::Lanes(d);
  uint64_t bits = 0;
  size_t l = 0;
  for (; l + lanes <= count; l += lanes) {
    bits |= HalfSpaceBits(d, LoadAll(), planes, query, begin + l) << l;
  }
  if (l == count) return bits;
  const LoadFirst load{count - l};
  bits |= HalfSpaceBits(d, load, planes, query, begin + l) << l;
  return bits & ~(~uint64_t{0} << count);
}

// Lowers each of `least`, of objects i, i + lanes, ..., to the sum of its
// vector. Sums are compared as integers, because few cores compare and multiply
// floats at the same time. Of several negative sums the nearest to 0 is the
// least. A NaN is the least only beside sums of the other sign, or other NaNs.
template <size_t... kVector, size_t... kTerm, class D, class... V>
HWY_INLINE void AddSums(std::index_sequence<kVector...>,
                        std::index_sequence<kTerm...>, D d,
                        const float* const* planes,
                        const detail::HalfSpaceTest& test, size_t i,
                        V&... least) {
  const hn::RebindToSigned<D> di;
  const size_t lanes = hn::Lanes(d);
  const float* const from[] = {planes[test.term[kTerm].plane] + i...};
  const auto sum_of = [&](size_t vector, auto... factor) HWY_ATTR {
    auto sum = hn::Set(d, test.offset);
    ((sum =
          hn::MulAdd(hn::LoadU(d, from[kTerm] + vector * lanes), factor, sum)),
     ...);
    return hn::BitCast(di, sum);
  };
  ((least =
        hn::Min(least, sum_of(kVector, hn::Set(d, test.term[kTerm].more)...))),
   ...);
}

// Tests first ... end - 1 in their order.
template <size_t kTerms, class D, class... V>
HWY_INLINE void AddTests(D d, const float* const* planes,
                         const detail::HalfSpaceQuery& query, size_t first,
                         size_t end, size_t i, V&... least) {
  end = HWY_MIN(end, query.end[kTerms]);
  for (size_t f = HWY_MAX(first, query.end[kTerms - 1]); f < end; ++f) {
    AddSums(std::index_sequence_for<V...>(), std::make_index_sequence<kTerms>(),
            d, planes, query.tests.test[query.order[f]], i, least...);
  }
}

// Raises each of `most` to twice the bits of its vector without the sign, so
// that a NaN is the greatest.
template <size_t... kVector, class D, class... V>
HWY_INLINE void Raise(std::index_sequence<kVector...>, D d, const float* plane,
                      V&... most) {
  const hn::RebindToUnsigned<D> du;
  const auto twice = [&](size_t vector) HWY_ATTR {
    const auto v = hn::BitCast(du, hn::LoadU(d, plane + vector * hn::Lanes(d)));
    return hn::Add(v, v);
  };
  ((most = hn::Max(most, twice(kVector))), ...);
}

// The slack of the sums of all vectors.
template <class Vectors, class D, class V, class... Vs>
HWY_INLINE hn::Vec<D> Slack(Vectors vectors, D d, const float* const* planes,
                            const detail::HalfSpaceQuery& query, size_t i,
                            V most, Vs... mosts) {
  ((mosts = most), ...);
  for (size_t p = 0; p < query.minima; ++p) {
    Raise(vectors, d, planes[p] + i, mosts...);
  }
  for (size_t p = 0; p < query.maxima; ++p) {
    Raise(vectors, d, planes[query.tests.max_plane + p] + i, mosts...);
  }
  ((most = hn::Max(most, mosts)), ...);
  return hn::MulAdd(hn::BitCast(d, hn::ShiftRight<1>(most)),
                    hn::Set(d, detail::kSumSlack), hn::Set(d, 0x1p-110f));
}

template <size_t... kVector, class D, class V, class... Vs>
HWY_INLINE uint64_t BitsBelow(std::index_sequence<kVector...>, D d, V limit,
                              Vs... sums) {
  return (... | (LaneBits(d, hn::Lt(hn::BitCast(d, sums), limit))
                 << (kVector * hn::Lanes(d))));
}
template <size_t... kVector, class D, class V, class... Vs>
HWY_INLINE uint64_t BitsFrom(std::index_sequence<kVector...>, D d, V limit,
                             Vs... sums) {
  return (... | (LaneBits(d, hn::Ge(hn::BitCast(d, sums), limit))
                 << (kVector * hn::Lanes(d))));
}

// The objects that are not behind a half-space. `unknown` are those that
// HalfSpaceWord() has to decide about.
template <class D, class... V>
HWY_INLINE uint64_t FrontBits(D d, const float* const* planes,
                              const detail::HalfSpaceQuery& query, size_t i,
                              uint64_t& unknown, V... least) {
  constexpr std::index_sequence_for<V...> kVectors;
  const hn::RebindToUnsigned<D> du;
  const uint64_t all =
      ~uint64_t{0} >> (kWordObjects - sizeof...(V) * hn::Lanes(d));
  auto slack = hn::Set(d, query.slack);
  if (!(query.slack < std::numeric_limits<float>::infinity())) {
    slack = Slack(kVectors, d, planes, query, i, hn::Zero(du),
                  hn::BitCast(du, least)...);
  }
  const auto below = hn::Neg(slack);
  // Halfway there may be none left, which neighbours have in common.
  const size_t count = query.end[detail::kMostTerms];
  uint64_t behind = 0;
  size_t first = 0;
  for (size_t end = (count + 1) / 2;; end = count) {
    AddTests<1>(d, planes, query, first, end, i, least...);
    AddTests<2>(d, planes, query, first, end, i, least...);
    AddTests<3>(d, planes, query, first, end, i, least...);
    AddTests<4>(d, planes, query, first, end, i, least...);
    behind = BitsBelow(kVectors, d, below, least...);
    first = end;
    if (first == count || behind == all) break;
  }
  unknown = ~(behind | BitsFrom(kVectors, d, slack, least...)) & all;
  return all & ~behind;
}

HWY_INLINE uint64_t FrontWord(const float* const* planes,
                              const detail::HalfSpaceQuery& query, size_t i) {
  const WordTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto most = hn::Set(di, 0x7fffffff);
  uint64_t bits = 0;
  uint64_t unknown = 0;
#if HWY_HAVE_SCALABLE
  for (size_t l = 0; l < kWordObjects; l += hn::Lanes(d)) {
    uint64_t some;
    bits |= FrontBits(d, planes, query, i + l, some, most) << l;
    unknown |= some << l;
  }
#else
  // Each factor is read once for as many vectors as registers hold.
  constexpr size_t kLanes = hn::MaxLanes(WordTag<float>());
  constexpr size_t kVectors = kLanes == 8 ? 8 : 4;
  for (size_t l = 0; l < kWordObjects; l += kVectors * kLanes) {
    uint64_t some;
    if constexpr (kVectors == 8) {
      bits |= FrontBits(d, planes, query, i + l, some, most, most, most, most,
                        most, most, most, most);
    } else {
      bits |= FrontBits(d, planes, query, i + l, some, most, most, most, most)
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

// Objects begin ... begin + count - 1, at least 64 and at most a tile, in plain
// order: those that touch the box, and then those of them in front.
void FrontWords(const float* const* planes, const detail::HalfSpaceQuery& query,
                size_t begin, size_t count, uint64_t* words) {
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
  if (query.tests.count == 0) return;
  for (size_t i = 0; i < count; i += kWordObjects) {
    uint64_t& word = words[i / kWordObjects];
    if (word == 0) continue;
    const size_t past = PastWord(count, i);
    word &= FrontWord(planes, query, begin + i - past) >> past;
  }
}

void HalfSpaceMask(const void* pointers, size_t begin, size_t count,
                   const void* values, uint64_t* words) noexcept {
  // The planes of a tile stay in L1.
  constexpr size_t kTile = 1024;
  const auto* planes = static_cast<const float* const*>(pointers);
  const auto& query = *static_cast<const detail::HalfSpaceQuery*>(values);
  for (size_t i = 0; i < count; i += kTile) {
    const size_t objects = HWY_MIN(kTile, count - i);
    if (query.rejects_all) {
      std::fill_n(words, (objects + 63) / 64, 0);
    } else if (kHasVectors && objects >= kWordObjects) {
      FrontWords(planes, query, begin + i, objects, words);
    } else {
      for (size_t l = 0; l < objects; l += kWordObjects) {
        words[l / kWordObjects] = HalfSpaceWord(
            planes, query, begin + i + l, HWY_MIN(kWordObjects, objects - l));
      }
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

// THE loop: queries, whole words of 64 objects, flat or staged, and the tail.
// Shapes are data (planes.h), the lane type is a template parameter.
//
// Query planes travel as a parameter pack of vectors: an SVE vector cannot be
// an array element or a member.
#if defined(HALFSPACE_KERNELS_REJECT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_REJECT_INL_H_
#undef HALFSPACE_KERNELS_REJECT_INL_H_
#else
#define HALFSPACE_KERNELS_REJECT_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <utility>

#include "hwy/highway.h"
#include "kernels/flat_words-inl.h"
#include "kernels/mask_job.h"
#include "kernels/planes.h"
#include "kernels/staged_groups-inl.h"
#include "kernels/staged_words-inl.h"
#include "kernels/word_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// How a shape's schedule is run.
template <class Shape>
inline constexpr bool kIsFlat = Shape::kOrder.stage_ends.size() == 1;

template <class Shape>
constexpr bool IsByWord() {
  if constexpr (Shape::kOrder.stage_ends.size() == 2) {
    return Shape::kGroup == kWordObjects;
  } else {
    return false;
  }
}

template <class Shape>
inline constexpr size_t kTogether =
    kIsFlat<Shape> || IsByWord<Shape>()
        ? kQueriesTogether<Shape::kOrder.stage_ends[0]>
        : 1;

// `words` whole words from object job.begin on, for kQueries queries.
template <class Shape, size_t kQueries, bool kIsFar, class Load, typename T,
          size_t... kPlane>
HWY_INLINE void ScanWords(std::index_sequence<kPlane...>, Load load,
                          const kernels::MaskJob& job, const T* const* planes,
                          const T* values, size_t words, uint64_t* row) {
  if constexpr (kIsFlat<Shape>) {
    ScanWordsFlat<Shape, sizeof...(kPlane), kQueries, kIsFar>(
        load, planes, values, job.begin, words, row, job.stride, job.flip);
  } else if constexpr (IsByWord<Shape>()) {
    ScanWordsStaged<Shape, kQueries, kIsFar>(load, planes, values, job.begin,
                                             words, row, job.stride, job.flip);
  } else {
    static_assert(kQueries == 1);
    const OneTag<T> d;
    ScanGroupsStaged<Shape>(
        d, load, planes, job.begin, words, row, job.flip,
        hn::Set(d, values[kernels::kQueryIndex<Shape, kPlane>])...);
  }
}

// The last, partial word, from object i on. Not inline: one for a shape and a
// type serves near, far and together, and the library is 6 % smaller.
template <class Shape, typename T, size_t... kPlane>
HWY_NOINLINE uint64_t ScanTail(std::index_sequence<kPlane...>,
                               const kernels::MaskJob& job, const T* values,
                               size_t i) {
  const T* planes[] = {static_cast<const T*>(job.planes[kPlane])...};
  const WordTag<T> d;
  return job.flip ^
         TailRejected<Shape>(
             d, planes, i, job.end - i,
             hn::Set(d, values[kernels::kQueryIndex<Shape, kPlane>])...);
}

// kQueries queries from `values` on, and their rows from `row` on. Returns
// HWY_TARGET, so that a call for one query ends with a jump. Not inline: what
// is near, far and together in one function needs so many registers that a
// short call spends nanoseconds on saving them.
template <class Shape, size_t kQueries, bool kIsFar, class Load, typename T,
          size_t... kPlane>
HWY_NOINLINE int64_t ScanQueries(std::index_sequence<kPlane...> all_planes,
                                 Load load, const kernels::MaskJob& job,
                                 const T* values, uint64_t* row) {
  // A local copy: the stores of words must not make the compiler reload them.
  const T* planes[] = {static_cast<const T*>(job.planes[kPlane])...};
  const size_t words = (job.end - job.begin) / kWordObjects;
  ScanWords<Shape, kQueries, kIsFar>(all_planes, load, job, planes, values,
                                     words, row);
  const size_t i = job.begin + words * kWordObjects;
  if (i == job.end) return HWY_TARGET;
  for (size_t q = 0; q < kQueries; ++q) {
    row[q * job.stride + words] = ScanTail<Shape>(
        all_planes, job, values + q * kernels::kQueryValues<Shape>, i);
  }
  return HWY_TARGET;
}

template <class Shape, typename T, class Load>
HWY_INLINE int64_t ScanAll(Load load, const kernels::MaskJob& job) {
  constexpr std::make_index_sequence<Shape::kOrder.planes.size()> kAll{};
  constexpr size_t kValues = kernels::kQueryValues<Shape>;
  constexpr size_t kMost = kTogether<Shape>;
  const T* values = static_cast<const T*>(job.queries);
  uint64_t* row = job.rows;
  if (job.is_far) {
    return ScanQueries<Shape, 1, true>(kAll, load, job, values, row);
  }
  if (job.query_count == 1) {
    return ScanQueries<Shape, 1, false>(kAll, load, job, values, row);
  }
  size_t left = job.query_count;
  if constexpr (kMost > 1) {
    for (; left >= kMost; left -= kMost) {
      ScanQueries<Shape, kMost, false>(kAll, load, job, values, row);
      values += kMost * kValues;
      row += kMost * job.stride;
    }
  }
  for (; left != 0; --left) {
    ScanQueries<Shape, 1, false>(kAll, load, job, values, row);
    values += kValues;
    row += job.stride;
  }
  return HWY_TARGET;
}

// Scans objects begin ... end - 1 with every query of the job, and writes their
// words. T is the type of planes and queries, in the order of planes.h. Returns
// HWY_TARGET.
template <class Shape, typename T>
HWY_INLINE int64_t Scan(const kernels::MaskJob& job) {
  if constexpr (kAlignedLoadsPay) {
    if (job.is_aligned) return ScanAll<Shape, T>(LoadAligned(), job);
  }
  return ScanAll<Shape, T>(LoadAll(), job);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_REJECT_INL_H_

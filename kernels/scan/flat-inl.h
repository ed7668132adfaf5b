// Tests all planes of every object at once, without a branch, for one query or
// for several that share each load. This is the way for planes in the caches.
//
// Query planes are passed as a parameter pack of vectors, because an SVE vector
// can be neither an array element nor a member.
#if defined(HALFSPACE_KERNELS_SCAN_FLAT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SCAN_FLAT_INL_H_
#undef HALFSPACE_KERNELS_SCAN_FLAT_INL_H_
#else
#define HALFSPACE_KERNELS_SCAN_FLAT_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "hwy/highway.h"
#include "kernels/compiler.h"
#include "kernels/scan/kernel_table.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Returns run(load), with aligned loads where it pays and all planes are
// aligned at object `begin`.
template <typename T, class Run>
HWY_INLINE auto WithLoad(const detail::Scan& scan, size_t begin,
                         const Run& run) {
  if constexpr (kAlignedLoadsPay && std::is_same_v<T, float>) {
    if ((scan.addresses.bits | begin * sizeof(T)) % 64 == 0) {
      return run(LoadAligned());
    }
  }
  return run(LoadAll());
}

// Returns run(tag), with the vectors for one query.
template <typename T, class Run>
HWY_INLINE auto WithVectors(const detail::Scan& scan, const Run& run) {
#if HALFSPACE_MASKED_COMPARES
  if (scan.is_wide) return run(WordTag<T>());
#else
  (void)scan;
#endif
  return run(OneTag<T>());
}

template <typename T>
QueryValues<T> ValuesOf(const detail::Scan& scan, const T* query) {
  return {query + scan.type->first_max, query};
}

// These are functions, because gcc does not inline lambdas of their size.
// Pointers are copied, because the compiler would load what it finds by a
// pointer again after every store of a word.

template <size_t kMins, class D, typename T, size_t... kPlane>
HWY_INLINE uint64_t TailWord(std::index_sequence<kPlane...>, D d,
                             const T* const* planes, QueryValues<T> query,
                             size_t i, size_t count) {
  const T* copies[] = {planes[kPlane] + i...};
  return KeptTail<kMins, false>(
      d, copies, 0, count, hn::Set(d, query.template Of<kMins>(kPlane))...);
}

// The last, partial word of a row, or a few objects, from object i on. A
// function of its own, because FlatWords() needs more registers.
template <size_t kMins, size_t kMaxs, typename T>
HWY_NOINLINE void FlatTail(const T* const* planes, QueryValues<T> query,
                           size_t i, size_t count, uint64_t* word) noexcept {
  *word = TailWord<kMins>(std::make_index_sequence<kMins + kMaxs>(),
                          WordTag<T>(), planes, query, i, count);
}

template <size_t kMins, class D, typename T, class... V>
HWY_INLINE void WriteWords(D d, bool is_aligned, const T* const* planes,
                           size_t count, uint64_t* row, V... query) {
  size_t i = 0;
  do {
    *row++ = is_aligned ? KeptBits<kMins>(d, LoadAligned(), planes, i, query...)
                        : KeptBits<kMins>(d, LoadAll(), planes, i, query...);
    i += kWordObjects;
  } while (count - i >= kWordObjects);
  if (i == count) return;
  *row = KeptTail<kMins, true>(d, planes, i, count, query...);
}
template <size_t kMins, class D, typename T, size_t... kPlane>
HWY_INLINE void WriteWords(std::index_sequence<kPlane...>, D d,
                           const T* const* planes, QueryValues<T> query,
                           size_t first, size_t count, uint64_t* row) {
  const T* copies[] = {planes[kPlane] + first...};
  bool is_aligned = false;
  if constexpr (kAlignedLoadsPay && std::is_same_v<T, float>) {
    is_aligned = (... | reinterpret_cast<uintptr_t>(copies[kPlane])) % 64 == 0;
  }
  WriteWords<kMins>(d, is_aligned, copies, count, row,
                    hn::Set(d, query.template Of<kMins>(kPlane))...);
}

// The words of objects first ... first + count - 1, at least 64, on the first
// kMins + kMaxs planes.
template <size_t kMins, size_t kMaxs, class D, typename T>
HWY_NOINLINE void FlatWords(const T* const* planes, QueryValues<T> query,
                            size_t first, size_t count,
                            uint64_t* row) noexcept {
  WriteWords<kMins>(std::make_index_sequence<kMins + kMaxs>(), D(), planes,
                    query, first, count, row);
}

// So many objects have their planes in the first-level cache. They are tested
// by vectors of 512 bits, if the target has them: in half of the time of 256
// bits (Zen 5). Out of the second-level cache 256 bits take 0.85 of the time of
// 512.
template <size_t kPlanes, typename T>
inline constexpr size_t kNearObjects = 32 * 1024 / (kPlanes * sizeof(T));

// A MaskKernel (kernel_table.h). It ends by a jump to another function, so it
// saves no registers.
template <size_t kMins, size_t kMaxs, class D>
HWY_INLINE void FlatMask(const void* pointers, size_t first, size_t count,
                         const void* values, uint64_t* row) noexcept {
  using T = hn::TFromD<D>;
  const T* const* planes = static_cast<const T* const*>(pointers);
  const auto query = ValuesOf<kMins, kMaxs>(static_cast<const T*>(values));
  if (count < kWordObjects) {
    if (count != 0) {
      FlatTail<kMins, kMaxs>(planes, query, first, count, row);
    }
  } else if (count <= kNearObjects<kMins + kMaxs, T>) {
    FlatWords<kMins, kMaxs, WordTag<T>>(planes, query, first, count, row);
  } else {
    FlatWords<kMins, kMaxs, D>(planes, query, first, count, row);
  }
}

#if HALFSPACE_MASKED_COMPARES

// How many queries share each load on kPlanes planes. With AVX-512 that takes a
// quarter less time (0.099 to 0.075 ns a pair for the simplex in L1 on Zen 4):
// its 32 registers hold four simplices, and its cores load no more vectors a
// cycle than they compare, one. AVX2 and SSE4 gain nothing, because their cores
// load two vectors a cycle and they have too few registers.
template <size_t kPlanes>
inline constexpr size_t kQueriesAtOnce = kPlanes <= 6 ? 4 : 2;

// Tests kQueries queries from number q of the chunk on, which share each load.
// Masks of the last plane alone take 0.75 to 0.85 of the time of masks of half
// of the planes (Zen 5).
template <size_t kMins, size_t kPlanes, size_t kQueries, typename T>
HWY_NOINLINE void FlatSeveral(const detail::Scan& scan,
                              const detail::Chunk& chunk, size_t q) {
  const WordTag<T> d;
  constexpr size_t kLanes = hn::MaxLanes(WordTag<T>());
  const size_t record = scan.type->plane_count;
  const T* values = static_cast<const T*>(chunk.queries) + q * record;
  uint64_t* const row = chunk.rows + q * chunk.stride;
  const T* planes[kPlanes];
  hn::Vec<WordTag<T>> compared[kPlanes][kQueries];
  for (size_t p = 0; p < kPlanes; ++p) {
    planes[p] = scan.Plane<T>(p);
    for (size_t query = 0; query < kQueries; ++query) {
      const QueryValues<T> its = ValuesOf(scan, values + query * record);
      compared[p][query] = hn::Set(d, its.template Of<kMins>(p));
    }
  }
  const size_t stride = chunk.stride;
  const size_t tail = (chunk.end - chunk.begin) % kWordObjects;
  const size_t end = chunk.end - tail;
  size_t i = chunk.begin;
  for (char* bytes = reinterpret_cast<char*>(row); i < end;
       i += kLanes, bytes += kLanes / 8) {
    WideVerdict<WordTag<T>> verdict[kQueries];
    HALFSPACE_UNROLL
    for (size_t p = 0; p < kPlanes; ++p) {
      const auto object = hn::LoadU(d, planes[p] + i);
      HALFSPACE_UNROLL
      for (size_t query = 0; query < kQueries; ++query) {
        const bool is_first = p == 0;
        const bool is_last = p + 1 == kPlanes;
        if (p < kMins) {
          AddWideVerdict<true>(d, is_first, is_last, object, compared[p][query],
                               verdict[query]);
        } else {
          AddWideVerdict<false>(d, is_first, is_last, object,
                                compared[p][query], verdict[query]);
        }
      }
    }
    HALFSPACE_UNROLL
    for (size_t query = 0; query < kQueries; ++query) {
      const auto left = MaskOf(verdict[query]);
      std::memcpy(bytes + query * stride * sizeof(*row), &left.raw, kLanes / 8);
    }
  }
  if (tail == 0) return;
  for (size_t query = 0; query < kQueries; ++query) {
    FlatTail<kMins, kPlanes - kMins>(
        planes, ValuesOf(scan, values + query * record), i, tail,
        row + (i - chunk.begin) / kWordObjects + query * stride);
  }
}

#endif  // HALFSPACE_MASKED_COMPARES

// Tests all queries of the chunk on the first kMins + kMaxs planes of the scan.
template <size_t kMins, size_t kMaxs, typename T>
int64_t Flat(const detail::Scan& scan, const detail::Chunk& chunk) {
  const T* values = static_cast<const T*>(chunk.queries);
  size_t q = 0;
#if HALFSPACE_MASKED_COMPARES
  constexpr size_t kAtOnce = kQueriesAtOnce<kMins + kMaxs>;
  for (; q + kAtOnce <= chunk.query_count; q += kAtOnce) {
    FlatSeveral<kMins, kMins + kMaxs, kAtOnce, T>(scan, chunk, q);
  }
#endif
  for (; q < chunk.query_count; ++q) {
    // Minima alone are compared with maxima, which the minima of the query
    // precede if it has any.
    const T* compared = values + q * scan.type->plane_count +
                        (kMaxs == 0 ? scan.type->first_max : 0);
    WithVectors<T>(scan, [&](auto d) HWY_ATTR {
      FlatMask<kMins, kMaxs, decltype(d)>(scan.planes, chunk.begin,
                                          chunk.end - chunk.begin, compared,
                                          chunk.rows + q * chunk.stride);
    });
  }
  return HWY_TARGET;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_FLAT_INL_H_

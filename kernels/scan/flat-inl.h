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
#include <type_traits>
#include <utility>

#include "hwy/highway.h"
#include "kernels/scan/kernel_table.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Returns run(load), with aligned loads where planes are aligned and it pays.
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

// The value of a query that plane kPlane is compared with. A minimum is
// compared with the query's maximum; a query's maxima come after its minima, if
// it has minima.
template <size_t kMins, size_t kPlane, typename T>
HWY_INLINE T QueryValue(const T* values, size_t first_max) {
  if constexpr (kPlane < kMins) {
    return values[first_max + kPlane];
  } else {
    return values[kPlane - kMins];
  }
}

template <size_t kMins, typename T, size_t... kPlane>
HWY_INLINE uint64_t WordOf(std::index_sequence<kPlane...>,
                           const detail::Scan& scan, const T* values, size_t i,
                           size_t count) {
  const T* planes[] = {scan.Plane<T>(kPlane)...};
  const WordTag<T> d;
  return KeptTail<kMins>(
      d, planes, i, count,
      hn::Set(d, QueryValue<kMins, kPlane>(values, scan.type->first_max))...);
}

// The last, partial word, from object i on. A function of its own, because
// calls on short ranges need no other.
template <size_t kMins, size_t kMaxs, typename T>
HWY_NOINLINE uint64_t FlatTail(const detail::Scan& scan, const void* query,
                               size_t i, size_t count) {
  return WordOf<kMins>(std::make_index_sequence<kMins + kMaxs>(), scan,
                       static_cast<const T*>(query), i, count);
}

template <size_t kMins, class D, class Load, typename T, class... V>
HWY_INLINE void FlatWords(D d, Load load, const T* const* planes, size_t first,
                          size_t words, uint64_t* row, V... query) {
  for (size_t w = 0; w < words; ++w) {
    row[w] =
        KeptBits<kMins>(d, load, planes, first + w * kWordObjects, query...);
  }
}

// Tests one query of the part, whose values begin at `values`, and writes its
// row. Not inlined: in one function with the code for several queries, which
// needs many registers, a short call would spend nanoseconds on saving them.
template <size_t kMins, class Load, typename T, size_t... kPlane>
HWY_NOINLINE int64_t FlatOne(std::index_sequence<kPlane...>, Load load,
                             const detail::Scan& scan, const detail::Part& part,
                             const T* values, uint64_t* row) {
  // A local copy, because the compiler would reload the pointers after every
  // store of a word.
  const T* planes[] = {scan.Plane<T>(kPlane)...};
  const size_t words = (part.end - part.begin) / kWordObjects;
  const OneTag<T> d;
  FlatWords<kMins>(
      d, load, planes, part.begin, words, row,
      hn::Set(d, QueryValue<kMins, kPlane>(values, scan.type->first_max))...);
  const size_t i = part.begin + words * kWordObjects;
  if (i != part.end) {
    row[words] = FlatTail<kMins, sizeof...(kPlane) - kMins, T>(scan, values, i,
                                                               part.end - i);
  }
  return HWY_TARGET;
}

#if HALFSPACE_MASKED_COMPARES

// How many queries share each load on kPlanes planes. With AVX-512 that takes a
// quarter less time (0.099 to 0.075 ns a pair for the simplex in L1 on Zen 4):
// its 32 registers hold four simplices, and its cores load no more vectors a
// cycle than they compare, one. AVX2 and SSE4 gain nothing, because their cores
// load two vectors a cycle and they have too few registers.
template <size_t kPlanes>
inline constexpr size_t kQueriesAtOnce = kPlanes <= 6 ? 4 : 2;

template <size_t kPlanes, size_t kQueries, class D>
struct QueryVectors {
  hn::Vec<D> planes[kPlanes][kQueries];
};

// Tests one vector of objects on plane kPlane and those after it, for all
// queries.
template <size_t kMins, size_t kPlane, size_t kPlanes, size_t... kQuery,
          class D, typename T>
HWY_INLINE void AddPlanes(
    std::index_sequence<kQuery...> all, D d, const T* const* planes, size_t i,
    const QueryVectors<kPlanes, sizeof...(kQuery), D>& queries,
    hn::Mask<D> (&kept)[sizeof...(kQuery)]) {
  if constexpr (kPlane < kPlanes) {
    constexpr bool kIsMin = kPlane < kMins;
    const hn::Vec<D> object = hn::LoadU(d, planes[kPlane] + i);
    if constexpr (kPlane == 0) {
      ((kept[kQuery] =
            FirstVerdict<kIsMin>(d, object, queries.planes[0][kQuery])),
       ...);
    } else {
      ((kept[kQuery] = NextVerdict<kIsMin>(d, kept[kQuery], object,
                                           queries.planes[kPlane][kQuery])),
       ...);
    }
    AddPlanes<kMins, kPlane + 1>(all, d, planes, i, queries, kept);
  }
}

// ORs the bits of one vector, which begins at bit `shift` of its word, into the
// words of survivors.
template <size_t kMins, size_t kPlanes, size_t... kQuery, class D, typename T>
HWY_INLINE void AddVector(
    std::index_sequence<kQuery...> all, D d, const T* const* planes, size_t i,
    size_t shift, const QueryVectors<kPlanes, sizeof...(kQuery), D>& queries,
    uint64_t (&survivors)[sizeof...(kQuery)]) {
  hn::Mask<D> kept[sizeof...(kQuery)];
  AddPlanes<kMins, 0>(all, d, planes, i, queries, kept);
  ((survivors[kQuery] |= LaneBits(d, kept[kQuery]) << shift), ...);
}

template <size_t kMins, size_t kPlanes, size_t... kVector, size_t... kQuery,
          class D, typename T>
HWY_INLINE void WordOfSeveral(
    std::index_sequence<kVector...>, std::index_sequence<kQuery...> all, D d,
    const T* const* planes, size_t i,
    const QueryVectors<kPlanes, sizeof...(kQuery), D>& queries, uint64_t* row,
    size_t stride) {
  constexpr size_t kLanes = hn::MaxLanes(D());
  uint64_t survivors[sizeof...(kQuery)] = {};
  (AddVector<kMins>(all, d, planes, i + kVector * kLanes, kVector * kLanes,
                    queries, survivors),
   ...);
  ((row[kQuery * stride] = survivors[kQuery]), ...);
}

// Tests queries q, q + 1, ... of the part, which share each load.
template <size_t kMins, typename T, size_t... kPlane, size_t... kQuery>
HWY_NOINLINE void FlatSeveral(std::index_sequence<kPlane...>,
                              std::index_sequence<kQuery...> all_queries,
                              const detail::Scan& scan,
                              const detail::Part& part, size_t q) {
  const WordTag<T> d;
  constexpr std::make_index_sequence<kWordObjects / hn::MaxLanes(WordTag<T>())>
      kVectors{};
  const T* planes[] = {scan.Plane<T>(kPlane)...};
  const T* values =
      static_cast<const T*>(part.queries) + q * scan.type->plane_count;
  const size_t words = (part.end - part.begin) / kWordObjects;
  uint64_t* row = part.rows + q * part.stride;
  QueryVectors<sizeof...(kPlane), sizeof...(kQuery), WordTag<T>> queries;
  const auto set_query = [&](size_t query) HWY_ATTR {
    const T* of_query = values + query * scan.type->plane_count;
    ((queries.planes[kPlane][query] = hn::Set(
          d, QueryValue<kMins, kPlane>(of_query, scan.type->first_max))),
     ...);
  };
  (set_query(kQuery), ...);
  for (size_t w = 0; w < words; ++w) {
    WordOfSeveral<kMins>(kVectors, all_queries, d, planes,
                         part.begin + w * kWordObjects, queries, row + w,
                         part.stride);
  }
  const size_t i = part.begin + words * kWordObjects;
  if (i == part.end) return;
  for (size_t query = 0; query < sizeof...(kQuery); ++query) {
    row[query * part.stride + words] =
        FlatTail<kMins, sizeof...(kPlane) - kMins, T>(
            scan, values + query * scan.type->plane_count, i, part.end - i);
  }
}

#endif  // HALFSPACE_MASKED_COMPARES

// Tests all queries of the part, with aligned or unaligned loads.
template <size_t kMins, typename T, class Planes, class Load>
HWY_INLINE int64_t FlatAll(Planes all_planes, Load load,
                           const detail::Scan& scan, const detail::Part& part) {
  // Returns at once, so that a call for one query ends with a jump.
  if (part.query_count == 1) {
    return FlatOne<kMins>(all_planes, load, scan, part,
                          static_cast<const T*>(part.queries), part.rows);
  }
  size_t q = 0;
#if HALFSPACE_MASKED_COMPARES
  constexpr size_t kAtOnce = kQueriesAtOnce<all_planes.size()>;
  for (; q + kAtOnce <= part.query_count; q += kAtOnce) {
    FlatSeveral<kMins, T>(all_planes, std::make_index_sequence<kAtOnce>(), scan,
                          part, q);
  }
#endif
  for (; q < part.query_count; ++q) {
    FlatOne<kMins>(
        all_planes, load, scan, part,
        static_cast<const T*>(part.queries) + q * scan.type->plane_count,
        part.rows + q * part.stride);
  }
  return HWY_TARGET;
}

// Tests all queries of the part on the first kMins + kMaxs planes of the scan.
template <size_t kMins, size_t kMaxs, typename T>
int64_t Flat(const detail::Scan& scan, const detail::Part& part) {
  constexpr std::make_index_sequence<kMins + kMaxs> kPlanes{};
  return WithLoad<T>(scan, part.begin, [&](auto load) HWY_ATTR {
    return FlatAll<kMins, T>(kPlanes, load, scan, part);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_FLAT_INL_H_

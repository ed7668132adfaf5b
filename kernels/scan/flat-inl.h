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

// The value of a query that plane p is compared with. A minimum is compared
// with the query's maximum; a query's maxima come after its minima, if it has
// minima.
template <size_t kMins, typename T>
HWY_INLINE T QueryValue(const detail::Scan& scan, const T* values, size_t p) {
  return values[p < kMins ? scan.type->first_max + p : p - kMins];
}

// The last, partial word, from object i on. A function of its own, because
// calls on short ranges need no other.
template <size_t kMins, size_t kMaxs, typename T>
HWY_NOINLINE uint64_t FlatTail(const detail::Scan& scan, const void* query,
                               size_t i, size_t count) {
  const WordTag<T> d;
  const T* values = static_cast<const T*>(query);
  const auto word = [&]<size_t... kPlane>(std::index_sequence<kPlane...>)
      HWY_ATTR {
    const T* planes[] = {scan.Plane<T>(kPlane)...};
    return KeptTail<kMins>(
        d, planes, i, count,
        hn::Set(d, QueryValue<kMins>(scan, values, kPlane))...);
  };
  return word(std::make_index_sequence<kMins + kMaxs>());
}

// Tests one query of the part, whose values begin at `values`, and writes its
// row. Not inlined: in one function with the code for several queries, which
// needs many registers, a short call would spend nanoseconds on saving them.
template <size_t kMins, size_t kMaxs, class Load, typename T>
HWY_NOINLINE int64_t FlatOne(Load load, const detail::Scan& scan,
                             const detail::Part& part, const T* values,
                             uint64_t* row) {
  const OneTag<T> d;
  // Local copies, because the compiler would load what it finds by a pointer
  // again after every store of a word.
  const size_t first = part.begin;
  const size_t count = part.end - first;
  const size_t words = count / kWordObjects;
  const auto write = [&](const T* const* planes, auto... query) HWY_ATTR {
    for (size_t w = 0; w < words; ++w) {
      row[w] =
          KeptBits<kMins>(d, load, planes, first + w * kWordObjects, query...);
    }
  };
  const auto test = [&]<size_t... kPlane>(std::index_sequence<kPlane...>)
      HWY_ATTR {
    const T* planes[] = {scan.Plane<T>(kPlane)...};
    write(planes, hn::Set(d, QueryValue<kMins>(scan, values, kPlane))...);
  };
  test(std::make_index_sequence<kMins + kMaxs>());
  const size_t left = count % kWordObjects;
  if (left != 0) {
    row[words] = FlatTail<kMins, kMaxs, T>(scan, values,
                                           first + words * kWordObjects, left);
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

// Tests kQueries queries from number q of the part on, which share each load.
template <size_t kMins, size_t kPlanes, size_t kQueries, typename T>
HWY_NOINLINE void FlatSeveral(const detail::Scan& scan,
                              const detail::Part& part, size_t q) {
  const WordTag<T> d;
  constexpr size_t kLanes = hn::MaxLanes(WordTag<T>());
  const size_t record = scan.type->plane_count;
  const T* values = static_cast<const T*>(part.queries) + q * record;
  uint64_t* row = part.rows + q * part.stride;
  const T* planes[kPlanes];
  hn::Vec<WordTag<T>> compared[kPlanes][kQueries];
  for (size_t p = 0; p < kPlanes; ++p) {
    planes[p] = scan.Plane<T>(p);
    for (size_t query = 0; query < kQueries; ++query) {
      compared[p][query] =
          hn::Set(d, QueryValue<kMins>(scan, values + query * record, p));
    }
  }
  const size_t end = part.end;
  const size_t stride = part.stride;
  size_t i = part.begin;
  for (; i + kWordObjects <= end; i += kWordObjects, ++row) {
    uint64_t survivors[kQueries] = {};
    for (size_t l = 0; l < kWordObjects; l += kLanes) {
      hn::Mask<WordTag<T>> kept[kQueries];
#pragma GCC unroll 16
      for (size_t p = 0; p < kPlanes; ++p) {
        const auto object = hn::LoadU(d, planes[p] + i + l);
#pragma GCC unroll 16
        for (size_t query = 0; query < kQueries; ++query) {
          const auto value = compared[p][query];
          if (p == 0) {
            kept[query] = FirstVerdict<(kMins > 0)>(d, object, value);
          } else if (p < kMins) {
            kept[query] = NextVerdict<true>(d, kept[query], object, value);
          } else {
            kept[query] = NextVerdict<false>(d, kept[query], object, value);
          }
        }
      }
      for (size_t query = 0; query < kQueries; ++query) {
        survivors[query] |= LaneBits(d, kept[query]) << l;
      }
    }
    for (size_t query = 0; query < kQueries; ++query) {
      row[query * stride] = survivors[query];
    }
  }
  if (i == end) return;
  for (size_t query = 0; query < kQueries; ++query) {
    row[query * stride] = FlatTail<kMins, kPlanes - kMins, T>(
        scan, values + query * record, i, end - i);
  }
}

#endif  // HALFSPACE_MASKED_COMPARES

// Tests all queries of the part on the first kMins + kMaxs planes of the scan.
template <size_t kMins, size_t kMaxs, typename T>
int64_t Flat(const detail::Scan& scan, const detail::Part& part) {
  return WithLoad<T>(scan, part.begin, [&](auto load) HWY_ATTR {
    const T* values = static_cast<const T*>(part.queries);
    // Returns at once, so that a call for one query ends with a jump.
    if (part.query_count == 1) {
      return FlatOne<kMins, kMaxs>(load, scan, part, values, part.rows);
    }
    size_t q = 0;
#if HALFSPACE_MASKED_COMPARES
    constexpr size_t kAtOnce = kQueriesAtOnce<kMins + kMaxs>;
    for (; q + kAtOnce <= part.query_count; q += kAtOnce) {
      FlatSeveral<kMins, kMins + kMaxs, kAtOnce, T>(scan, part, q);
    }
#endif
    for (; q < part.query_count; ++q) {
      FlatOne<kMins, kMaxs>(load, scan, part,
                            values + q * scan.type->plane_count,
                            part.rows + q * part.stride);
    }
    return int64_t{HWY_TARGET};
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_FLAT_INL_H_

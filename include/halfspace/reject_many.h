// Several queries: which of the stored bounds could each of them touch?
//
//   std::vector<std::size_t> counts(queries.size());
//   halfspace::SurvivorCounts(world, queries, counts);
//
// The results are those of reject.h for each query. A call loads one tile of
// the world into the L1 cache and tests all queries there, then it loads the
// next tile. So it reads a world that is larger than the caches once for all
// queries, not once per query. (Over quantized bounds it reads the world once
// per 256 queries.) On targets with enough registers, such as AVX-512, several
// queries also share each load.
//
// Every call takes
//   world    as in reject.h; may be empty
//   queries  any number of the world's Query type, also none; NaNs and empty
//            queries have the same effect as in reject.h
//   options  as in reject.h
//
// Threads share the work of a call by ranges of objects (Options::range). Give
// each thread a range and outputs of its own. To write rows of masks together,
// give each thread its words of the same rows (`row_words`).
//
// Errors, floating-point mode and the layout of masks: as RejectMask() in
// reject.h. The queries must not be null or misaligned, unless there are none.
//
// Thread safety: as in reject.h. A call allocates nothing and uses up to 32 KiB
// of stack.
//
// Source: "The Bounding Simplex: A SIMD-Era Rejection Primitive" (the tests).
#ifndef HALFSPACE_REJECT_MANY_H_
#define HALFSPACE_REJECT_MANY_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/scan.h"
#include "halfspace/reject.h"
#include "halfspace/span.h"
#include "halfspace/target.h"

namespace halfspace {

// Writes the survivor mask of every query.
//
// The mask of queries[q] is row q. A row has MaskWords(n) words for the n
// objects of `options.range`. Row q begins at rows[q * row_words]. If
// `row_words` is 0, rows follow each other without a gap. A larger number than
// MaskWords(n) writes a range of objects into the rows of a larger mask: the
// call does not touch the words between two rows.
//
// Errors: as RejectMask(). `row_words` must be 0 or at least MaskWords(n), and
// `rows` must have room for all rows; the last one needs MaskWords(n) words
// only. Without queries or without objects, `rows` may be empty.
template <typename AnyWorld>
void SurvivorMasks(const AnyWorld& world,
                   Span<const typename AnyWorld::Query> queries,
                   Span<std::uint64_t> rows, const Options& options = {},
                   std::size_t row_words = 0) {
  detail::SurvivorMasks(
      detail::ScanOf(world.view(), queries.data(), queries.size()), rows,
      options, row_words);
}

// Writes every surviving pair and returns the number of pairs. Pair j is the
// query `query_indices[j]` and the object `object_indices[j]`. Object indices
// are positions in the world, also with a range.
//
// Pairs are written tile by tile. The pairs of one query are in ascending order
// of objects. Pairs of other queries can be between them.
//
// The spans may be shorter than the result. The call then writes as many pairs
// as the shorter span can hold, and still returns the number of all pairs. It
// does not write the first `skip` of them, so that a long result can be fetched
// in pieces. The order of pairs depends on the world, the queries and the range
// alone.
//
// Errors: as RejectMask(). The world must have at most 2^32 objects, and there
// must be at most 2^32 queries. The parts of the two spans that the call can
// write must not overlap.
template <typename AnyWorld>
[[nodiscard]] std::size_t SurvivorPairs(
    const AnyWorld& world, Span<const typename AnyWorld::Query> queries,
    Span<std::uint32_t> query_indices, Span<std::uint32_t> object_indices,
    const Options& options = {}, std::size_t skip = 0) {
  return detail::SurvivorPairs(
      detail::ScanOf(world.view(), queries.data(), queries.size()),
      query_indices, object_indices, options, skip);
}

// Writes to counts[q] the number of survivors of queries[q].
//
// Errors: as RejectMask(). `counts.size()` must be at least `queries.size()`.
template <typename AnyWorld>
void SurvivorCounts(const AnyWorld& world,
                    Span<const typename AnyWorld::Query> queries,
                    Span<std::size_t> counts, const Options& options = {}) {
  detail::SurvivorCounts(
      detail::ScanOf(world.view(), queries.data(), queries.size()), counts,
      options);
}

}  // namespace halfspace

#endif  // HALFSPACE_REJECT_MANY_H_

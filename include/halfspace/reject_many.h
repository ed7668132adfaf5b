// The calls for several queries: Q queries against N objects.
//
// The answers are those of reject.h for each query. The work is done in tiles:
// a tile of the world is brought into the first-level cache once, and all
// queries (over quantized bounds, 256 at a time) are tested there. So a world
// that is larger than the caches is read once for all queries and not once for
// each. Where there are enough registers, as with AVX-512, several queries also
// share each load.
//
// Every call takes
//   world    as in reject.h: floats, doubles or quantized bounds
//   queries  any number, of the world's Query type; a NaN or an empty query is
//            treated as in reject.h
//   options  as in reject.h. Threads share the work by ranges of objects: give
//            each thread a range, and outputs of its own, or, if these are rows
//            of masks, its words of the same rows (Options::row_words)
//
// Errors, thread safety and the meaning of masks are those of reject.h. Two
// more preconditions: the two lists of SurvivorPairs do not overlap where they
// are written, and with 32-bit indices there are at most 2^32 queries. Nothing
// is allocated: a call uses up to 32 KiB of stack. An empty world and an empty
// list of queries are valid.
//
// Source: "The Bounding Simplex: A SIMD-Era Rejection Primitive" (the tests).
#ifndef HALFSPACE_REJECT_MANY_H_
#define HALFSPACE_REJECT_MANY_H_

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "halfspace/detail/scan.h"
#include "halfspace/reject.h"
#include "halfspace/span.h"
#include "halfspace/targets.h"

namespace halfspace {

// Writes the reject mask of every query. The mask of queries[q] is row q: the
// MaskWords(objects of the range) words of `rows` from q * stride on. The
// stride is options.row_words, or, if that is 0, the words of a row. `rows` has
// room for all rows.
//   Throws also if options.row_words is neither 0 nor enough for a row.
template <typename AnyWorld>
void RejectMasks(const AnyWorld& world,
                 Span<const typename AnyWorld::Query> queries,
                 Span<std::uint64_t> rows, const Options& options = {}) {
  detail::RejectMasks(detail::ScanOf(world, queries), rows, options);
}

// The same with survivor masks.
template <typename AnyWorld>
void SurvivorMasks(const AnyWorld& world,
                   Span<const typename AnyWorld::Query> queries,
                   Span<std::uint64_t> rows, const Options& options = {}) {
  detail::SurvivorMasks(detail::ScanOf(world, queries), rows, options);
}

// Writes every surviving pair, as query_indices[j] and object_indices[j], and
// returns the number of pairs. Pairs come tile by tile: those of one query are
// in ascending order of objects, with pairs of other queries between them. If
// the shorter span is too short, it is filled and the full number is returned.
// At most 2^32 objects and queries. The spans must not overlap.
template <typename AnyWorld>
[[nodiscard]] std::size_t SurvivorPairs(
    const AnyWorld& world, Span<const typename AnyWorld::Query> queries,
    Span<std::uint32_t> query_indices, Span<std::uint32_t> object_indices,
    const Options& options = {}) {
  return detail::SurvivorPairs(detail::ScanOf(world, queries), query_indices,
                               object_indices, options);
}

// Writes to counts[q] how many objects survive queries[q]. `counts` has room
// for all queries.
template <typename AnyWorld>
void SurvivorCounts(const AnyWorld& world,
                    Span<const typename AnyWorld::Query> queries,
                    Span<std::size_t> counts, const Options& options = {}) {
  detail::SurvivorCounts(detail::ScanOf(world, queries), counts, options);
}

// The survivors of a few queries among some consecutive objects of the world.
struct SurvivorTile {
  std::size_t first_query = 0;
  std::size_t queries = 0;
  std::size_t first_object = 0;  // a multiple of 64 after the range's begin
  std::size_t objects = 0;

  // The survivor mask of query first_query + q; bit 0 of word 0 is
  // first_object. Valid until the callback returns.
  Span<const std::uint64_t> Row(std::size_t q) const {
    return {rows + q * stride, MaskWords(objects)};
  }

  const std::uint64_t* rows = nullptr;
  std::size_t stride = 0;  // words from one row to the next
};

// Calls function(const SurvivorTile&) for every tile; each pair of a query and
// an object is in exactly one tile. Use it to process survivors while they are
// in the cache, without storing them. A function that returns a bool ends the
// call by returning false. Exceptions of the function pass through.
template <typename AnyWorld, typename Function>
void ForEachTile(const AnyWorld& world,
                 Span<const typename AnyWorld::Query> queries,
                 Function&& function, const Options& options = {}) {
  // Also of what no pointer to data can name: a function.
  auto call = [&function](const SurvivorTile& tile) {
    if constexpr (std::is_same_v<decltype(function(tile)), bool>) {
      return function(tile);
    } else {
      function(tile);
      return true;
    }
  };
  detail::ForEachTile(
      detail::ScanOf(world, queries),
      [](void* context, const SurvivorTile& tile) {
        return (*static_cast<decltype(call)*>(context))(tile);
      },
      &call, options);
}

}  // namespace halfspace

#endif  // HALFSPACE_REJECT_MANY_H_

// The calls for many queries at once: Q queries against N objects.
//
// The answers are those of reject.h for each query; the work is done in tiles.
// A tile of the world is brought into the first-level cache once, and all
// queries (of quantized bounds 256 at a time) are tested there, so that a world
// out of the caches costs its bytes once for all of them and not once for each.
// Where registers allow it, as with AVX-512, several queries share each load.
//
// Every call takes
//   world    as the calls of reject.h: floats, doubles or quantized bounds
//   queries  any number, of the world's Query type; NaN and empty queries as
//            there
//   options  as there; a range of objects is how threads share the work: give
//            each thread a range, and outputs of its own, or, where these are
//            rows of masks, its columns of the same rows (Options::row_words)
//
// Errors, thread safety and the meaning of masks are those of reject.h. Errors
// too are lists of pairs that overlap one another where they are written, and
// more than 2^32 queries with 32-bit indices. Nothing is allocated: a call
// works on up to 32 KiB of stack. An empty world, and no queries, are fine.
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

// Writes the reject mask of every query. Row q, the mask of queries[q], is the
// MaskWords(objects of the range) words of `rows` from q * options.row_words
// on, or, if that is 0, from q times so many words on. `rows` has room for all.
// Throws also if options.row_words is neither 0 nor enough for a row.
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

// Writes every surviving pair: query_indices[j] and object_indices[j]. Pairs
// come tile by tile: those of one query in ascending order of objects, but not
// side by side. What fits in the shorter span is written, and the number of all
// pairs is returned. At most 2^32 objects and queries. The spans must not
// overlap.
template <typename AnyWorld>
[[nodiscard]] std::size_t SurvivorPairs(
    const AnyWorld& world, Span<const typename AnyWorld::Query> queries,
    Span<std::uint32_t> query_indices, Span<std::uint32_t> object_indices,
    const Options& options = {}) {
  return detail::SurvivorPairs(detail::ScanOf(world, queries), query_indices,
                               object_indices, options);
}

// Writes how many objects survive each query: counts[q] of queries[q]. `counts`
// has room for all.
template <typename AnyWorld>
void SurvivorCounts(const AnyWorld& world,
                    Span<const typename AnyWorld::Query> queries,
                    Span<std::size_t> counts, const Options& options = {}) {
  detail::SurvivorCounts(detail::ScanOf(world, queries), counts, options);
}

// The survivors of a few queries in a part of the world.
struct SurvivorTile {
  std::size_t first_query = 0;
  std::size_t queries = 0;
  std::size_t first_object = 0;  // a multiple of 64 after the range's begin
  std::size_t objects = 0;

  // The survivor mask of query first_query + q: bit 0 of word 0 is
  // first_object. Valid during the call that gives it.
  Span<const std::uint64_t> Row(std::size_t q) const {
    return {rows + q * stride, MaskWords(objects)};
  }

  const std::uint64_t* rows = nullptr;
  std::size_t stride = 0;  // words from one row to the next
};

// Calls `function`, anything that takes a const SurvivorTile&, for every tile:
// each pair of a query and an object is in one of them. For survivors that are
// to be used while they are in the cache, and never stored. A function that
// returns a bool ends the call by returning false. What it throws passes
// through.
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

// A scan in chunks. A tile of the world stays in the first-level cache while
// all batches of queries are tested against it. Survivors of quantized bounds
// are tested again by the floats, one chunk later.
#ifndef HALFSPACE_DISPATCH_SCAN_CHUNKS_H_
#define HALFSPACE_DISPATCH_SCAN_CHUNKS_H_

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "dispatch/scan/prepare.h"
#include "halfspace/detail/scan.h"
#include "kernels/compiler.h"
#include "kernels/scan/kernel_table.h"

namespace halfspace::dispatch {

using detail::Chunk;
using detail::kMostQueries;
using detail::Scan;

// A row is the words of one query on at most kRowObjects objects. A chunk is
// one row of each query of a batch, or up to kRowsOfOne rows of one query.
inline constexpr std::size_t kRowWords = 64;
inline constexpr std::size_t kRowObjects = 64 * kRowWords;
inline constexpr std::size_t kRowsOfOne = 4;

// The words of a chunk, and which of them are nonzero.
struct Tested {
  // Up to kMostListed survivors of quantized bounds are listed. If a row has
  // one or two, each loop over words and bits is mispredicted once in each row,
  // and there would be three such loops.
  static constexpr std::size_t kMostListed = 64;

  Chunk chunk;
  std::size_t row_count;
  std::uint64_t nonzero[kMostQueries];  // words, of each row
  std::size_t candidates;               // their number, listed or not
  std::uint16_t list[kMostListed];      // row * kRowObjects + object

  bool is_one() const { return chunk.query_count == 1; }
  std::size_t words() const { return MaskWords(chunk.end - chunk.begin); }
  std::size_t WordsInRow(std::size_t row) const {
    return is_one() ? std::min(kRowWords, words() - row * kRowWords) : words();
  }
  std::size_t QueryOfRow(std::size_t row) const {
    return chunk.first_query + (is_one() ? 0 : row);
  }
  std::size_t ObjectOfRow(std::size_t row) const {
    return chunk.begin + (is_one() ? row * kRowObjects : 0);
  }
  std::uint64_t* RowWords(std::size_t row) const {
    return chunk.rows + (is_one() ? row * kRowWords : row * chunk.stride);
  }
};

// Test a candidate, a survivor of quantized bounds, on the floats (chunks.cc).
bool FloatsReject(const Scan& scan, std::size_t query, std::size_t object);
void PrefetchFloats(const Scan& scan, std::size_t object);

// Divides the planes of objects begin ... begin + objects - 1, as far as these
// exist, into `shares` shares, and prefetches share number `share`. Without
// this, the first batch on a tile would wait for memory line by line.
void PrefetchTile(const Scan& scan, std::size_t begin, std::size_t objects,
                  std::size_t share, std::size_t shares);

// One query is tested on a few rows at a time, because more work between
// prefetching floats and reading them hides more of their latency. Several
// queries are tested on a tile that leaves room for the words in the
// first-level cache: with 32 KiB a box took 4 % more time on Zen 4. The second
// half of quantized planes is rarely read, so it does not count.
inline std::size_t ChunkObjects(const Scan& scan) {
  constexpr std::size_t kTileBytes = 28 * 1024;
  constexpr std::size_t kQuantizedTileBytes = 32 * 1024;
  if (scan.query_count == 1) return kRowsOfOne * kRowObjects;
  const std::size_t bytes =
      scan.type->encode != nullptr ? kQuantizedTileBytes : kTileBytes;
  return std::min(kRowObjects, bytes / scan.type->record_bytes / 64 * 64);
}

// Calls visit(row, object of the row) for every bit of the words.
template <typename Visit>
HALFSPACE_ALWAYS_INLINE void ForEachBit(const Tested& tested,
                                        const Visit& visit) {
  for (std::size_t row = 0; row < tested.row_count; ++row) {
    const std::uint64_t* const words = tested.RowWords(row);
    for (std::uint64_t nonzero = tested.nonzero[row]; nonzero != 0;
         nonzero &= nonzero - 1) {
      const auto w = static_cast<std::size_t>(std::countr_zero(nonzero));
      for (std::uint64_t left = words[w]; left != 0; left &= left - 1) {
        visit(row, 64 * w + static_cast<std::size_t>(std::countr_zero(left)));
      }
    }
  }
}

// Calls visit() for every candidate, from their list if they are few.
template <typename Visit>
void ForEachCandidate(const Tested& tested, const Visit& visit) {
  if (tested.candidates > Tested::kMostListed) return ForEachBit(tested, visit);
  for (std::size_t c = 0; c < tested.candidates; ++c) {
    visit(tested.list[c] / kRowObjects, tested.list[c] % kRowObjects);
  }
}

inline void FindNonzero(const Scan& scan, Tested& tested) {
  tested.row_count = tested.is_one()
                         ? (tested.words() + kRowWords - 1) / kRowWords
                         : tested.chunk.query_count;
  for (std::size_t row = 0; row < tested.row_count; ++row) {
    tested.nonzero[row] = scan.kernels->nonzero_words(tested.RowWords(row),
                                                      tested.WordsInRow(row));
  }
}

// Tests a chunk on quantized bounds that floats refine: writes its words, and
// prefetches and lists the candidates.
//
// Only the minima of octahedra are tested. They usually leave so few candidates
// that testing these by their floats is faster than testing the maxima, which
// are four more cache lines for each word. If more than a quarter of the words
// are nonzero, the maxima are tested too.
inline void FindCandidates(const Scan& scan, Tested& tested) {
  bool is_tested = false;
  if (scan.kernel == detail::kBySimplex) {
    const detail::ScanKernel minima =
        scan.is_streaming ? detail::kMinimaStreaming : detail::kMinima;
    scan.kernels->run[minima](scan, tested.chunk);
    FindNonzero(scan, tested);
    const std::uint64_t rows =
        tested.row_count == 0 ? 0
                              : ~std::uint64_t{0} >> (64 - tested.row_count);
    is_tested = 4 * scan.kernels->count_bits(tested.nonzero, rows) <=
                tested.chunk.query_count * tested.words();
  }
  if (!is_tested) {
    Run(scan, tested.chunk);
    FindNonzero(scan, tested);
  }
  std::size_t count = 0;
  ForEachBit(tested, [&](std::size_t row, std::size_t object) {
    PrefetchFloats(scan, tested.ObjectOfRow(row) + object);
    if (count < Tested::kMostListed) {
      tested.list[count] =
          static_cast<std::uint16_t>(row * kRowObjects + object);
    }
    ++count;
  });
  tested.candidates = count;
}

// Clears the bits of candidates that the floats reject.
inline void Refine(const Scan& scan, Tested& tested) {
  ForEachCandidate(tested, [&](std::size_t row, std::size_t object) {
    const std::uint64_t rejected = FloatsReject(
        scan, tested.QueryOfRow(row), tested.ObjectOfRow(row) + object);
    std::uint64_t& word = tested.RowWords(row)[object / 64];
    word &= ~(rejected << object % 64);
    if (word == 0) tested.nonzero[row] &= ~(std::uint64_t{1} << object / 64);
  });
}

// How a call goes through its scan:
//   kBlock     so many queries are encoded at a time
//   kRows      a chunk has at most so many rows
//   kOneRow    one query on at most so many objects is one row, without chunks
//   kIsUrgent  a survivor is wanted soon. It is often among the first kOneRow
//              objects, so these are the first chunk.
struct OneQuery {
  static constexpr std::size_t kBlock = 1;
  static constexpr std::size_t kRows = kRowsOfOne;
  static constexpr std::size_t kOneRow = kRowObjects;
  static constexpr bool kIsUrgent = false;
};
struct UrgentQuery {
  static constexpr std::size_t kBlock = 1;
  static constexpr std::size_t kRows = 1;
  static constexpr std::size_t kOneRow = 512;
  static constexpr bool kIsUrgent = true;
};
struct ManyQueries {
  static constexpr std::size_t kBlock = 256;
  static constexpr std::size_t kRows = kMostQueries;
  static constexpr std::size_t kOneRow = 0;
  static constexpr bool kIsUrgent = false;
};

// Rows on the stack, for two chunks.
template <typename Queries>
struct Rows {
  void operator()(Chunk& chunk, std::size_t turn) {
    chunk.rows = words[turn];
    chunk.stride = kRowWords;
  }
  std::uint64_t words[2][Queries::kRows * kRowWords];
};

// Calls test(chunk) for every batch of queries on every tile of objects, until
// it returns false. Returns whether it never did. The rows of the chunks are
// not set.
//
// Queries are encoded once for all tiles, kBlock at a time. kBlock is so large
// that reading the world again for the next block costs little.
template <typename Queries, typename Test>
HALFSPACE_ALWAYS_INLINE bool ForEachChunk(const Scan& scan, const Test& test) {
  const detail::ScanType& type = *scan.type;
  alignas(16) std::byte
      quantized[Queries::kBlock * detail::kMaxPlanes * sizeof(std::int16_t)];
  const std::size_t most =
      type.encode != nullptr ? Queries::kBlock : scan.query_count;
  for (std::size_t first = 0; first < scan.query_count; first += most) {
    const std::size_t block = std::min(most, scan.query_count - first);
    const auto* queries = static_cast<const std::byte*>(scan.queries);
    if (type.encode != nullptr) {
      type.encode(scan, first, block, quantized);
      queries = quantized;
    }
    const std::size_t batches = (block + kMostQueries - 1) / kMostQueries;
    std::size_t objects =
        Queries::kIsUrgent ? Queries::kOneRow : ChunkObjects(scan);
    for (std::size_t begin = scan.begin, end; begin < scan.end; begin = end) {
      end = std::min(scan.end - begin, objects) + begin;
      for (std::size_t b = 0; b < batches; ++b) {
        if (batches > 1) PrefetchTile(scan, end, objects, b, batches);
        const std::size_t q = b * kMostQueries;
        if (!test(Chunk{.first_query = first + q,
                        .query_count = std::min(kMostQueries, block - q),
                        .queries = queries + q * type.record_bytes,
                        .begin = begin,
                        .end = end,
                        .rows = nullptr,
                        .stride = 0})) {
          return false;
        }
      }
      if (Queries::kIsUrgent) objects = kRowObjects;
    }
  }
  return true;
}

// Tests every chunk and calls visit(tested), until it returns false. Bounds
// that floats refine are refined one chunk later, unless a survivor is urgent,
// because their floats are still being fetched.
//
// place(chunk, turn) sets the rows and the stride of a chunk. The rows of two
// turns are in use at the same time. `tested` says which words are nonzero only
// if bounds are refined.
template <typename Queries, typename Place, typename Visit>
void VisitChunks(const Scan& scan, Place& place, const Visit& visit) {
  Tested chunks[2];
  Tested* last = nullptr;  // the chunk that waits to be refined, or null
  const auto refine = [&](Tested* tested) {
    if (tested == nullptr) return true;
    Refine(scan, *tested);
    return visit(*tested);
  };
  const bool visited = ForEachChunk<Queries>(scan, [&](const Chunk& chunk) {
    Tested* const tested = &chunks[last == &chunks[0]];
    tested->chunk = chunk;
    place(tested->chunk, last == &chunks[0]);
    if (!scan.type->is_refined) {
      Run(scan, tested->chunk);
      return visit(*tested);
    }
    FindCandidates(scan, *tested);
    return refine(Queries::kIsUrgent ? tested : std::exchange(last, tested));
  });
  if (visited) refine(last);
}

// Visits all chunks, with their rows on the stack. `tested` always says which
// words are nonzero. Not inlined, so that a call of one row needs neither its
// stack nor its registers.
template <typename Queries, typename Visit>
HALFSPACE_NOINLINE void VisitRows(const Scan& scan, const Visit& visit) {
  Rows<Queries> rows;
  VisitChunks<Queries>(scan, rows, [&](Tested& tested) {
    if (!scan.type->is_refined) FindNonzero(scan, tested);
    return visit(tested);
  });
}

// The words of one query on all objects of a scan of at most one row.
inline Tested OneRow(const Scan& scan, std::uint64_t* words,
                     std::uint64_t nonzero) {
  Tested tested;
  tested.chunk = WholeRange(scan, words);
  tested.row_count = 1;
  tested.nonzero[0] = nonzero;
  return tested;
}

// Tests all objects of a prepared scan. Calls visit(tested) with the words of
// one chunk after another, until it returns false. A scan of one row is one
// chunk, without the cost of chunks.
template <typename Queries, typename Visit>
HALFSPACE_ALWAYS_INLINE void VisitWords(Scan& scan, const Options& options,
                                        const Visit& visit) {
  if constexpr (Queries::kOneRow != 0) {
    const std::size_t objects = scan.end - scan.begin;
    if (objects <= Queries::kOneRow && scan.type->encode == nullptr) {
      std::uint64_t words[Queries::kOneRow / 64];
      WriteWords(scan, options, words);
      const std::size_t count = MaskWords(objects);
      visit(OneRow(scan, words,
                   count == 1 ? words[0] != 0
                              : scan.kernels->nonzero_words(words, count)));
      return;
    }
  }
  ChooseKernel(scan, options);
  VisitRows<Queries>(scan, visit);
}

// Calls visit(query, object) for every survivor. Within a chunk, the objects of
// each query ascend.
template <typename Visit>
HALFSPACE_ALWAYS_INLINE void ForEachSurvivor(const Tested& tested,
                                             const Visit& visit) {
  ForEachBit(tested, [&](std::size_t row, std::size_t object) {
    visit(tested.QueryOfRow(row), tested.ObjectOfRow(row) + object);
  });
}

// Calls visit(query, number of survivors) for every row.
template <typename Visit>
void ForEachCount(const Scan& scan, const Tested& tested, const Visit& visit) {
  for (std::size_t row = 0; row < tested.row_count; ++row) {
    visit(tested.QueryOfRow(row),
          scan.kernels->count_bits(tested.RowWords(row), tested.nonzero[row]));
  }
}

// Turns survivor masks into reject masks, and back.
inline void Flip(std::uint64_t* words, std::size_t count) {
  for (std::size_t w = 0; w < count; ++w) words[w] = ~words[w];
}

// Writes the masks of all queries; row q begins at rows + q * stride, with the
// range's first object.
template <typename Queries>
void WriteRows(const Scan& scan, std::uint64_t* rows, std::size_t stride) {
  const auto place = [&](Chunk& chunk, std::size_t) {
    chunk.rows =
        rows + chunk.first_query * stride + (chunk.begin - scan.begin) / 64;
    chunk.stride = stride;
  };
  VisitChunks<Queries>(scan, place, [](const Tested&) { return true; });
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_SCAN_CHUNKS_H_

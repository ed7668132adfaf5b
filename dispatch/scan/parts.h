// A scan in parts: tiles of the world that stay in the first-level cache while
// batch after batch of queries is tested against them. Survivors of quantized
// bounds are refined by the floats one part later.
#ifndef HALFSPACE_DISPATCH_SCAN_PARTS_H_
#define HALFSPACE_DISPATCH_SCAN_PARTS_H_

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "dispatch/scan/prepare.h"
#include "halfspace/detail/scan.h"
#include "kernels/scan/kernel_table.h"

namespace halfspace::dispatch {

using detail::kMostQueries;
using detail::Part;
using detail::Scan;

// A run is the words of one query on at most kRunObjects objects. A part is one
// run of each query of a batch, or up to kRunsOfOne runs of one query.
inline constexpr std::size_t kRunWords = 64;
inline constexpr std::size_t kRunObjects = 64 * kRunWords;
inline constexpr std::size_t kRunsOfOne = 4;

// The words of a part, and which of them are nonzero.
struct Tested {
  // Up to kMostListed survivors of quantized bounds are listed. With one or two
  // in a run, a loop over words and their bits is mispredicted once in each
  // run, and there would be three such loops.
  static constexpr std::size_t kMostListed = 64;

  Part part;
  std::size_t runs;
  std::uint64_t nonzero[kMostQueries];  // words, of each run
  std::size_t candidates;               // their number, listed or not
  std::uint16_t list[kMostListed];      // run * kRunObjects + object

  bool is_one() const { return part.query_count == 1; }
  std::size_t words() const { return MaskWords(part.end - part.begin); }
  std::size_t WordsOfRun(std::size_t run) const {
    return is_one() ? std::min(kRunWords, words() - run * kRunWords) : words();
  }
  std::size_t QueryOfRun(std::size_t run) const {
    return part.first_query + (is_one() ? 0 : run);
  }
  std::size_t ObjectOfRun(std::size_t run) const {
    return part.begin + (is_one() ? run * kRunObjects : 0);
  }
  std::uint64_t* RowOfRun(std::size_t run) const {
    return part.rows + (is_one() ? run * kRunWords : run * part.stride);
  }
};

// Test a candidate, a survivor of quantized bounds, on the floats (parts.cc).
bool FloatsReject(const Scan& scan, std::size_t query, std::size_t object);
void PrefetchFloats(const Scan& scan, std::size_t object);

// Prefetches share `share` of `shares` of the planes of objects begin ... begin
// + objects - 1, as far as these exist. Otherwise the first batch on a tile
// would wait for memory line by line.
void PrefetchTile(const Scan& scan, std::size_t begin, std::size_t objects,
                  std::size_t share, std::size_t shares);

// One query takes a few runs at a time: the more work lies between prefetching
// floats and reading them, the more of their latency is hidden. Several queries
// take a tile that leaves room in the first-level cache for the words: a box
// took 4 % more time with 32 KiB on Zen 4. The second half of quantized planes
// is seldom read, and needs no room.
inline std::size_t PartObjects(const Scan& scan) {
  constexpr std::size_t kTileBytes = 28 * 1024;
  constexpr std::size_t kQuantizedTileBytes = 32 * 1024;
  if (scan.query_count == 1) return kRunsOfOne * kRunObjects;
  const std::size_t bytes =
      scan.type->encode != nullptr ? kQuantizedTileBytes : kTileBytes;
  return std::min(kRunObjects, bytes / scan.type->record_bytes / 64 * 64);
}

// Calls visit(object) for every bit of the words that `nonzero` names.
template <typename Visit>
void ForEachBit(const std::uint64_t* words, std::uint64_t nonzero,
                const Visit& visit) {
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    const auto w = static_cast<std::size_t>(std::countr_zero(nonzero));
    for (std::uint64_t left = words[w]; left != 0; left &= left - 1) {
      visit(64 * w + static_cast<std::size_t>(std::countr_zero(left)));
    }
  }
}

// Calls visit(run, object of the run) for every bit of the words.
template <typename Visit>
void ForEachBit(const Tested& tested, const Visit& visit) {
  for (std::size_t run = 0; run < tested.runs; ++run) {
    ForEachBit(tested.RowOfRun(run), tested.nonzero[run],
               [&](std::size_t object) { visit(run, object); });
  }
}

// The same for the candidates, by their list if they are few.
template <typename Visit>
void ForEachCandidate(const Tested& tested, const Visit& visit) {
  if (tested.candidates > Tested::kMostListed) return ForEachBit(tested, visit);
  for (std::size_t c = 0; c < tested.candidates; ++c) {
    visit(tested.list[c] / kRunObjects, tested.list[c] % kRunObjects);
  }
}

inline void FindNonzero(const Scan& scan, Tested& tested) {
  tested.runs = tested.is_one() ? (tested.words() + kRunWords - 1) / kRunWords
                                : tested.part.query_count;
  for (std::size_t run = 0; run < tested.runs; ++run) {
    tested.nonzero[run] = scan.kernels->nonzero_words(tested.RowOfRun(run),
                                                      tested.WordsOfRun(run));
  }
}

// Writes the words of a part, and finds the nonzero ones.
//
// Where quantized octahedra are refined, their minima are the filter: they
// usually leave so few candidates that testing those on floats is faster than
// testing the maxima, which out of the caches are four more cache lines for
// each word. The maxima are tested too if more than a quarter of the words are
// nonzero.
inline void TestPart(const Scan& scan, Tested& tested) {
  if (scan.type->is_refined && scan.way == detail::kBySimplex) {
    const detail::Way minima =
        scan.is_streaming ? detail::kMinimaStreaming : detail::kMinima;
    scan.kernels->run[minima](scan, tested.part);
    FindNonzero(scan, tested);
    const std::uint64_t runs =
        tested.runs == 0 ? 0 : ~std::uint64_t{0} >> (64 - tested.runs);
    if (4 * scan.kernels->count_bits(tested.nonzero, runs) <=
        tested.part.query_count * tested.words()) {
      return;
    }
  }
  Run(scan, tested.part);
  FindNonzero(scan, tested);
}

// Prefetches the floats of the candidates, and lists these.
inline void PrefetchCandidates(const Scan& scan, Tested& tested) {
  std::size_t count = 0;
  ForEachBit(tested, [&](std::size_t run, std::size_t object) {
    PrefetchFloats(scan, tested.ObjectOfRun(run) + object);
    if (count < Tested::kMostListed) {
      tested.list[count] =
          static_cast<std::uint16_t>(run * kRunObjects + object);
    }
    ++count;
  });
  tested.candidates = count;
}

// Clears the bits of candidates that the floats reject.
inline void Refine(const Scan& scan, const Tested& tested) {
  ForEachCandidate(tested, [&](std::size_t run, std::size_t object) {
    const std::uint64_t rejected = FloatsReject(
        scan, tested.QueryOfRun(run), tested.ObjectOfRun(run) + object);
    tested.RowOfRun(run)[object / 64] &= ~(rejected << object % 64);
  });
}

// How many queries are encoded at a time, and room on the stack for the words
// of two parts: for one query, and for several.
struct OneQuery {
  static constexpr std::size_t kBlock = 1;
  static constexpr std::size_t kStride = 0;
  std::uint64_t rows[2][kRunsOfOne * kRunWords];
};
struct ManyQueries {
  static constexpr std::size_t kBlock = 256;
  static constexpr std::size_t kStride = kRunWords;
  std::uint64_t rows[2][kMostQueries * kRunWords];
};

// Room for kQueries encoded queries.
template <std::size_t kQueries>
struct EncodedQueries {
  alignas(
      16) std::byte bytes[kQueries * detail::kMaxPlanes * sizeof(std::int16_t)];
};

// Queries `first` ... `first` + `count` - 1 as the kernels read them: the
// caller's own, or, over quantized bounds, encoded here.
template <std::size_t kQueries>
const std::byte* ReadableQueries(const Scan& scan, std::size_t first,
                                 std::size_t count,
                                 EncodedQueries<kQueries>& quantized) {
  if (scan.type->encode == nullptr) {
    return static_cast<const std::byte*>(scan.queries) +
           first * scan.type->record_bytes;
  }
  scan.type->encode(scan, first, count, quantized.bytes);
  return quantized.bytes;
}

// visit(argument), and whether to go on: a visitor that returns nothing does.
template <typename Visit, typename Argument>
bool GoesOn(const Visit& visit, const Argument& argument) {
  if constexpr (std::is_void_v<
                    std::invoke_result_t<const Visit&, const Argument&>>) {
    visit(argument);
    return true;
  } else {
    return visit(argument);
  }
}

// Calls visit(part), without rows, for every batch of queries and tile of
// `objects` objects, until it returns false. Queries are encoded once for all
// tiles of the world, kBlock at a time: so many that reading the world again
// for the next block does not matter.
template <std::size_t kBlock, typename Visit>
void ForEachBatch(const Scan& scan, std::size_t objects, const Visit& visit) {
  EncodedQueries<kBlock> quantized;
  const std::size_t most = scan.type->encode != nullptr
                               ? kBlock
                               : std::max<std::size_t>(1, scan.query_count);
  for (std::size_t first = 0; first < scan.query_count; first += most) {
    const std::size_t block = std::min(most, scan.query_count - first);
    const std::byte* queries = ReadableQueries(scan, first, block, quantized);
    const std::size_t batches = (block + kMostQueries - 1) / kMostQueries;
    for (std::size_t begin = scan.begin; begin < scan.end; begin += objects) {
      const std::size_t end = std::min(scan.end - begin, objects) + begin;
      for (std::size_t b = 0; b < batches; ++b) {
        if (batches > 1) PrefetchTile(scan, end, objects, b, batches);
        const std::size_t q = b * kMostQueries;
        const Part part{.first_query = first + q,
                        .query_count = std::min(kMostQueries, block - q),
                        .queries = queries + q * scan.type->record_bytes,
                        .begin = begin,
                        .end = end,
                        .rows = nullptr,
                        .stride = 0};
        if (!GoesOn(visit, part)) return;
      }
    }
  }
}

// Tests part after part and calls visit(tested) with each after refining it,
// until it returns false. place(part, turn) sets its rows and stride; the rows
// of two turns are in use at a time.
template <std::size_t kBlock, typename Place, typename Visit>
void ForEachPlacedPart(const Scan& scan, const Place& place,
                       const Visit& visit) {
  // The floats that refine the previous part are still being fetched.
  Tested parts[2];
  std::size_t turn = 0;
  bool is_waiting = false;
  const auto finish = [&](const Tested& tested) {
    Refine(scan, tested);
    return GoesOn(visit, tested);
  };
  ForEachBatch<kBlock>(scan, PartObjects(scan), [&](const Part& part) {
    Tested& tested = parts[turn];
    tested.part = part;
    place(tested.part, turn);
    TestPart(scan, tested);
    if (!scan.type->is_refined) return GoesOn(visit, tested);
    PrefetchCandidates(scan, tested);
    turn ^= 1;
    const bool goes_on = !is_waiting || finish(parts[turn]);
    is_waiting = goes_on;
    return goes_on;
  });
  if (is_waiting) finish(parts[turn ^ 1]);
}

// The same with rows on the stack.
template <typename Queries, typename Visit>
void ForEachPart(const Scan& scan, const Visit& visit) {
  Queries room;
  ForEachPlacedPart<Queries::kBlock>(
      scan,
      [&room](Part& part, std::size_t turn) {
        part.rows = room.rows[turn];
        part.stride = Queries::kStride;
      },
      visit);
}

// The words of a range of one run, unless bounds are quantized.
struct OneRun {
  std::uint64_t nonzero;
  std::uint64_t words[kRunWords];
};

// Tests such a range, and returns whether it is one. It takes a fraction of
// what parts take.
inline bool TestOneRun(const Scan& scan, OneRun& run) {
  if (scan.end - scan.begin > kRunObjects || scan.type->encode != nullptr) {
    return false;
  }
  Run(scan, WholeRange(scan, run.words));
  run.nonzero =
      scan.kernels->nonzero_words(run.words, MaskWords(scan.end - scan.begin));
  return true;
}

// Calls visit(query, object) for every survivor: those of a query in a part in
// ascending order.
template <typename Visit>
void ForEachSurvivor(const Scan& scan, const Tested& tested,
                     const Visit& visit) {
  const auto survivor = [&](std::size_t run, std::size_t object) {
    visit(tested.QueryOfRun(run), tested.ObjectOfRun(run) + object);
  };
  if (!scan.type->is_refined) return ForEachBit(tested, survivor);
  ForEachCandidate(tested, [&](std::size_t run, std::size_t object) {
    if ((tested.RowOfRun(run)[object / 64] >> object % 64 & 1) != 0) {
      survivor(run, object);
    }
  });
}

// Calls visit(query, number of survivors) for every run.
template <typename Visit>
void ForEachCount(const Scan& scan, const Tested& tested, const Visit& visit) {
  for (std::size_t run = 0; run < tested.runs; ++run) {
    visit(tested.QueryOfRun(run),
          scan.kernels->count_bits(tested.RowOfRun(run), tested.nonzero[run]));
  }
}

// Turns survivor masks into reject masks, and back.
inline void Flip(std::uint64_t* words, std::size_t count) {
  for (std::size_t w = 0; w < count; ++w) words[w] = ~words[w];
}

// Writes the masks of all queries; row q begins at rows + q * stride, with the
// range's first object.
template <typename Queries>
void WriteRows(const Scan& scan, std::uint64_t* rows, std::size_t stride,
               bool rejects) {
  const auto place = [&](Part& part, std::size_t) {
    part.rows =
        rows + part.first_query * stride + (part.begin - scan.begin) / 64;
    part.stride = stride;
  };
  const auto finish = [&](const Part& part) {
    if (!rejects) return;
    const std::size_t words = MaskWords(part.end - part.begin);
    for (std::size_t q = 0; q < part.query_count; ++q) {
      Flip(part.rows + q * stride, words);
    }
  };
  if (scan.type->is_refined) {
    return ForEachPlacedPart<Queries::kBlock>(
        scan, place, [&](const Tested& tested) { finish(tested.part); });
  }
  // Masks that are not refined need no list of nonzero words.
  ForEachBatch<Queries::kBlock>(scan, PartObjects(scan),
                                [&](const Part& batch) {
                                  Part part = batch;
                                  place(part, 0);
                                  Run(scan, part);
                                  finish(part);
                                });
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_SCAN_PARTS_H_

// A scan in parts: tiles of the world that stay in the first-level cache while
// group after group of queries is tested against them.
#ifndef HALFSPACE_DISPATCH_TILES_H_
#define HALFSPACE_DISPATCH_TILES_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "dispatch/confirm.h"
#include "dispatch/prepared_scan.h"

namespace halfspace::dispatch {

// A strip is one query against at most so many objects, or words; a part is at
// most so many strips, of many queries or of one.
inline constexpr std::size_t kStripWords = 64;
inline constexpr std::size_t kStripObjects = 64 * kStripWords;
inline constexpr std::size_t kPartStrips = 16;

// How many parts are begun before the first of them is confirmed.
inline constexpr std::size_t kPartsUnderWay = 2;

// What survived the codes, if it is no more than that, is listed: with one or
// two in a strip, loops over words and their bits are mispredicted once in each
// strip, and there are three of them.
inline constexpr std::size_t kMostListed = 64;
struct Candidate {
  std::size_t query;
  std::size_t object;
  std::uint64_t* word;  // has its bit
};

// The survivors of queries first ... first + count - 1 among objects begin ...
// end - 1. The words of query q begin at rows + q * stride.
struct Part {
  std::size_t first = 0;
  std::size_t count = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
  std::uint64_t* rows = nullptr;
  std::size_t stride = 0;
  // Of each strip: those of one query after another.
  std::array<std::uint64_t, kPartStrips> live;
  bool is_listed = false;
  std::size_t candidates = 0;
  std::array<Candidate, kMostListed> list;
};

// One query takes strips of a part side by side: the further apart the work on
// codes and on floats, the longer may floats be on their way. Many queries take
// a tile that stays in the cache.
inline std::size_t PartObjects(const PreparedScan& scan) {
  // Room is left for the words: a box took 4 % more with 32 KiB on Zen 4. The
  // second half of coded planes is seldom looked at, and needs none.
  constexpr std::size_t kTileBytes = 28 * 1024;
  constexpr std::size_t kCodedTileBytes = 32 * 1024;
  if (scan.query_count() == 1) return kPartStrips * kStripObjects;
  const std::size_t bytes = scan.is_coded() ? kCodedTileBytes : kTileBytes;
  return std::min(kStripObjects, bytes / scan.RecordBytes() / 64 * 64);
}

// Calls visit(strip, query of the scan, first object, words, count of words).
template <typename Visit>
void ForEachStrip(const Part& part, const Visit& visit) {
  const std::size_t words = MaskWords(part.end - part.begin);
  std::size_t strip = 0;
  for (std::size_t q = 0; q < part.count; ++q) {
    for (std::size_t w = 0; w < words; w += kStripWords) {
      visit(strip++, part.first + q, part.begin + 64 * w,
            part.rows + q * part.stride + w, std::min(kStripWords, words - w));
    }
  }
}

inline void FindLive(const PreparedScan& scan, Part& part) {
  ForEachStrip(part, [&](std::size_t strip, std::size_t, std::size_t,
                         std::uint64_t* words, std::size_t count) {
    part.live[strip] = scan.table().live_words(words, count);
  });
}

// Whether more than a quarter of the words live.
inline bool ManyLive(const PreparedScan& scan, const Part& part) {
  const std::size_t words = MaskWords(part.end - part.begin);
  const std::size_t strips =
      part.count * ((words + kStripWords - 1) / kStripWords);
  if (strips == 0) return false;
  const std::uint64_t all_strips = ~std::uint64_t{0} >> (64 - strips);
  return 4 * scan.table().count_survivors(part.live.data(), all_strips) >
         part.count * words;
}

// Writes the part's words, and finds those that live. Returns the target's bit.
inline std::int64_t RunPart(const PreparedScan& scan, const QueryBlock& block,
                            Part& part) {
  const std::size_t first = part.first - block.first;
  part.is_listed = false;
  if (scan.HasFirstStage()) {
    const std::int64_t bit = scan.RunFirstStage(
        block, first, part.count, part.begin, part.end, part.rows, part.stride);
    FindLive(scan, part);
    if (!ManyLive(scan, part)) return bit;
  }
  const std::int64_t bit =
      scan.Run(block, first, part.count, part.begin, part.end, part.rows,
               part.stride, ~std::uint64_t{0});
  FindLive(scan, part);
  return bit;
}

// Calls visit(query, object, word with its bit) for every survivor in the
// words, or every one that is listed: those of a query in a part in ascending
// order, query after query.
template <typename Visit>
void ForEachBit(const Part& part, const Visit& visit) {
  if (part.is_listed) {
    for (std::size_t c = 0; c < part.candidates; ++c) {
      visit(part.list[c].query, part.list[c].object, *part.list[c].word);
    }
    return;
  }
  ForEachStrip(part, [&](std::size_t strip, std::size_t query,
                         std::size_t first, std::uint64_t* words, std::size_t) {
    for (std::uint64_t live = part.live[strip]; live != 0; live &= live - 1) {
      const auto w = static_cast<std::size_t>(std::countr_zero(live));
      for (std::uint64_t left = words[w]; left != 0; left &= left - 1) {
        visit(query,
              first + 64 * w + static_cast<std::size_t>(std::countr_zero(left)),
              words[w]);
      }
    }
  });
}

// Asks for the floats that confirm what lives, and lists it.
inline void PrefetchPart(const PreparedScan& scan, Part& part) {
  std::size_t count = 0;
  ForEachBit(part,
             [&](std::size_t query, std::size_t object, std::uint64_t& word) {
               PrefetchFloats(scan.scan(), object);
               if (count < kMostListed)
                 part.list[count] = {query, object, &word};
               ++count;
             });
  part.candidates = count;
  part.is_listed = count <= kMostListed;
}

inline void Confirm(const PreparedScan& scan, const Part& part) {
  const float* queries = static_cast<const float*>(scan.scan().queries);
  ForEachBit(
      part, [&](std::size_t query, std::size_t object, std::uint64_t& word) {
        const std::uint64_t rejected = FloatsReject(
            scan.scan(), queries + query * scan.scan().plane_count, object);
        word &= ~(rejected << object % 64);
      });
}

// Calls visit(block, first, count, begin, end) for every group of queries of
// every block, tile of `objects` objects after tile; without queries once, for
// no objects, so that the target is known. It returns the target's bit, and so
// does this.
template <typename Visit>
std::int64_t ForEachGroup(const PreparedScan& scan, std::size_t objects,
                          const Visit& visit) {
  std::int64_t target = 0;
  scan.ForEachBlock([&](const QueryBlock& block) {
    if (block.count == 0) {
      target = visit(block, 0, 0, scan.begin(), scan.begin());
      return;
    }
    const std::size_t groups = (block.count + kPartStrips - 1) / kPartStrips;
    std::size_t begin = scan.begin();
    do {
      const std::size_t end =
          scan.end() - begin < objects ? scan.end() : begin + objects;
      std::size_t first = 0;
      do {
        if (groups > 1) {
          scan.PrefetchTile(end, objects, first / kPartStrips, groups);
        }
        const std::size_t count = std::min(kPartStrips, block.count - first);
        target = visit(block, first, count, begin, end);
        first += count;
      } while (first < block.count);
      begin = end;
    } while (begin < scan.end());
  });
  return target;
}

// Runs part after part of the scan and calls visit(part) with each. place(part)
// sets its rows and stride before. Returns the bit of the target.
template <typename Place, typename Visit>
std::int64_t ForEachPart(const PreparedScan& scan, const Place& place,
                         const Visit& visit) {
  // The parts before wait for the floats that confirm them.
  std::array<Part, kPartsUnderWay> parts;
  std::size_t turn = 0;
  const auto finish = [&](Part& part) {
    if (part.count == 0) return;
    Confirm(scan, part);
    visit(part);
    part.count = 0;
  };
  const std::int64_t target =
      ForEachGroup(scan, PartObjects(scan),
                   [&](const QueryBlock& block, std::size_t first,
                       std::size_t count, std::size_t begin, std::size_t end) {
                     Part& part = parts[turn];
                     part.first = block.first + first;
                     part.count = count;
                     part.begin = begin;
                     part.end = end;
                     place(part, turn);
                     const std::int64_t bit = RunPart(scan, block, part);
                     if (!scan.is_confirmed()) {
                       visit(part);
                     } else {
                       PrefetchPart(scan, part);
                       turn = (turn + 1) % kPartsUnderWay;
                       finish(parts[turn]);
                     }
                     return bit;
                   });
  if (scan.is_confirmed()) {
    for (std::size_t i = 1; i < kPartsUnderWay; ++i) {
      finish(parts[(turn + i) % kPartsUnderWay]);
    }
  }
  return target;
}

// The same with rows on the stack.
template <typename Visit>
std::int64_t ForEachPart(const PreparedScan& scan, const Visit& visit) {
  std::uint64_t rows[kPartsUnderWay][kPartStrips * kStripWords];
  return ForEachPart(
      scan,
      [&](Part& part, std::size_t turn) {
        part.rows = rows[turn];
        part.stride = kStripWords;
      },
      visit);
}

// Calls visit(query, object) for every survivor.
template <typename Visit>
void ForEachSurvivor(const Part& part, const Visit& visit) {
  ForEachBit(part,
             [&](std::size_t query, std::size_t object, std::uint64_t word) {
               if ((word >> object % 64 & 1) != 0) visit(query, object);
             });
}

// Calls visit(query, number of survivors).
template <typename Visit>
void ForEachCount(const PreparedScan& scan, const Part& part,
                  const Visit& visit) {
  ForEachStrip(part, [&](std::size_t strip, std::size_t query, std::size_t,
                         const std::uint64_t* words, std::size_t) {
    visit(query, scan.table().count_survivors(words, part.live[strip]));
  });
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_TILES_H_

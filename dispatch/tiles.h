// The survivors of a scan, tile by tile of queries and objects.
#ifndef HALFSPACE_DISPATCH_TILES_H_
#define HALFSPACE_DISPATCH_TILES_H_

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dispatch/prepared_scan.h"
#include "halfspace/reject_many.h"

namespace halfspace::dispatch {

// The largest tile, whose words are kept on the stack.
inline constexpr std::size_t kTileWords = 64;
inline constexpr std::size_t kTileQueries = 16;

// Objects of a tile that stays in the first-level cache while query after query
// is tested against it; one query needs no more than that its words do.
inline std::size_t TileObjects(const PreparedScan& scan) {
  constexpr std::size_t kTileBytes = 24 * 1024;
  constexpr std::size_t kMost = 64 * kTileWords;
  if (scan.query_count() == 1) return kMost;
  return std::min(kMost, kTileBytes / scan.RecordBytes() / 64 * 64);
}

// Calls visit(block, begin, end) for every block of queries and, within it,
// tile of objects; without queries once, for no objects, so that the target is
// known. Returns its bit.
template <typename Visit>
std::int64_t ForEachObjectTile(const PreparedScan& scan, std::size_t objects,
                               const Visit& visit) {
  std::int64_t target = 0;
  scan.ForEachBlock([&](const QueryBlock& block) {
    if (block.count == 0) {
      target = visit(block, 0, 0);
      return;
    }
    std::size_t begin = scan.begin();
    do {
      const std::size_t end =
          scan.end() - begin < objects ? scan.end() : begin + objects;
      target = visit(block, begin, end);
      begin = end;
    } while (begin < scan.end());
  });
  return target;
}

// Calls visit(object) for the survivors of query first_query + q of a tile, in
// ascending order.
template <typename Visit>
void ForEachSurvivor(const SurvivorTile& tile, std::size_t q,
                     const Visit& visit) {
  const std::span<const std::uint64_t> row = tile.Row(q);
  for (std::size_t w = 0; w < row.size(); ++w) {
    for (std::uint64_t left = row[w]; left != 0; left &= left - 1) {
      visit(tile.first_object + 64 * w +
            static_cast<std::size_t>(std::countr_zero(left)));
    }
  }
}

// Calls visit(tile), a SurvivorTile, for each that is not empty. Returns the
// bit of the target.
template <typename Visit>
std::int64_t ForEachSurvivorTile(const PreparedScan& scan, const Visit& visit) {
  return ForEachObjectTile(
      scan, TileObjects(scan),
      [&](const QueryBlock& block, std::size_t begin, std::size_t end) {
        std::uint64_t rows[kTileQueries * kTileWords];
        std::int64_t target = 0;
        std::size_t q = 0;
        do {
          const std::size_t count = std::min(kTileQueries, block.count - q);
          target = scan.Run(block, q, count, begin, end, rows, kTileWords,
                            ~std::uint64_t{0});
          if (count != 0 && begin != end) {
            visit(SurvivorTile{.first_query = block.first + q,
                               .queries = count,
                               .first_object = begin,
                               .objects = end - begin,
                               .rows = rows,
                               .stride = kTileWords});
          }
          q += count;
        } while (q < block.count);
        return target;
      });
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_TILES_H_

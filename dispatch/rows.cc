#include "dispatch/rows.h"

#include "dispatch/tiles.h"

namespace halfspace::dispatch {
namespace {

// Without a look at the words.
std::int64_t WriteUnconfirmedRows(const PreparedScan& scan, std::uint64_t* rows,
                                  std::size_t words, std::uint64_t flip) {
  const std::size_t objects =
      scan.query_count() == 1 ? scan.end() : PartObjects(scan);
  return ForEachGroup(
      scan, objects,
      [&](const QueryBlock& block, std::size_t first, std::size_t count,
          std::size_t begin, std::size_t end) {
        return scan.Run(block, first, count, begin, end,
                        rows + (block.first + first) * words + begin / 64,
                        words, flip);
      });
}

}  // namespace

std::int64_t WriteRows(const PreparedScan& scan, std::uint64_t* rows,
                       std::size_t words, std::uint64_t flip) {
  if (!scan.is_confirmed()) {
    return WriteUnconfirmedRows(scan, rows, words, flip);
  }
  const auto place = [&](Part& part, std::size_t) {
    part.rows = rows + part.first * words + part.begin / 64;
    part.stride = words;
  };
  return ForEachPart(scan, place, [flip](const Part& part) {
    if (flip != 0) return;
    ForEachStrip(part, [](std::size_t, std::size_t, std::size_t,
                          std::uint64_t* strip, std::size_t count) {
      for (std::size_t w = 0; w < count; ++w) strip[w] = ~strip[w];
    });
  });
}

}  // namespace halfspace::dispatch

#include "halfspace/reject_many.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "dispatch/prepared_scan.h"
#include "dispatch/tiles.h"
#include "kernels/error.h"

namespace halfspace::detail {
namespace {

using dispatch::PreparedScan;
using dispatch::QueryBlock;

Target WriteMasks(const Scan& scan, std::span<std::uint64_t> rows,
                  std::uint64_t flip, const Options& options,
                  std::string_view call) {
  const PreparedScan prepared(scan, options, call);
  const std::size_t words = MaskWords(scan.size);
  if (words != 0 && rows.size() / words < scan.query_count) {
    kernels::ThrowInvalid(call, "rows",
                          "at least " + std::to_string(scan.query_count) +
                              " rows of " + std::to_string(words) + " words",
                          std::to_string(rows.size()) + " words");
  }
  prepared.CheckOutput("rows", rows.data(),
                       words * scan.query_count * sizeof(std::uint64_t),
                       alignof(std::uint64_t));
  return Target::FromHighwayBit(dispatch::ForEachObjectTile(
      prepared, dispatch::TileObjects(prepared),
      [&](const QueryBlock& block, std::size_t begin, std::size_t end) {
        return prepared.Run(block, 0, block.count, begin, end,
                            rows.data() + block.first * words + begin / 64,
                            words, flip);
      }));
}

}  // namespace

Target RejectMasks(const Scan& scan, std::span<std::uint64_t> rows,
                   const Options& options) {
  return WriteMasks(scan, rows, 0, options, "RejectMasks");
}

Target SurvivorMasks(const Scan& scan, std::span<std::uint64_t> rows,
                     const Options& options) {
  return WriteMasks(scan, rows, ~std::uint64_t{0}, options, "SurvivorMasks");
}

SurvivorCount SurvivorPairs(const Scan& scan,
                            std::span<std::uint32_t> query_indices,
                            std::span<std::uint32_t> object_indices,
                            const Options& options) {
  const PreparedScan prepared(scan, options, "SurvivorPairs");
  prepared.CheckIndicesFit();
  const std::size_t capacity =
      std::min(query_indices.size(), object_indices.size());
  const auto check = [&](const char* name, std::span<std::uint32_t> indices) {
    if (scan.size == 0 || scan.query_count == 0) return;
    // No more than one pair for each object and query is ever written.
    const std::size_t writable = capacity / scan.query_count < scan.size
                                     ? capacity
                                     : scan.size * scan.query_count;
    prepared.CheckOutput(name, indices.data(), writable * sizeof(std::uint32_t),
                         alignof(std::uint32_t));
  };
  check("query_indices", query_indices);
  check("object_indices", object_indices);
  SurvivorCount result;
  result.target = Target::FromHighwayBit(
      dispatch::ForEachSurvivorTile(prepared, [&](const SurvivorTile& tile) {
        for (std::size_t q = 0; q < tile.queries; ++q) {
          dispatch::ForEachSurvivor(tile, q, [&](std::size_t object) {
            if (result.count < capacity) {
              query_indices[result.count] =
                  static_cast<std::uint32_t>(tile.first_query + q);
              object_indices[result.count] = static_cast<std::uint32_t>(object);
            }
            ++result.count;
          });
        }
      }));
  return result;
}

Target SurvivorCounts(const Scan& scan, std::span<std::size_t> counts,
                      const Options& options) {
  const PreparedScan prepared(scan, options, "SurvivorCounts");
  if (counts.size() < scan.query_count) {
    kernels::ThrowInvalid(
        "SurvivorCounts", "counts",
        "at least " + std::to_string(scan.query_count) + ", one for each query",
        std::to_string(counts.size()));
  }
  prepared.CheckOutput("counts", counts.data(),
                       scan.query_count * sizeof(std::size_t),
                       alignof(std::size_t));
  std::fill_n(counts.begin(), scan.query_count, std::size_t{0});
  return Target::FromHighwayBit(
      dispatch::ForEachSurvivorTile(prepared, [&](const SurvivorTile& tile) {
        for (std::size_t q = 0; q < tile.queries; ++q) {
          const std::span<const std::uint64_t> row = tile.Row(q);
          counts[tile.first_query + q] +=
              prepared.CountBits(row.data(), row.size());
        }
      }));
}

Target ForEachTile(const Scan& scan, TileFunction function, void* context,
                   const Options& options) {
  const PreparedScan prepared(scan, options, "ForEachTile");
  return Target::FromHighwayBit(dispatch::ForEachSurvivorTile(
      prepared, [&](const SurvivorTile& tile) { function(context, tile); }));
}

}  // namespace halfspace::detail

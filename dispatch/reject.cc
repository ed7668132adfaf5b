#include "halfspace/reject.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "dispatch/prepared_scan.h"
#include "dispatch/tiles.h"
#include "kernels/error.h"

namespace halfspace::detail {
namespace {

using dispatch::PreparedScan;
using dispatch::QueryBlock;

// Codes that are confirmed go tile by tile: what survives is looked at while
// its words are in the cache. All else is one call of a kernel.
std::size_t ObjectsAtOnce(const PreparedScan& scan) {
  return scan.is_confirmed() ? dispatch::TileObjects(scan)
                             : scan.end() - scan.begin();
}

Target WriteMask(const Scan& scan, std::span<std::uint64_t> mask,
                 std::uint64_t flip, const Options& options,
                 std::string_view call) {
  const PreparedScan prepared(scan, options, call);
  const std::size_t words = MaskWords(scan.size);
  if (mask.size() < words) {
    kernels::ThrowInvalid(call, "mask",
                          "at least " + std::to_string(words) + " words for " +
                              std::to_string(scan.size) + " objects",
                          std::to_string(mask.size()));
  }
  prepared.CheckOutput("mask", mask.data(), words * sizeof(std::uint64_t),
                       alignof(std::uint64_t));
  return Target::FromHighwayBit(dispatch::ForEachObjectTile(
      prepared, ObjectsAtOnce(prepared),
      [&](const QueryBlock& block, std::size_t begin, std::size_t end) {
        return prepared.Run(block, 0, 1, begin, end, mask.data() + begin / 64,
                            0, flip);
      }));
}

}  // namespace

Target RejectMask(const Scan& scan, std::span<std::uint64_t> mask,
                  const Options& options) {
  return WriteMask(scan, mask, 0, options, "RejectMask");
}

Target SurvivorMask(const Scan& scan, std::span<std::uint64_t> mask,
                    const Options& options) {
  return WriteMask(scan, mask, ~std::uint64_t{0}, options, "SurvivorMask");
}

SurvivorCount Survivors(const Scan& scan, std::span<std::uint32_t> indices,
                        const Options& options) {
  const PreparedScan prepared(scan, options, "Survivors");
  prepared.CheckIndicesFit();
  // No more than one index for each object is ever written.
  prepared.CheckOutput(
      "indices", indices.data(),
      std::min(indices.size(), scan.size) * sizeof(std::uint32_t),
      alignof(std::uint32_t));
  std::size_t count = 0;
  const std::int64_t target =
      dispatch::ForEachSurvivorTile(prepared, [&](const SurvivorTile& tile) {
        dispatch::ForEachSurvivor(tile, 0, [&](std::size_t object) {
          if (count < indices.size()) {
            indices[count] = static_cast<std::uint32_t>(object);
          }
          ++count;
        });
      });
  return {count, Target::FromHighwayBit(target)};
}

SurvivorCount CountSurvivors(const Scan& scan, const Options& options) {
  const PreparedScan prepared(scan, options, "CountSurvivors");
  std::size_t count = 0;
  const std::int64_t target =
      dispatch::ForEachSurvivorTile(prepared, [&](const SurvivorTile& tile) {
        const std::span<const std::uint64_t> row = tile.Row(0);
        count += prepared.CountBits(row.data(), row.size());
      });
  return {count, Target::FromHighwayBit(target)};
}

SurvivorFlag AnySurvivor(const Scan& scan, const Options& options) {
  const PreparedScan prepared(scan, options, "AnySurvivor");
  SurvivorFlag result;
  prepared.ForEachBlock([&](const QueryBlock& block) {
    // A survivor is often among the first.
    std::size_t objects = 512;
    std::size_t begin = prepared.begin();
    do {
      const std::size_t end =
          prepared.end() - begin < objects ? prepared.end() : begin + objects;
      std::uint64_t words[dispatch::kTileWords];
      result.target = Target::FromHighwayBit(
          prepared.Run(block, 0, 1, begin, end, words, 0, ~std::uint64_t{0}));
      result.any = std::any_of(words, words + MaskWords(end - begin),
                               [](std::uint64_t word) { return word != 0; });
      begin = end;
      objects = 64 * dispatch::kTileWords;
    } while (!result.any && begin < prepared.end());
  });
  return result;
}

}  // namespace halfspace::detail

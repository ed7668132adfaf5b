#include "halfspace/reject.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "dispatch/prepared_scan.h"
#include "dispatch/rows.h"
#include "dispatch/tiles.h"
#include "kernels/error.h"

namespace halfspace::detail {
namespace {

using dispatch::Part;
using dispatch::PreparedScan;

// Apart: its strings would cost each call their room.
[[noreturn]] void ThrowShortMask(const Scan& scan, std::size_t words,
                                 std::string_view call) {
  kernels::ThrowInvalid(call, "mask",
                        "at least " + std::to_string(MaskWords(scan.size)) +
                            " words for " + std::to_string(scan.size) +
                            " objects",
                        std::to_string(words));
}

Target WriteMask(const Scan& scan, std::span<std::uint64_t> mask,
                 std::uint64_t flip, const Options& options,
                 std::string_view call) {
  const PreparedScan prepared(scan, options, call);
  const std::size_t words = MaskWords(scan.size);
  if (mask.size() < words) [[unlikely]] {
    ThrowShortMask(scan, mask.size(), call);
  }
  prepared.CheckOutput("mask", mask.data(), words * sizeof(std::uint64_t),
                       alignof(std::uint64_t));
  if (scan.book == nullptr) {
    // The short way: a small call costs little more than its kernel.
    return Target::FromHighwayBit(prepared.Run(
        {0, 1, scan.queries}, 0, 1, prepared.begin(), prepared.end(),
        mask.data() + prepared.begin() / 64, words, flip));
  }
  return Target::FromHighwayBit(
      dispatch::WriteRows(prepared, mask.data(), words, flip));
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
      dispatch::ForEachPart(prepared, [&](const Part& part) {
        dispatch::ForEachSurvivor(part, [&](std::size_t, std::size_t object) {
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
      dispatch::ForEachPart(prepared, [&](const Part& part) {
        dispatch::ForEachCount(
            prepared, part,
            [&](std::size_t, std::size_t survivors) { count += survivors; });
      });
  return {count, Target::FromHighwayBit(target)};
}

SurvivorFlag AnySurvivor(const Scan& scan, const Options& options) {
  const PreparedScan prepared(scan, options, "AnySurvivor");
  SurvivorFlag result;
  prepared.ForEachBlock([&](const dispatch::QueryBlock& block) {
    // A survivor is often among the first.
    std::size_t objects = 512;
    std::uint64_t words[dispatch::kStripWords];
    Part part;
    part.count = 1;
    part.end = prepared.begin();
    part.rows = words;
    do {
      part.begin = part.end;
      part.end = prepared.end() - part.begin < objects ? prepared.end()
                                                       : part.begin + objects;
      result.target =
          Target::FromHighwayBit(dispatch::RunPart(prepared, block, part));
      if (prepared.is_confirmed()) dispatch::Confirm(prepared, part);
      dispatch::ForEachSurvivor(
          part, [&](std::size_t, std::size_t) { result.any = true; });
      objects = dispatch::kStripObjects;
    } while (!result.any && part.end < prepared.end());
  });
  return result;
}

}  // namespace halfspace::detail

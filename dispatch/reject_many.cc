#include "halfspace/reject_many.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "dispatch/prepared_scan.h"
#include "dispatch/rows.h"
#include "dispatch/tiles.h"
#include "kernels/error.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

using dispatch::Part;
using dispatch::PreparedScan;

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
  return Target::FromHighwayBit(
      dispatch::WriteRows(prepared, rows.data(), words, flip));
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
  // No more than one pair for each object and query is ever written.
  const bool all_fit =
      scan.query_count == 0 || capacity / scan.query_count >= scan.size;
  const std::size_t bytes =
      (all_fit ? scan.size * scan.query_count : capacity) *
      sizeof(std::uint32_t);
  const auto check = [&](const char* name, std::span<std::uint32_t> indices) {
    prepared.CheckOutput(name, indices.data(), bytes, alignof(std::uint32_t));
  };
  check("query_indices", query_indices);
  check("object_indices", object_indices);
  if (kernels::Overlap(query_indices.data(), bytes, object_indices.data(),
                       bytes)) {
    kernels::ThrowInvalid("SurvivorPairs", "object_indices",
                          "memory apart from query_indices", "an overlap");
  }
  std::size_t count = 0;
  const std::int64_t target =
      dispatch::ForEachPart(prepared, [&](const Part& part) {
        dispatch::ForEachSurvivor(
            part, [&](std::size_t query, std::size_t object) {
              if (count < capacity) {
                query_indices[count] = static_cast<std::uint32_t>(query);
                object_indices[count] = static_cast<std::uint32_t>(object);
              }
              ++count;
            });
      });
  return {count, Target::FromHighwayBit(target)};
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
      dispatch::ForEachPart(prepared, [&](const Part& part) {
        dispatch::ForEachCount(prepared, part,
                               [&](std::size_t query, std::size_t survivors) {
                                 counts[query] += survivors;
                               });
      }));
}

Target ForEachTile(const Scan& scan, TileFunction function, void* context,
                   const Options& options) {
  const PreparedScan prepared(scan, options, "ForEachTile");
  return Target::FromHighwayBit(
      dispatch::ForEachPart(prepared, [&](const Part& part) {
        if (part.count == 0 || part.begin == part.end) return;
        function(context, {.first_query = part.first,
                           .queries = part.count,
                           .first_object = part.begin,
                           .objects = part.end - part.begin,
                           .rows = part.rows,
                           .stride = part.stride});
      }));
}

}  // namespace halfspace::detail

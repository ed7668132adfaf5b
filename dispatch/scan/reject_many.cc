#include "halfspace/reject_many.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/scan/chunks.h"
#include "dispatch/scan/prepare.h"

namespace halfspace::detail {
namespace {

using dispatch::ManyQueries;
using dispatch::Tested;

}  // namespace

void SurvivorMasks(Scan&& scan, Span<std::uint64_t> rows,
                   const Options& options, std::size_t row_words) {
  constexpr const char* kCall = "SurvivorMasks";
  dispatch::Prepare(scan, options, kCall);
  dispatch::ChooseKernel(scan, options);
  const std::size_t words = MaskWords(scan.end - scan.begin);
  const std::size_t stride = row_words != 0 ? row_words : words;
  if (stride < words) {
    dispatch::ThrowInvalid(
        kCall, "row_words",
        "0, or at least the " + std::to_string(words) + " words of a row",
        std::to_string(stride));
  }
  std::size_t used = 0;
  if (words != 0 && scan.query_count != 0) {
    // The last row may end before the next would begin.
    const std::size_t most =
        rows.size() < words ? 0 : (rows.size() - words) / stride + 1;
    if (most < scan.query_count) {
      dispatch::ThrowInvalid(
          kCall, "rows",
          "at least " + std::to_string(scan.query_count) + " rows of " +
              std::to_string(words) + " words" +
              (stride == words
                   ? ""
                   : ", " + std::to_string(stride) + " words apart"),
          std::to_string(rows.size()) + " words");
    }
    used = (scan.query_count - 1) * stride + words;
    dispatch::CheckAddressable(kCall, "rows", used, sizeof(std::uint64_t));
  }
  dispatch::CheckOutput(
      scan, {"rows", rows.data(), used, used, sizeof(std::uint64_t)});
  dispatch::WriteRows<ManyQueries>(scan, rows.data(), stride);
}

std::size_t SurvivorPairs(Scan&& scan, Span<std::uint32_t> query_indices,
                          Span<std::uint32_t> object_indices,
                          const Options& options, std::size_t skip) {
  dispatch::Prepare(scan, options, "SurvivorPairs");
  const std::size_t capacity =
      std::min(query_indices.size(), object_indices.size());
  // No more than one pair for each query and object of the range is ever
  // written.
  const std::size_t objects = scan.end - scan.begin;
  const bool all_fit =
      scan.query_count == 0 || capacity / scan.query_count >= objects;
  const std::size_t used = all_fit ? objects * scan.query_count : capacity;
  const std::size_t bytes = used * sizeof(std::uint32_t);
  const auto check = [&](const char* name, Span<std::uint32_t> indices) {
    dispatch::CheckOutput(scan, {name, indices.data(), indices.size(), used,
                                 sizeof(std::uint32_t), true});
  };
  check("query_indices", query_indices);
  check("object_indices", object_indices);
  if (dispatch::Overlap(query_indices.data(), bytes, object_indices.data(),
                        bytes)) {
    dispatch::ThrowOverlap("SurvivorPairs", "object_indices", "query_indices");
  }
  std::size_t count = 0;
  dispatch::VisitWords<ManyQueries>(scan, options, [&](const Tested& tested) {
    dispatch::ForEachSurvivor(
        tested, [&](std::size_t query, std::size_t object) {
          const std::size_t place = count++;
          if (place >= skip && place - skip < capacity) {
            query_indices[place - skip] = static_cast<std::uint32_t>(query);
            object_indices[place - skip] = static_cast<std::uint32_t>(object);
          }
        });
    return true;
  });
  return count;
}

void SurvivorCounts(Scan&& scan, Span<std::size_t> counts,
                    const Options& options) {
  dispatch::Prepare(scan, options, "SurvivorCounts");
  if (counts.size() < scan.query_count) {
    dispatch::ThrowInvalid(
        "SurvivorCounts", "counts",
        "at least " + std::to_string(scan.query_count) + ", one for each query",
        std::to_string(counts.size()));
  }
  dispatch::CheckOutput(scan, {"counts", counts.data(), counts.size(),
                               scan.query_count, sizeof(std::size_t)});
  std::fill_n(counts.begin(), scan.query_count, std::size_t{0});
  dispatch::VisitWords<ManyQueries>(scan, options, [&](const Tested& tested) {
    dispatch::ForEachCount(scan, tested,
                           [&](std::size_t query, std::size_t survivors) {
                             counts[query] += survivors;
                           });
    return true;
  });
}

}  // namespace halfspace::detail

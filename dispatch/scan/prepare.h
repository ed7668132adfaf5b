// What every call does first: it checks its arguments, and chooses how to scan.
#ifndef HALFSPACE_DISPATCH_SCAN_PREPARE_H_
#define HALFSPACE_DISPATCH_SCAN_PREPARE_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "dispatch/targets/chosen_target.h"
#include "dispatch/targets/detect_targets.h"
#include "halfspace/detail/scan.h"
#include "halfspace/reject.h"
#include "kernels/scan/kernel_table.h"

namespace halfspace::dispatch {

// Up to this many bytes of planes are taken to be in cache; more are streamed
// where that pays.
inline constexpr std::size_t kInCacheBytes = 128 * 1024;

// Planes of no more values fit the address space whatever they store.
inline constexpr std::size_t kMostObjects =
    std::numeric_limits<std::size_t>::max() / 16;

// What a call writes.
struct Output {
  const char* argument;
  const void* begin;
  std::size_t bytes;  // 0 needs no check
  std::size_t alignment;
};

// Each throws (error.h), in the name of scan.call, if something is
// wrong.
void RefuseBadWorld(const detail::Scan& scan);
[[noreturn]] void RefuseBadRange(const detail::Scan& scan, const Range& range);
void RefuseBadOutput(const detail::Scan& scan, const Output& output);
[[noreturn]] void RefuseSchedule(const detail::Scan& scan, Schedule schedule);

// Throws if there are more than 2^32 objects or queries.
void CheckIndicesFit(const detail::Scan& scan);

// The way through all planes, by shape and schedule; docs/design.md says why
// the defaults are what they are.
inline constexpr detail::Way kWayOf[3][4] = {
    // kAuto, kFlat, kStaged, kStagedByAxis
    {detail::kMinima, detail::kMinima, detail::kMinima, detail::kMinima},
    {detail::kAll, detail::kAll, detail::kByAxis, detail::kByAxis},
    {detail::kBySimplex, detail::kAll, detail::kBySimplex, detail::kByAxis},
};
// A word of quantized bounds is one or two vectors, so a stage by axis could
// skip nothing.
inline constexpr detail::Way kWayOfQuantized[3][4] = {
    {detail::kMinima, detail::kMinima, detail::kMinima, detail::kMinima},
    {detail::kAll, detail::kAll, detail::kAll, detail::kAll},
    {detail::kBySimplex, detail::kAll, detail::kBySimplex, detail::kBySimplex},
};

// The streaming way: of one query over planes that are not in cache.
inline constexpr detail::Way kStreamingWayOf[detail::kWays] = {
    detail::kMinimaStreaming, detail::kMinimaStreaming, detail::kAllStreaming,
    detail::kAllStreaming,    detail::kByAxis,          detail::kBySimplex,
};

// Writes the words of a part. Returns the bit of the target.
inline std::int64_t Run(const detail::Scan& scan, const detail::Part& part) {
  return scan.kernels->run[scan.way](scan, part);
}

// Throws (error.h) in the name of `call`. An empty world resolves
// its target too, so that a bad target is always an error.
inline void Prepare(detail::Scan& scan, const Options& options,
                    const char* call) {
  const Range& range = options.range;
  scan.call = call;
  scan.begin = std::min(range.begin, scan.size);
  scan.end = std::min(range.end, scan.size);
  // A quick check of a few cycles that finds whether anything may be wrong;
  // only then is each plane checked. Refined scans have planes of floats
  // too, and are always checked.
  const auto queries = reinterpret_cast<std::uintptr_t>(scan.queries);
  if (queries == 0 || (queries & (scan.query_bytes - 1u)) != 0 ||
      scan.addresses.lowest == 0 ||
      (scan.addresses.bits & (scan.element_bytes - 1u)) != 0 ||
      scan.size > kMostObjects || scan.is_refined) [[unlikely]] {
    RefuseBadWorld(scan);
  }
  if (range.begin > range.end) [[unlikely]]
    RefuseBadRange(scan, range);
  const auto schedule = static_cast<std::size_t>(options.schedule);
  if (schedule > static_cast<std::size_t>(Schedule::kStagedByAxis))
      [[unlikely]] {
    RefuseSchedule(scan, options.schedule);
  }
  scan.kernels = scan.all_kernels + IndexOf(options.target, call);
  scan.is_aligned =
      (scan.addresses.bits | scan.begin * scan.element_bytes) % 64 == 0;
  scan.is_streaming =
      scan.query_count == 1 &&
      (scan.end - scan.begin) * scan.record_bytes > kInCacheBytes &&
      StreamingPays();
  const auto shape = static_cast<std::size_t>(scan.shape);
  scan.way = scan.quantizer == nullptr ? kWayOf[shape][schedule]
                                       : kWayOfQuantized[shape][schedule];
  if (scan.is_streaming) scan.way = kStreamingWayOf[scan.way];
}

// Only after the last check, because a call that is refused writes nothing.
inline void ReportTarget(const detail::Scan& scan, const Options& options) {
  if (options.ran == nullptr) [[likely]]
    return;
  // The kernel says which target it is of: no queries, no objects.
  detail::Part nothing{};
  nothing.queries = scan.queries;
  *options.ran = Target::FromHighwayBit(Run(scan, nothing));
}

// Throws unless the output lies outside every plane and query, and is aligned.
inline void CheckOutput(const detail::Scan& scan, const Output& output) {
  if (output.bytes == 0) return;
  const auto begin = reinterpret_cast<std::uintptr_t>(output.begin);
  const auto queries = reinterpret_cast<std::uintptr_t>(scan.queries);
  const std::size_t query_bytes = scan.query_count * scan.query_record_bytes;
  // Usually all planes are in one block of memory and the output is outside it,
  // which one compare finds. Differences wrap.
  const std::size_t world_bytes = scan.addresses.highest -
                                  scan.addresses.lowest +
                                  scan.size * scan.element_bytes;
  if (begin == 0 || (begin & (output.alignment - 1)) != 0 ||
      begin - scan.addresses.lowest < world_bytes ||
      scan.addresses.lowest - begin < output.bytes ||
      begin - queries < query_bytes || queries - begin < output.bytes ||
      scan.is_refined) [[unlikely]] {
    RefuseBadOutput(scan, output);
  }
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_SCAN_PREPARE_H_

#include "dispatch/scan/prepare.h"

#include <string>

#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"

namespace halfspace::dispatch {
namespace {

using dispatch::CheckPointer;
using dispatch::Overlap;
using dispatch::ThrowInvalid;

std::string PlaneName(const detail::Scan& scan, std::size_t p) {
  if (scan.type->kind == detail::PlaneLayout::kSphere) {
    return p == scan.type->dims ? "world.radius"
                                : "world.center[" + std::to_string(p) + "]";
  }
  return dispatch::PlaneName("world", scan.type->axes, p);
}

// plane_at(p) is the address of a plane.
template <typename PlaneAt>
void CheckPlanes(const detail::Scan& scan, const PlaneAt& plane_at,
                 std::size_t bytes) {
  for (std::size_t p = 0; p < scan.type->plane_count; ++p) {
    CheckPointer(
        scan.call, plane_at(p), bytes, [&] { return PlaneName(scan, p); },
        [&] {
          return "a plane of " + std::to_string(scan.size) +
                 (bytes == sizeof(double) ? " doubles" : " floats");
        });
  }
}

template <typename PlaneAt>
void CheckApart(const detail::Scan& scan, const PlaneAt& plane_at,
                std::size_t plane_bytes, const CallOutput& output) {
  for (std::size_t p = 0; p < scan.type->plane_count; ++p) {
    if (Overlap(plane_at(p), plane_bytes, output.begin,
                output.used * output.bytes)) {
      dispatch::ThrowOverlap(scan.call, output.argument, "the world's planes",
                             "an overlap with " + PlaneName(scan, p));
    }
  }
}

void CheckWorld(const detail::Scan& scan) {
  const detail::ScanType& type = *scan.type;
  if (type.is_refined && scan.floats.size != scan.size) {
    ThrowInvalid(
        scan.call, "world",
        "as many floats as quantized bounds, " + std::to_string(scan.size),
        std::to_string(scan.floats.size));
  }
  if (scan.query_count != 0) {
    CheckPointer(
        scan.call, scan.queries, type.query_bytes,
        [] { return std::string("queries"); },
        [&] { return std::to_string(scan.query_count) + " queries"; });
  }
  if (scan.size == 0) return;
  const std::size_t bytes = type.element_bytes;
  dispatch::CheckAddressable(scan.call, "world.size", scan.size, bytes);
  // Quantized bounds are always the library's own.
  if (type.encode == nullptr) {
    CheckPlanes(
        scan, [&](std::size_t p) { return PlaneAt(scan, p); }, bytes);
  }
  if (type.is_refined) {
    CheckPlanes(
        scan, [&](std::size_t p) { return scan.floats.column[p]; },
        sizeof(float));
  }
}

void CheckIndicesFit(const detail::Scan& scan) {
  if (std::uint64_t{scan.size} > kMostIndices) {
    ThrowInvalid(scan.call, "world.size",
                 "at most 2^32 objects for 32-bit indices",
                 std::to_string(scan.size));
  }
  if (std::uint64_t{scan.query_count} > kMostIndices) {
    ThrowInvalid(scan.call, "queries",
                 "at most 2^32 queries for 32-bit indices",
                 std::to_string(scan.query_count));
  }
}

}  // namespace

std::size_t CheckEach(const detail::Scan& scan, const Options& options,
                      const CallOutput& output) {
  CheckWorld(scan);
  const Range& range = options.range;
  if (range.begin > range.end) {
    ThrowInvalid(scan.call, "options.range.end",
                 "not less than its begin, " + std::to_string(range.begin),
                 std::to_string(range.end));
  }
  if (static_cast<std::size_t>(options.schedule) > kLastSchedule) {
    ThrowInvalid(scan.call, "options.schedule", "one of the enumerators",
                 std::to_string(static_cast<int>(options.schedule)));
  }
  const std::size_t target = IndexOf(options.target, scan.call);
  CheckOutput(scan, output);
  return target;
}

void CheckOutput(const detail::Scan& scan, const CallOutput& output) {
  if (output.are_indices) CheckIndicesFit(scan);
  if (output.size < output.used) {
    const std::size_t objects = scan.end - scan.begin;
    ThrowInvalid(scan.call, output.argument,
                 "at least " + std::to_string(output.used) + " words for " +
                     std::to_string(objects) + " objects",
                 std::to_string(output.size));
  }
  const std::size_t bytes = output.used * output.bytes;
  if (bytes == 0) return;
  CheckPointer(
      scan.call, output.begin, output.bytes, [&] { return output.argument; },
      [] { return "room for the output"; });
  CheckApart(
      scan, [&](std::size_t p) { return PlaneAt(scan, p); },
      scan.size * scan.type->element_bytes, output);
  if (scan.type->is_refined) {
    CheckApart(
        scan, [&](std::size_t p) { return scan.floats.column[p]; },
        dispatch::ColumnBytes(scan.floats.size, scan.floats.stride,
                              sizeof(float)),
        output);
  }
  if (Overlap(scan.queries, scan.query_count * scan.type->query_record_bytes,
              output.begin, bytes)) {
    dispatch::ThrowOverlap(scan.call, output.argument, "the queries",
                           "an overlap with them");
  }
}

}  // namespace halfspace::dispatch

#include "dispatch/scan/prepare.h"

#include <string>

#include "kernels/error.h"
#include "kernels/memory_checks.h"

namespace halfspace::dispatch {
namespace {

using kernels::CheckPointer;
using kernels::Overlap;
using kernels::ThrowInvalid;

std::string PlaneName(const detail::Scan& scan, std::size_t p) {
  return kernels::PlaneName("world", scan.axes, p);
}

template <typename Pointers>
void CheckPlanes(const detail::Scan& scan, const Pointers& planes,
                 std::size_t bytes) {
  for (std::size_t p = 0; p < scan.plane_count; ++p) {
    CheckPointer(
        scan.call, planes[p], bytes, [&] { return PlaneName(scan, p); },
        [&] {
          return "a plane of " + std::to_string(scan.size) +
                 (bytes == sizeof(double) ? " doubles" : " floats");
        });
  }
}

template <typename Pointers>
void CheckApart(const detail::Scan& scan, const Pointers& planes,
                std::size_t plane_bytes, const Output& output) {
  for (std::size_t p = 0; p < scan.plane_count; ++p) {
    if (Overlap(planes[p], plane_bytes, output.begin, output.bytes)) {
      kernels::ThrowOverlap(scan.call, output.argument, "the world's planes",
                            "an overlap with " + PlaneName(scan, p));
    }
  }
}

}  // namespace

void RefuseBadWorld(const detail::Scan& scan) {
  if (scan.is_refined && scan.floats.size != scan.size) {
    ThrowInvalid(
        scan.call, "world",
        "as many floats as quantized bounds, " + std::to_string(scan.size),
        std::to_string(scan.floats.size));
  }
  if (scan.query_count != 0) {
    CheckPointer(
        scan.call, scan.queries, scan.query_bytes,
        [] { return std::string("queries"); },
        [&] { return std::to_string(scan.query_count) + " queries"; });
  }
  if (scan.size == 0) return;
  const std::size_t bytes = scan.element_bytes;
  kernels::CheckAddressable(scan.call, "world.size", scan.size, bytes);
  // Quantized bounds are always the library's own.
  if (scan.quantizer == nullptr) CheckPlanes(scan, scan.planes, bytes);
  if (scan.is_refined) CheckPlanes(scan, scan.floats.planes, sizeof(float));
}

void RefuseBadRange(const detail::Scan& scan, const Range& range) {
  ThrowInvalid(scan.call, "options.range.end",
               "not less than its begin, " + std::to_string(range.begin),
               std::to_string(range.end));
}

void RefuseSchedule(const detail::Scan& scan, Schedule schedule) {
  ThrowInvalid(scan.call, "options.schedule", "one of the enumerators",
               std::to_string(static_cast<int>(schedule)));
}

void RefuseBadOutput(const detail::Scan& scan, const Output& output) {
  CheckPointer(
      scan.call, output.begin, output.alignment,
      [&] { return output.argument; }, [] { return "room for the output"; });
  CheckApart(scan, scan.planes, scan.size * scan.element_bytes, output);
  if (scan.is_refined) {
    CheckApart(scan, scan.floats.planes,
               kernels::ColumnBytes(scan.floats.size, scan.floats.stride,
                                    sizeof(float)),
               output);
  }
  if (Overlap(scan.queries, scan.query_count * scan.query_record_bytes,
              output.begin, output.bytes)) {
    kernels::ThrowOverlap(scan.call, output.argument, "the queries",
                          "an overlap with them");
  }
}

void CheckIndicesFit(const detail::Scan& scan) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
  if (scan.size > kMost) {
    ThrowInvalid(scan.call, "world.size",
                 "at most 2^32 objects for 32-bit indices",
                 std::to_string(scan.size));
  }
  if (scan.query_count > kMost) {
    ThrowInvalid(scan.call, "queries",
                 "at most 2^32 queries for 32-bit indices",
                 std::to_string(scan.query_count));
  }
}

}  // namespace halfspace::dispatch

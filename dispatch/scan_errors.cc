#include "dispatch/scan_errors.h"

#include <algorithm>
#include <limits>
#include <string>

#include "kernels/error.h"
#include "kernels/memory_checks.h"

namespace halfspace::dispatch {
namespace {

using detail::Element;
using kernels::CheckPointer;
using kernels::Overlap;
using kernels::ThrowInvalid;

std::string PlaneName(const detail::Scan& scan, std::size_t p) {
  const std::size_t axes = scan.axes;
  std::string name = "world.";
  name += p < axes ? "min[" : "max[";
  return name + std::to_string(p % axes) + "]";
}

template <typename Pointers>
void CheckPlanes(const detail::Scan& scan, const Pointers& planes,
                 std::size_t bytes, std::string_view call) {
  for (std::size_t p = 0; p < scan.plane_count; ++p) {
    CheckPointer(
        call, planes[p], bytes, [&] { return PlaneName(scan, p); },
        [&] {
          return "a plane of " + std::to_string(scan.size) +
                 (bytes == sizeof(double) ? " doubles" : " floats");
        });
  }
}

template <typename Pointers>
void CheckApart(const detail::Scan& scan, const Pointers& planes,
                std::size_t plane_bytes, std::string_view call,
                std::string_view argument, const void* begin,
                std::size_t bytes) {
  for (std::size_t p = 0; p < scan.plane_count; ++p) {
    if (Overlap(planes[p], plane_bytes, begin, bytes)) {
      ThrowInvalid(call, argument, "memory apart from the world's planes",
                   "an overlap with " + PlaneName(scan, p));
    }
  }
}

// From the first value of a column to the end of the last.
std::size_t ColumnBytes(const detail::FloatColumns& columns) {
  return columns.size == 0
             ? 0
             : ((columns.size - 1) * columns.stride + 1) * sizeof(float);
}

}  // namespace

void RefuseBadWorld(const detail::Scan& scan, std::string_view call) {
  if (scan.is_confirmed && scan.confirming.size != scan.size) {
    ThrowInvalid(call, "world",
                 "as many floats as codes, " + std::to_string(scan.size),
                 std::to_string(scan.confirming.size));
  }
  if (scan.query_count != 0) {
    CheckPointer(
        call, scan.queries, scan.query_bytes,
        [] { return std::string("queries"); },
        [&] { return std::to_string(scan.query_count) + " queries"; });
  }
  if (scan.size == 0) return;
  const std::size_t bytes = scan.element_bytes;
  if (scan.size > std::numeric_limits<std::size_t>::max() / bytes) {
    ThrowInvalid(call, "world.size", "a size that fits the address space",
                 std::to_string(scan.size));
  }
  // Codes are always the library's own.
  if (scan.book == nullptr) CheckPlanes(scan, scan.planes, bytes, call);
  if (scan.is_confirmed) {
    CheckPlanes(scan, scan.confirming.planes, sizeof(float), call);
  }
}

void RefuseBadRange(const detail::Scan& scan, const Range& range,
                    std::string_view call) {
  if (range.begin % 64 != 0) {
    ThrowInvalid(call, "options.range.begin", "a multiple of 64",
                 std::to_string(range.begin));
  }
  if (range.end % 64 != 0 && range.end < scan.size) {
    ThrowInvalid(call, "options.range.end",
                 "a multiple of 64, or the world's size",
                 std::to_string(range.end));
  }
  if (range.begin > range.end) {
    ThrowInvalid(call, "options.range.end",
                 "not less than its begin, " + std::to_string(range.begin),
                 std::to_string(range.end));
  }
}

void RefuseBadSchedule(Schedule schedule, std::string_view call) {
  ThrowInvalid(call, "options.schedule", "one of the enumerators",
               std::to_string(static_cast<int>(schedule)));
}

void RefuseBadOutput(const detail::Scan& scan, std::string_view call,
                     std::string_view argument, const void* begin,
                     std::size_t bytes, std::size_t alignment) {
  CheckPointer(
      call, begin, alignment, [&] { return argument; },
      [] { return "room for the output"; });
  CheckApart(scan, scan.planes, scan.size * scan.element_bytes, call, argument,
             begin, bytes);
  if (scan.is_confirmed) {
    CheckApart(scan, scan.confirming.planes, ColumnBytes(scan.confirming), call,
               argument, begin, bytes);
  }
  if (Overlap(scan.queries,
              scan.query_count * scan.plane_count * scan.query_bytes, begin,
              bytes)) {
    ThrowInvalid(call, argument, "memory apart from the queries",
                 "an overlap with them");
  }
}

}  // namespace halfspace::dispatch

#include "dispatch/prepared_scan.h"

#include <algorithm>
#include <limits>
#include <string>

#include "dispatch/confirm.h"
#include "dispatch/registry.h"
#include "dispatch/shape_planes.h"
#include "halfspace/detail/code_book.h"
#include "kernels/error.h"
#include "kernels/memory_checks.h"

namespace halfspace::dispatch {
namespace {

using detail::Element;
using detail::Shape;
using kernels::CheckPointer;
using kernels::Overlap;
using kernels::ThrowInvalid;

std::size_t BytesOf(Element element) {
  constexpr std::size_t kBytes[] = {sizeof(float), sizeof(double),
                                    sizeof(std::int8_t), sizeof(std::int16_t)};
  return kBytes[static_cast<std::size_t>(element)];
}

// Queries are floats, or doubles in a world of doubles.
std::size_t QueryBytes(const detail::Scan& scan) {
  return scan.element == Element::kFloat64 ? sizeof(double) : sizeof(float);
}

std::string PlaneName(const detail::Scan& scan, std::size_t p) {
  const std::size_t axes = AxesOf(scan);
  std::string name = "world.";
  name += p < axes ? "min[" : "max[";
  return name + std::to_string(p % axes) + "]";
}

Variant VariantOf(const detail::Scan& scan, Schedule schedule,
                  std::string_view call) {
  // The measured defaults; docs/design.md says why.
  if (schedule == Schedule::kAuto) {
    schedule = scan.shape == Shape::kAabo ? Schedule::kStaged : Schedule::kFlat;
  }
  if (schedule > Schedule::kStagedByAxis) {
    ThrowInvalid(call, "options.schedule", "one of the enumerators",
                 std::to_string(static_cast<int>(schedule)));
  }
  const bool flat = schedule == Schedule::kFlat;
  switch (scan.shape) {
    case Shape::kSimplex:
      return flat ? kSimplexFlat : kSimplexByAxis;
    case Shape::kAabb:
      return flat ? kAabbFlat : kAabbByAxis;
    case Shape::kAabo:
      break;
  }
  if (flat) return kAaboFlat;
  return schedule == Schedule::kStaged ? kAaboBySimplex : kAaboByAxis;
}

void CheckPlanes(const detail::Scan& scan, const detail::PlanePointers& planes,
                 std::size_t bytes, std::string_view call) {
  for (std::size_t p = 0; p < PlanesOf(scan); ++p) {
    CheckPointer(
        call, planes[p], bytes, [&] { return PlaneName(scan, p); },
        [&] {
          return "a plane of " + std::to_string(scan.size) +
                 (bytes == sizeof(double) ? " doubles" : " floats");
        });
  }
}

}  // namespace

PreparedScan::PreparedScan(const detail::Scan& scan, const Options& options,
                           std::string_view call)
    : scan_(scan), call_(call) {
  if (scan.is_confirmed && scan.confirming_size != scan.size) {
    ThrowInvalid(call, "world",
                 "as many floats as codes, " + std::to_string(scan.size),
                 std::to_string(scan.confirming_size));
  }
  if (scan.query_count != 0) {
    CheckPointer(
        call, scan.queries, QueryBytes(scan),
        [] { return std::string("queries"); },
        [&] { return std::to_string(scan.query_count) + " queries"; });
  }
  if (scan.size != 0) CheckWorld();
  SetRange(options.range);
  table_ = &KernelsFor(options.target, scan.dims, call);
  kernel_ = table_->mask[static_cast<std::size_t>(scan.element)]
                        [VariantOf(scan, options.schedule, call)];
}

void PreparedScan::CheckWorld() const {
  const std::size_t bytes = BytesOf(scan_.element);
  if (scan_.size > std::numeric_limits<std::size_t>::max() / bytes) {
    ThrowInvalid(call_, "world.size", "a size that fits the address space",
                 std::to_string(scan_.size));
  }
  // Codes are always the library's own.
  if (scan_.book == nullptr) CheckPlanes(scan_, scan_.planes, bytes, call_);
  if (scan_.is_confirmed) {
    CheckPlanes(scan_, scan_.confirming, sizeof(float), call_);
  }
}

void PreparedScan::SetRange(const Range& range) {
  const auto must_be = [this](const char* argument, const char* expected,
                              std::size_t given) {
    ThrowInvalid(call_, argument, expected, std::to_string(given));
  };
  end_ = std::min(range.end, scan_.size);
  begin_ = std::min(range.begin, scan_.size);
  if (range.begin % 64 != 0) {
    must_be("options.range.begin", "a multiple of 64", range.begin);
  }
  if (end_ % 64 != 0 && end_ != scan_.size) {
    must_be("options.range.end", "a multiple of 64, or the world's size",
            range.end);
  }
  if (range.begin > range.end) {
    must_be("options.range.end", "not less than its begin", range.end);
  }
}

std::size_t PreparedScan::RecordBytes() const {
  return PlanesOf(scan_) * BytesOf(scan_.element);
}

void PreparedScan::CheckOutput(std::string_view argument, const void* begin,
                               std::size_t bytes, std::size_t alignment) const {
  if (bytes == 0) return;
  CheckPointer(
      call_, begin, alignment, [&] { return argument; },
      [] { return "room for the output"; });
  const auto check = [&](const detail::PlanePointers& planes,
                         std::size_t element_bytes) {
    for (std::size_t p = 0; p < PlanesOf(scan_); ++p) {
      if (Overlap(planes[p], scan_.size * element_bytes, begin, bytes)) {
        ThrowInvalid(call_, argument, "memory apart from the world's planes",
                     "an overlap with " + PlaneName(scan_, p));
      }
    }
  };
  check(scan_.planes, BytesOf(scan_.element));
  if (scan_.is_confirmed) check(scan_.confirming, sizeof(float));
  if (Overlap(scan_.queries,
              scan_.query_count * PlanesOf(scan_) * QueryBytes(scan_), begin,
              bytes)) {
    ThrowInvalid(call_, argument, "memory apart from the queries",
                 "an overlap with them");
  }
}

void PreparedScan::CheckIndicesFit() const {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
  if (scan_.size > kMost) {
    ThrowInvalid(call_, "world.size", "at most 2^32 objects for 32-bit indices",
                 std::to_string(scan_.size));
  }
  if (scan_.query_count > kMost) {
    ThrowInvalid(call_, "queries", "at most 2^32 queries for 32-bit indices",
                 std::to_string(scan_.query_count));
  }
}

QueryBlock PreparedScan::BlockOf(std::size_t first, std::byte* codes) const {
  const std::size_t planes = PlanesOf(scan_);
  const std::size_t count = std::min(kBlockQueries, scan_.query_count - first);
  QueryBlock block{first, count, nullptr, nullptr};
  if (scan_.book == nullptr) {
    block.elements = static_cast<const std::byte*>(scan_.queries) +
                     first * planes * QueryBytes(scan_);
    return block;
  }
  block.elements = codes;
  block.floats = static_cast<const float*>(scan_.queries) + first * planes;
  for (std::size_t q = 0; q < count; ++q) {
    const float* values = block.floats + q * planes;
    if (scan_.element == Element::kCode8) {
      scan_.book->CodeQuery(values,
                            reinterpret_cast<std::int8_t*>(codes) + q * planes);
    } else {
      scan_.book->CodeQuery(
          values, reinterpret_cast<std::int16_t*>(codes) + q * planes);
    }
  }
  return block;
}

std::int64_t PreparedScan::Run(const QueryBlock& block, std::size_t first,
                               std::size_t count, std::size_t begin,
                               std::size_t end, std::uint64_t* rows,
                               std::size_t stride, std::uint64_t flip) const {
  const std::size_t planes = PlanesOf(scan_);
  const std::size_t element_bytes = BytesOf(scan_.element);
  const std::int64_t target =
      kernel_({.planes = scan_.planes.data(),
               .queries = block.elements + first * planes * element_bytes,
               .query_count = count,
               .begin = begin,
               .end = end,
               .rows = rows,
               .stride = stride,
               .flip = scan_.is_confirmed ? ~std::uint64_t{0} : flip});
  if (!scan_.is_confirmed) return target;
  const std::size_t words = MaskWords(end - begin);
  for (std::size_t q = 0; q < count; ++q) {
    std::uint64_t* row = rows + q * stride;
    ConfirmWords(scan_, block.floats + (first + q) * planes, begin, row, words);
    if (flip == 0) {
      for (std::size_t w = 0; w < words; ++w) row[w] = ~row[w];
    }
  }
  return target;
}

}  // namespace halfspace::dispatch

#include "dispatch/prepared_scan.h"

#include <string>

#include "halfspace/detail/code_book.h"
#include "kernels/error.h"
#include "kernels/prefetch.h"

namespace halfspace::dispatch {

void PreparedScan::CheckIndicesFit() const {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
  if (scan_.size > kMost) {
    kernels::ThrowInvalid(call_, "world.size",
                          "at most 2^32 objects for 32-bit indices",
                          std::to_string(scan_.size));
  }
  if (scan_.query_count > kMost) {
    kernels::ThrowInvalid(call_, "queries",
                          "at most 2^32 queries for 32-bit indices",
                          std::to_string(scan_.query_count));
  }
}

void PreparedScan::PrefetchTile(std::size_t begin, std::size_t objects,
                                std::size_t share, std::size_t shares) const {
  constexpr std::size_t kLine = 64;
  const std::size_t end = begin + std::min(objects, end_ - begin);
  const std::size_t bytes = (end - begin) * scan_.element_bytes;
  const std::size_t lines = bytes / kLine;
  const std::size_t first = lines * share / shares;
  const std::size_t last = lines * (share + 1) / shares;
  for (std::size_t p = 0; p < scan_.plane_count; ++p) {
    const char* plane =
        static_cast<const char*>(scan_.planes[p]) + begin * scan_.element_bytes;
    for (std::size_t line = first; line < last; ++line) {
      kernels::PrefetchFar(plane + line * kLine);
    }
  }
}

QueryBlock PreparedScan::CodedBlock(std::size_t first, std::byte* codes) const {
  const std::size_t count = std::min(kBlockQueries, scan_.query_count - first);
  const float* values =
      static_cast<const float*>(scan_.queries) + first * scan_.plane_count;
  std::byte* to = codes;
  for (std::size_t q = 0; q < count; ++q) {
    if (scan_.element == detail::Element::kCode8) {
      scan_.book->CodeQuery(values, reinterpret_cast<std::int8_t*>(to));
    } else {
      scan_.book->CodeQuery(values, reinterpret_cast<std::int16_t*>(to));
    }
    values += scan_.plane_count;
    to += RecordBytes();
  }
  return {first, count, codes};
}

}  // namespace halfspace::dispatch

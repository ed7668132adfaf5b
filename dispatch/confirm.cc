#include "dispatch/confirm.h"

#include <bit>

#include "dispatch/shape_planes.h"

namespace halfspace::dispatch {
namespace {

const float* PlaneOf(const detail::Scan& scan, std::size_t p) {
  return static_cast<const float*>(scan.confirming[p]);
}

// One object at a time: so few are left that a vector would be mostly idle. Its
// loads, one from each plane, miss the caches all at once.
bool Rejects(const detail::Scan& scan, const float* query, std::size_t i) {
  const std::size_t axes = AxesOf(scan);
  const bool has_maxima = scan.shape != detail::Shape::kSimplex;
  const float* query_max = has_maxima ? query + axes : query;
  bool rejected = false;
  for (std::size_t k = 0; k < axes; ++k) {
    rejected |= PlaneOf(scan, k)[i] > query_max[k];
  }
  if (!has_maxima) return rejected;
  for (std::size_t k = 0; k < axes; ++k) {
    rejected |= PlaneOf(scan, axes + k)[i] < query[k];
  }
  return rejected;
}

}  // namespace

void ConfirmWords(const detail::Scan& scan, const float* query,
                  std::size_t first, std::uint64_t* words, std::size_t count) {
  for (std::size_t w = 0; w < count; ++w) {
    std::uint64_t kept = words[w];
    if (kept == 0) [[likely]]
      continue;
    for (std::uint64_t left = kept; left != 0; left &= left - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(left));
      if (Rejects(scan, query, first + 64 * w + bit)) {
        kept &= ~(std::uint64_t{1} << bit);
      }
    }
    words[w] = kept;
  }
}

}  // namespace halfspace::dispatch

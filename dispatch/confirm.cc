#include "dispatch/confirm.h"

#include <bit>

#include "kernels/prefetch.h"

namespace halfspace::dispatch {
namespace {

const float* ValueOf(const detail::Scan& scan, std::size_t plane,
                     std::size_t object) {
  return scan.confirming.planes[plane] + object * scan.confirming.stride;
}

// One object at a time: so few are left that a vector would be mostly idle.
bool Rejects(const detail::Scan& scan, const float* query, std::size_t i) {
  const std::size_t axes = scan.axes;
  const bool has_maxima = scan.shape != detail::Shape::kSimplex;
  const float* query_max = has_maxima ? query + axes : query;
  bool rejected = false;
  for (std::size_t k = 0; k < axes; ++k) {
    rejected |= *ValueOf(scan, k, i) > query_max[k];
  }
  if (!has_maxima) return rejected;
  for (std::size_t k = 0; k < axes; ++k) {
    rejected |= *ValueOf(scan, axes + k, i) < query[k];
  }
  return rejected;
}

// Calls visit(word, bit, object) for every candidate.
template <typename Visit>
void ForEachCandidate(const Candidates& candidates, const Visit& visit) {
  for (std::uint64_t live = candidates.live; live != 0; live &= live - 1) {
    const auto w = static_cast<std::size_t>(std::countr_zero(live));
    for (std::uint64_t left = candidates.words[w]; left != 0;
         left &= left - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(left));
      visit(candidates.words[w], bit, candidates.first + 64 * w + bit);
    }
  }
}

}  // namespace

void PrefetchFloats(const detail::Scan& scan, const Candidates& candidates) {
  const std::size_t planes = scan.plane_count;
  // A record may lie across two cache lines; planes are a line each.
  const std::size_t step = scan.confirming.stride == 1 ? 1 : planes - 1;
  ForEachCandidate(candidates,
                   [&](std::uint64_t&, std::size_t, std::size_t object) {
                     for (std::size_t p = 0; p < planes; p += step) {
                       kernels::Prefetch(ValueOf(scan, p, object));
                     }
                   });
}

void ConfirmWords(const detail::Scan& scan, const Candidates& candidates) {
  ForEachCandidate(candidates, [&](std::uint64_t& word, std::size_t bit,
                                   std::size_t object) {
    if (Rejects(scan, candidates.query, object)) {
      word &= ~(std::uint64_t{1} << bit);
    }
  });
}

}  // namespace halfspace::dispatch

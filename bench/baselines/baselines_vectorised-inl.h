// The loops that the compiler vectorises, included once for each instruction
// set, which HALFSPACE_BASELINE names: compiled above the baseline, so that
// nothing of the C++ library may be used here, and in a namespace that says so.

#include "bench/baselines/simplex_job.h"

namespace halfspace::bench {
namespace HALFSPACE_BASELINE {
namespace {

// 16 KiB of planes.
constexpr std::size_t kTile = 1024;

unsigned CountByOr(const float* x, const float* y, const float* z,
                   const float* d, std::size_t objects, const float* query) {
  const float qx = query[0], qy = query[1], qz = query[2], qd = query[3];
  unsigned rejected = 0;
  for (std::size_t i = 0; i < objects; ++i) {
    rejected += static_cast<unsigned>((x[i] > qx) | (y[i] > qy) | (z[i] > qz) |
                                      (d[i] > qd));
  }
  return static_cast<unsigned>(objects) - rejected;
}

unsigned CountByAnd(const float* x, const float* y, const float* z,
                    const float* d, std::size_t objects, const float* query) {
  const float qx = query[0], qy = query[1], qz = query[2], qd = query[3];
  unsigned count = 0;
  for (std::size_t i = 0; i < objects; ++i) {
    count += static_cast<unsigned>((x[i] <= qx) & (y[i] <= qy) & (z[i] <= qz) &
                                   (d[i] <= qd));
  }
  return count;
}

template <typename CountTile>
void Count(const SimplexJob& job, CountTile count_tile) {
  for (std::size_t q = 0; q < job.query_count; ++q) job.counts[q] = 0;
  for (std::size_t begin = 0; begin < job.objects; begin += kTile) {
    const std::size_t left = job.objects - begin;
    const std::size_t objects = left < kTile ? left : kTile;
    for (std::size_t q = 0; q < job.query_count; ++q) {
      job.counts[q] += count_tile(job.planes[0] + begin, job.planes[1] + begin,
                                  job.planes[2] + begin, job.planes[3] + begin,
                                  objects, job.queries + 4 * q);
    }
  }
}

}  // namespace

void CountWithOr(const SimplexJob& job) { Count(job, CountByOr); }
void CountWithAnd(const SimplexJob& job) { Count(job, CountByAnd); }

}  // namespace HALFSPACE_BASELINE
}  // namespace halfspace::bench

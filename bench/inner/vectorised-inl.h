// The loop that a compiler vectorises: part of target_loops.cc.

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// 16 KiB of planes.
inline constexpr size_t kVectorisedTile = 1024;

// Rejected ones by OR, or survivors by AND: compilers prefer one or the other.
template <bool kByOr>
size_t CountTile(const bench::SimplexJob& job, size_t begin, size_t objects,
                 const float* query) {
  const float* const x = job.planes[0] + begin;
  const float* const y = job.planes[1] + begin;
  const float* const z = job.planes[2] + begin;
  const float* const d = job.planes[3] + begin;
  const float qx = query[0], qy = query[1], qz = query[2], qd = query[3];
  unsigned count = 0;
  for (size_t i = 0; i < objects; ++i) {
    if constexpr (kByOr) {
      count += static_cast<unsigned>((x[i] > qx) | (y[i] > qy) | (z[i] > qz) |
                                     (d[i] > qd));
    } else {
      count += static_cast<unsigned>((x[i] <= qx) & (y[i] <= qy) &
                                     (z[i] <= qz) & (d[i] <= qd));
    }
  }
  return kByOr ? objects - count : count;
}

template <bool kByOr>
void CountSimplices(const bench::SimplexJob& job) {
  for (size_t q = 0; q < job.query_count; ++q) job.counts[q] = 0;
  for (size_t begin = 0; begin < job.objects; begin += kVectorisedTile) {
    const size_t objects = HWY_MIN(kVectorisedTile, job.objects - begin);
    for (size_t q = 0; q < job.query_count; ++q) {
      job.counts[q] +=
          CountTile<kByOr>(job, begin, objects, job.queries + 4 * q);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#include "dispatch/scan/chunks.h"

#include "kernels/compiler.h"

namespace halfspace::dispatch {
namespace {

const float* ValueOf(const Scan& scan, std::size_t plane, std::size_t object) {
  return scan.floats.floats(plane) + object * scan.floats.stride;
}

}  // namespace

void PrefetchFloats(const Scan& scan, std::size_t object) {
  const std::size_t planes = scan.type->plane_count;
  // A record may span two cache lines. Each plane is in a line of its own.
  const std::size_t step = scan.floats.stride == 1 ? 1 : planes - 1;
  for (std::size_t p = 0; p < planes; p += step) {
    kernels::Prefetch(ValueOf(scan, p, object));
  }
}

// Tests one object at a time, because so few are left that most lanes of a
// vector would be empty.
bool FloatsReject(const Scan& scan, std::size_t query, std::size_t object) {
  const float* values =
      static_cast<const float*>(scan.queries) + query * scan.type->plane_count;
  const std::size_t axes = scan.type->axes;
  bool rejected = false;
  for (std::size_t k = 0; k < axes; ++k) {
    rejected |= *ValueOf(scan, k, object) > values[scan.type->first_max + k];
  }
  for (std::size_t k = axes; k < scan.type->plane_count; ++k) {
    rejected |= *ValueOf(scan, k, object) < values[k - axes];
  }
  return rejected;
}

void PrefetchTile(const Scan& scan, std::size_t begin, std::size_t objects,
                  std::size_t share, std::size_t shares) {
  constexpr std::size_t kLine = 64;
  const std::size_t bytes =
      std::min(objects, scan.end - begin) * scan.type->element_bytes;
  const std::size_t lines = bytes / kLine;
  const std::size_t first = lines * share / shares;
  const std::size_t last = lines * (share + 1) / shares;
  for (std::size_t p = 0; p < scan.type->plane_count; ++p) {
    const char* plane = static_cast<const char*>(PlaneAt(scan, p)) +
                        begin * scan.type->element_bytes;
    for (std::size_t line = first; line < last; ++line) {
      kernels::PrefetchToL2(plane + line * kLine);
    }
  }
}

}  // namespace halfspace::dispatch

// Bounds of floats or of doubles as floats, which a BVH stores. Doubles are
// rounded outward.
#ifndef HALFSPACE_DISPATCH_BVH_ROUNDED_H_
#define HALFSPACE_DISPATCH_BVH_ROUNDED_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "dispatch/bvh/layout.h"
#include "dispatch/bvh/scratch.h"
#include "halfspace/detail/plane_arrays.h"
#include "halfspace/memory.h"
#include "halfspace/runner.h"

namespace halfspace::detail {

// The floats of `objects`. Columns of floats are used as they are. Doubles are
// rounded into planes of `count` values: slot s gets element elements[s], or
// element s if `elements` is null. A slot whose element is kNoId is not
// written.
class Rounded {
 public:
  Rounded(const PlaneLayout& layout, const MemoryResource& memory,
          const Columns& objects, std::size_t count,
          const std::uint32_t* elements, const Runner& run);

  const Columns& columns() const { return columns_; }

 private:
  Scratch floats_;
  Columns columns_;
};

// Calls visit(i, values) for each bound, in order.
template <typename Visit>
void ForEachRecord(const PlaneLayout& layout, const Columns& bounds,
                   const Visit& visit) {
  constexpr std::size_t kSome = 64;
  const std::size_t planes = layout.plane_count;
  const float* const rows = RowsOf(bounds, planes);
  std::array<float, kSome * kMaxPlanes> read;
  for (std::size_t i = 0; i < bounds.size; ++i) {
    if (rows != nullptr) {
      visit(i, rows + i * planes);
      continue;
    }
    if (i % kSome == 0) {
      ReadRecords(bounds, planes, layout.axes, i,
                  std::min(kSome, bounds.size - i), read.data());
    }
    visit(i, read.data() + i % kSome * planes);
  }
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_ROUNDED_H_

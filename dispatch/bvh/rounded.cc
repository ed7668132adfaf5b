#include "dispatch/bvh/rounded.h"

#include "dispatch/exact/default_fp_mode.h"
#include "dispatch/exact/outward.h"
#include "kernels/prefetch.h"

namespace halfspace::detail {
namespace {

// Elements are read in any order.
constexpr std::size_t kAhead = 32;

void PrefetchElement(const Columns& objects, std::size_t planes,
                     std::size_t i) {
  if (i == kNoId) return;
  // The values of a record are in one line, or in two.
  const std::size_t step = objects.stride == 1 ? 1 : planes - 1;
  for (std::size_t p = 0; p < planes; p += step) {
    kernels::Prefetch(objects.doubles(p) + i * objects.stride);
  }
}

}  // namespace

Rounded::Rounded(const PlaneLayout& layout, const MemoryResource& memory,
                 const Columns& objects, std::size_t count,
                 const std::uint32_t* elements, const Runner& run)
    : floats_(memory, objects.is_double
                          ? count * layout.plane_count * sizeof(float)
                          : 0),
      columns_(objects) {
  if (!objects.is_double) return;
  auto* const floats = reinterpret_cast<float*>(floats_.data());
  const std::size_t planes = layout.plane_count;
  columns_ = ColumnsOf<float>(count, 1);
  for (std::size_t p = 0; p < planes; ++p) {
    columns_.column[p] = floats + p * count;
  }
  const auto element_of = [elements](std::size_t s) -> std::size_t {
    return elements == nullptr ? s : elements[s];
  };
  dispatch::RunInDefaultFpMode(run, PartsOf(count), [&](std::size_t part) {
    const std::size_t end = std::min(count, (part + 1) * kPartSlots);
    for (std::size_t s = part * kPartSlots; s < end; ++s) {
      if (s + kAhead < end) {
        PrefetchElement(objects, planes, element_of(s + kAhead));
      }
      const std::size_t i = element_of(s);
      if (i == kNoId) continue;
      for (std::size_t p = 0; p < planes; ++p) {
        const dispatch::ExactSum value = {
            objects.doubles(p)[i * objects.stride], 0.0};
        floats[p * count + s] = p < layout.axes ? dispatch::RoundDown(value)
                                                : dispatch::RoundUp(value);
      }
    }
  });
}

}  // namespace halfspace::detail

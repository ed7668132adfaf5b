// Bounds of doubles, which are rounded outward to floats before a BVH reads
// them. Apart from the calls with floats, which link none of this.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "dispatch/bvh/layout.h"
#include "dispatch/bvh/scratch.h"
#include "halfspace/bvh.h"
#include "halfspace/transform.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/exact/outward.h"
#include "kernels/memory_checks.h"
#include "kernels/prefetch.h"

namespace halfspace::detail {
namespace {

class Rounded {
 public:
  Rounded(const BvhShape& shape, const MemoryResource& memory,
          std::size_t count)
      : shape_(shape),
        count_(count),
        floats_(memory, count * PlanesOf(shape) * sizeof(float)) {}

  // Object s is element element_of(s), or none for kNoId.
  template <typename ElementOf>
  FloatColumns Round(const Columns<double>& objects, const Runner& run,
                     const ElementOf& element_of) const {
    FloatColumns columns;
    columns.size = count_;
    columns.stride = 1;
    for (std::size_t p = 0; p < PlanesOf(shape_); ++p) {
      columns.planes[p] = Plane(p);
    }
    kernels::RunInDefaultFpMode(run, PartsOf(count_), [&](std::size_t part) {
      const std::size_t end = std::min(count_, (part + 1) * kPartSlots);
      for (std::size_t s = part * kPartSlots; s < end; ++s) {
        if (s + kAhead < end) Prefetch(objects, element_of(s + kAhead));
        const std::size_t i = element_of(s);
        if (i != kNoId) RoundObject(objects, i, s);
      }
    });
    return columns;
  }

 private:
  // Elements are read in any order.
  static constexpr std::size_t kAhead = 32;

  void Prefetch(const Columns<double>& objects, std::size_t i) const {
    if (i == kNoId) return;
    // The values of a record are in one line, or in two.
    const std::size_t step = objects.stride == 1 ? 1 : PlanesOf(shape_) - 1;
    for (std::size_t p = 0; p < PlanesOf(shape_); p += step) {
      kernels::Prefetch(objects.planes[p] + i * objects.stride);
    }
  }

  float* Plane(std::size_t p) const {
    return reinterpret_cast<float*>(floats_.data()) + p * count_;
  }

  void RoundObject(const Columns<double>& objects, std::size_t i,
                   std::size_t s) const {
    for (std::size_t p = 0; p < PlanesOf(shape_); ++p) {
      const kernels::ExactSum value = {objects.planes[p][i * objects.stride],
                                       0.0};
      Plane(p)[s] =
          p < shape_.axes ? kernels::RoundDown(value) : kernels::RoundUp(value);
    }
  }

  BvhShape shape_;
  std::size_t count_;
  Scratch floats_;
};

void CheckBounds(const char* call, Span<const double> values) {
  kernels::CheckMemory(call, "bounds", values.data(), values.size(),
                       alignof(double));
}

// Calls change() with a list of records.
template <typename Change>
void WithRounded(const BvhShape& shape, const MemoryResource& memory,
                 Span<const double> values, const Change& change) {
  const Scratch scratch(memory, values.size() * sizeof(float));
  auto* const floats = reinterpret_cast<float*>(scratch.data());
  RoundOutward(values, shape.axes, PlanesOf(shape), floats);
  change(Span<const float>(floats, values.size()));
}

}  // namespace

void BvhTree::Build(const Columns<double>& objects,
                    const BuildOptions& options) {
  CheckBuild(objects.size, options);
  if (objects.size > 0) CheckColumns(shape_, objects, "Bvh");
  const Rounded rounded(shape_, memory_, objects.size);
  Build(rounded.Round(objects, options.run, [](std::size_t s) { return s; }),
        options);
}

void BvhTree::Refit(const Columns<double>& objects, bool is_by_id,
                    const Runner& run) {
  if (!CheckRefit(objects.size, is_by_id)) return;
  const char* const call = is_by_id ? "Bvh::Refit" : "Bvh::RefitInOrder";
  CheckColumns(shape_, objects, call);
  CheckLoaded(call);
  const Rounded rounded(shape_, memory_, slots());
  const FloatColumns in_order =
      rounded.Round(objects, run, [&](std::size_t s) -> std::size_t {
        if (!IsPresent(levels_, s)) return kNoId;
        return is_by_id ? levels_.ids[s] : s;
      });
  Refit(in_order, false, run);
}

void BvhTree::Set(Span<const std::uint32_t> ids, Span<const double> values) {
  CheckBounds("Bvh::Set", values);
  if (!CheckSet(ids, values.size() / PlanesOf(shape_))) return;
  WithRounded(shape_, memory_, values,
              [&](Span<const float> floats) { SetChecked(ids, floats); });
}

void BvhTree::Insert(Span<const double> values, Span<std::uint32_t> ids) {
  CheckBounds("Bvh::Insert", values);
  if (!CheckInsert(values.size() / PlanesOf(shape_), ids)) return;
  WithRounded(shape_, memory_, values,
              [&](Span<const float> floats) { Insert(floats, ids); });
}

}  // namespace halfspace::detail

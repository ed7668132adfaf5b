#include "dispatch/bvh/axes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "dispatch/default_fp_mode.h"

namespace halfspace::detail {
namespace {

using Kernels = BvhKernels::OfPlanes;

// A sample: short runs of consecutive objects.
constexpr std::size_t kRuns = 32;
constexpr std::size_t kRun = 4;

// Calls function(first, count) for each run.
template <typename Function>
void ForRuns(const Columns& objects, const Function& function) {
  const std::size_t step = std::max(kRun, objects.size / kRuns);
  for (std::size_t r = 0; r < kRuns && r * step < objects.size; ++r) {
    function(r * step, std::min(kRun, objects.size - r * step));
  }
}

// Most centers on an axis. The outermost 16ths of the sample extend the range
// of the others by at most a quarter, because objects far away would leave the
// others few cells.
struct Range {
  float least = 0;
  float width = 0;
};
using Ranges = std::array<Range, kCenterAxes>;

Ranges RangesOf(const Columns& objects, const Kernels& kernels) {
  std::array<std::array<float, kRuns * kRun>, kCenterAxes> samples;
  std::array<std::size_t, kCenterAxes> counts{};
  ForRuns(objects, [&](std::size_t first, std::size_t count) {
    Centers centers;
    kernels.centers(objects, first, count, centers);
    for (std::size_t k = 0; k < kCenterAxes; ++k) {
      for (std::size_t i = 0; i < count; ++i) {
        if (centers[k][i] == kLastCenter) continue;
        samples[k][counts[k]++] = centers[k][i];
      }
    }
  });
  Ranges ranges;
  for (std::size_t k = 0; k < kCenterAxes; ++k) {
    const std::size_t count = counts[k];
    if (count == 0) continue;
    float* const sample = samples[k].data();
    std::sort(sample, sample + count);
    const float low = sample[count / 16];
    const float high = sample[count - 1 - count / 16];
    const float more = (high - low) / 4;
    const bool is_narrow = !(low < high);
    ranges[k].least = is_narrow ? sample[0] : std::max(sample[0], low - more);
    ranges[k].width = (is_narrow ? sample[count - 1]
                                 : std::min(sample[count - 1], high + more)) -
                      ranges[k].least;
  }
  return ranges;
}

// The median extent of the sampled objects on an axis, or 0 of bounds without
// maxima. A few large objects do not count. Points of doubles, which are
// rounded outward, have no extent.
double ExtentOf(const PlaneLayout& layout, const Columns& objects,
                std::size_t axis) {
  if (!layout.has_max || axis >= layout.axes) return 0;
  std::array<double, kRuns * kRun> extents;
  std::size_t some = 0;
  ForRuns(objects, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const double min = objects.floats(axis)[i * objects.stride];
      const double max = objects.floats(layout.axes + axis)[i * objects.stride];
      const double rounded = 0x1p-21 * std::max(std::abs(min), std::abs(max));
      if (max >= min) extents[some++] = max - min > rounded ? max - min : 0;
    }
  });
  if (some == 0) return 0;
  std::nth_element(extents.begin(), extents.begin() + some / 2,
                   extents.begin() + some);
  return extents[some / 2];
}

// A float that is not negative, rounded to its upper bits.
constexpr int kDropped = 21;
constexpr std::uint32_t kFieldBits = 32 - 1 - kDropped;

}  // namespace

std::uint32_t AxisWeights::Pack() const {
  static_assert(kFieldBits * kCenterAxes < 32);
  std::uint32_t packed = is_given ? 1u << 31 : 0;
  for (std::size_t k = 0; k < kCenterAxes; ++k) {
    std::uint32_t bits;
    std::memcpy(&bits, &weight[k], sizeof(bits));
    bits += 1u << (kDropped - 1);
    packed |= bits >> kDropped << k * kFieldBits;
  }
  return packed;
}

AxisWeights AxisWeights::Unpack(std::uint32_t packed) {
  AxisWeights weights{};
  weights.is_given = packed != kNone && packed >> 31 != 0;
  for (std::size_t k = 0; k < kCenterAxes; ++k) {
    // Those of an altered blob can be any.
    constexpr std::uint32_t kOne = 0x3F800000;
    const std::uint32_t field =
        packed >> k * kFieldBits & ((1u << kFieldBits) - 1);
    const std::uint32_t bits = std::min(field << kDropped, kOne);
    std::memcpy(&weights.weight[k], &bits, sizeof(bits));
  }
  return weights;
}

namespace {

AxisWeights FindWeights(
    const PlaneLayout& layout, const Columns& objects, const Kernels& kernels,
    const std::optional<std::array<float, 3>>& query_extents) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const Ranges ranges = RangesOf(objects, kernels);
  std::array<double, kCenterAxes> extents;
  double share = kInf;
  for (std::size_t k = 0; k < kCenterAxes; ++k) {
    extents[k] = ExtentOf(layout, objects, k);
    if (extents[k] > 0 && ranges[k].width > 0) {
      share = std::min(share, extents[k] / std::sqrt(double{ranges[k].width}));
    }
  }
  if (share == kInf) share = 1;
  std::array<double, kCenterAxes> units;
  double least = kInf;
  for (std::size_t k = 0; k < kCenterAxes; ++k) {
    const double width = ranges[k].width;
    if (query_extents) {
      const auto& query = *query_extents;
      // The axis D of an octahedron in 2 dimensions is the third one.
      const double its =
          k < layout.dims ? double{query[k]} : double{query[0]} + query[1];
      // Points that are found by points are cut by the extents of all.
      units[k] = std::max(its + extents[k], width * 0x1p-20);
    } else {
      units[k] = extents[k] + share * std::sqrt(width);
    }
    if (width > 0) least = std::min(least, units[k]);
  }
  AxisWeights weights{};
  weights.is_given = query_extents.has_value();
  for (std::size_t k = 0; k < kCenterAxes; ++k) {
    // The sample has no extent on an axis whose unit is less.
    const double weight = units[k] > least ? least / units[k] : 1;
    weights.weight[k] = weight <= 1 ? static_cast<float>(weight) : 0;
  }
  return AxisWeights::Unpack(weights.Pack());
}

Grid FindGrid(const Columns& objects, const AxisWeights& weights,
              const Kernels& kernels) {
  constexpr float kMostCells = std::numeric_limits<float>::max() / 0x1p15f;
  const Ranges ranges = RangesOf(objects, kernels);
  float widest = 0;
  for (std::size_t k = 0; k < kCenterAxes; ++k) {
    widest = std::max(widest, ranges[k].width * weights.weight[k]);
  }
  Grid grid{};
  for (std::size_t k = 0; k < kCenterAxes; ++k) {
    grid.least[k] = ranges[k].least;
    // All centers in one place are in one cell.
    const float cells = widest > 0 ? weights.weight[k] / widest : 0;
    if (cells <= kMostCells) grid.cells_of_unit[k] = cells;
  }
  return grid;
}

}  // namespace

AxisWeights WeightsOf(
    const PlaneLayout& layout, const Columns& objects, const Kernels& kernels,
    const std::optional<std::array<float, 3>>& query_extents) {
  return dispatch::InDefaultFpMode(
      [&] { return FindWeights(layout, objects, kernels, query_extents); });
}

Grid GridOf(const Columns& objects, const AxisWeights& weights,
            const Kernels& kernels) {
  return dispatch::InDefaultFpMode(
      [&] { return FindGrid(objects, weights, kernels); });
}

}  // namespace halfspace::detail

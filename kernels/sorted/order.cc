#include "kernels/sorted/order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "kernels/sorted/block.h"

namespace halfspace::kernels {
namespace {

using detail::Centers;
using detail::kBlockObjects;
using Kernels = detail::SortedKernels::OfPlanes;

constexpr std::size_t kAxes = detail::kCenterAxes;

// Calls function(first, count, centers) for 64 objects at a time.
template <typename Function>
void ForCenters(const detail::FloatColumns& objects, const Kernels& kernels,
                const Function& function) {
  Centers centers;
  for (std::size_t first = 0; first < objects.size; first += kBlockObjects) {
    const std::size_t count = std::min(kBlockObjects, objects.size - first);
    kernels.centers(objects, first, count, centers);
    function(first, count, centers);
  }
}

using Point = std::array<float, kAxes>;

struct Extent {
  Point least;
  Point greatest;

  Extent() {
    least.fill(std::numeric_limits<float>::infinity());
    greatest.fill(-std::numeric_limits<float>::infinity());
  }
  // Without what is placed last: one such object would leave all others a cell.
  void Add(std::size_t axis, float center) {
    least[axis] = std::min(least[axis], center);
    greatest[axis] =
        std::max(greatest[axis],
                 center == detail::kLastCenter ? -detail::kLastCenter : center);
  }
  float Width(std::size_t k) const { return greatest[k] - least[k]; }
};

struct Entry {
  Point center;
  std::uint32_t id;
};
static_assert(sizeof(Entry) == kOrderScratch);

void SortByMedians(Entry* entries, std::size_t count) {
  while (count > detail::kBlockObjects) {
    std::size_t node = detail::kBlockObjects;
    while (node * detail::kBlockObjects < count) node *= detail::kBlockObjects;
    const std::size_t middle = (count + node - 1) / node / 2 * node;
    Extent extent;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < kAxes; ++k) {
        extent.Add(k, entries[i].center[k]);
      }
    }
    std::size_t widest = 0;
    for (std::size_t k = 1; k < kAxes; ++k) {
      if (extent.Width(k) > extent.Width(widest)) widest = k;
    }
    std::nth_element(entries, entries + middle, entries + count,
                     [widest](const Entry& a, const Entry& b) {
                       return a.center[widest] < b.center[widest];
                     });
    SortByMedians(entries, middle);
    entries += middle;
    count -= middle;
  }
}

struct Key {
  std::uint32_t place;
  std::uint32_t id;
};
static_assert(2 * sizeof(Key) == kOrderScratch);

}  // namespace

void OrderByMedians(const detail::FloatColumns& objects, const Kernels& kernels,
                    std::byte* scratch, std::uint32_t* ids) {
  auto* const entries = reinterpret_cast<Entry*>(scratch);
  ForCenters(objects, kernels,
             [&](std::size_t first, std::size_t count, const Centers& centers) {
               for (std::size_t i = 0; i < count; ++i) {
                 entries[first + i] = {
                     {centers[0][i], centers[1][i], centers[2][i]},
                     static_cast<std::uint32_t>(first + i)};
               }
             });
  SortByMedians(entries, objects.size);
  for (std::size_t i = 0; i < objects.size; ++i) ids[i] = entries[i].id;
}

void OrderByCurve(const detail::FloatColumns& objects, const Kernels& kernels,
                  std::byte* scratch, std::uint32_t* ids) {
  Extent extent;
  ForCenters(objects, kernels,
             [&](std::size_t, std::size_t count, const Centers& centers) {
               for (std::size_t k = 0; k < kAxes; ++k) {
                 for (std::size_t i = 0; i < count; ++i) {
                   extent.Add(k, centers[k][i]);
                 }
               }
             });
  detail::Grid grid;
  for (std::size_t k = 0; k < kAxes; ++k) {
    const float width = extent.Width(k);
    grid.least[k] = extent.least[k];
    grid.cells_of_unit[k] =
        width > 0 && 1 / width <= std::numeric_limits<float>::max() / 0x1p15f
            ? 1 / width
            : 0;
  }
  auto* from = reinterpret_cast<Key*>(scratch);
  auto* to = from + objects.size;
  // A radix sort, the lowest digit first.
  constexpr std::size_t kDigits = 3;
  constexpr std::uint32_t kDigitBits = detail::kPlaceBits / kDigits;
  std::array<std::array<std::uint32_t, 1u << kDigitBits>, kDigits> starts{};
  const auto digit_of = [](const Key& key, std::size_t digit) {
    return key.place >> digit * kDigitBits & ((1u << kDigitBits) - 1);
  };
  ForCenters(
      objects, kernels,
      [&](std::size_t first, std::size_t count, const Centers& centers) {
        std::array<std::uint32_t, kBlockObjects> places;
        kernels.places(centers, grid, places.data());
        for (std::size_t i = 0; i < count; ++i) {
          const Key key{places[i], static_cast<std::uint32_t>(first + i)};
          from[first + i] = key;
          for (std::size_t d = 0; d < kDigits; ++d) {
            ++starts[d][digit_of(key, d)];
          }
        }
      });
  for (std::size_t d = 0; d < kDigits; ++d) {
    std::uint32_t start = 0;
    for (std::uint32_t& bucket : starts[d]) {
      start += std::exchange(bucket, start);
    }
    for (std::size_t i = 0; i < objects.size; ++i) {
      to[starts[d][digit_of(from[i], d)]++] = from[i];
    }
    std::swap(from, to);
  }
  for (std::size_t i = 0; i < objects.size; ++i) ids[i] = from[i].id;
}

}  // namespace halfspace::kernels

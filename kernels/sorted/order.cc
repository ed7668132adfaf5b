#include "kernels/sorted/order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "kernels/sorted/block.h"

namespace halfspace::kernels {
namespace {

constexpr std::size_t kAxes = 3;  // the last is 0 in two dimensions

using Point = std::array<float, kAxes>;

// Centers that are no numbers, as of what is empty, come last.
constexpr float kMost = std::numeric_limits<float>::max() / 4;

float CenterOf(float min, float max) {
  const float center = 0.5f * min + 0.5f * max;
  return center >= -kMost && center <= kMost ? center : kMost;
}

// The center of a bound, from its planes.
class Centers {
 public:
  Centers(const detail::SortedShape& shape, const detail::FloatColumns& objects)
      : objects_(objects),
        has_max_(shape.has_max),
        axes_(shape.axes),
        dims_(std::min<std::size_t>(
            shape.has_max ? shape.axes : shape.axes - 1u, kAxes)) {}

  std::size_t size() const { return objects_.size; }

  Point At(std::size_t i) const {
    Point center{};
    if (has_max_) {
      for (std::size_t k = 0; k < dims_; ++k) {
        center[k] = CenterOf(Value(k, i), Value(axes_ + k, i));
      }
      return center;
    }
    // The centroid of a simplex is equally far from all its planes.
    float slack = 0;
    for (std::size_t k = 0; k < axes_; ++k) slack -= Value(k, i);
    slack /= static_cast<float>(axes_);
    for (std::size_t k = 0; k < dims_; ++k) {
      const float value = Value(k, i) + slack;
      center[k] = CenterOf(value, value);
    }
    return center;
  }

 private:
  float Value(std::size_t plane, std::size_t i) const {
    return objects_.planes[plane][i * objects_.stride];
  }

  const detail::FloatColumns& objects_;
  bool has_max_;
  std::size_t axes_;
  std::size_t dims_;
};

struct Extent {
  Point least;
  Point greatest;

  Extent() {
    least.fill(std::numeric_limits<float>::infinity());
    greatest.fill(-std::numeric_limits<float>::infinity());
  }
  // Without what is placed last: one such object would leave all others a cell.
  void Add(const Point& point) {
    for (std::size_t k = 0; k < kAxes; ++k) {
      if (point[k] == kMost) continue;
      least[k] = std::min(least[k], point[k]);
      greatest[k] = std::max(greatest[k], point[k]);
    }
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
    for (std::size_t i = 0; i < count; ++i) extent.Add(entries[i].center);
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

constexpr std::uint32_t kCurveBits = 10;  // of each axis
constexpr std::uint32_t kCells = 1u << kCurveBits;

// Some objects, so that the compiler has loops over them to vectorise.
constexpr std::size_t kChunk = 64;
using Cells = std::array<std::array<std::uint32_t, kChunk>, kAxes>;

// The places of cells on Hilbert's curve: J. Skilling, "Programming the Hilbert
// curve" (2004), without branches on the bits.
void FindPlaces(Cells& cells, std::array<std::uint32_t, kChunk>& places) {
  auto& first = cells[0];
  for (std::uint32_t bit = kCells >> 1; bit > 1; bit >>= 1) {
    const std::uint32_t low = bit - 1;
    for (auto& axis : cells) {
      for (std::size_t i = 0; i < kChunk; ++i) {
        const std::uint32_t is_set =
            0u - static_cast<std::uint32_t>((axis[i] & bit) != 0);
        const std::uint32_t swapped = (first[i] ^ axis[i]) & low & ~is_set;
        axis[i] ^= swapped;
        first[i] ^= (is_set & low) | swapped;
      }
    }
  }
  std::array<std::uint32_t, kChunk> flips{};
  for (std::size_t i = 0; i < kChunk; ++i) {
    cells[1][i] ^= cells[0][i];
    cells[2][i] ^= cells[1][i];
  }
  for (std::uint32_t bit = kCells >> 1; bit > 1; bit >>= 1) {
    for (std::size_t i = 0; i < kChunk; ++i) {
      const std::uint32_t is_set =
          0u - static_cast<std::uint32_t>((cells[2][i] & bit) != 0);
      flips[i] ^= is_set & (bit - 1);
    }
  }
  places.fill(0);
  for (std::uint32_t bit = kCurveBits; bit-- > 0;) {
    for (const auto& axis : cells) {
      for (std::size_t i = 0; i < kChunk; ++i) {
        places[i] = places[i] << 1 | ((axis[i] ^ flips[i]) >> bit & 1);
      }
    }
  }
}

struct Key {
  std::uint32_t place;
  std::uint32_t id;
};
static_assert(2 * sizeof(Key) == kOrderScratch);

}  // namespace

void OrderByMedians(const detail::SortedShape& shape,
                    const detail::FloatColumns& objects, std::byte* scratch,
                    std::uint32_t* ids) {
  const Centers centers(shape, objects);
  auto* const entries = reinterpret_cast<Entry*>(scratch);
  for (std::size_t i = 0; i < centers.size(); ++i) {
    entries[i] = {centers.At(i), static_cast<std::uint32_t>(i)};
  }
  SortByMedians(entries, centers.size());
  for (std::size_t i = 0; i < centers.size(); ++i) ids[i] = entries[i].id;
}

void OrderByCurve(const detail::SortedShape& shape,
                  const detail::FloatColumns& objects, std::byte* scratch,
                  std::uint32_t* ids) {
  const Centers centers(shape, objects);
  Extent extent;
  for (std::size_t i = 0; i < centers.size(); ++i) extent.Add(centers.At(i));
  Point scale;
  for (std::size_t k = 0; k < kAxes; ++k) {
    const float width = extent.Width(k);
    scale[k] = width > 0 ? static_cast<float>(kCells) / width : 0;
    if (!(scale[k] <= std::numeric_limits<float>::max())) scale[k] = 0;
  }
  auto* from = reinterpret_cast<Key*>(scratch);
  auto* to = from + centers.size();
  // A radix sort: the bits of one axis' number are a digit, the lowest first.
  std::array<std::array<std::uint32_t, kCells>, kAxes> starts{};
  const auto digit_of = [](const Key& key, std::size_t digit) {
    return key.place >> digit * kCurveBits & (kCells - 1);
  };
  for (std::size_t first = 0; first < centers.size(); first += kChunk) {
    const std::size_t count = std::min(kChunk, centers.size() - first);
    Cells cells{};
    for (std::size_t i = 0; i < count; ++i) {
      const Point center = centers.At(first + i);
      for (std::size_t k = 0; k < kAxes; ++k) {
        const float at = center[k] == kMost
                             ? static_cast<float>(kCells)
                             : (center[k] - extent.least[k]) * scale[k];
        cells[k][i] = static_cast<std::uint32_t>(
            std::min(at, static_cast<float>(kCells - 1)));
      }
    }
    std::array<std::uint32_t, kChunk> places;
    FindPlaces(cells, places);
    for (std::size_t i = 0; i < count; ++i) {
      const Key key{places[i], static_cast<std::uint32_t>(first + i)};
      from[first + i] = key;
      for (std::size_t d = 0; d < kAxes; ++d) ++starts[d][digit_of(key, d)];
    }
  }
  for (std::size_t d = 0; d < kAxes; ++d) {
    std::uint32_t start = 0;
    for (std::uint32_t& bucket : starts[d]) {
      start += std::exchange(bucket, start);
    }
    for (std::size_t i = 0; i < centers.size(); ++i) {
      to[starts[d][digit_of(from[i], d)]++] = from[i];
    }
    std::swap(from, to);
  }
  for (std::size_t i = 0; i < centers.size(); ++i) ids[i] = from[i].id;
}

}  // namespace halfspace::kernels

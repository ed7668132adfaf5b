#include "dispatch/bvh/order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "dispatch/default_fp_mode.h"
#include "kernels/bvh/block.h"

namespace halfspace::dispatch {
namespace {

using detail::Centers;
using detail::kBlockObjects;
using Kernels = detail::BvhKernels::OfPlanes;

constexpr std::size_t kAxes = detail::kCenterAxes;

// The number of objects that a thread takes at a time.
constexpr std::size_t kPart = kBlockObjects * kBlockObjects;

// Calls function(first, count, centers) for 64 of objects begin ... end - 1 at
// a time.
template <typename Function>
void ForCenters(const detail::Columns& objects, std::size_t begin,
                std::size_t end, const Kernels& kernels, const Runner& run,
                const Function& function) {
  const std::size_t parts = (end - begin + kPart - 1) / kPart;
  RunInDefaultFpMode(run, parts, [&](std::size_t part) {
    const std::size_t part_end = std::min(end, begin + (part + 1) * kPart);
    Centers centers;
    for (std::size_t first = begin + part * kPart; first < part_end;
         first += kBlockObjects) {
      const std::size_t count = std::min(kBlockObjects, part_end - first);
      kernels.centers(objects, first, count, centers);
      function(first, count, centers);
    }
  });
}

using Point = std::array<float, kAxes>;

struct Extent {
  Point least;
  Point greatest;

  Extent() {
    least.fill(std::numeric_limits<float>::infinity());
    greatest.fill(-std::numeric_limits<float>::infinity());
  }
  // An object without a center does not count: it would leave only one cell for
  // all others.
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

struct Piece {
  std::size_t begin;
  std::size_t end;
};

// Moves the entries whose cell is below `cell` to the front, and returns their
// end. It has no branches, because they would be mispredicted.
template <typename CellOf>
Entry* Partition(Entry* first, Entry* end, float cell, const CellOf& cell_of) {
  for (Entry* e = first; e != end; ++e) {
    const Entry entry = *e;
    *e = *first;
    *first = entry;
    first += cell_of(entry) < cell ? 1 : 0;
  }
  return first;
}

// As std::nth_element along an axis: the entry of rank `middle` is moved to its
// place, with the lesser entries before it. First it counts the entries of each
// cell of the range, and then moves each entry about once. With
// std::nth_element alone, a rebuild takes 1.45 times as long (16 384 boxes,
// AVX2).
void PlaceMiddle(Entry* first, std::size_t middle, Entry* end, std::size_t axis,
                 float least, float width) {
  constexpr std::size_t kCells = 128;
  const float scale = static_cast<float>(kCells) / width;
  const auto by_axis = [axis](const Entry& a, const Entry& b) {
    return a.center[axis] < b.center[axis];
  };
  // If all centers are equal or kLastCenter, or the range is below 2^-121, the
  // scale is not a positive finite number.
  if (!(scale > 0 && scale <= std::numeric_limits<float>::max())) {
    std::nth_element(first, first + middle, end, by_axis);
    return;
  }
  // Centers equal to kLastCenter get the last cell.
  const auto cell_of = [=](const Entry& entry) {
    const float cell = (entry.center[axis] - least) * scale;
    return std::min(cell, static_cast<float>(kCells - 1));
  };
  std::array<std::uint32_t, kCells> counts{};
  for (const Entry* e = first; e != end; ++e) {
    ++counts[static_cast<std::size_t>(static_cast<std::int32_t>(cell_of(*e)))];
  }
  std::size_t cell = 0;
  std::size_t below = 0;
  while (below + counts[cell] <= middle) below += counts[cell++];
  Entry* const of_cell =
      Partition(first, end, static_cast<float>(cell), cell_of);
  Entry* const behind =
      cell + 1 == kCells
          ? end
          : Partition(of_cell, end, static_cast<float>(cell + 1), cell_of);
  std::nth_element(of_cell, first + middle, behind, by_axis);
}

// Divides a piece into a lower and an upper half, and returns where the upper
// half begins. That is at a multiple of the largest full node.
std::size_t Split(Entry* entries, const Piece& piece) {
  const std::size_t count = piece.end - piece.begin;
  std::size_t node = kBlockObjects;
  while (node * kBlockObjects < count) node *= kBlockObjects;
  const std::size_t middle = (count + node - 1) / node / 2 * node;
  Entry* const first = entries + piece.begin;
  Extent extent;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < kAxes; ++k) extent.Add(k, first[i].center[k]);
  }
  std::size_t widest = 0;
  for (std::size_t k = 1; k < kAxes; ++k) {
    if (extent.Width(k) > extent.Width(widest)) widest = k;
  }
  PlaceMiddle(first, middle, first + count, widest, extent.least[widest],
              extent.Width(widest));
  return piece.begin + middle;
}

void SortByMedians(Entry* entries, Piece piece) {
  while (piece.end - piece.begin > kBlockObjects) {
    const std::size_t middle = Split(entries, piece);
    SortByMedians(entries, {piece.begin, middle});
    piece.begin = middle;
  }
}

}  // namespace

void OrderByMedians(const detail::Columns& objects, const Kernels& kernels,
                    std::byte* scratch, std::uint32_t* ids, const Runner& run) {
  auto* const entries = reinterpret_cast<Entry*>(scratch);
  ForCenters(objects, 0, objects.size, kernels, run,
             [&](std::size_t first, std::size_t count, const Centers& centers) {
               for (std::size_t i = 0; i < count; ++i) {
                 entries[first + i] = {
                     {centers[0][i], centers[1][i], centers[2][i]},
                     static_cast<std::uint32_t>(first + i)};
               }
             });
  // Pieces are split until there are enough of them for all threads.
  constexpr std::size_t kPieces = 64;
  std::array<Piece, kPieces> pieces;
  std::size_t count = 1;
  pieces[0] = {0, objects.size};
  while (2 * count <= kPieces && objects.size / count > kPart) {
    std::array<Piece, kPieces> halves;
    RunInDefaultFpMode(run, count, [&](std::size_t i) {
      const std::size_t middle = Split(entries, pieces[i]);
      halves[2 * i] = {pieces[i].begin, middle};
      halves[2 * i + 1] = {middle, pieces[i].end};
    });
    pieces = halves;
    count *= 2;
  }
  RunInDefaultFpMode(run, count,
                     [&](std::size_t i) { SortByMedians(entries, pieces[i]); });
  for (std::size_t i = 0; i < objects.size; ++i) ids[i] = entries[i].id;
}

// The grid over most centers, by a sample of consecutive objects. The outermost
// 16ths of the sample extend the range of the others by at most a quarter.
// Objects farther away share the cells at the end, because they would leave the
// others few cells.
detail::Grid GridOf(const detail::Columns& objects, const Kernels& kernels) {
  const DefaultFpMode mode;
  constexpr std::size_t kRuns = 32;
  constexpr std::size_t kRun = 4;
  constexpr float kMostCells = std::numeric_limits<float>::max() / 0x1p15f;
  std::array<std::array<float, kRuns * kRun>, kAxes> samples;
  std::array<std::size_t, kAxes> counts{};
  const std::size_t step = std::max(kRun, objects.size / kRuns);
  for (std::size_t r = 0; r < kRuns && r * step < objects.size; ++r) {
    const std::size_t count = std::min(kRun, objects.size - r * step);
    Centers centers;
    kernels.centers(objects, r * step, count, centers);
    for (std::size_t k = 0; k < kAxes; ++k) {
      for (std::size_t i = 0; i < count; ++i) {
        if (centers[k][i] == detail::kLastCenter) continue;
        samples[k][counts[k]++] = centers[k][i];
      }
    }
  }
  detail::Grid grid{};
  for (std::size_t k = 0; k < kAxes; ++k) {
    const std::size_t count = counts[k];
    if (count == 0) continue;
    float* const sample = samples[k].data();
    std::sort(sample, sample + count);
    const float low = sample[count / 16];
    const float high = sample[count - 1 - count / 16];
    const float more = (high - low) / 4;
    const bool is_narrow = !(low < high);
    grid.least[k] = is_narrow ? sample[0] : std::max(sample[0], low - more);
    const float width = (is_narrow ? sample[count - 1]
                                   : std::min(sample[count - 1], high + more)) -
                        grid.least[k];
    if (width > 0 && 1 / width <= kMostCells) {
      grid.cells_of_unit[k] = 1 / width;
    }
  }
  return grid;
}

const CurveKey* KeysByCurve(const detail::Columns& objects, std::size_t begin,
                            std::size_t end, const detail::Grid& grid,
                            const Kernels& kernels, std::byte* scratch,
                            const Runner& run) {
  const std::size_t count = end - begin;
  auto* from = reinterpret_cast<CurveKey*>(scratch);
  auto* to = from + count;
  // A radix sort, the lowest digit first.
  constexpr std::size_t kDigits = 3;
  constexpr std::uint32_t kDigitBits = detail::kPlaceBits / kDigits;
  std::array<std::array<std::uint32_t, 1u << kDigitBits>, kDigits> starts{};
  const auto digit_of = [](const CurveKey& key, std::size_t digit) {
    return key.place >> digit * kDigitBits & ((1u << kDigitBits) - 1);
  };
  ForCenters(objects, begin, end, kernels, run,
             [&](std::size_t first, std::size_t some, const Centers& centers) {
               std::array<std::uint32_t, kBlockObjects> places;
               kernels.places(centers, grid, places.data());
               for (std::size_t i = 0; i < some; ++i) {
                 from[first - begin + i] = {
                     places[i], static_cast<std::uint32_t>(first + i)};
               }
             });
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t d = 0; d < kDigits; ++d) ++starts[d][digit_of(from[i], d)];
  }
  for (std::size_t d = 0; d < kDigits; ++d) {
    std::uint32_t start = 0;
    for (std::uint32_t& bucket : starts[d]) {
      start += std::exchange(bucket, start);
    }
    for (std::size_t i = 0; i < count; ++i) {
      to[starts[d][digit_of(from[i], d)]++] = from[i];
    }
    std::swap(from, to);
  }
  return from;
}

void OrderByCurve(const detail::Columns& objects, const Kernels& kernels,
                  std::byte* scratch, std::uint32_t* ids, const Runner& run) {
  const CurveKey* const keys =
      KeysByCurve(objects, 0, objects.size, GridOf(objects, kernels), kernels,
                  scratch, run);
  for (std::size_t i = 0; i < objects.size; ++i) ids[i] = keys[i].id;
}

}  // namespace halfspace::dispatch

#include "dispatch/bvh/order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>
#include <utility>

#include "dispatch/default_fp_mode.h"
#include "kernels/bvh/kernel_table.h"
#include "kernels/compiler.h"

namespace halfspace::detail {
namespace {

using Kernels = BvhKernels::OfPlanes;

constexpr std::size_t kAxes = kCenterAxes;

// The number of objects that a thread takes at a time.
constexpr std::size_t kPart = kBlockObjects * kBlockObjects;

// Calls function(first, count, centers) for 64 of objects begin ... end - 1 at
// a time.
template <typename Function>
void ForCenters(const Columns& objects, std::size_t begin, std::size_t end,
                const Kernels& kernels, const Runner& run,
                const Function& function) {
  const std::size_t parts = (end - begin + kPart - 1) / kPart;
  dispatch::RunInDefaultFpMode(run, parts, [&](std::size_t part) {
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

using Center = std::array<float, kAxes>;

struct Extent {
  Center least;
  Center greatest;

  Extent() {
    least.fill(std::numeric_limits<float>::infinity());
    greatest.fill(-std::numeric_limits<float>::infinity());
  }
  // An object without a center does not count: it would leave only one cell for
  // all others.
  void Add(std::size_t axis, float center) {
    least[axis] = std::min(least[axis], center);
    greatest[axis] =
        std::max(greatest[axis], center == kLastCenter ? -kLastCenter : center);
  }
  float Width(std::size_t k) const { return greatest[k] - least[k]; }
};

struct Entry {
  Center center;
  std::uint32_t id;
};
static_assert(sizeof(Entry) == kOrderScratch);

struct Piece {
  std::size_t begin;
  std::size_t end;
};

// A range of entries, one of which gets its place: the lesser ones along an
// axis come before it. As std::nth_element, but the standard library does not
// say how it arranges the others, and BVHs would differ between libraries.
struct Selection {
  Entry* first;
  Entry* middle;
  Entry* end;
  std::size_t axis;

  float At(const Entry& entry) const { return entry.center[axis]; }
  std::size_t size() const { return static_cast<std::size_t>(end - first); }

  // Keeps the part around the middle after one entry's value: less, equal or
  // greater. Returns false if the middle has its place.
  bool Halve() {
    if (size() < 2) return false;
    // The samples are at quarters. If objects were listed on the way out and
    // back, those at the ends and in the middle are the least and the greatest.
    float a = At(first[size() / 4]);
    float pivot = At(first[size() / 2]);
    const float b = At(first[size() - 1 - size() / 4]);
    if (pivot < a) std::swap(pivot, a);
    pivot = std::max(a, std::min(pivot, b));  // the median of three
    Entry* const from = Partition(
        first, end, [&](const Entry& entry) { return At(entry) < pivot; });
    if (middle < from) {
      end = from;
      return true;
    }
    first = Partition(from, end,
                      [&](const Entry& entry) { return !(pivot < At(entry)); });
    return middle >= first;
  }
};

// Places the middle of many entries. It counts the entries of each cell of the
// range, and then moves each entry about once. With std::nth_element alone, a
// rebuild takes 1.45 times as long (16 384 boxes, AVX2). The least entry is in
// the first cell and the greatest in the last, so each step loses entries.
template <typename T>
HALFSPACE_NOINLINE void PlaceMiddle(Selection of, T least, T greatest) {
  constexpr std::size_t kCells = 128;
  constexpr std::size_t kMany = 512;
  while (of.size() > kMany) {
    const T scale = T{kCells} / (greatest - least);
    // If all centers are equal or kLastCenter, or the range of floats is below
    // 2^-121, the scale is not a positive finite number.
    if (!(scale > 0 && scale <= std::numeric_limits<T>::max())) {
      if constexpr (std::is_same_v<T, float>) {
        return PlaceMiddle<double>(of, least, greatest);
      }
      break;
    }
    // Centers equal to kLastCenter get the last cell.
    const auto cell_of = [axis = of.axis, least, scale](const Entry& entry) {
      const T cell = (entry.center[axis] - least) * scale;
      return std::min(cell, T{kCells - 1});
    };
    std::array<std::uint32_t, kCells> counts{};
    for (const Entry* e = of.first; e != of.end; ++e) {
      ++counts[static_cast<std::size_t>(
          static_cast<std::int32_t>(cell_of(*e)))];
    }
    std::size_t cell = 0;
    const Entry* below = of.first;
    while (below + counts[cell] <= of.middle) below += counts[cell++];
    // Where few entries are far away from all others, one cell has most
    // entries, and cells alone would take a step for each 7 binades.
    const bool is_skewed = 2 * counts[cell] > of.size();
    const T own = static_cast<T>(cell);
    of.first = Partition(of.first, of.end, [=](const Entry& entry) {
      return cell_of(entry) < own;
    });
    if (cell + 1 < kCells) {
      of.end = Partition(of.first, of.end, [=](const Entry& entry) {
        return cell_of(entry) < own + 1;
      });
    }
    if (is_skewed && !of.Halve()) return;
    Extent extent;
    for (const Entry* e = of.first; e != of.end; ++e) {
      extent.Add(of.axis, of.At(*e));
    }
    least = extent.least[of.axis];
    greatest = extent.greatest[of.axis];
  }
  while (of.Halve()) {
  }
}

// How entries become leaves.
struct Cuts {
  const AxisWeights& weights;
  std::size_t first_slot;  // of entry 0

  // The blocks of so many slots that a piece is in.
  std::size_t First(const Piece& piece, std::size_t slots) const {
    return (first_slot + piece.begin) / slots;
  }
  std::size_t Blocks(const Piece& piece, std::size_t slots) const {
    return (first_slot + piece.end + slots - 1) / slots - First(piece, slots);
  }
};

// Divides a piece into a lower and an upper half, and returns where the upper
// half begins. That is at a multiple of the largest full node. A piece in one
// block has no upper half.
std::size_t Split(Entry* entries, const Piece& piece, const Cuts& cuts) {
  if (cuts.Blocks(piece, kBlockObjects) < 2) return piece.end;
  const std::size_t count = piece.end - piece.begin;
  std::size_t node = kBlockObjects;
  while (node * kBlockObjects < count) node *= kBlockObjects;
  const std::size_t middle =
      (cuts.First(piece, node) + cuts.Blocks(piece, node) / 2) * node -
      cuts.first_slot - piece.begin;
  Entry* const first = entries + piece.begin;
  Extent extent;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < kAxes; ++k) extent.Add(k, first[i].center[k]);
  }
  std::size_t axis = 0;
  const auto cost_of = [&](std::size_t k) {
    return std::pair(extent.Width(k) * cuts.weights.weight[k], extent.Width(k));
  };
  for (std::size_t k = 1; k < kAxes; ++k) {
    if (cost_of(k) > cost_of(axis)) axis = k;
  }
  PlaceMiddle(Selection{first, first + middle, first + count, axis},
              extent.least[axis], extent.greatest[axis]);
  return piece.begin + middle;
}

void SortByMedians(Entry* entries, Piece piece, const Cuts& cuts) {
  while (cuts.Blocks(piece, kBlockObjects) > 1) {
    const std::size_t middle = Split(entries, piece, cuts);
    SortByMedians(entries, {piece.begin, middle}, cuts);
    piece.begin = middle;
  }
}

void SortAllByMedians(Entry* entries, std::size_t size, const Cuts& cuts,
                      const Runner& run) {
  // Pieces are split until there are enough of them for all threads.
  constexpr std::size_t kPieces = 64;
  std::array<Piece, kPieces> pieces;
  std::size_t count = 1;
  pieces[0] = {0, size};
  while (2 * count <= kPieces && size / count > kPart) {
    std::array<Piece, kPieces> halves;
    dispatch::RunInDefaultFpMode(run, count, [&](std::size_t i) {
      const std::size_t middle = Split(entries, pieces[i], cuts);
      halves[2 * i] = {pieces[i].begin, middle};
      halves[2 * i + 1] = {middle, pieces[i].end};
    });
    pieces = halves;
    count *= 2;
  }
  const auto sort = [&](std::size_t i) {
    SortByMedians(entries, pieces[i], cuts);
  };
  // Cells of a curve are often one piece, and many.
  if (count == 1) return dispatch::InDefaultFpMode([&] { sort(0); });
  dispatch::RunInDefaultFpMode(run, count, sort);
}

// The entries of the objects ids[0 ... count - 1].
void GatherEntries(const PlaneLayout& layout, const Columns& objects,
                   const Kernels& kernels, const std::uint32_t* ids,
                   std::size_t count, Entry* entries) {
  std::array<std::array<float, kBlockObjects>, kMaxPlanes> values;
  Columns gathered = ColumnsOf<float>(kBlockObjects, 1);
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    gathered.column[p] = values[p].data();
  }
  for (std::size_t first = 0; first < count; first += kBlockObjects) {
    const std::size_t some = std::min(kBlockObjects, count - first);
    for (std::size_t i = 0; i < some; ++i) {
      for (std::size_t p = 0; p < layout.plane_count; ++p) {
        values[p][i] = objects.floats(p)[ids[first + i] * objects.stride];
      }
    }
    Centers centers;
    kernels.centers(gathered, 0, some, centers);
    for (std::size_t i = 0; i < some; ++i) {
      entries[first + i] = {{centers[0][i], centers[1][i], centers[2][i]},
                            ids[first + i]};
    }
  }
}

}  // namespace

void OrderByMedians(const Columns& objects, const AxisWeights& weights,
                    const Kernels& kernels, std::byte* scratch,
                    std::uint32_t* ids, const Runner& run) {
  auto* const entries = reinterpret_cast<Entry*>(scratch);
  ForCenters(objects, 0, objects.size, kernels, run,
             [&](std::size_t first, std::size_t count, const Centers& centers) {
               for (std::size_t i = 0; i < count; ++i) {
                 entries[first + i] = {
                     {centers[0][i], centers[1][i], centers[2][i]},
                     static_cast<std::uint32_t>(first + i)};
               }
             });
  SortAllByMedians(entries, objects.size, {weights, 0}, run);
  for (std::size_t i = 0; i < objects.size; ++i) ids[i] = entries[i].id;
}

void OrderCell(const PlaneLayout& layout, const Columns& objects,
               const AxisWeights& weights, const Kernels& kernels,
               std::byte* scratch, std::uint32_t* ids, std::size_t count,
               std::size_t first_slot, const Runner& run) {
  auto* const entries = reinterpret_cast<Entry*>(scratch);
  dispatch::InDefaultFpMode(
      [&] { GatherEntries(layout, objects, kernels, ids, count, entries); });
  SortAllByMedians(entries, count, {weights, first_slot}, run);
  for (std::size_t i = 0; i < count; ++i) ids[i] = entries[i].id;
}

const CurveKey* KeysByCurve(const Columns& objects, std::size_t begin,
                            std::size_t end, const Grid& grid,
                            const Kernels& kernels, std::byte* scratch,
                            const Runner& run) {
  const std::size_t count = end - begin;
  auto* from = reinterpret_cast<CurveKey*>(scratch);
  auto* to = from + count;
  // A radix sort, the lowest digit first.
  constexpr std::size_t kDigits = 3;
  constexpr std::uint32_t kDigitBits = kPlaceBits / kDigits;
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

void OrderByCurve(const PlaneLayout& layout, const Columns& objects,
                  const AxisWeights& weights, const Kernels& kernels,
                  std::byte* scratch, std::uint32_t* ids, const Runner& run) {
  const std::size_t count = objects.size;
  const CurveKey* const keys =
      KeysByCurve(objects, 0, count, GridOf(objects, weights, kernels), kernels,
                  scratch, run);
  for (std::size_t i = 0; i < count; ++i) ids[i] = keys[i].id;
  // The half of the scratch memory without the keys has room for half of the
  // objects. At most one cell has more. It is sorted last, because its entries
  // overwrite the keys.
  const bool are_first = reinterpret_cast<const std::byte*>(keys) == scratch;
  std::byte* const free = scratch + (are_first ? count * sizeof(CurveKey) : 0);
  Piece large = {0, 0};
  const auto order = [&](const Piece& cell, std::byte* its_scratch) {
    OrderCell(layout, objects, weights, kernels, its_scratch, ids + cell.begin,
              cell.end - cell.begin, cell.begin, run);
  };
  ForCrowdedCells(
      count, [&](std::size_t i) { return keys[i].place; },
      [&](std::size_t begin, std::size_t end) {
        if (2 * (end - begin) > count) {
          large = {begin, end};
        } else {
          order({begin, end}, free);
        }
      });
  if (large.end != 0) order(large, scratch);
}

}  // namespace halfspace::detail

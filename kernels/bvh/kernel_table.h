// The codes of objects, and the parameters of the kernels of BVHs. No Highway
// here.
#ifndef HALFSPACE_KERNELS_BVH_KERNEL_TABLE_H_
#define HALFSPACE_KERNELS_BVH_KERNEL_TABLE_H_

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "halfspace/bvh.h"
#include "kernels/bvh/levels.h"
#include "kernels/results.h"

namespace halfspace {
struct IdPair;
}

namespace halfspace::detail {

static_assert(kMostAtOnce == kBlockObjects);

// The codes of the objects in leaves: 16 bits for each plane, less kCodeBias,
// as x86 compares signed numbers. Value v, or -v of a maximum, has the code
//
//   min(max(floor((v - base) * scale), 0), kMostCode)
//
// computed in float. A value of a query gets two codes, kCodeMargin above and
// kCodeMargin below the formula. The margin is more than all rounding errors in
// any mode. So an object with a code above the upper one has a greater value,
// and an object with a code below the lower one has a lesser value. This holds
// for any finite base and any positive scale up to 2^100 (docs/bvh.md).
inline constexpr int kMostCode = 65535;
inline constexpr int kCodeBias = 32768;
inline constexpr float kCodeMargin = 0x1p-4f;

// The most queries that walk together. An entry in a list of blocks to visit
// has the number of the query above kQueryShift bits of the block. The highest
// of these bits says that the block is inside the query.
inline constexpr std::size_t kWalkers = 64;
inline constexpr std::size_t kQueryShift = 26;
inline constexpr std::uint32_t kInsideBit = std::uint32_t{1}
                                            << (kQueryShift - 1);
inline constexpr std::uint32_t kBlockMask = kInsideBit - 1;

// Where ids go.
struct WalkIds : Results<std::uint32_t> {
  std::size_t* offsets;  // of several queries: where the last one begins
};

struct Walk;
using WalkFunction = void (*)(const Walk& walk);

struct Walk {
  const BvhLevels* levels;
  // Bounds, one after another: first all minima, then all maxima of each;
  // simplices have only maxima. Or one query shape in the form that its kernel
  // reads (shape_query.h).
  const void* queries;
  std::size_t query_count;
  WalkIds* ids;         // to find
  std::size_t* counts;  // to count: of each query, added to
  // Only objects whose masks have one of these bits are found. All ones finds
  // all objects.
  std::uint32_t mask;
  QueryStatistics* statistics;  // added to, or null
  // Whether the first survivor is wanted soon. Then each leaf is read when it
  // is found, instead of several leaves at a time, until the first flush().
  bool is_urgent;
};

// Blocks begin ... end - 1 of a level. The kernel encodes each block, if there
// are codes, and bounds it by a node of the next level, if there is one.
// Threads may divide a level at multiples of 64 blocks.
struct BlockRange {
  const BvhLevel* level;
  const BvhLevel* above;  // or null
  const CodeMap* map;
  std::int16_t* codes;  // of objects in leaves, or null
  std::size_t begin;
  std::size_t end;
  // Null, or a word for each of these blocks, with a bit for each object or
  // node that has changed. The others keep their codes, and a block without a
  // set bit keeps its node. If this is not null, `above` is not null either.
  const std::uint64_t* changed;
  // The kernel sets a bit for each node of the next level that changes. This
  // points to the word of the node of block `begin`.
  std::uint64_t* changed_above;
};

// Coordinate k of the center of object i. An object without a center, which is
// empty or has a NaN, gets kLastCenter.
inline constexpr std::size_t kCenterAxes =
    3;  // the last is 0 where two are used
using Centers = std::array<std::array<float, kBlockObjects>, kCenterAxes>;
inline constexpr float kLastCenter = std::numeric_limits<float>::max() / 4;

// The grid of a curve. On each axis it begins at the least center, and has a
// number of cells per unit of length.
inline constexpr std::uint32_t kPlaceBits = 30;  // of all axes
struct Grid {
  std::array<float, kCenterAxes> least;
  std::array<float, kCenterAxes> cells_of_unit;
};

struct BvhKernels {
  struct OfPlanes {
    // Finds the centers of objects first ... first + count - 1, at most 64.
    void (*centers)(const Columns& objects, std::size_t first,
                    std::size_t count, Centers& centers);
    // Finds the places of 64 centers on Hilbert's curve.
    void (*places)(const Centers& centers, const Grid& grid,
                   std::uint32_t* places);
    void (*encode)(const BlockRange& range);
    // Returns the lane of the node that has to grow least to enclose a bound,
    // as a sum over its planes, or of the first of those that are nearly equal.
    // `values` are all minima, then all maxima, and `nodes` has a bit for each
    // node of the block that counts. There must be one.
    std::size_t (*nearest_node)(const BvhLevel& level, std::size_t block,
                                const float* values, std::uint64_t nodes);
    WalkFunction find;
    WalkFunction count;
  };
  OfPlanes minima;  // simplices
  OfPlanes all;
};

// A set of slots, as a hash table of blocks. Its size depends on the size of
// the set. If it has an entry for each block of the world, the entries are in
// the order of the blocks.
struct SlotSet {
  struct Block {
    std::uint64_t slots;  // 0: an unused entry
    std::uint32_t block;
    std::uint32_t first;  // slots of the set in the entries before
  };

  // The entry of a block, or the unused entry where it would be. A table with
  // fewer entries than blocks always has unused entries.
  std::size_t EntryOf(std::size_t block) const {
    std::size_t i = (block + (block >> bits) * kSpread) & ((1u << bits) - 1);
    while (blocks[i].slots != 0 && blocks[i].block != block) {
      i = i + 1 == size ? 0 : i + 1;
    }
    return i;
  }
  std::uint64_t SlotsOf(std::size_t block) const {
    return blocks[EntryOf(block)].slots;
  }
  // The number of the set's slots before one of them.
  std::size_t RankOf(std::size_t slot) const {
    const Block& entry = blocks[EntryOf(slot / kBlockObjects)];
    const std::uint64_t bit = std::uint64_t{1} << slot % kBlockObjects;
    return entry.first +
           static_cast<std::size_t>(std::popcount(entry.slots & (bit - 1)));
  }

  // Odd, so that blocks at any distance from each other get different entries.
  static constexpr std::size_t kSpread = 0x9E3779B1;
  Block* blocks;
  std::size_t size;
  std::uint32_t bits;
  // For each slot of the set, by its rank: the masks that the other object of a
  // pair must have one bit of. Or null.
  const std::uint32_t* wanted;
};

// A limit of the Euclidean distance between boxes. Squared distances in floats
// decide up to `sure` and from `beyond` on, and in doubles between them.
struct NearLimit {
  std::size_t dims = 0;  // 0 without a limit
  float sure;
  float beyond;
  double squared;
  float d_gap;  // between octahedra on D
};

// Finds the pairs of the objects in blocks begin ... end - 1 of one world with
// the objects of another world or of the same world.
struct PairJoin {
  Walk walk;  // in the other world: its levels, and masks of both
  const BvhLevels* queries;
  bool is_one_world;   // each pair is written once, and no object with itself
  const SlotSet* set;  // only these objects, with all objects; or null
  bool has_margin;
  // Bounds up to this far apart on each axis are a pair.
  std::array<float, 4> margins;
  NearLimit near;  // no farther apart than the margins
  std::size_t begin;
  std::size_t end;
  Results<IdPair>* pairs;
};

struct BvhPairKernels {
  void (*join)(const PairJoin& join);
};

// A table of kernels that serve bounds with any planes.
template <typename Kernels>
struct KernelsOfAll {
  static const Kernels* const kTargets;  // of each compiled target, best first
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_BVH_KERNEL_TABLE_H_

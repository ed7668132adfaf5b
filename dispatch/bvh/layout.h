// The memory layout of a BVH. All offsets follow from a few numbers in its
// header, so a copy of the bytes is a copy of the BVH.
#ifndef HALFSPACE_DISPATCH_BVH_LAYOUT_H_
#define HALFSPACE_DISPATCH_BVH_LAYOUT_H_

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dispatch/bvh/scratch.h"
#include "dispatch/errors/number_checks.h"
#include "dispatch/sink.h"
#include "dispatch/targets/chosen_target.h"
#include "halfspace/bvh.h"
#include "halfspace/detail/plane_arrays.h"
#include "halfspace/memory.h"
#include "halfspace/runner.h"
#include "kernels/bvh/kernel_table.h"

namespace halfspace::detail {

// The ids that queries find.
using IdSink = dispatch::Sink<WalkIds, std::uint32_t, 512>;

// Partial rebuilds sort at least so many slots, a quarter of a node of level 2.
// They are few so that the longest frame of many is short.
inline constexpr std::size_t kGroupSlots = 16 * kBlockObjects;

// A thread that encodes leaves takes so many slots at a time, a node of level
// 2, because the bits of two smaller tasks could share a word.
inline constexpr std::size_t kTaskSlots = kBlockObjects * kBlockObjects;

using dispatch::kMostObjects;

// The capacity of a tree.
struct BvhRoom {
  std::size_t slots;
  std::size_t ids;  // 0 until a change by id, else at least `slots`
  bool has_masks;

  bool operator==(const BvhRoom&) const = default;
};

// The planes of a bound: all minima, then all maxima.
using BoundValues = std::array<float, kMaxPlanes>;

// Slots begin ... end - 1.
struct SlotRange {
  std::size_t begin;
  std::size_t end;
};

struct alignas(64) BvhHeader {
  char magic[8];
  std::uint32_t version;  // other bytes first: another version
  std::uint8_t dims;
  std::uint8_t axes;
  std::uint8_t has_max;
  std::uint8_t has_masks;
  std::uint64_t bytes;
  std::uint64_t checksum;  // of all other bytes; 0 since a change
  std::uint32_t capacity;  // slots that there is room for
  std::uint32_t id_room;   // BvhRoom::ids
  std::uint32_t slots;     // in use or erased: from 0 on
  std::uint32_t size;      // objects
  std::uint32_t ids;       // in use or free: from 0 on
  std::uint32_t weights;   // AxisWeights::Pack() of the last sort of all
  std::uint32_t sorted;    // slots when all were sorted, that are left of these
  std::uint32_t inserted;  // since then or ResetInsertions()
};
static_assert(sizeof(BvhHeader) == 64);

// Skips the checksum, because another thread may be writing it in Blob().
inline void CopyButChecksum(void* to, const std::byte* from,
                            std::size_t bytes) {
  constexpr std::size_t kBefore = offsetof(BvhHeader, checksum);
  constexpr std::size_t kAfter = kBefore + sizeof(std::uint64_t);
  std::memcpy(to, from, kBefore);
  std::memcpy(static_cast<std::byte*>(to) + kAfter, from + kAfter,
              bytes - kAfter);
}

// Not an std::atomic_ref, which libc++ has since its version 19.
inline std::atomic<std::uint64_t>& Checksum(BvhHeader& header) {
  using Atomic = std::atomic<std::uint64_t>;
  static_assert(sizeof(Atomic) == sizeof(header.checksum));
  static_assert(alignof(Atomic) == sizeof(header.checksum));
  static_assert(Atomic::is_always_lock_free);
  return reinterpret_cast<Atomic&>(header.checksum);
}

inline constexpr char kBvhMagic[8] = {'h', 'a', 'l', 'f', 's', 'o', 'r', 't'};
// Any change of the bytes or of their meaning is a new format (docs/bvh.md).
inline constexpr std::uint32_t kBvhVersion = 5;

constexpr std::size_t BlocksOf(std::size_t objects) {
  return (objects + kBlockObjects - 1) / kBlockObjects;
}
constexpr std::size_t GroupsOf(std::size_t slots,
                               std::size_t group_slots = kGroupSlots) {
  return (slots + group_slots - 1) / group_slots;
}

inline const BvhKernels::OfPlanes& KernelsFor(const BvhType& type,
                                              Target target, const char* call) {
  const BvhKernels& kernels = type.kernels[dispatch::IndexOf(target, call)];
  return type.has_max ? kernels.all : kernels.minima;
}

// Sets the pointers of `levels` to the arrays of a tree in the memory at
// `begin`, and their sizes to 0. Returns the size of the memory in bytes.
// `begin` is null to compute only the size. In new memory, the bytes between
// the arrays become 0.
std::size_t Place(const BvhType& type, const BvhRoom& room, std::byte* begin,
                  bool is_new, BvhLevels& levels);

// Sets the sizes of all levels.
void SetSlots(BvhLevels& levels, std::size_t slots);

// Writes Empty() and no id to the slots of a level from `begin` to the end of
// its block.
void ClearSlots(const PlaneLayout& layout, BvhLevels& levels, std::size_t level,
                std::size_t begin);

// Sets the sizes of all levels, and clears the rest of their last blocks. These
// blocks have to be encoded afterwards.
void Truncate(const PlaneLayout& layout, BvhLevels& levels, std::size_t slots);

inline void AssignBit(std::uint64_t* words, std::size_t i, bool value) {
  const std::uint64_t bit = std::uint64_t{1} << i % 64;
  words[i / 64] = value ? words[i / 64] | bit : words[i / 64] & ~bit;
}

// Whether there is an object in a slot.
inline bool IsPresent(const BvhLevels& levels, std::size_t slot) {
  const std::uint64_t* const words = levels.level[0].present;
  return (words[slot / 64] >> slot % 64 & 1) != 0;
}

// Whether an object has this id, which is in use or free. `levels.slots` must
// not be null.
inline bool IsIn(const BvhLevels& levels, std::size_t slots, std::uint32_t id) {
  const std::uint32_t slot = levels.slots[id];
  return slot < slots && levels.ids[slot] == id;
}

// Throws, in the name of `call`, if the planes of the objects cannot be read.
// There must be objects.
void CheckColumns(const PlaneLayout& layout, const Columns& objects,
                  const char* call);

// A bit for each lane of a block that is a slot in use.
inline std::uint64_t LanesOf(std::size_t slots, std::size_t block) {
  const std::size_t count =
      std::min(kBlockObjects, slots - block * kBlockObjects);
  return ~std::uint64_t{0} >> (kBlockObjects - count);
}

// Writes the id and the slot of an object, and its masks if the tree has masks.
inline void PutId(const BvhLevels& levels, std::size_t slot, std::uint32_t id,
                  std::uint32_t masks) {
  levels.ids[slot] = id;
  if (levels.slots != nullptr) {
    levels.slots[id] = static_cast<std::uint32_t>(slot);
  }
  std::uint32_t* const all = levels.level[0].masks;
  if (all != nullptr) all[slot] = masks;
}

// Marks the first `slots` slots as present.
void FillPresent(const BvhLevel& level, std::size_t slots);

// Fits the map of codes to the floats. The leaves have to be encoded
// afterwards.
void FitMap(const PlaneLayout& layout, const BvhLevels& levels);

// Copies the bounds of all present objects and encodes all levels. Slot s gets
// element elements[s], or element s if `elements` is null.
void FillSlots(const PlaneLayout& layout, const BvhLevels& levels,
               const Columns& objects, const std::uint32_t* elements,
               const BvhKernels::OfPlanes& kernels, const Runner& run);

// Blocks begin ... end - 1 of a level, as the kernels encode them.
inline BlockRange RangeOf(const BvhLevels& levels, std::size_t level,
                          std::size_t begin, std::size_t end,
                          const std::uint64_t* changed = nullptr,
                          std::uint64_t* changed_above = nullptr) {
  const bool is_top = level + 1 == levels.count;
  return {&levels.level[level],
          is_top ? nullptr : &levels.level[level + 1],
          levels.map,
          level == 0 ? levels.codes : nullptr,
          begin,
          end,
          changed,
          changed_above};
}

// Encodes all levels from level `from` on. The floats and the presence bits of
// that level must be set.
void EncodeLevels(const BvhLevels& levels, const BvhKernels::OfPlanes& kernels,
                  std::size_t from);

// Encodes the blocks of slots begin ... end - 1, and the nodes above them.
void EncodeSlots(BvhLevels& levels, const BvhKernels::OfPlanes& kernels,
                 std::size_t begin, std::size_t end);

// Sets the masks of all nodes to the union of the masks below them.
void OrAllMasks(BvhLevels& levels);

// Copies the bounds of the slots of a block whose bits are set. Slot s gets
// element elements[s], or element s if `elements` is null.
void CopyBounds(const BvhLevels& levels, const Columns& objects,
                const std::uint32_t* elements, std::size_t block,
                std::uint64_t slots);

// The current cost of a range of slots that begins at a block. It is the sum of
// the surface areas of the nodes above them.
BvhGroup AsIs(const PlaneLayout& layout, const BvhLevels& levels,
              const SlotRange& range);

// Group `group` of the slots in use.
inline SlotRange GroupAt(const BvhLevels& levels, std::size_t group) {
  return {group * kGroupSlots,
          std::min(levels.level[0].size, (group + 1) * kGroupSlots)};
}

// The cost that `objects` objects would have had when they were sorted.
inline double CostAsBuilt(const BvhGroup& built, std::uint64_t objects) {
  if (built.objects == 0 || built.objects == objects) return built.cost;
  return built.cost * static_cast<double>(objects) /
         static_cast<double>(built.objects);
}

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

#endif  // HALFSPACE_DISPATCH_BVH_LAYOUT_H_

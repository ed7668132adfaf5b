// How a BVH changes, one object at a time or all bounds at once.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <functional>
#include <limits>
#include <new>
#include <string>
#include <tuple>
#include <utility>

#include "dispatch/bvh/scratch.h"
#include "dispatch/bvh/tree.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/errors/number_checks.h"
#include "halfspace/bvh.h"
#include "halfspace/mask.h"
#include "kernels/compiler.h"

namespace halfspace::detail {
namespace {

// No more slots than before. Prepare() raises `ids` to the number of slots.
constexpr BvhRoom kSlotsById = {.slots = 0, .ids = 1, .has_masks = false};

// Insertions between two sorts of the last slots. Up to so many objects, about
// four leaves, have no order, and almost every query visits these leaves.
constexpr std::size_t kSortEach = 256;

// An id that is in the list twice, or kNoId, which must not be in it.
std::uint32_t FindTwice(Span<const std::uint32_t> ids,
                        const MemoryResource& memory) {
  if (std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>()) ==
      ids.end()) {
    return kNoId;
  }
  // A hash table, of which less than half is used.
  constexpr std::uint32_t kOdd = 0x9E3779B1;
  const auto bits = static_cast<unsigned>(std::bit_width(2 * ids.size()));
  const std::size_t size = std::size_t{1} << bits;
  const Scratch scratch(memory, size * sizeof(std::uint32_t));
  auto* const table = reinterpret_cast<std::uint32_t*>(scratch.data());
  std::fill_n(table, size, kNoId);
  for (const std::uint32_t id : ids) {
    auto i = static_cast<std::size_t>((std::uint64_t{id * kOdd} << bits) >> 32);
    while (table[i] != kNoId && table[i] != id) i = (i + 1) % size;
    if (table[i] == id) return id;
    table[i] = id;
  }
  return kNoId;
}

// The size of a node as a sum over its planes.
float ExtentOf(const PlaneLayout& layout, const BvhLevel& level,
               std::size_t node) {
  float extent = 0;
  for (std::size_t k = 0; k < layout.axes; ++k) {
    if (layout.has_max) extent += level.Value(layout.axes + k, node);
    extent -= level.Value(k, node);
  }
  return extent;
}

// How much a node must grow to enclose a bound, by the same measure. In 3
// dimensions a simplex adds how far the bound is beyond the cube in it, as
// NearestNode() of the kernels does.
float GrowthOf(const PlaneLayout& layout, const BvhLevel& level,
               std::size_t node, const float* values) {
  float growth = 0;
  const auto add = [&growth](float beyond) {
    growth += beyond > 0 ? beyond : 0;
  };
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    const float plane = level.Value(p, node);
    add(p < layout.axes ? plane - values[p] : values[p] - plane);
  }
  if (!layout.has_max && layout.dims == 3) {
    const float edge =
        ExtentOf(layout, level, node) / static_cast<float>(layout.dims);
    for (std::size_t p = 0; p < layout.dims; ++p) {
      add(values[p] - level.Value(p, node) - edge);
    }
  }
  return growth;
}

// A bit for each object and each node that has changed, if there are enough
// changes to make up for the time to look at all bits.
class ChangedBits {
 public:
  ChangedBits(const MemoryResource& memory, std::size_t slots,
              std::size_t changes)
      : bytes_(changes <= BvhState::FewChanges(slots)
                   ? 0
                   : BvhState::WordsOfChanges(slots) * sizeof(std::uint64_t)),
        memory_(memory, bytes_) {
    if (bytes_ > 0) std::memset(memory_.data(), 0, bytes_);
  }

  // Null if there are none. Level 0 has the first words, one for each block.
  // The words of level 1 follow, and so on.
  std::uint64_t* words() const {
    return reinterpret_cast<std::uint64_t*>(memory_.data());
  }

 private:
  std::size_t bytes_;
  Scratch memory_;
};

void CheckAsMany(Span<const std::uint32_t> ids, const Columns& bounds,
                 const char* call) {
  if (bounds.size == ids.size()) return;
  dispatch::ThrowInvalid(call, "bounds",
                         "a bound for each id, " + std::to_string(ids.size()),
                         std::to_string(bounds.size));
}

}  // namespace

std::size_t BvhState::WordsOfChanges(std::size_t slots) {
  std::size_t words = 0;
  // A tree with room for more has a level for these too.
  for (std::size_t level = 0; level < kMostLevels; ++level) {
    slots = std::max<std::size_t>(1, BlocksOf(slots));
    words += slots;
  }
  return words;
}

void BvhState::CheckChange(const char* call) {
  std::ignore = KernelsFor(type_, Target(), call);
  CheckLoaded(call);
}

void BvhState::Prepare(const char* call, BvhRoom room) {
  CheckChange(call);
  const BvhRoom old = Room();
  room = {std::max(old.slots, room.slots), std::max(old.ids, room.ids),
          old.has_masks || room.has_masks};
  if (room.ids > 0) room.ids = std::max(room.ids, room.slots);
  if (!is_owned_ || room.slots > old.slots || room.ids > old.ids ||
      room.has_masks != old.has_masks) {
    Reallocate(call, room);
  }
  is_as_loaded_ = false;
  if (block_ == nullptr) return;
  header().version = kBvhVersion;
  header().checksum = 0;
}

void BvhState::Reallocate(const char* call, const BvhRoom& room) {
  if (room.slots == 0) return;
  BvhState grown(type_, memory_);
  grown.Allocate(room);
  // What is not used yet is part of a blob.
  std::memset(grown.block_ + sizeof(BvhHeader), 0,
              grown.bytes_ - sizeof(BvhHeader));
  BvhHeader& to = grown.header();
  const std::size_t old_count = block_ == nullptr ? 0 : levels_.count;
  if (block_ != nullptr) {
    const BvhHeader& from = header();
    to.slots = from.slots;
    to.size = from.size;
    to.ids = from.ids;
    to.sorted = from.sorted;
    to.inserted = from.inserted;
    to.weights = from.weights;
  }
  SetSlots(grown.levels_, to.slots);
  for (std::size_t l = 0; l < grown.levels_.count; ++l) {
    const BvhLevel& level = grown.levels_.level[l];
    if (l >= old_count) {
      // Node after node: those of the level below are encoded into it.
      for (std::size_t n = 0; n < level.size; n += kBlockObjects) {
        ClearSlots(type_, grown.levels_, l, n);
      }
      continue;
    }
    const BvhLevel& old = levels_.level[l];
    const std::size_t blocks = BlocksOf(old.size);
    const auto copy = [blocks](auto* copied, const auto* source,
                               std::size_t of_block) {
      std::memcpy(copied, source, blocks * of_block * sizeof(*copied));
    };
    copy(level.floats, old.floats, type_.plane_count * kBlockObjects);
    copy(level.present, old.present, 1);
    if (level.regular != nullptr) copy(level.regular, old.regular, 1);
    if (level.masks == nullptr) continue;
    if (old.masks != nullptr) {
      copy(level.masks, old.masks, kBlockObjects);
    } else {
      std::fill_n(level.masks, old.size, 0xFFFFFFFF);
    }
  }
  if (old_count > 0) {
    *grown.levels_.map = *levels_.map;
    if (levels_.codes != nullptr && grown.levels_.codes != nullptr) {
      std::memcpy(grown.levels_.codes, levels_.codes,
                  BlocksOf(to.slots) * type_.plane_count * kBlockObjects *
                      sizeof(std::int16_t));
    }
    std::memcpy(grown.levels_.ids, levels_.ids,
                BlocksOf(to.slots) * kBlockObjects * sizeof(std::uint32_t));
    std::copy_n(levels_.built, GroupsOf(to.slots), grown.levels_.built);
    const bool is_coded_now =
        levels_.codes == nullptr && grown.levels_.codes != nullptr;
    if (is_coded_now || grown.levels_.count > old_count) {
      const auto& kernels = KernelsFor(type_, Target(), call);
      dispatch::InDefaultFpMode([&] {
        if (is_coded_now) FitMap(type_, grown.levels_);
        EncodeLevels(grown.levels_, kernels, is_coded_now ? 0 : old_count - 1);
      });
      if (room.has_masks) OrAllMasks(grown.levels_);
    }
    if (levels_.slots != nullptr) {
      std::memcpy(grown.levels_.slots, levels_.slots,
                  to.ids * sizeof(std::uint32_t));
    }
    if (levels_.used != nullptr) {
      grown.Used().AddAll(Used());
    } else if (room.ids > 0) {
      // After a build there is an object in each slot. In the blob of an older
      // format, which may be altered, there may be none, or any id.
      for (std::size_t s = 0; s < to.slots; ++s) {
        const std::uint32_t id = levels_.ids[s];
        if (id >= to.ids || !IsPresent(levels_, s)) continue;
        grown.levels_.slots[id] = static_cast<std::uint32_t>(s);
        grown.Used().Add(id);
      }
    }
  }
  Swap(grown);
}

void BvhTree::CheckIds(Span<const std::uint32_t> ids, const char* call) const {
  const BvhState& tree = BvhState::Of(*this);
  dispatch::CheckMemory(call, "ids", ids.data(), ids.size(),
                        alignof(std::uint32_t));
  const bool has_slots = tree.levels_.slots != nullptr;
  const std::uint32_t limit = has_slots ? tree.header().ids : 0;
  const std::size_t slots = tree.slots();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] < limit ? IsIn(tree.levels_, slots, ids[i]) : Has(ids[i])) {
      continue;
    }
    dispatch::ThrowInvalid(call, "ids", "the id of an object",
                           std::to_string(ids[i]), i);
  }
}

// Called before a change of one object. Returns its slot.
std::size_t BvhState::PrepareObject(std::uint32_t id, bool has_masks,
                                    const char* call) {
  CheckId(id, call);
  Prepare(call, {.slots = 0, .ids = 1, .has_masks = has_masks});
  return levels_.slots[id];
}

// Encodes the object of a slot and the nodes above it, up to the first node
// that stays the same. In a block that AppendSlot() has begun, all slots are
// encoded.
void BvhState::EncodePath(std::size_t slot, bool is_new_block) {
  const BvhKernels::OfPlanes& kernels = KernelsFor(type_, Target(), "Bvh");
  dispatch::InDefaultFpMode([&] {
    std::uint64_t changed = is_new_block
                                ? ~std::uint64_t{0}
                                : std::uint64_t{1} << slot % kBlockObjects;
    for (std::size_t l = 0; l + 1 < levels_.count && changed != 0; ++l) {
      slot /= kBlockObjects;
      std::uint64_t above = 0;
      kernels.encode(RangeOf(levels_, l, slot, slot + 1, &changed, &above));
      changed = above;
    }
  });
}

// Writes a bound to a slot in use. With `changed`, sets the bit of the slot,
// and EncodeTouched() encodes it later. If `changed` is null, encodes it at
// once.
void BvhState::Write(std::size_t slot, const float* values,
                     std::uint64_t* changed) {
  for (std::size_t p = 0; p < type_.plane_count; ++p) {
    levels_.level[0].Value(p, slot) = values[p];
  }
  if (changed == nullptr) return EncodePath(slot);
  AssignBit(changed, slot, true);
}

void BvhTree::Set(std::uint32_t id, Span<const float> values) {
  BvhState& tree = BvhState::Of(*this);
  tree.Write(tree.PrepareObject(id, false, "Bvh::Set"), values.data(), nullptr);
}

// Encodes the slots of the set bits and the nodes above them, level after
// level.
void BvhState::EncodeTouched(std::uint64_t* changed) {
  if (changed == nullptr) return;
  const BvhKernels::OfPlanes& kernels = KernelsFor(type_, Target(), "Bvh");
  dispatch::InDefaultFpMode([&] {
    for (std::size_t l = 0; l + 1 < levels_.count; ++l) {
      const std::size_t blocks = BlocksOf(levels_.level[l].size);
      kernels.encode(RangeOf(levels_, l, 0, blocks, changed, changed + blocks));
      changed += blocks;
    }
  });
}

void BvhTree::Set(Span<const std::uint32_t> ids, const Columns& bounds) {
  BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::Set";
  if (bounds.size != 0) CheckColumns(tree.type_, bounds, kCall);
  CheckAsMany(ids, bounds, kCall);
  CheckIds(ids, kCall);
  if (ids.empty()) return;
  tree.CheckChange(kCall);
  const ChangedBits changed(tree.memory_, tree.slots(), ids.size());
  tree.Prepare(kCall, kSlotsById);
  ForEachRecord(tree.type_, bounds, [&](std::size_t i, const float* values) {
    const std::size_t slot = tree.levels_.slots[ids[i]];
    tree.Write(slot, values, changed.words());
  });
  tree.EncodeTouched(changed.words());
}

void BvhTree::Refit(Span<const std::uint32_t> ids, const Columns& bounds) {
  BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::Refit";
  CheckIds(ids, kCall);
  if (ids.empty()) return;
  if (bounds.size < id_limit()) {
    dispatch::ThrowInvalid(
        kCall, "bounds",
        "a bound for each id, at least " + std::to_string(id_limit()),
        std::to_string(bounds.size));
  }
  CheckColumns(tree.type_, bounds, kCall);
  tree.CheckChange(kCall);
  const ChangedBits changed(tree.memory_, tree.slots(), ids.size());
  tree.Prepare(kCall, kSlotsById);
  std::uint64_t* const words = changed.words();
  if (words == nullptr) {
    for (const std::uint32_t id : ids) {
      BoundValues values;
      for (std::size_t p = 0; p < tree.type_.plane_count; ++p) {
        values[p] = bounds.floats(p)[id * bounds.stride];
      }
      tree.Write(tree.levels_.slots[id], values.data(), nullptr);
    }
    return;
  }
  for (const std::uint32_t id : ids) {
    AssignBit(words, tree.levels_.slots[id], true);
  }
  // Leaf by leaf, so that bounds are copied to memory that is in cache. Those
  // of the next leaf are anywhere. To prefetch the second line of a bound, as a
  // refit of all objects does, takes 5 to 18 % longer (Zen 3).
  const std::uint32_t* const its_ids = tree.levels_.ids;
  std::size_t next = 0;
  const std::size_t blocks = BlocksOf(tree.slots());
  for (std::size_t block = 0; block < blocks; block = next) {
    while (++next < blocks && words[next] == 0) {
    }
    for (std::uint64_t bits = next < blocks ? words[next] : 0; bits != 0;
         bits &= bits - 1) {
      const std::size_t slot = next * kBlockObjects + LowestBit(bits);
      kernels::PrefetchToL2(bounds.floats(0) + its_ids[slot] * bounds.stride);
    }
    CopyBounds(tree.levels_, bounds, its_ids, block, words[block]);
  }
  tree.EncodeTouched(words);
}

void BvhState::AppendSlot() {
  const std::size_t slot = header().slots++;
  SetSlots(levels_, header().slots);
  std::size_t node = slot;
  for (std::size_t l = 0; l < levels_.count; ++l) {
    if (node % kBlockObjects != 0) break;
    ClearSlots(type_, levels_, l, node);
    if (l == 0 && slot % kGroupSlots == 0)
      levels_.built[slot / kGroupSlots] = {};
    node /= kBlockObjects;
  }
}

// Returns an empty slot in a leaf that would grow by a 16th at most, or slots()
// if there is none. If a leaf could double its size, the leaves would have four
// times the surface when all objects have come and gone.
std::size_t BvhState::FindSlot(const float* values) const {
  const std::size_t end = slots();
  if (size() == end) return end;
  const BvhKernels::OfPlanes& kernels = KernelsFor(type_, Target(), "Bvh");
  const std::uint64_t* const present = levels_.level[0].present;
  std::size_t block = 0;
  for (std::size_t l = levels_.count; l-- > 1;) {
    const BvhLevel& level = levels_.level[l];
    const std::size_t first = block * kBlockObjects;
    // Nodes without objects are left out, because their bounds are Empty().
    std::uint64_t with_room = level.present[block];
    if (l == 1) {
      const std::size_t nodes = std::min(kBlockObjects, level.size - first);
      std::uint64_t full = 0;
      for (std::size_t i = 0; i < nodes; ++i) {
        full |= std::uint64_t{~present[first + i] == 0} << i;
      }
      const std::size_t last = level.size - 1;
      if (present[last] == LanesOf(end, last) && last < first + nodes) {
        full |= std::uint64_t{1} << last % kBlockObjects;
      }
      with_room &= ~full;
    }
    if (with_room == 0) return end;
    block = first + kernels.nearest_node(level, block, values, with_room);
  }
  if (levels_.count > 1) {
    const BvhLevel& leaves = levels_.level[1];
    const float growth = GrowthOf(type_, leaves, block, values);
    if (growth > 0 && !(16 * growth <= ExtentOf(type_, leaves, block))) {
      return end;
    }
  }
  const std::uint64_t empty = LanesOf(end, block) & ~present[block];
  return empty == 0 ? end : block * kBlockObjects + LowestBit(empty);
}

// Returns the first of the last slots that are due for a sort after `added`
// objects were appended, or slots() if none are. Each 256 inserted objects are
// sorted together, later each 1024, and so on. All objects are due when half as
// many were inserted as there were at the last sort of all.
std::size_t BvhState::FirstDue(std::size_t added) const {
  const std::size_t end = slots();
  const BvhHeader& header = this->header();
  if (header.inserted >= std::max<std::size_t>(header.sorted / 2, kSortEach)) {
    return 0;
  }
  const std::size_t after = end - std::min<std::size_t>(end, header.sorted);
  const std::size_t before = after - std::min(after, added);
  std::size_t last = kSortEach;
  if (after / last == before / last) return end;
  while (after / (4 * last) != before / (4 * last)) last *= 4;
  return end - std::max(std::min(added, end), after - before / last * last);
}

// The room for `more` objects. If more than a quarter of the slots are empty,
// CloseGaps() makes room.
BvhRoom BvhState::RoomFor(std::size_t more, const char* call) const {
  const BvhRoom room = Room();
  if (slots() + more <= room.slots ||
      (room.slots > 0 && size() + more <= room.slots / 4 * 3 + 1)) {
    return kSlotsById;
  }
  dispatch::CheckObjectCount(call, "world", slots() + more);
  const std::size_t half_more =
      room.slots + std::max(kBlockObjects, room.slots / 2);
  return {std::max(slots() + more, std::min(kMostObjects - 1, half_more)), 1,
          false};
}

// Sorts the slots that are due. Without memory for that they stay as they are,
// as the order changes no result.
void BvhState::SortDue(std::size_t added, const char* call) {
  const std::size_t first = FirstDue(added);
  if (first == slots()) return;
  const SlotRange range = {first / kBlockObjects * kBlockObjects, slots()};
  const bool is_all = first == 0;
#if defined(__cpp_exceptions)
  try {
    Resort(call, {&range, 1}, BuildQuality::kHigh, Runner());
  } catch (const std::bad_alloc&) {
    return;
  }
#else
  Resort(call, {&range, 1}, BuildQuality::kHigh, Runner());
#endif
  if (is_all) {
    header().sorted = header().size;
    header().inserted = 0;
  }
}

// Writes a new object to an empty slot, whose block has to be encoded then.
void BvhState::Put(std::size_t slot, std::uint32_t id, const float* values) {
  BvhHeader& header = this->header();
  if (slot == header.slots) AppendSlot();
  const BvhLevel& level = levels_.level[0];
  for (std::size_t p = 0; p < type_.plane_count; ++p) {
    level.Value(p, slot) = values[p];
  }
  AssignBit(level.present, slot, true);
  PutId(levels_, slot, id, 0xFFFFFFFF);
  Used().Add(id);
  header.ids = std::max(header.ids, id + 1);
  ++header.size;
  ++header.inserted;
}

std::uint32_t BvhTree::Insert(Span<const float> values) {
  BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::Insert";
  tree.CheckChange(kCall);
  std::size_t slot =
      dispatch::InDefaultFpMode([&] { return tree.FindSlot(values.data()); });
  tree.Prepare(kCall,
               slot == tree.slots() ? tree.RoomFor(1, kCall) : kSlotsById);
  if (slot == tree.header().capacity) {
    tree.CloseGaps();
    slot = tree.slots();
  }
  const auto id = static_cast<std::uint32_t>(tree.Used().Least());
  const std::size_t added = slot == tree.slots() ? 1 : 0;
  tree.Put(slot, id, values.data());
  tree.EncodePath(slot, slot % kBlockObjects == 0);
  tree.SortDue(added, kCall);
  return id;
}

void BvhTree::Insert(const Columns& bounds, Span<std::uint32_t> ids) {
  BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::Insert";
  if (bounds.size != 0) CheckColumns(tree.type_, bounds, kCall);
  dispatch::CheckMemory(kCall, "ids", ids.data(), ids.size(),
                        alignof(std::uint32_t));
  if (ids.size() < bounds.size) {
    dispatch::ThrowInvalid(
        kCall, "ids",
        "an element for each bound, at least " + std::to_string(bounds.size),
        std::to_string(ids.size()));
  }
  if (bounds.size == 0) return;
  tree.CheckChange(kCall);
  tree.Append(
      bounds, tree.RoomFor(bounds.size, kCall),
      [&](std::size_t i) {
        return ids[i] = static_cast<std::uint32_t>(tree.Used().Least());
      },
      kCall);
}

void BvhState::CheckNewIds(Span<const std::uint32_t> ids,
                           const char* call) const {
  constexpr const char* kExpected =
      "ids that no object has, below 4294967295, each once";
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] == kNoId || Has(ids[i])) {
      dispatch::ThrowInvalid(call, "ids", kExpected, std::to_string(ids[i]), i);
    }
  }
  if (const std::uint32_t id = FindTwice(ids, memory_); id != kNoId) {
    dispatch::ThrowInvalid(call, "ids", kExpected,
                           std::to_string(id) + " twice");
  }
}

void BvhTree::InsertAs(Span<const std::uint32_t> ids, const Columns& bounds) {
  BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::InsertAs";
  if (bounds.size != 0) CheckColumns(tree.type_, bounds, kCall);
  CheckAsMany(ids, bounds, kCall);
  dispatch::CheckMemory(kCall, "ids", ids.data(), ids.size(),
                        alignof(std::uint32_t));
  tree.CheckChange(kCall);
  tree.CheckNewIds(ids, kCall);
  if (ids.empty()) return;
  BvhRoom room = tree.RoomFor(ids.size(), kCall);
  const std::size_t limit =
      std::size_t{*std::max_element(ids.begin(), ids.end())} + 1;
  // By half at least, as the ids of new objects often ascend.
  const std::size_t old = tree.Room().ids;
  if (limit > old) {
    room.ids = std::max(limit, std::min<std::size_t>(kNoId, old + old / 2));
  }
  tree.Append(
      bounds, room, [&](std::size_t i) { return ids[i]; }, kCall);
}

// After CheckChange(). A short list takes empty slots, as single objects do.
// With more than a few objects, nodes are encoded once, after all have a slot.
// Sorts the new slots, or all, if that is due.
template <typename IdOf>
void BvhState::Append(const Columns& bounds, const BvhRoom& room,
                      const IdOf& id_of, const char* call) {
  const ChangedBits changed(memory_, slots() + bounds.size, bounds.size);
  Prepare(call, room);
  if (slots() + bounds.size > header().capacity) CloseGaps();
  const std::size_t begin = slots();
  // A larger list is sorted in less time than empty slots are found.
  const bool is_short = 16 * bounds.size <= size();
  std::uint64_t* const words = changed.words();
  dispatch::InDefaultFpMode([&] {
    ForEachRecord(type_, bounds, [&](std::size_t i, const float* values) {
      const std::size_t slot = is_short ? FindSlot(values) : slots();
      Put(slot, id_of(i), values);
      if (words == nullptr) return EncodePath(slot, slot % kBlockObjects == 0);
      // All slots of a new block are encoded.
      words[slot / 64] |=
          slot < begin ? std::uint64_t{1} << slot % 64 : ~std::uint64_t{0};
    });
  });
  EncodeTouched(words);
  SortDue(slots() - begin, call);
}

// Encodes the empty slot as Write() does.
void BvhState::Remove(std::uint32_t id, std::uint64_t* changed) {
  const std::size_t slot = levels_.slots[id];
  const BvhLevel& level = levels_.level[0];
  AssignBit(level.present, slot, false);
  if (level.masks != nullptr) level.masks[slot] = 0;
  levels_.ids[slot] = kNoId;
  levels_.slots[id] = kNoId;
  Used().Remove(id);
  --header().size;
  constexpr float kInf = std::numeric_limits<float>::infinity();
  BoundValues empty;
  for (std::size_t p = 0; p < type_.plane_count; ++p) {
    empty[p] = p < type_.axes ? kInf : -kInf;
  }
  Write(slot, empty.data(), changed);
}

bool BvhState::HasManyGaps() const {
  return slots() > 2 * size() + kBlockObjects || size() == 0;
}

void BvhTree::Erase(std::uint32_t id) {
  BvhState& tree = BvhState::Of(*this);
  tree.PrepareObject(id, false, "Bvh::Erase");
  tree.Remove(id, nullptr);
  if (tree.HasManyGaps()) tree.CloseGaps();
}

void BvhTree::Erase(Span<const std::uint32_t> ids) {
  BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::Erase";
  CheckIds(ids, kCall);
  if (ids.empty()) return;
  tree.CheckChange(kCall);
  const ChangedBits changed(tree.memory_, tree.slots(), ids.size());
  tree.Prepare(kCall, kSlotsById);
  for (const std::uint32_t id : ids) {
    if (!tree.Has(id)) continue;  // a second time in the list
    tree.Remove(id, changed.words());
  }
  tree.EncodeTouched(changed.words());
  if (tree.HasManyGaps()) tree.CloseGaps();
}

void BvhTree::Clear() {
  BvhState& tree = BvhState::Of(*this);
  if (!tree.is_owned_) return tree.Free();
  if (tree.block_ == nullptr) return;
  BvhHeader& header = tree.header();
  header.version = kBvhVersion;
  header.checksum = 0;
  header.slots = header.size = header.ids = 0;
  header.sorted = header.inserted = 0;
  SetSlots(tree.levels_, 0);
  if (tree.levels_.used != nullptr) tree.Used().Clear();
  tree.is_checked_ = true;
  tree.is_as_loaded_ = false;
}

// Slots that are empty now do not count as room, because insertions may find
// none of them near enough.
void BvhTree::Reserve(std::size_t objects) {
  BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::Reserve";
  const std::size_t room = objects <= tree.size()
                               ? tree.slots()
                               : tree.slots() + (objects - tree.size());
  if (std::max(objects, room) >= dispatch::kMostObjects) {
    dispatch::ThrowInvalid(kCall, "objects", "fewer than 2^31 objects in all",
                           std::to_string(objects));
  }
  tree.Prepare(kCall, {.slots = room, .ids = 1, .has_masks = false});
}

void BvhTree::SetMasks(std::uint32_t id, std::uint32_t masks) {
  BvhState& tree = BvhState::Of(*this);
  const std::size_t slot = tree.PrepareObject(id, true, "Bvh::SetMasks");
  tree.levels_.level[0].masks[slot] = masks;
  tree.EncodePath(slot);
}

void BvhTree::SetMasks(Span<const std::uint32_t> masks) {
  BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::SetMasks";
  dispatch::CheckMemory(kCall, "masks", masks.data(), masks.size(),
                        alignof(std::uint32_t));
  if (masks.size() < id_limit()) {
    dispatch::ThrowInvalid(
        kCall, "masks",
        "a mask for each id, at least " + std::to_string(id_limit()),
        std::to_string(masks.size()));
  }
  if (tree.block_ == nullptr) return;
  tree.Prepare(kCall, {.slots = 0, .ids = 0, .has_masks = true});
  for (std::size_t s = 0; s < tree.header().slots; ++s) {
    const std::uint32_t id = tree.levels_.ids[s];
    tree.levels_.level[0].masks[s] = id != kNoId ? masks[id] : 0;
  }
  OrAllMasks(tree.levels_);
}

void BvhTree::Refit(const Columns& objects, bool is_by_id, const Runner& run) {
  BvhState& tree = BvhState::Of(*this);
  const char* const call = is_by_id ? "Bvh::Refit" : "Bvh::RefitInOrder";
  const std::size_t size = is_by_id ? id_limit() : tree.slots();
  if (objects.size < size || (!is_by_id && objects.size > size)) {
    dispatch::ThrowInvalid(call, "bounds",
                           (is_by_id ? "a bound for each id, at least "
                                     : "a bound for each element of ids(), ") +
                               std::to_string(size),
                           std::to_string(objects.size));
  }
  if (size == 0) return;
  CheckColumns(tree.type_, objects, call);
  tree.CheckLoaded(call);
  const Rounded floats(tree.type_, tree.memory_, objects, tree.slots(),
                       is_by_id ? tree.levels_.ids : nullptr, run);
  tree.Prepare(call, {});
  FillSlots(tree.type_, tree.levels_, floats.columns(),
            is_by_id && !objects.is_double ? tree.levels_.ids : nullptr,
            KernelsFor(tree.type_, Target(), call), run);
}

}  // namespace halfspace::detail

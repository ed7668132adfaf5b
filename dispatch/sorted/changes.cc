// How a sorted world changes, one object at a time or all bounds at once.
#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "dispatch/sorted/layout.h"
#include "dispatch/sorted/scratch.h"
#include "halfspace/sorted.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

// How much a node would have to grow to enclose a bound.
float GrowthOf(const SortedShape& shape, const SortedLevel& level,
               std::size_t node, const float* values) {
  float growth = 0;
  for (std::size_t p = 0; p < PlanesOf(shape); ++p) {
    const float beyond = p < shape.axes ? level.planes[p][node] - values[p]
                                        : values[p] - level.planes[p][node];
    if (beyond > 0) growth += beyond;
  }
  return growth;
}

std::uint64_t ExistingLanes(const SortedLevel& level, std::size_t block) {
  const std::size_t count =
      std::min(kBlockObjects, level.size - block * kBlockObjects);
  return ~std::uint64_t{0} >> (kBlockObjects - count);
}

}  // namespace

// Also when nothing grows: it makes a blob in place its own.
void SortedTree::Reallocate(std::size_t capacity, const SortedExtras& extras) {
  SortedTree grown(shape_, memory_);
  grown.Allocate(capacity, extras);
  // What is not used yet is part of a blob.
  std::memset(grown.block_ + sizeof(SortedHeader), 0,
              grown.bytes_ - sizeof(SortedHeader));
  SortedHeader& to = grown.header();
  const std::size_t old_count = block_ == nullptr ? 0 : levels_.count;
  if (block_ != nullptr) {
    const SortedHeader& from = header();
    to.slots = from.slots;
    to.size = from.size;
    to.ids = from.ids;
    to.free_id = from.free_id;
  }
  SetSlots(grown.levels_, to.slots);
  for (std::size_t l = 0; l < grown.levels_.count; ++l) {
    const SortedLevel& level = grown.levels_.level[l];
    if (l >= old_count) {
      // Node after node: those of the level below are encoded into it.
      for (std::size_t n = 0; n < level.size; n += kBlockObjects) {
        ClearSlots(shape_, grown.levels_, l, n);
      }
      continue;
    }
    const SortedLevel& old = levels_.level[l];
    const std::size_t blocks = BlocksOf(old.size);
    const auto copy = [blocks](auto* copied, const auto* source,
                               std::size_t of_block) {
      std::memcpy(copied, source, blocks * of_block * sizeof(*copied));
    };
    copy(level.blocks, old.blocks, BlockBytes(PlanesOf(shape_)));
    for (std::size_t p = 0; p < PlanesOf(shape_); ++p) {
      copy(level.planes[p], old.planes[p], kBlockObjects);
    }
    copy(level.present, old.present, 1);
    if (level.regular != nullptr) copy(level.regular, old.regular, 1);
    if (level.categories == nullptr) continue;
    if (old.categories != nullptr) {
      copy(level.categories, old.categories, kBlockObjects);
    } else {
      std::fill_n(level.categories, blocks * kBlockObjects, 0xFFFFFFFF);
    }
  }
  if (old_count > 0) {
    std::memcpy(grown.levels_.ids, levels_.ids,
                BlocksOf(to.slots) * kBlockObjects * sizeof(std::uint32_t));
    if (extras.has_slots && levels_.slots != nullptr) {
      std::memcpy(grown.levels_.slots, levels_.slots,
                  to.ids * sizeof(std::uint32_t));
    }
    std::memcpy(grown.levels_.built, levels_.built,
                PartsOf(to.slots) * sizeof(double));
    if (grown.levels_.count > old_count) {
      const auto& kernels = KernelsOf(shape_, Target(), "SortedWorld");
      kernels::InDefaultFpMode(
          [&] { EncodeLevels(grown.levels_, kernels, old_count - 1); });
      if (extras.has_categories) OrAllCategories(grown.levels_);
    }
  }
  Swap(grown);
}

// Before a change by id.
void SortedTree::NeedSlots() {
  if (block_ == nullptr) return;
  if (header().has_slots && is_owned_) return;
  if (header().has_slots) return MakeOwn();
  CheckIds("SortedWorld");
  Reallocate(header().capacity, {true, header().has_categories != 0});
  std::fill_n(levels_.slots, header().ids, kNoId);
  for (std::size_t s = 0; s < header().slots; ++s) {
    if (IsPresent(levels_, s)) {
      levels_.slots[levels_.ids[s]] = static_cast<std::uint32_t>(s);
    }
  }
}

void SortedTree::MakeOwn() {
  if (is_owned_) return;
  Reallocate(header().capacity,
             {header().has_slots != 0, header().has_categories != 0});
}

void SortedTree::CheckIds(const char* call) const {
  for (std::size_t s = 0; s < header().slots; ++s) {
    if (IsPresent(levels_, s) && levels_.ids[s] >= header().ids) {
      kernels::ThrowInvalid(call, "blob",
                            "ids below " + std::to_string(header().ids),
                            std::to_string(levels_.ids[s]));
    }
  }
}

bool SortedTree::Has(std::uint32_t id) const {
  if (block_ == nullptr || id >= header().ids) return false;
  if (levels_.slots == nullptr) return true;
  const std::uint32_t slot = levels_.slots[id];
  return slot < header().slots && levels_.ids[slot] == id;
}

std::size_t SortedTree::SlotOf(std::uint32_t id, const char* call) {
  if (Has(id)) NeedSlots();
  // Again, as the ids of an altered blob may be twice there.
  if (!Has(id)) {
    kernels::ThrowInvalid(call, "id", "the id of an object in the world",
                          std::to_string(id));
  }
  return levels_.slots[id];
}

// Encodes the block of a slot and bounds it anew, and so on upwards until a
// node stays as it was.
void SortedTree::EncodePath(std::size_t slot) {
  const SortedKernels::OfPlanes& kernels =
      KernelsOf(shape_, Target(), "SortedWorld");
  kernels::InDefaultFpMode([&] {
    std::size_t block = slot;
    for (std::size_t l = 0; l < levels_.count; ++l) {
      block /= kBlockObjects;
      if (l + 1 == levels_.count) {
        kernels.encode({&levels_.level[l], nullptr, block, block + 1});
        return;
      }
      const SortedLevel& above = levels_.level[l + 1];
      const auto node = [&] {
        std::array<float, 8> planes{};
        for (std::size_t p = 0; p < PlanesOf(shape_); ++p) {
          planes[p] = above.planes[p][block];
        }
        std::array<std::uint64_t, 3> bits{above.present[block / 64], 0, 0};
        if (above.regular != nullptr) bits[1] = above.regular[block / 64];
        if (above.categories != nullptr) bits[2] = above.categories[block];
        return std::pair(planes, bits);
      };
      const auto before = node();
      kernels.encode({&levels_.level[l], &above, block, block + 1});
      if (above.categories != nullptr) OrCategories(levels_, l, block);
      if (node() == before) return;
    }
  });
}

void SortedTree::Set(std::uint32_t id, Span<const float> values) {
  const std::size_t slot = SlotOf(id, "SortedWorld::Set");
  for (std::size_t p = 0; p < values.size(); ++p) {
    levels_.level[0].planes[p][slot] = values[p];
  }
  EncodePath(slot);
}

std::size_t SortedTree::AppendSlot() {
  if (block_ == nullptr) {
    Reallocate(kBlockObjects, {true, false});
  } else if (header().slots == header().capacity) {
    if (header().slots + 1 >= kMostObjects) {
      kernels::ThrowInvalid("SortedWorld::Insert", "world",
                            "less than 2^31 objects",
                            std::to_string(header().slots));
    }
    Reallocate(
        std::min(kMostObjects - 1, std::max(header().capacity + kBlockObjects,
                                            header().capacity / 2 * 3)),
        {true, header().has_categories != 0});
  }
  const std::size_t slot = header().slots++;
  SetSlots(levels_, header().slots);
  std::size_t node = slot;
  for (std::size_t l = 0; l < levels_.count; ++l) {
    if (node % kBlockObjects != 0) break;
    ClearSlots(shape_, levels_, l, node);
    if (l == 0 && slot % kPartSlots == 0) levels_.built[slot / kPartSlots] = 0;
    node /= kBlockObjects;
  }
  return slot;
}

// An empty slot where a bound makes nodes grow little, or a new one at the end.
std::size_t SortedTree::FindSlot(const float* values) {
  if (block_ == nullptr || header().size == header().slots) {
    return AppendSlot();
  }
  std::size_t block = 0;
  for (std::size_t l = levels_.count; l-- > 1;) {
    const SortedLevel& level = levels_.level[l];
    std::size_t best = level.size;
    float least = 0;
    for (std::size_t n = block * kBlockObjects;
         n < std::min(level.size, (block + 1) * kBlockObjects); ++n) {
      if (l == 1 &&
          levels_.level[0].present[n] == ExistingLanes(levels_.level[0], n)) {
        continue;
      }
      const float growth = GrowthOf(shape_, level, n, values);
      if (best == level.size || growth < least) {
        best = n;
        least = growth;
      }
    }
    if (best == level.size) return AppendSlot();
    block = best;
  }
  const std::uint64_t empty =
      ExistingLanes(levels_.level[0], block) & ~levels_.level[0].present[block];
  if (empty == 0) return AppendSlot();
  std::size_t lane = 0;
  while ((empty >> lane & 1) == 0) ++lane;
  return block * kBlockObjects + lane;
}

std::uint32_t SortedTree::Insert(Span<const float> values) {
  NeedSlots();
  const std::size_t slot =
      kernels::InDefaultFpMode([&] { return FindSlot(values.data()); });
  // Only of a blob that was altered: else there is a free id, or a slot for
  // each.
  if (header().free_id == kNoId && header().ids == header().capacity) {
    Reallocate(header().capacity + kBlockObjects,
               {true, header().has_categories != 0});
  }
  SortedHeader& header = this->header();
  std::uint32_t id = header.free_id;
  if (id == kNoId) {
    id = static_cast<std::uint32_t>(header.ids++);
  } else {
    const std::uint32_t next = levels_.slots[id];
    header.free_id = next < header.ids ? next : kNoId;
  }
  const SortedLevel& level = levels_.level[0];
  for (std::size_t p = 0; p < values.size(); ++p) {
    level.planes[p][slot] = values[p];
  }
  level.present[slot / kBlockObjects] |= std::uint64_t{1}
                                         << slot % kBlockObjects;
  if (level.categories != nullptr) level.categories[slot] = 0xFFFFFFFF;
  levels_.ids[slot] = id;
  levels_.slots[id] = static_cast<std::uint32_t>(slot);
  ++header.size;
  EncodePath(slot);
  return id;
}

void SortedTree::Erase(std::uint32_t id) {
  const std::size_t slot = SlotOf(id, "SortedWorld::Erase");
  const SortedLevel& level = levels_.level[0];
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (std::size_t p = 0; p < PlanesOf(shape_); ++p) {
    level.planes[p][slot] = p < shape_.axes ? kInf : -kInf;
  }
  level.present[slot / kBlockObjects] &=
      ~(std::uint64_t{1} << slot % kBlockObjects);
  if (level.categories != nullptr) level.categories[slot] = 0;
  levels_.ids[slot] = kNoId;
  SortedHeader& header = this->header();
  levels_.slots[id] = header.free_id;
  header.free_id = id;
  --header.size;
  EncodePath(slot);
}

void SortedTree::SetCategories(std::uint32_t id, std::uint32_t categories) {
  const std::size_t slot = SlotOf(id, "SortedWorld::SetCategories");
  if (levels_.level[0].categories == nullptr) {
    Reallocate(header().capacity, {true, true});
    OrAllCategories(levels_);
  }
  levels_.level[0].categories[slot] = categories;
  EncodePath(slot);
}

void SortedTree::SetCategories(Span<const std::uint32_t> categories) {
  kernels::CheckMemory("SortedWorld::SetCategories", "categories",
                       categories.data(), categories.size(),
                       alignof(std::uint32_t));
  if (block_ == nullptr) return;
  if (levels_.level[0].categories == nullptr) {
    Reallocate(header().capacity, {header().has_slots != 0, true});
  }
  MakeOwn();
  for (std::size_t s = 0; s < header().slots; ++s) {
    const std::uint32_t id = levels_.ids[s];
    levels_.level[0].categories[s] =
        id < categories.size() ? categories[id] : 0;
  }
  OrAllCategories(levels_);
}

void SortedTree::Refit(const FloatColumns& objects, bool is_by_id,
                       const PartRunner& run) {
  const char* const call =
      is_by_id ? "SortedWorld::Refit" : "SortedWorld::RefitInOrder";
  const std::size_t size = block_ == nullptr ? 0
                           : is_by_id        ? header().ids
                                             : header().slots;
  if (objects.size < size || (!is_by_id && objects.size > size)) {
    kernels::ThrowInvalid(call, "bounds",
                          (is_by_id ? "a bound for each id, at least "
                                    : "a bound for each element of ids(), ") +
                              std::to_string(size),
                          std::to_string(objects.size));
  }
  if (size == 0) return;
  CheckColumns(shape_, objects, call);
  if (is_by_id) CheckIds(call);
  MakeOwn();
  FillSlots(shape_, levels_, objects, is_by_id ? levels_.ids : nullptr,
            KernelsOf(shape_, Target(), call), run);
}

}  // namespace halfspace::detail

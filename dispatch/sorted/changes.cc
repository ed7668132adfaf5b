// How a sorted world changes: one object at a time, all bounds at once, and the
// order of the worst parts.
#include <algorithm>
#include <cmath>
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
#include "kernels/prefetch.h"
#include "kernels/sorted/order.h"

namespace halfspace::detail {
namespace {

// The objects of some slots, one after another: what is sorted again.
class Gathered {
 public:
  Gathered(const SortedShape& shape, const MemoryResource& memory,
           const SortedLevels& levels, std::size_t room)
      : planes_(PlanesOf(shape)),
        room_(room),
        levels_(levels),
        floats_(memory, room * planes_ * sizeof(float)),
        ids_(memory, room * sizeof(std::uint32_t)),
        categories_(memory, levels.level[0].categories == nullptr
                                ? 0
                                : room * sizeof(std::uint32_t)) {
    columns_.size = 0;
    columns_.stride = 1;
    for (std::size_t p = 0; p < planes_; ++p) {
      columns_.planes[p] = Floats() + p * room;
    }
  }

  const FloatColumns& columns() const { return columns_; }
  std::uint32_t* ids() const {
    return reinterpret_cast<std::uint32_t*>(ids_.data());
  }
  std::uint32_t* categories() const {
    return reinterpret_cast<std::uint32_t*>(categories_.data());
  }

  // The objects of slots begin ... end - 1.
  void Add(std::size_t begin, std::size_t end) {
    const SortedLevel& level = levels_.level[0];
    for (std::size_t s = begin; s < end; ++s) {
      if ((level.present[s / kBlockObjects] >> s % kBlockObjects & 1) == 0) {
        continue;
      }
      const std::size_t i = columns_.size++;
      for (std::size_t p = 0; p < planes_; ++p) {
        Floats()[p * room_ + i] = level.planes[p][s];
      }
      ids()[i] = levels_.ids[s];
      if (categories() != nullptr) categories()[i] = level.categories[s];
    }
  }

 private:
  float* Floats() const { return reinterpret_cast<float*>(floats_.data()); }

  std::size_t planes_;
  std::size_t room_;
  const SortedLevels& levels_;
  Scratch floats_;
  Scratch ids_;
  Scratch categories_;
  FloatColumns columns_;
};

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

// The bounds of the next block, which are anywhere.
void Prefetch(const FloatColumns& objects, std::size_t planes,
              const std::uint32_t* elements) {
  // The values of a record are in one line, or in two.
  const std::size_t step = objects.stride == 1 ? 1 : planes - 1;
  for (std::size_t i = 0; i < kBlockObjects; ++i) {
    if (elements[i] == kNoId) continue;
    for (std::size_t p = 0; p < planes; p += step) {
      kernels::PrefetchToL2(objects.planes[p] + elements[i] * objects.stride);
    }
  }
}

void OrCategories(SortedLevels& levels, std::size_t level, std::size_t block) {
  const std::uint32_t* const of_block =
      levels.level[level].categories + block * kBlockObjects;
  std::uint32_t all = 0;
  for (std::size_t i = 0; i < kBlockObjects; ++i) all |= of_block[i];
  levels.level[level + 1].categories[block] = all;
}

void OrAllCategories(SortedLevels& levels) {
  for (std::size_t l = 0; l + 1 < levels.count; ++l) {
    for (std::size_t b = 0; b < BlocksOf(levels.level[l].size); ++b) {
      OrCategories(levels, l, b);
    }
  }
}

void FillPart(const SortedLevels& levels, std::size_t planes,
              const FloatColumns& objects, const std::uint32_t* elements,
              const SortedKernels::OfPlanes& kernels, std::size_t part) {
  const SortedLevel& level = levels.level[0];
  const SortedLevel* const above =
      levels.count > 1 ? &levels.level[1] : nullptr;
  const std::size_t end_block =
      std::min(BlocksOf(level.size), (part + 1) * kBlockObjects);
  for (std::size_t b = part * kBlockObjects; b < end_block; ++b) {
    const std::size_t first = b * kBlockObjects;
    if (elements != nullptr && b + 1 < end_block) {
      Prefetch(objects, planes, elements + first + kBlockObjects);
    }
    std::uint64_t present = level.present[b];
    if (~present == 0 && elements != nullptr) {
      for (std::size_t p = 0; p < planes; ++p) {
        float* const to = level.planes[p] + first;
        for (std::size_t i = 0; i < kBlockObjects; ++i) {
          to[i] = objects.planes[p][elements[first + i] * objects.stride];
        }
      }
    } else if (~present == 0 && objects.stride == 1) {
      for (std::size_t p = 0; p < planes; ++p) {
        std::memcpy(level.planes[p] + first, objects.planes[p] + first,
                    kBlockObjects * sizeof(float));
      }
    } else {
      for (std::size_t s = first; present != 0; present >>= 1, ++s) {
        if ((present & 1) == 0) continue;
        const std::size_t from =
            (elements == nullptr ? s : elements[s]) * objects.stride;
        for (std::size_t p = 0; p < planes; ++p) {
          level.planes[p][s] = objects.planes[p][from];
        }
      }
    }
    kernels.encode({&level, above, b, b + 1});
  }
}

}  // namespace

void CheckColumns(const SortedShape& shape, const FloatColumns& objects,
                  const char* call) {
  for (std::size_t p = 0; p < PlanesOf(shape); ++p) {
    kernels::CheckPointer(
        call, objects.planes[p], alignof(float),
        [&] { return kernels::PlaneName("world", shape.axes, p); },
        [&] {
          return "a plane of " + std::to_string(objects.size) + " floats";
        });
  }
}

void FillSlots(const SortedShape& shape, const SortedLevels& levels,
               const FloatColumns& objects, const std::uint32_t* elements,
               const SortedKernels::OfPlanes& kernels, const PartRunner& run) {
  run(PartsOf(levels.level[0].size), [&](std::size_t part) {
    kernels::InDefaultFpMode([&] {
      FillPart(levels, PlanesOf(shape), objects, elements, kernels, part);
    });
  });
  kernels::InDefaultFpMode([&] { EncodeLevels(levels, kernels, 1); });
}

double CostOf(const SortedShape& shape, const SortedLevels& levels,
              std::size_t part) {
  if (levels.count == 1) return 0;
  const SortedLevel& nodes = levels.level[1];
  const std::size_t end = std::min(nodes.size, (part + 1) * kBlockObjects);
  double cost = 0;
  for (std::size_t n = part * kBlockObjects; n < end; ++n) {
    double extents[4] = {};
    double slack = 0;
    for (std::size_t k = 0; k < shape.axes; ++k) {
      const double min = nodes.planes[k][n];
      slack -= min;
      if (shape.has_max) extents[k] = nodes.planes[shape.axes + k][n] - min;
    }
    double surface = slack;
    if (shape.has_max) {
      surface = shape.axes == 2
                    ? extents[0] + extents[1]
                    : extents[0] * extents[1] + extents[1] * extents[2] +
                          extents[2] * extents[0];
    } else if (shape.axes == 4) {
      surface = slack * slack;
    }
    if (surface > 0 && surface < std::numeric_limits<double>::infinity()) {
      cost += surface;
    }
  }
  return cost;
}

// Also when nothing grows: it makes a blob in place its own.
void SortedTree::Reallocate(std::size_t capacity, const SortedExtras& extras) {
  SortedTree grown(shape_, memory_);
  grown.Allocate(capacity, extras);
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
      EncodeLevels(grown.levels_, KernelsOf(shape_, Target(), "SortedWorld"),
                   old_count - 1);
      if (extras.has_categories) OrAllCategories(grown.levels_);
    }
  }
  Swap(grown);
}

// Before a change by id.
void SortedTree::NeedSlots() {
  if (block_ == nullptr) return;
  if (header().has_slots && is_owned_) return;
  const bool had_slots = header().has_slots != 0;
  Reallocate(std::max(header().capacity, header().ids),
             {true, header().has_categories != 0});
  if (had_slots) return;
  for (std::size_t s = 0; s < header().slots; ++s) {
    const std::uint32_t id = levels_.ids[s];
    if (id >= header().ids) {
      kernels::ThrowInvalid("SortedWorld", "blob",
                            "ids below " + std::to_string(header().ids),
                            std::to_string(id));
    }
    levels_.slots[id] = static_cast<std::uint32_t>(s);
  }
}

bool SortedTree::Has(std::uint32_t id) const {
  if (block_ == nullptr || id >= header().ids) return false;
  if (levels_.slots == nullptr) return true;
  const std::uint32_t slot = levels_.slots[id];
  return slot < header().slots && levels_.ids[slot] == id;
}

std::size_t SortedTree::SlotOf(std::uint32_t id, const char* call) {
  if (!Has(id)) {
    kernels::ThrowInvalid(call, "id", "the id of an object in the world",
                          std::to_string(id));
  }
  NeedSlots();
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
      const auto after = node();
      if (before.second == after.second &&
          std::memcmp(before.first.data(), after.first.data(),
                      sizeof(before.first)) == 0) {
        return;
      }
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
  const std::size_t slot = FindSlot(values.data());
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
  if (block_ == nullptr) return;
  if (levels_.level[0].categories == nullptr || !is_owned_) {
    Reallocate(header().capacity, {header().has_slots != 0, true});
  }
  for (std::size_t s = 0; s < header().slots; ++s) {
    const std::uint32_t id = levels_.ids[s];
    levels_.level[0].categories[s] =
        id < categories.size() ? categories[id] : 0;
  }
  OrAllCategories(levels_);
}

void SortedTree::Refit(const FloatColumns& objects, bool is_by_id,
                       const PartRunner& run) {
  constexpr const char* kCall = "SortedWorld::Refit";
  const std::size_t size = block_ == nullptr ? 0
                           : is_by_id        ? header().ids
                                             : header().slots;
  if (objects.size < size || (!is_by_id && objects.size > size)) {
    kernels::ThrowInvalid(kCall, "bounds",
                          (is_by_id ? "a bound for each id, at least "
                                    : "a bound for each element of ids(), ") +
                              std::to_string(size),
                          std::to_string(objects.size));
  }
  if (size == 0) return;
  CheckColumns(shape_, objects, kCall);
  if (!is_owned_) {
    Reallocate(header().capacity,
               {header().has_slots != 0, header().has_categories != 0});
  }
  FillSlots(shape_, levels_, objects, is_by_id ? levels_.ids : nullptr,
            KernelsOf(shape_, Target(), kCall), run);
}

double SortedTree::Decay() const {
  if (block_ == nullptr) return 1;
  double built = 0;
  double now = 0;
  for (std::size_t part = 0; part < PartsOf(header().slots); ++part) {
    built += levels_.built[part];
    now += CostOf(shape_, levels_, part);
  }
  return now == built ? 1 : now / built;
}

void SortedTree::Rebuild(Order order, const PartRunner& run) {
  if (block_ == nullptr) return;
  Gathered objects(shape_, memory_, levels_, header().slots);
  objects.Add(0, header().slots);
  SortedTree sorted(shape_, memory_);
  sorted.Build(objects.columns(), order, Target(), run);
  if (sorted.block_ == nullptr) return Swap(sorted);
  const SortedHeader& from = header();
  if (from.has_slots || from.has_categories) {
    sorted.Reallocate(std::max<std::size_t>(sorted.size(), from.ids),
                      {from.has_slots != 0, from.has_categories != 0});
  }
  SortedLevels& levels = sorted.levels_;
  if (from.has_slots) {
    std::memcpy(levels.slots, levels_.slots, from.ids * sizeof(std::uint32_t));
  }
  for (std::size_t s = 0; s < sorted.size(); ++s) {
    const std::uint32_t element = levels.ids[s];
    const std::uint32_t id = objects.ids()[element];
    levels.ids[s] = id;
    if (from.has_slots && id < from.ids) {
      levels.slots[id] = static_cast<std::uint32_t>(s);
    }
    if (from.has_categories) {
      levels.level[0].categories[s] = objects.categories()[element];
    }
  }
  if (from.has_categories) OrAllCategories(levels);
  sorted.header().ids = from.ids;
  sorted.header().free_id = from.free_id;
  Swap(sorted);
}

std::size_t SortedTree::RebuildWorst(std::size_t objects) {
  if (block_ == nullptr || objects == 0 || levels_.count == 1) return 0;
  if (!is_owned_) NeedSlots();
  const std::size_t parts = PartsOf(header().slots);
  const Scratch memory(memory_, parts * sizeof(std::pair<double, std::size_t>));
  auto* const worst =
      reinterpret_cast<std::pair<double, std::size_t>*>(memory.data());
  std::size_t bad = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    const double excess = CostOf(shape_, levels_, part) - levels_.built[part];
    if (excess > 0) worst[bad++] = {-excess, part};
  }
  std::sort(worst, worst + bad);
  bad = std::min(bad, std::max<std::size_t>(1, objects / kPartSlots));
  if (bad == 0) return 0;
  // The slots keep their places, and so their nodes: in the order of the parts
  // the objects of a part stay near each other.
  std::sort(worst, worst + bad,
            [](const auto& a, const auto& b) { return a.second < b.second; });
  Gathered gathered(shape_, memory_, levels_, bad * kPartSlots);
  const auto end_of = [&](std::size_t part) {
    return std::min<std::size_t>(header().slots, (part + 1) * kPartSlots);
  };
  for (std::size_t w = 0; w < bad; ++w) {
    gathered.Add(worst[w].second * kPartSlots, end_of(worst[w].second));
  }
  const FloatColumns& columns = gathered.columns();
  const Scratch order(memory_, columns.size * sizeof(std::uint32_t));
  auto* const elements = reinterpret_cast<std::uint32_t*>(order.data());
  const Scratch scratch(memory_, columns.size * kernels::kOrderScratch);
  const SortedKernels::OfPlanes& kernels =
      KernelsOf(shape_, Target(), "SortedWorld::RebuildWorst");
  InTurn in_turn;
  kernels::OrderByMedians(columns, kernels, scratch.data(), elements,
                          RunnerOf(in_turn));
  kernels::InDefaultFpMode([&] {
    const SortedLevel& level = levels_.level[0];
    std::size_t next = 0;
    for (std::size_t w = 0; w < bad; ++w) {
      const std::size_t begin = worst[w].second * kPartSlots;
      const std::size_t end = end_of(worst[w].second);
      for (std::size_t s = begin; s < end; ++s) {
        if (s % kBlockObjects == 0) ClearSlots(shape_, levels_, 0, s);
        if (next == columns.size) continue;
        const std::uint32_t element = elements[next++];
        for (std::size_t p = 0; p < PlanesOf(shape_); ++p) {
          level.planes[p][s] = columns.planes[p][element];
        }
        level.present[s / kBlockObjects] |= std::uint64_t{1}
                                            << s % kBlockObjects;
        const std::uint32_t id = gathered.ids()[element];
        levels_.ids[s] = id;
        if (levels_.slots != nullptr && id < header().ids) {
          levels_.slots[id] = static_cast<std::uint32_t>(s);
        }
        if (level.categories != nullptr) {
          level.categories[s] = gathered.categories()[element];
        }
      }
      kernels.encode(
          {&level, &levels_.level[1], begin / kBlockObjects, BlocksOf(end)});
    }
    EncodeLevels(levels_, kernels, 1);
    if (level.categories != nullptr) OrAllCategories(levels_);
  });
  for (std::size_t w = 0; w < bad; ++w) {
    levels_.built[worst[w].second] = CostOf(shape_, levels_, worst[w].second);
  }
  return columns.size;
}

}  // namespace halfspace::detail

// How far the order of a sorted world has decayed, and new orders for all
// objects and for the worst parts.
#include <algorithm>
#include <cstring>
#include <utility>

#include "dispatch/sorted/layout.h"
#include "dispatch/sorted/scratch.h"
#include "halfspace/sorted.h"
#include "kernels/exact/default_fp_mode.h"
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
      if (!IsPresent(levels_, s)) continue;
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

}  // namespace

double SortedTree::Decay() const {
  if (block_ == nullptr) return 1;
  return kernels::InDefaultFpMode([&] {
    double built = 0;
    double now = 0;
    for (std::size_t part = 0; part < PartsOf(header().slots); ++part) {
      built += levels_.built[part];
      now += CostOf(shape_, levels_, part);
    }
    return now == built ? 1 : now / built;
  });
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
  const std::size_t parts = PartsOf(header().slots);
  const Scratch memory(memory_, parts * sizeof(std::pair<double, std::size_t>));
  auto* const worst =
      reinterpret_cast<std::pair<double, std::size_t>*>(memory.data());
  std::size_t bad = 0;
  kernels::InDefaultFpMode([&] {
    for (std::size_t part = 0; part < parts; ++part) {
      const double excess = CostOf(shape_, levels_, part) - levels_.built[part];
      if (excess > 0) worst[bad++] = {-excess, part};
    }
  });
  std::sort(worst, worst + bad);
  bad = std::min(bad, std::max<std::size_t>(1, objects / kPartSlots));
  if (bad == 0) return 0;
  MakeOwn();
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
  kernels::InDefaultFpMode([&] {
    for (std::size_t w = 0; w < bad; ++w) {
      levels_.built[worst[w].second] = CostOf(shape_, levels_, worst[w].second);
    }
  });
  return columns.size;
}

}  // namespace halfspace::detail

// The cost ratio of a BVH, and rebuilds of all of it or of its worst groups.
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <tuple>
#include <utility>

#include "dispatch/bvh/order.h"
#include "dispatch/bvh/scratch.h"
#include "dispatch/bvh/tree.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/number_checks.h"
#include "halfspace/bvh.h"

namespace halfspace::detail {
namespace {

// The objects of some slots in new memory, to be sorted again.
class Gathered {
 public:
  Gathered(const PlaneLayout& layout, const MemoryResource& memory,
           const BvhLevels& levels, Span<const SlotRange> ranges)
      : planes_(layout.plane_count),
        room_(Slots(ranges)),
        levels_(levels),
        floats_(memory, room_ * planes_ * sizeof(float)),
        ids_(memory, room_ * sizeof(std::uint32_t)),
        masks_(memory, levels.level[0].masks == nullptr
                           ? 0
                           : room_ * sizeof(std::uint32_t)) {
    columns_ = ColumnsOf<float>(0, 1);
    for (std::size_t p = 0; p < planes_; ++p) {
      columns_.column[p] = Floats() + p * room_;
    }
    for (const SlotRange& range : ranges) Add(range);
  }

  const Columns& columns() const { return columns_; }
  std::uint32_t* ids() const {
    return reinterpret_cast<std::uint32_t*>(ids_.data());
  }
  bool has_masks() const { return masks_.data() != nullptr; }
  std::uint32_t MasksOf(std::uint32_t element) const {
    return has_masks() ? Masks()[element] : 0;
  }

 private:
  static std::size_t Slots(Span<const SlotRange> ranges) {
    std::size_t slots = 0;
    for (const SlotRange& range : ranges) slots += range.end - range.begin;
    return slots;
  }

  void Add(const SlotRange& range) {
    const BvhLevel& level = levels_.level[0];
    for (std::size_t s = range.begin; s < range.end; ++s) {
      if (!IsPresent(levels_, s)) continue;
      const std::size_t i = columns_.size++;
      for (std::size_t p = 0; p < planes_; ++p) {
        Floats()[p * room_ + i] = level.Value(p, s);
      }
      ids()[i] = levels_.ids[s];
      if (has_masks()) Masks()[i] = level.masks[s];
    }
  }

  float* Floats() const { return reinterpret_cast<float*>(floats_.data()); }
  std::uint32_t* Masks() const {
    return reinterpret_cast<std::uint32_t*>(masks_.data());
  }

  std::size_t planes_;
  std::size_t room_;
  const BvhLevels& levels_;
  Scratch floats_;
  Scratch ids_;
  Scratch masks_;
  Columns columns_;
};

// The bound of some blocks of objects, from the nodes above them.
BoundValues BoundOf(const PlaneLayout& layout, const BvhLevels& levels,
                    const SlotRange& range) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  BoundValues bound;
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    const bool is_min = p < layout.axes;
    bound[p] = is_min ? kInf : -kInf;
    for (std::size_t n = range.begin / kBlockObjects; n < BlocksOf(range.end);
         ++n) {
      const float value = levels.level[1].Value(p, n);
      bound[p] = is_min ? std::min(bound[p], value) : std::max(bound[p], value);
    }
  }
  return bound;
}

// The share of the world's bound that both bounds cover, or 0 if one of them
// has an infinite plane. An axis on which the world has no extent does not
// count.
double Overlap(const PlaneLayout& layout, const BoundValues& a,
               const BoundValues& b, const BoundValues& world) {
  double slack = 0;
  double of_world = 0;
  double share = 1;
  for (std::size_t k = 0; k < layout.axes; ++k) {
    const double min = std::max(a[k], b[k]);
    if (!layout.has_max) {
      slack -= min;
      of_world -= world[k];
      continue;
    }
    const std::size_t max = layout.axes + k;
    const double width = double{std::min(a[max], b[max])} - min;
    const double all = double{world[max]} - world[k];
    if (!(all > 0) && width >= 0) continue;
    share *= std::max(0.0, width / all);
  }
  if (!layout.has_max) share = slack / of_world;
  return share > 0 && share <= 1 ? share : 0;
}

// A group, and the reasons to sort it.
struct WornGroup {
  double overlap;  // with the group that has grown most
  double growth;
  std::size_t group;
};

}  // namespace

double BvhState::CostRatio() const {
  if (slots() <= kBlockObjects) return 1;
  return dispatch::InDefaultFpMode([&] {
    double built = 0;
    double now = 0;
    for (std::size_t group = 0; group < GroupsOf(header().slots); ++group) {
      const BvhGroup as_is = AsIs(type_, levels_, GroupAt(levels_, group));
      built += CostAsBuilt(levels_.built[group], as_is.objects);
      now += as_is.cost;
    }
    return now == built ? 1 : now / built;
  });
}

double BvhTree::CostRatio() const { return BvhState::Of(*this).CostRatio(); }

double BvhTree::ExpectedLeaves(Span<const float> extents) const {
  const BvhState& tree = BvhState::Of(*this);
  const PlaneLayout& layout = tree.type_;
  for (std::size_t k = 0; k < layout.dims; ++k) {
    dispatch::CheckLength("Bvh::ExpectedLeaves", "extents", extents[k]);
  }
  const std::size_t leaves = BlocksOf(tree.slots());
  if (leaves <= 1) return static_cast<double>(leaves);
  return dispatch::InDefaultFpMode([&] {
    BoundValues world;
    Bounds({world.data(), layout.plane_count});
    double expected = 0;
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
      double share = 1;
      for (std::size_t k = 0; k < layout.dims; ++k) {
        const auto extent = [&](const auto& value) {
          return double{value(layout.axes + k)} - value(k);
        };
        const double all = extent([&](std::size_t p) { return world[p]; });
        const double own = extent([&](std::size_t p) {
          return tree.levels_.level[1].Value(p, leaf);
        });
        // A leaf without objects has none, and an infinite one has all.
        const double axis = (std::max(own, 0.0) + extents[k]) / all;
        share *= own < 0 ? 0 : axis < 1 ? axis : 1;
      }
      expected += share;
    }
    return expected;
  });
}

void BvhTree::Rebuild(const BuildOptions& options) {
  BvhState& tree = BvhState::Of(*this);
  tree.CheckBuild(tree.size(), options);
  if (tree.block_ == nullptr) return;
  tree.CheckLoaded("Bvh::Rebuild");
  const SlotRange all = {0, tree.header().slots};
  const Gathered objects(tree.type_, tree.memory_, tree.levels_, {&all, 1});
  const std::size_t size = objects.columns().size;
  std::uint32_t ids = 0;  // up to the greatest that is in use
  for (std::size_t i = 0; i < size; ++i) {
    ids = std::max(ids, objects.ids()[i] + 1);
  }
  const bool has_slots = tree.levels_.slots != nullptr;
  BvhState sorted(tree.type_, tree.memory_);
  sorted.BuildIn({size, has_slots ? ids : 0, tree.header().has_masks != 0},
                 objects.columns(), options,
                 AxisWeights::Unpack(tree.header().weights));
  BvhLevels& levels = sorted.levels_;
  if (has_slots && size > 0) {
    std::fill_n(levels.slots, ids, kNoId);
    sorted.Used().Clear();
  }
  for (std::size_t s = 0; s < size; ++s) {
    const std::uint32_t element = levels.ids[s];
    const std::uint32_t id = objects.ids()[element];
    PutId(levels, s, id, objects.MasksOf(element));
    if (has_slots) sorted.Used().Add(id);
  }
  if (size > 0 && objects.has_masks()) OrAllMasks(levels);
  if (size > 0) sorted.header().ids = ids;
  tree.Swap(sorted);
}

void BvhState::SortAll(const char* call, BuildQuality quality,
                       const Runner& run) {
  if (slots() == 0) return;
  CheckChange(call);
  const SlotRange all = {0, slots()};
  Resort(call, {&all, 1}, quality, run);
  header().sorted = header().slots;
  header().inserted = 0;
}

std::size_t BvhState::Resort(const char* call, Span<const SlotRange> ranges,
                             BuildQuality quality, const Runner& run) {
  const BvhKernels::OfPlanes& kernels = KernelsFor(type_, Target(), call);
  const Gathered gathered(type_, memory_, levels_, ranges);
  const Columns& columns = gathered.columns();
  const Scratch order(memory_, columns.size * sizeof(std::uint32_t));
  auto* const elements = reinterpret_cast<std::uint32_t*>(order.data());
  const Scratch scratch(memory_, columns.size * kOrderScratch);
  const bool is_all = ranges[0].end - ranges[0].begin == slots();
  auto weights = AxisWeights::Unpack(header().weights);
  if (header().weights == AxisWeights::kNone || (is_all && !weights.is_given)) {
    weights = WeightsOf(type_, columns, kernels, std::nullopt);
  }
  if (quality == BuildQuality::kFast) {
    OrderByCurve(type_, columns, weights, kernels, scratch.data(), elements,
                 run);
  } else {
    OrderByMedians(columns, weights, kernels, scratch.data(), elements, run);
  }
  Prepare(call, {});
  if (is_all) header().weights = weights.Pack();
  const BvhLevel& level = levels_.level[0];
  std::size_t next = 0;
  for (const SlotRange& range : ranges) {
    for (std::size_t s = range.begin; s < range.end; ++s) {
      if (s % kBlockObjects == 0) ClearSlots(type_, levels_, 0, s);
      if (next == columns.size) continue;
      const std::uint32_t element = elements[next++];
      for (std::size_t p = 0; p < type_.plane_count; ++p) {
        level.Value(p, s) = columns.floats(p)[element];
      }
      level.present[s / kBlockObjects] |= std::uint64_t{1} << s % kBlockObjects;
      PutId(levels_, s, gathered.ids()[element], gathered.MasksOf(element));
    }
  }
  dispatch::InDefaultFpMode([&] {
    if (is_all) FitMap(type_, levels_);
    for (const SlotRange& range : ranges) {
      EncodeSlots(levels_, kernels, range.begin, range.end);
    }
    // The last slot in use is that of the last object.
    std::size_t blocks = BlocksOf(header().slots);
    while (blocks > 0 && level.present[blocks - 1] == 0) --blocks;
    if (blocks > 0) {
      const std::size_t end =
          blocks * kBlockObjects -
          static_cast<std::size_t>(std::countl_zero(level.present[blocks - 1]));
      // As many objects as before are behind those that were sorted with all.
      const auto cut = header().slots - static_cast<std::uint32_t>(end);
      header().slots -= cut;
      header().sorted -= std::min(header().sorted, cut);
      Truncate(type_, levels_, end);
      EncodeSlots(levels_, kernels, end - 1, end);
    }
    for (const SlotRange& range : ranges) {
      const std::size_t groups = GroupsOf(std::min(range.end, slots()));
      for (std::size_t g = range.begin / kGroupSlots; g < groups; ++g) {
        // Objects before the range, in the same group, keep their decay.
        const SlotRange group = GroupAt(levels_, g);
        const std::size_t begin = std::max(group.begin, range.begin);
        const BvhGroup rest = AsIs(type_, levels_, {group.begin, begin});
        const BvhGroup sorted = AsIs(type_, levels_, {begin, group.end});
        levels_.built[g] = {
            sorted.cost + CostAsBuilt(levels_.built[g], rest.objects),
            sorted.objects + rest.objects};
      }
    }
  });
  return columns.size;
}

void BvhState::CloseGaps() {
  const BvhKernels::OfPlanes& kernels = KernelsFor(type_, Target(), "Bvh");
  BvhHeader& header = this->header();
  const double decay = std::max(1.0, CostRatio());
  const BvhLevel& level = levels_.level[0];
  std::size_t to = 0;
  std::size_t sorted = 0;
  for (std::size_t s = 0; s < header.slots; ++s) {
    if (!IsPresent(levels_, s)) continue;
    if (s < header.sorted) ++sorted;
    for (std::size_t p = 0; p < type_.plane_count; ++p) {
      level.Value(p, to) = level.Value(p, s);
    }
    PutId(levels_, to, levels_.ids[s],
          level.masks == nullptr ? 0 : level.masks[s]);
    ++to;
  }
  header.slots = static_cast<std::uint32_t>(to);
  header.sorted = static_cast<std::uint32_t>(sorted);
  if (to == 0) {
    header.ids = 0;
    header.inserted = 0;
  }
  Truncate(type_, levels_, to);
  FillPresent(level, to);
  dispatch::InDefaultFpMode([&] {
    EncodeLevels(levels_, kernels, 0);
    if (level.masks != nullptr) OrAllMasks(levels_);
    // The cost ratio stays as it was.
    for (std::size_t group = 0; group < GroupsOf(to); ++group) {
      levels_.built[group] = AsIs(type_, levels_, GroupAt(levels_, group));
      levels_.built[group].cost /= decay;
    }
  });
}

std::size_t BvhTree::RebuildPartial(std::size_t objects, const Runner& run) {
  BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::RebuildPartial";
  if (tree.slots() == 0 || objects == 0 || tree.levels_.count == 1) return 0;
  // Objects that were inserted are sorted with those that came with them, which
  // can be anywhere: their groups have not grown.
  if (objects >= tree.size() && tree.header().sorted != tree.slots()) {
    tree.SortAll(kCall, BuildQuality::kHigh, run);
    return tree.size();
  }
  tree.CheckChange(kCall);
  const std::size_t groups = GroupsOf(tree.header().slots);
  const Scratch memory(tree.memory_, groups * sizeof(WornGroup));
  auto* const worn = reinterpret_cast<WornGroup*>(memory.data());
  std::size_t alike = 0;
  dispatch::InDefaultFpMode([&] {
    const BvhLevels& levels = tree.levels_;
    const auto bound_of = [&](std::size_t group) {
      return BoundOf(tree.type_, levels, GroupAt(levels, group));
    };
    for (std::size_t group = 0; group < groups; ++group) {
      const BvhGroup as_is = AsIs(tree.type_, levels, GroupAt(levels, group));
      const double growth =
          as_is.cost - CostAsBuilt(levels.built[group], as_is.objects);
      // An altered blob can have a NaN, which cannot be sorted.
      worn[group] = {0, growth > 0 ? growth : 0, group};
    }
    std::iter_swap(worn, std::max_element(worn, worn + groups,
                                          [](const auto& a, const auto& b) {
                                            return a.growth < b.growth;
                                          }));
    const BoundValues bound = bound_of(worn[0].group);
    const BoundValues world = BoundOf(tree.type_, levels, {0, tree.slots()});
    const double size = Overlap(tree.type_, bound, bound, world);
    for (std::size_t i = 0; i < groups && worn[0].growth > 0; ++i) {
      const BoundValues other = bound_of(worn[i].group);
      worn[i].overlap = Overlap(tree.type_, bound, other, world);
      // A group of new objects from everywhere overlaps all groups, and would
      // spread the objects of those that are sorted with it: queries of a world
      // whose objects come and go took three times as long.
      const double others_size = Overlap(tree.type_, other, other, world);
      if (8 * others_size >= size && 8 * size >= others_size) {
        std::swap(worn[i], worn[alike++]);
      }
    }
  });
  if (!(worn[0].growth > 0)) return 0;
  const std::size_t most =
      objects >= tree.size() ? groups
                             : std::max<std::size_t>(2, objects / kGroupSlots);
  if (most >= groups) alike = groups;
  // The groups that overlap are sorted together, so objects that have moved
  // from one group to another change their group. A group that is sorted alone
  // would keep its objects, wherever they are.
  std::sort(worn + 1, worn + alike, [](const auto& a, const auto& b) {
    return std::tie(a.overlap, a.growth, b.group) >
           std::tie(b.overlap, b.growth, a.group);
  });
  std::size_t bad = 1;
  while (bad < std::min(most, alike) &&
         (worn[bad].overlap > 0 || worn[bad].growth > 0)) {
    ++bad;
  }
  // The groups are sorted by their number, so that neighbouring slots get
  // neighbouring objects.
  std::sort(worn, worn + bad,
            [](const auto& a, const auto& b) { return a.group < b.group; });
  const Scratch list(tree.memory_, bad * sizeof(SlotRange));
  auto* const ranges = reinterpret_cast<SlotRange*>(list.data());
  for (std::size_t w = 0; w < bad; ++w) {
    ranges[w] = GroupAt(tree.levels_, worn[w].group);
  }
  return tree.Resort(kCall, {ranges, bad}, BuildQuality::kHigh, run);
}

}  // namespace halfspace::detail

// The calls of bvh_pairs.h.
#include "dispatch/bvh/pairs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "dispatch/bvh/scratch.h"
#include "dispatch/bvh/tree.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/errors/number_checks.h"
#include "dispatch/outward.h"
#include "dispatch/sink.h"
#include "halfspace/bvh_pairs.h"
#include "kernels/bvh/kernel_table.h"
#include "kernels/compiler.h"

namespace halfspace::detail {
namespace {

using PairSink = dispatch::Sink<Results<IdPair>, IdPair, 256>;

// Checks a set before it allocates memory, and before any pair is written.
void CheckSet(const BvhTree& tree, Span<const std::uint32_t> ids,
              Span<const std::uint32_t> wanted, const char* call) {
  if (!wanted.empty()) {
    if (wanted.size() != ids.size()) {
      dispatch::ThrowInvalid(call, "options.wanted",
                             std::to_string(ids.size()) + " masks, or none",
                             std::to_string(wanted.size()));
    }
    dispatch::CheckPointer(
        call, wanted.data(), alignof(std::uint32_t),
        [] { return "options.wanted"; },
        [&] { return std::to_string(wanted.size()) + " masks"; });
  }
  tree.CheckIds(ids, call);
}

// A SlotSet of `count` numbers, slots or ids, below `limit`. A small set does
// not allocate.
class SetOf : public SlotSet {
 public:
  SetOf(const MemoryResource& memory, std::size_t count, std::size_t limit)
      : SlotSet(TableFor(count, limit)),
        memory_(memory, size <= kFewEntries ? 0 : size * sizeof(Block)) {
    blocks =
        size <= kFewEntries ? few_ : reinterpret_cast<Block*>(memory_.data());
    std::fill_n(blocks, size, Block{});
  }

  void Add(std::size_t number) {
    Block& entry = blocks[EntryOf(number / kBlockObjects)];
    entry.block = static_cast<std::uint32_t>(number / kBlockObjects);
    entry.slots |= BitOf(number);
  }
  // After the last Add().
  void Rank() {
    std::uint32_t first = 0;
    for (std::size_t i = 0; i < size; ++i) {
      blocks[i].first = first;
      first += static_cast<std::uint32_t>(std::popcount(blocks[i].slots));
    }
  }

 private:
  static constexpr std::size_t kFewEntries = 256;
  // At most a quarter of the entries are used, or each block has its own entry.
  static SlotSet TableFor(std::size_t count, std::size_t limit) {
    const std::size_t blocks = BlocksOf(limit);
    const std::size_t most = std::min(4 * count, blocks);
    const auto bits = static_cast<std::uint32_t>(std::bit_width(most));
    return {nullptr, std::min(std::size_t{1} << bits, blocks), bits, nullptr};
  }

  Block few_[kFewEntries];
  Scratch memory_;
};

constexpr std::size_t kFewIds = 64;

// A mask for each id of a list. A short list does not allocate.
class Masks {
 public:
  Masks(const MemoryResource& memory, std::size_t count)
      : memory_(memory, count <= kFewIds ? 0 : count * sizeof(std::uint32_t)) {
    std::fill_n(data(), count, 0);
  }
  std::uint32_t* data() {
    return memory_.data() == nullptr
               ? few_
               : reinterpret_cast<std::uint32_t*>(memory_.data());
  }

 private:
  Scratch memory_;
  std::uint32_t few_[kFewIds];
};

// The set of a call, and what its objects want.
class ObjectSet {
 public:
  ObjectSet(const BvhTree& tree, Span<const std::uint32_t> ids,
            Span<const std::uint32_t> wanted)
      : levels_(tree.levels()),
        slots_(tree.memory(), ids.size(), levels_.level[0].size),
        wanted_(tree.memory(), wanted.size()) {
    if (levels_.slots != nullptr) {
      Fill(ids, wanted);
    } else if (!ids.empty()) {
      Search(tree.memory(), ids, wanted);
    }
    if (!wanted.empty()) slots_.wanted = wanted_.data();
  }

  const SlotSet& slots() const { return slots_; }

 private:
  void Fill(Span<const std::uint32_t> ids, Span<const std::uint32_t> wanted) {
    for (std::uint32_t id : ids) slots_.Add(levels_.slots[id]);
    if (wanted.empty()) return;
    slots_.Rank();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      wanted_.data()[slots_.RankOf(levels_.slots[ids[i]])] |= wanted[i];
    }
  }

  // For a world without slots by id. A function of its own, because its tables
  // would make the stack frame of its caller large.
  HALFSPACE_NOINLINE void Search(const MemoryResource& memory,
                                 Span<const std::uint32_t> ids,
                                 Span<const std::uint32_t> wanted) {
    const std::size_t size = levels_.level[0].size;
    const Scratch bits(memory, BlocksOf(size) * sizeof(std::uint64_t));
    const std::uint32_t* const id_of = levels_.ids;
    auto* const is_in = reinterpret_cast<std::uint64_t*>(bits.data());
    std::fill_n(is_in, BlocksOf(size), 0);
    for (std::uint32_t id : ids) is_in[id / kBlockObjects] |= BitOf(id);
    std::size_t count = 0;
    for (std::size_t i = 0; i < BlocksOf(size); ++i) {
      count += static_cast<std::size_t>(std::popcount(is_in[i]));
    }
    // Stops when all ids are found. An altered blob can have any ids.
    const auto for_each = [&](const auto& visit) {
      std::size_t left = count;
      for (std::uint32_t s = 0; s < size && left > 0; ++s) {
        const std::uint32_t id = id_of[s];
        if (id < size &&
            (is_in[id / kBlockObjects] >> id % kBlockObjects & 1) != 0) {
          visit(s, id);
          --left;
        }
      }
    };
    for_each([this](std::uint32_t s, std::uint32_t) { slots_.Add(s); });
    if (wanted.empty()) return;
    slots_.Rank();
    SetOf set(memory, ids.size(), size);
    for (std::uint32_t id : ids) set.Add(id);
    set.Rank();
    Masks by_id(memory, ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
      by_id.data()[set.RankOf(ids[i])] |= wanted[i];
    }
    for_each([&](std::uint32_t s, std::uint32_t id) {
      wanted_.data()[slots_.RankOf(s)] = by_id.data()[set.RankOf(id)];
    });
  }

  const BvhLevels& levels_;
  SetOf slots_;
  Masks wanted_;
};

// The margin on each axis. D is minus the sum of the others, so it has
// `of_d` times the margin.
std::array<float, 4> MarginsOf(const PlaneLayout& layout, float margin,
                               double of_d) {
  std::array<float, 4> margins{};
  for (std::size_t k = 0; k < layout.axes; ++k) {
    margins[k] = k < layout.dims ? margin : dispatch::RoundUp(of_d * margin);
  }
  return margins;
}

// The error of a squared distance in floats is below 2^-20, or 2^-120.
NearLimit NearLimitOf(const PlaneLayout& layout, float within) {
  // In some modes an overflow becomes the greatest float.
  constexpr double kMost = 0x1p127;
  constexpr double kLeast = 0x1p-100;
  NearLimit limit{};
  limit.dims = layout.dims;
  const double squared = double{within} * within;
  limit.squared = squared * (1 + 0x1p-50);
  limit.sure =
      squared < kLeast
          ? -1.0f
          : static_cast<float>(std::min(kMost, squared * (1 - 0x1p-18)));
  limit.beyond = dispatch::RoundUp(std::max(kLeast, squared) * (1 + 0x1p-18));
  limit.d_gap = dispatch::RoundUp(std::sqrt(static_cast<double>(layout.dims)) *
                                      within * (1 + 0x1p-20) +
                                  0x1p-120);
  return limit;
}

// Looks at the bits, because a compare may flush subnormals.
bool IsAboveZero(float length) {
  return kernels::BitCast<std::uint32_t>(length) << 1 != 0;
}

// Whether a list without absent ids is of all objects. Looks at sorted lists
// only: for these it is a fraction of what the set would take.
bool IsOfAll(const BvhTree& tree, Span<const std::uint32_t> ids) {
  return ids.size() == tree.size() &&
         std::adjacent_find(ids.begin(), ids.end(),
                            std::greater_equal<std::uint32_t>()) == ids.end();
}

// A function of its own, as Search().
HALFSPACE_NOINLINE void JoinSet(const BvhPairKernels& kernels, PairJoin& join,
                                const BvhTree& tree,
                                Span<const std::uint32_t> ids,
                                Span<const std::uint32_t> wanted) {
  const ObjectSet set(tree, ids, wanted);
  join.set = &set.slots();
  kernels.join(join);
}

}  // namespace

void FindPairs(const PairSources& sources, const PairOptions& options,
               const char* call, Results<IdPair>& pairs) {
  const BvhPairKernels& kernels =
      sources.kernels[dispatch::IndexOf(options.target, call)];
  const BvhTree& a = *sources.a;
  const BvhTree& b = sources.b != nullptr ? *sources.b : a;
  dispatch::CheckFiniteLength(call, "options.margin", options.margin);
  dispatch::CheckFiniteLength(call, "options.within", options.within);
  const bool has_margin = IsAboveZero(options.margin);
  const bool is_near = IsAboveZero(options.within);
  if (has_margin && is_near) {
    dispatch::ThrowInvalid(call, "options.within", "0 next to a margin",
                           detail::NumberText(options.within));
  }
  if (sources.ids != nullptr) {
    CheckSet(a, *sources.ids, options.wanted, call);
  } else if (!options.wanted.empty()) {
    dispatch::ThrowInvalid(call, "options.wanted", "no masks without a set",
                           std::to_string(options.wanted.size()));
  }
  if (a.size() == 0 || b.size() == 0) return;
  PairJoin join{};
  join.walk.levels = &b.levels();
  join.walk.mask = options.mask;
  join.queries = &a.levels();
  join.is_one_world = sources.b == nullptr;
  join.has_margin = has_margin || is_near;
  if (join.has_margin) {
    dispatch::InDefaultFpMode([&] {
      const auto dims = static_cast<double>(a.type().dims);
      join.margins = is_near
                         ? MarginsOf(a.type(), options.within, std::sqrt(dims))
                         : MarginsOf(a.type(), options.margin, dims);
      if (is_near) join.near = NearLimitOf(a.type(), options.within);
    });
  }
  join.begin = options.begin;
  join.end = std::min(options.end, BlocksOf(a.levels().level[0].size));
  join.pairs = &pairs;
  // The pairs of all objects are those of the world, in the same order.
  if (sources.ids == nullptr || (join.is_one_world && options.wanted.empty() &&
                                 IsOfAll(a, *sources.ids))) {
    return kernels.join(join);
  }
  JoinSet(kernels, join, a, *sources.ids, options.wanted);
}

std::size_t BvhPairs(const PairSources& sources, Span<IdPair> pairs,
                     const PairOptions& options) {
  static_assert(sizeof(IdPair) == 2 * sizeof(std::uint32_t));
  const char* const call = sources.ids != nullptr ? "PairsOf" : "Pairs";
  if (pairs.size() != 0) {
    dispatch::CheckPointer(
        call, pairs.data(), alignof(IdPair), [] { return "pairs"; },
        [&] {
          return "memory for " + std::to_string(pairs.size()) + " pairs";
        });
  }
  PairSink to(pairs, options.skip);
  FindPairs(sources, options, call, to);
  to.Flush();
  return to.flushed;
}

void BvhForEachPair(const PairSources& sources, PairsFunction function,
                    void* context, const PairOptions& options) {
  PairSink to(function, context, options.skip);
  // If the function has ended the call, there are none.
  FindPairs(sources, options,
            sources.ids != nullptr ? "ForEachPairOf" : "ForEachPair", to);
  to.Flush();
}

std::size_t BvhTree::PairsOf(const BvhPairKernels* kernels,
                             Span<const std::uint32_t> ids, Span<IdPair> pairs,
                             const PairOptions& options) const {
  return BvhPairs({kernels, this, nullptr, &ids}, pairs, options);
}

void BvhTree::ForEachPairOf(const BvhPairKernels* kernels,
                            Span<const std::uint32_t> ids,
                            PairsFunction function, void* context,
                            const PairOptions& options) const {
  BvhForEachPair({kernels, this, nullptr, &ids}, function, context, options);
}

}  // namespace halfspace::detail

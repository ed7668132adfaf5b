// The calls of bvh_pairs.h: checks, the set, and what becomes of the pairs.
#include <algorithm>
#include <cstring>
#include <string>

#include "dispatch/bvh/layout.h"
#include "dispatch/bvh/scratch.h"
#include "halfspace/bvh_pairs.h"
#include "kernels/bvh/block.h"
#include "kernels/error.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

// Pairs that go to the caller's memory while that has room for those of a
// block, and to a buffer then.
struct PairsToSpan : PairSink {
  explicit PairsToSpan(Span<IdPair> to) : span(to) {
    begin = next = reinterpret_cast<std::uint32_t*>(span.data());
    end = begin + 2 * span.size();
    make_room = [](PairSink& pairs) {
      static_cast<PairsToSpan&>(pairs).Flush();
      return true;
    };
  }

  void Flush() {
    const auto count = static_cast<std::size_t>(next - begin) / 2;
    if (begin == buffer && total < span.size()) {
      std::memcpy(span.data() + total, buffer,
                  std::min(count, span.size() - total) * sizeof(IdPair));
    }
    total += count;
    begin = next = buffer;
    end = std::end(buffer);
  }

  Span<IdPair> span;
  std::uint32_t* begin;
  std::size_t total = 0;  // before `begin`
  std::uint32_t buffer[4 * kBlockObjects];
};

// Pairs that a function takes, some at a time.
struct PairsToFunction : PairSink {
  PairsToFunction(PairsFunction to, void* its_context)
      : function(to), context(its_context) {
    next = &buffer[0].a;
    end = next + 2 * kRoom;
    make_room = [](PairSink& pairs) {
      return static_cast<PairsToFunction&>(pairs).Flush();
    };
  }

  bool Flush() {
    const auto count = static_cast<std::size_t>(next - &buffer[0].a) / 2;
    next = &buffer[0].a;
    return count == 0 || function(context, {buffer, count});
  }

  static constexpr std::size_t kRoom = 256;
  PairsFunction function;
  void* context;
  IdPair buffer[kRoom];
};

std::uint64_t BitOf(std::size_t i) { return std::uint64_t{1} << (i % 64); }

// Before the set takes memory, and any pair is written.
void CheckIds(const BvhTree& tree, Span<const std::uint32_t> ids,
              const char* call) {
  if (ids.empty()) return;
  kernels::CheckPointer(
      call, ids.data(), alignof(std::uint32_t), [] { return "ids"; },
      [&] { return std::to_string(ids.size()) + " ids"; });
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (tree.Has(ids[i])) continue;
    kernels::ThrowInvalid(call, "ids[" + std::to_string(i) + "]",
                          "the id of an object in the world",
                          std::to_string(ids[i]));
  }
}

// Of each slot a bit, whether its id is in a list.
class SlotSet {
 public:
  // The set of all objects has no memory.
  SlotSet(const BvhTree& tree, const Span<const std::uint32_t>* ids)
      : memory_(tree.memory(), ids == nullptr ? 0 : Bytes(tree)) {
    if (ids == nullptr) return;
    const BvhLevels& levels = tree.levels();
    const std::size_t size = levels.level[0].size;
    std::uint64_t* const by_slot = words();
    std::uint64_t* const by_id =
        levels.slots != nullptr ? nullptr : by_slot + BlocksOf(size);
    std::fill_n(by_slot, Bytes(tree) / sizeof(std::uint64_t), 0);
    for (std::uint32_t id : *ids) {
      if (by_id != nullptr) {
        by_id[id / 64] |= BitOf(id);
      } else {
        by_slot[levels.slots[id] / 64] |= BitOf(levels.slots[id]);
      }
    }
    if (by_id == nullptr) return;
    for (std::size_t s = 0; s < size; ++s) {
      const std::uint32_t id = levels.ids[s];
      // Any number, in a blob that was altered.
      if (id < size && (by_id[id / 64] & BitOf(id)) != 0) {
        by_slot[s / 64] |= BitOf(s);
      }
    }
  }

  std::uint64_t* words() const {
    return reinterpret_cast<std::uint64_t*>(memory_.data());
  }

 private:
  // Without slots by id, also the set by id: its ids are below the slots.
  static std::size_t Bytes(const BvhTree& tree) {
    const std::size_t words = BlocksOf(tree.levels().level[0].size);
    return (tree.levels().slots != nullptr ? words : 2 * words) *
           sizeof(std::uint64_t);
  }

  Scratch memory_;
};

void Join(const PairSources& sources, const PairOptions& options,
          const char* call, PairSink& pairs) {
  const BvhPairKernels& kernels =
      sources.kernels[dispatch::IndexOf(options.target, call)];
  const BvhTree& a = *sources.a;
  const BvhTree& b = sources.b != nullptr ? *sources.b : a;
  if (sources.ids != nullptr) CheckIds(a, *sources.ids, call);
  if (a.size() == 0 || b.size() == 0) return;
  const SlotSet set(a, sources.ids);
  PairJoin join{};
  join.walk.levels = &b.levels();
  join.walk.mask = options.mask;
  join.queries = &a.levels();
  join.is_one_world = sources.b == nullptr;
  join.set = set.words();
  join.begin = options.begin;
  join.end = std::min(options.end, BlocksOf(a.levels().level[0].size));
  join.pairs = &pairs;
  kernels.join(join);
}

}  // namespace

std::size_t BvhPairs(const PairSources& sources, Span<IdPair> pairs,
                     const PairOptions& options) {
  static_assert(sizeof(IdPair) == 2 * sizeof(std::uint32_t));
  const char* const call = sources.ids != nullptr ? "PairsOf" : "Pairs";
  if (pairs.size() != 0) {
    kernels::CheckPointer(
        call, pairs.data(), alignof(IdPair), [] { return "pairs"; },
        [&] {
          return "memory for " + std::to_string(pairs.size()) + " pairs";
        });
  }
  PairsToSpan to(pairs);
  Join(sources, options, call, to);
  to.Flush();
  return to.total;
}

void BvhForEachPair(const PairSources& sources, PairsFunction function,
                    void* context, const PairOptions& options) {
  PairsToFunction to(function, context);
  // After a function that ended the call there are none.
  Join(sources, options,
       sources.ids != nullptr ? "ForEachPairOf" : "ForEachPair", to);
  to.Flush();
}

}  // namespace halfspace::detail

#include "dispatch/broad_phase/state.h"

#include <algorithm>
#include <string>
#include <utility>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"

namespace halfspace::detail {

void BroadPhaseState::CheckList(const char* call, Span<const std::uint32_t> ids,
                                const char* name, const void* others,
                                std::size_t other_count,
                                std::size_t alignment) const {
  if (other_count != ids.size()) {
    dispatch::ThrowInvalid(call, name,
                           "one for each id, " + std::to_string(ids.size()),
                           std::to_string(other_count));
  }
  const auto check = [&](const char* argument, const void* memory,
                         std::size_t its_alignment) {
    // Not only CheckMemory(), because a call of it takes as long as the move of
    // a body.
    if (ids.empty() || dispatch::IsAligned(memory, its_alignment)) return;
    dispatch::CheckMemory(call, argument, memory, ids.size(), its_alignment);
  };
  check("ids", ids.data(), alignof(std::uint32_t));
  check(name, others, alignment);
}

void BroadPhaseState::CheckBodies(const char* call,
                                  Span<const std::uint32_t> ids) const {
  CheckList(call, ids, "ids", ids.data(), ids.size(), alignof(std::uint32_t));
  const std::size_t i = records.FindAbsent(ids);
  if (i == ids.size()) return;
  dispatch::ThrowInvalid(call, "ids", "the id of a body",
                         std::to_string(ids[i]), i);
}

BlockVector<std::uint32_t> BroadPhaseState::IdsOf(
    Records::ChangedSet set, const MemoryResource& memory) const {
  BlockVector<std::uint32_t> ids{BlockAllocator<std::uint32_t>(memory)};
  ids.reserve(records.Count(set));
  records.ForEachOf(set, [&](std::uint32_t id) { ids.push_back(id); });
  return ids;
}

void BroadPhaseState::Flush() {
  if (!records.HasMarks()) return;
  BvhState::Of(tree).PrepareRefit();
  const std::size_t count = records.TakeMarks();
  const bool is_all = 2 * count > tree.size();
  WithAxes(type.axes, [&](auto axes) {
    is_all ? FlushAll<axes>() : FlushSome<axes>(count);
  });
}

// Copies block by block, so that bounds are written to memory that is in cache.
// Records can be anywhere, so the records of the next block are prefetched.
template <std::size_t kAxes, typename BitsOf>
void BroadPhaseState::CopyBlocks(std::size_t begin, std::size_t end,
                                 const BitsOf& bits_of) {
  const BvhLevels& levels = tree.levels();
  Records::BlockCopy copies[2];
  Records::BlockCopy* copy = copies;
  Records::BlockCopy* next_copy = copies + 1;
  const auto find_from = [&](std::size_t block, Records::BlockCopy& to) {
    while (block < end && bits_of(block) == 0) ++block;
    if (block < end) {
      to.Find(records, levels.ids + block * kBlockObjects, bits_of(block));
    }
    return block;
  };
  std::size_t next = 0;
  for (std::size_t block = find_from(begin, *copy); block < end; block = next) {
    next = find_from(block + 1, *next_copy);
    copy->CopyTo<kAxes>(levels.level[0].Plane(block, 0));
    std::swap(copy, next_copy);
  }
}

// As Bvh::Refit() of all objects.
template <std::size_t kAxes>
void BroadPhaseState::FlushAll() {
  const BvhLevels& levels = tree.levels();
  const BvhKernels::OfPlanes& kernels =
      KernelsFor(type, Target(), "BroadPhase");
  dispatch::InDefaultFpMode([&] {
    if (levels.codes != nullptr) FitMap(type, levels);
    const std::size_t blocks = BlocksOf(levels.level[0].size);
    for (std::size_t begin = 0; begin < blocks; begin += kBlockObjects) {
      const std::size_t end = std::min(blocks, begin + kBlockObjects);
      CopyBlocks<kAxes>(begin, end, [&](std::size_t block) {
        return levels.level[0].present[block];
      });
      kernels.encode(RangeOf(levels, 0, begin, end));
    }
    EncodeLevels(levels, kernels, 1);
  });
}

// As Bvh::Refit() of a list.
template <std::size_t kAxes>
void BroadPhaseState::FlushSome(std::size_t count) {
  const BvhLevels& levels = tree.levels();
  BvhState& state = BvhState::Of(tree);
  if (count <= BvhState::FewChanges(levels.level[0].size)) {
    return records.ForEachTaken([&](std::uint32_t id) {
      const std::size_t slot = levels.slots[id];
      records.Copy<kAxes>(id, &levels.level[0].Value(0, slot));
      state.EncodePath(slot);
    });
  }
  std::uint64_t* const changed = changed_slots.data();
  std::fill(changed_slots.begin(), changed_slots.end(), 0);
  records.ForEachTaken([&](std::uint32_t id) {
    const std::size_t slot = levels.slots[id];
    changed[slot / 64] |= std::uint64_t{1} << slot % 64;
  });
  CopyBlocks<kAxes>(0, BlocksOf(levels.level[0].size),
                    [changed](std::size_t block) { return changed[block]; });
  state.EncodeTouched(changed);
}

void BroadPhaseState::Adopt(BvhTree its_tree) {
  // Adds slots by id. Throws if the ids of the tree are wrong.
  its_tree.Reserve(its_tree.size());
  tree = std::move(its_tree);
  // In the order of ids, so that records are written one after another.
  const auto limit = static_cast<std::uint32_t>(tree.id_limit());
  std::uint32_t reserved = kNoId;  // 64 ids
  for (std::uint32_t id = 0; id < limit; ++id) {
    if (!tree.Has(id)) continue;
    if (id / 64 != reserved) records.Reserve({&id, 1});
    reserved = id / 64;
    float values[kMostBodyPlanes];
    tree.GetAt(tree.levels().slots[id], Span<float>(values, planes()));
    records.Insert(id, values);
  }
  size.store(tree.size(), std::memory_order_relaxed);
  ReserveChanges(tree.ids().size());
}

void BroadPhaseState::Assign(const BroadPhaseState& from) {
  records.ReserveAs(from.records);
  events.Reserve(from.events);
  collides_with.reserve(from.collides_with.size());
  changed_slots.reserve(from.changed_slots.size());
  BvhState::Of(tree).CopyFrom(BvhState::Of(from.tree));
  // From here on nothing fails.
  changed_slots.resize(from.changed_slots.size());
  collides_with = from.collides_with;
  events = from.events;
  wear = from.wear;
  needs_no_sort = from.needs_no_sort;
  const BvhLevels& levels = tree.levels();
  records.Assign(from.records, [level = levels.level[0], slots = levels.slots](
                                   std::uint32_t id, std::size_t plane) {
    return level.Value(plane, slots[id]);
  });
  size.store(tree.size(), std::memory_order_relaxed);
}

void BroadPhaseState::Swap(BroadPhaseState& other) {
  records.Swap(other.records);
  size.store(other.size.exchange(size));
  swap(tree, other.tree);
  swap(events, other.events);
  std::swap(wear, other.wear);
  std::swap(needs_no_sort, other.needs_no_sort);
  changed_slots.swap(other.changed_slots);
  collides_with.swap(other.collides_with);
}

Reading::Reading(BroadPhaseState& state)
    : state_(state),
      line_(state.options.caller_locks ? 0 : ReadersLock::LineOfThread()) {
  const BroadPhaseOptions& options = state.options;
  const bool is_at_once = options.moves_are_seen_at_once;
  if (is_at_once && state.records.HasMarks()) {
    if (options.caller_locks) {
      ++state.version;
      state.Flush();
    } else if (state.lock.TryLockAndClose()) {
      ++state.version;
      state.Flush();
      state.lock.Open();
      state.lock.Unlock();
    }
  }
  Enter();
  if (is_at_once && state.records.HasMarks()) {
    is_exact_ = false;
    time_ = state.records.TimeOfQuery();
  }
}

void Changing::BeginBeside() {
  // As many updates as make an exclusive one in between rare.
  constexpr std::uint32_t kBeside = 64;
  BroadPhaseState& state = state_;
  if (state.lock.TakeWaits() && !state.options.moves_are_seen_at_once) {
    state.beside = kBeside;
  } else if (state.beside > 0 && --state.beside == 0) {
    state.tree_copy = BvhTree(state.type, state.options.memory);
  }
  Begin(state.beside > 0 ? state.records.CountMarks() : 0);
}

void Changing::BeginBeside(std::size_t bodies) {
  // A copy takes 1 to 2 ns for each body of the tree, and a flush 5 for each
  // body that moved, if these are many (Zen 5).
  constexpr std::size_t kCopied = 32;
  if (state_.shown != &state_.tree) return;
  if (bodies < state_.tree.size() / kCopied) return Close();
  Open();
  BvhState::Of(state_.tree_copy).CopyFrom(BvhState::Of(state_.tree));
  Show(state_.tree_copy);
}

}  // namespace halfspace::detail

#include "dispatch/broad_phase/state.h"

#include <algorithm>
#include <bit>
#include <string>

#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"

namespace halfspace::detail {

void BroadPhaseState::CheckIds(const char* call,
                               Span<const std::uint32_t> ids) const {
  dispatch::CheckMemory(call, "ids", ids.data(), ids.size(),
                        alignof(std::uint32_t));
}

void BroadPhaseState::CheckList(const char* call, Span<const std::uint32_t> ids,
                                const char* name, const void* others,
                                std::size_t other_count,
                                std::size_t alignment) const {
  if (other_count != ids.size()) {
    dispatch::ThrowInvalid(call, name,
                           "one for each id, " + std::to_string(ids.size()),
                           std::to_string(other_count));
  }
  CheckIds(call, ids);
  dispatch::CheckMemory(call, name, others, other_count, alignment);
}

void BroadPhaseState::CheckBodies(const char* call,
                                  Span<const std::uint32_t> ids) const {
  CheckIds(call, ids);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (records.Has(ids[i])) continue;
    dispatch::ThrowInvalid(call, "ids", "the id of a body",
                           std::to_string(ids[i]), i);
  }
}

// As Refit() of a Bvh: a few bodies one by one, and many leaf by leaf, so that
// bounds are copied to memory that is in cache. The records of the next leaf
// are anywhere.
void BroadPhaseState::Flush() {
  if (!records.HasMarks()) return;
  BvhState& state = BvhState::Of(tree);
  state.PrepareRefit();
  const BvhLevels& levels = tree.levels();
  WithAxes(type.axes, [&](auto axes) {
    constexpr std::size_t kAxes = decltype(axes)::value;
    const auto copy = [&](std::size_t slot) {
      records.Copy<kAxes>(levels.ids[slot], &levels.level[0].Value(0, slot));
    };
    constexpr std::size_t kMostFew = 64;
    const std::size_t slots = levels.level[0].size;
    const std::size_t most_few =
        std::min(kMostFew, BvhState::FewChanges(slots));
    std::size_t few[kMostFew];
    std::size_t count = 0;
    std::uint64_t* const changed = changed_slots.data();
    const auto touch = [changed](std::size_t slot) {
      changed[slot / 64] |= std::uint64_t{1} << slot % 64;
    };
    records.TakeMarks([&](std::uint32_t id) {
      const std::size_t slot = levels.slots[id];
      if (count < most_few) {
        few[count++] = slot;
        return;
      }
      if (count == most_few) {
        std::fill(changed_slots.begin(), changed_slots.end(), 0);
        std::for_each(few, few + count++, touch);
      }
      touch(slot);
    });
    if (count <= most_few) {
      for (std::size_t i = 0; i < count; ++i) {
        copy(few[i]);
        state.EncodePath(few[i]);
      }
      return;
    }
    const auto for_each_of = [&](std::size_t block, const auto& visit) {
      for (std::uint64_t bits = changed[block]; bits != 0; bits &= bits - 1) {
        visit(block * kBlockObjects +
              static_cast<std::size_t>(std::countr_zero(bits)));
      }
    };
    const std::size_t blocks = BlocksOf(slots);
    std::size_t next = 0;
    for (std::size_t block = 0; block < blocks; block = next) {
      while (++next < blocks && changed[next] == 0) {
      }
      if (next < blocks) {
        for_each_of(next, [&](std::size_t slot) {
          records.Prefetch(levels.ids[slot]);
        });
      }
      for_each_of(block, copy);
    }
    state.EncodeTouched(changed);
  });
}

void BroadPhaseState::Adopt(BvhTree its_tree) {
  BvhState::Of(its_tree).PrepareRefit();  // throws if its ids are wrong
  tree = std::move(its_tree);
  const Span<const std::uint32_t> ids = tree.ids();
  for (std::size_t slot = 0; slot < ids.size(); ++slot) {
    if (ids[slot] == kNoId) continue;
    float values[kMostBodyPlanes];
    tree.GetAt(slot, Span<float>(values, planes()));
    records.Reserve({&ids[slot], 1});
    records.Insert(ids[slot], values);
  }
  size.store(tree.size(), std::memory_order_relaxed);
  ReserveChanges(ids.size());
}

void BroadPhaseState::Swap(BroadPhaseState& other) {
  records.Swap(other.records);
  size.store(other.size.exchange(size));
  swap(tree, other.tree);
  swap(events, other.events);
  changed_slots.swap(other.changed_slots);
  collides_with.swap(other.collides_with);
}

Reading::Reading(BroadPhaseState& state)
    : state_(state),
      outer_(innermost_),
      line_(state.options.caller_locks ? 0 : ReadersLock::LineOfThread()),
      is_exact_(true) {
  const BroadPhaseOptions& options = state.options;
  const bool is_at_once = !options.moves_wait_for_update;
  if (is_at_once && state.records.HasMarks() && !IsInside(state)) {
    if (options.caller_locks) {
      state.Flush();
    } else if (state.lock.TryLock()) {
      state.Flush();
      state.lock.Unlock();
    }
  }
  if (!options.caller_locks) state.lock.Enter(line_, outer_ != nullptr);
  innermost_ = this;
  if (is_at_once && state.records.HasMarks()) {
    is_exact_ = false;
    query_ = state.records.NextQuery();
  }
}

bool Reading::IsInside(const BroadPhaseState& state) {
  for (const Reading* r = innermost_; r != nullptr; r = r->outer_) {
    if (&r->state_ == &state) return true;
  }
  return false;
}

void Changing::Check(const char* call, const BroadPhaseState& state) {
  if (!Reading::IsInside(state)) return;
  dispatch::ThrowInvalid(
      call, "call",
      "no query of the broad phase that still runs on this thread: this call "
      "waits for queries",
      "a call by the function of a query");
}

}  // namespace halfspace::detail

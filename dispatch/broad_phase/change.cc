// How a broad phase changes.
#include <algorithm>
#include <memory>
#include <new>
#include <string>
#include <tuple>

#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/pairs.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"

namespace halfspace::detail {
namespace {

// The tree is sorted again if its cost ratio is above this.
constexpr double kDecayed = 1.25;
constexpr double kAllDecayed = 2;

// Until queries visit twice as many leaves, an update sorts 2 objects for each
// body that changed, and 2048 at least: a few changes wait. If 16 of 65 536
// bodies come and go in each frame, updates take a sixth of the time that they
// took when they always sorted a 16th of the bodies. The cost ratio, which all
// leaves have a part in, is computed after a 64th of the bodies has changed, or
// in the first update without changes.
constexpr std::size_t kSortedPerChange = 2;
constexpr std::size_t kLeastSorted = 2048;

// If parts of the order do not keep up with fast bodies, all are sorted as soon
// as the decay has cost as much as that sort does. So the two cost at most
// twice what the best number of sorts would cost. Of 64 000 bodies that all
// move (Zen 5) a search for pairs takes 22 ns a body and as often more as the
// cost ratio says, a sort by kFast 30 and by kHigh 70. Where sorts come often,
// kHigh gains less than it costs.
constexpr double kWorn = 1.5;
constexpr double kFastSort = 1;  // in searches
constexpr double kHighSort = 3;
constexpr std::uint32_t kOften = 8;  // updates

void SortAll(BroadPhaseState& state, Changing& changing, BuildQuality quality,
             const Runner& run) {
  changing.Begin(state.tree.size());
  BvhState::Of(state.tree).SortAll("BroadPhase::Update", quality, run);
  state.wear = {};
}

constexpr std::uint32_t kAllBits = 0xFFFFFFFF;

// What the decay costs in this update. In the default floating-point mode.
double CostOf(const BroadPhaseState& state, double ratio, std::size_t changed) {
  const auto size = static_cast<double>(state.tree.size());
  const auto pairs = static_cast<double>(state.events.pairs().size());
  // Bodies that do not move are searched for by those that do.
  const double searched = std::min(1.0, static_cast<double>(changed) / size);
  return searched * (ratio - 1) * (1 + pairs / size / 4);
}

// Returns whether all were sorted.
bool SortWorn(BroadPhaseState& state, Changing& changing, double ratio,
              std::size_t changed, const Runner& run) {
  if (!(ratio > kWorn) || changed == 0) return false;
  const bool is_often = state.wear.updates <= kOften;
  const bool is_due = dispatch::InDefaultFpMode([&] {
    state.wear.cost += CostOf(state, ratio, changed);
    return !(state.wear.cost < (is_often ? kFastSort : kHighSort));
  });
  if (!is_due) return false;
  SortAll(state, changing, is_often ? BuildQuality::kFast : BuildQuality::kHigh,
          run);
  return true;
}

void Sort(BroadPhaseState& state, Changing& changing,
          const UpdateOptions& options) {
  BvhTree& tree = state.tree;
  Wear& wear = state.wear;
  const bool is_automatic = options.budget == UpdateOptions::kAutomatic;
  const std::size_t changed = state.records.Count(Records::kForOrder);
  state.records.Clear(Records::kForOrder);
  wear.changes =
      static_cast<std::uint32_t>(std::min(wear.changes + changed, tree.size()));
  if (changed > 0) {
    state.needs_no_sort = false;
    if (wear.updates <= kOften) ++wear.updates;
  }
  const std::size_t due = kSortedPerChange * wear.changes;
  if (options.budget == 0 || tree.size() == 0) return;
  const std::size_t least_due = std::min(tree.size() / 32, kLeastSorted);
  if (is_automatic && changed > 0 && due < least_due) return;
  if (is_automatic && state.needs_no_sort) return;
  const double ratio = tree.CostRatio();
  if (!(ratio > kDecayed)) {
    wear.changes = 0;
    state.needs_no_sort = true;
    return;
  }
  const bool is_all_decayed = ratio > kAllDecayed;
  std::size_t budget = options.budget;
  if (is_automatic) {
    if (SortWorn(state, changing, ratio, changed, options.run)) return;
    // All are sorted soon.
    if (ratio > kWorn && !IsSmallSet(changed, tree.size())) return;
    budget = tree.size() / 16;
    if (!is_all_decayed) {
      state.needs_no_sort = due < std::min(tree.size(), kLeastSorted);
      if (state.needs_no_sort) return;
      budget = std::min(budget, due);
    }
  } else if (is_all_decayed && budget >= tree.size()) {
    return SortAll(state, changing, BuildQuality::kHigh, options.run);
  }
  changing.Begin(budget);
  const std::size_t sorted =
      tree.RebuildPartial(std::max<std::size_t>(budget, 1), options.run);
  const std::size_t of_changes = sorted / kSortedPerChange;
  wear.changes -= static_cast<std::uint32_t>(
      std::min<std::size_t>(wear.changes, of_changes));
  // The next update computes the ratio too, however few bodies change.
  if (is_all_decayed) {
    wear.changes = std::max(
        wear.changes, static_cast<std::uint32_t>(least_due / kSortedPerChange));
  }
}

void SetMask(BroadPhaseState& state, std::uint32_t id, const BodyMasks& masks) {
  const bool has_masks = state.tree.levels().level[0].masks != nullptr;
  if (has_masks || masks.category != kAllBits) {
    state.tree.SetMasks(id, masks.category);
  }
  if (!state.collides_with.empty()) {
    state.collides_with[id] = masks.collides_with;
  }
}

// Allocates the memory for SetMask().
void ReserveMasks(BroadPhaseState& state, Span<const std::uint32_t> ids,
                  Span<const BodyMasks> masks) {
  if (ids.empty()) return;
  const bool has_some =
      !state.collides_with.empty() ||
      std::any_of(masks.begin(), masks.end(), [](const BodyMasks& its) {
        return its.collides_with != kAllBits;
      });
  if (!has_some) return;
  const std::size_t limit = std::max<std::size_t>(
      state.tree.id_limit(), *std::max_element(ids.begin(), ids.end()) + 1u);
  if (state.collides_with.size() < limit) {
    state.collides_with.resize(limit, kAllBits);
  }
}

// Erases the bodies that Insert() has inserted before it failed.
class Inserted {
 public:
  Inserted(BroadPhaseState& state, Span<const std::uint32_t> ids)
      : state_(state), ids_(ids) {}
  Inserted(const Inserted&) = delete;
  Inserted& operator=(const Inserted&) = delete;
  ~Inserted() {
    for (std::size_t i = 0; i < count_; ++i) {
      if (state_.tree.Has(ids_[i])) state_.tree.Erase(ids_[i]);
      state_.records.Erase(ids_[i]);
    }
  }
  void Add() { ++count_; }
  void Keep() { count_ = 0; }

 private:
  BroadPhaseState& state_;
  Span<const std::uint32_t> ids_;
  std::size_t count_ = 0;
};

// Returns the first id that cannot be inserted, or ids.size().
std::size_t InsertBodies(BroadPhaseState& state, Span<const std::uint32_t> ids,
                         Span<const float> values,
                         Span<const BodyMasks> masks) {
  const Changing changing(state);
  if (ids.empty()) return 0;
  // Empty slots are found by the bounds of leaves, which must not depend on
  // whether a query has copied the bodies that moved.
  if (state.options.moves_are_seen_at_once) state.Flush();
  const std::size_t planes = state.planes();
  state.records.Reserve(ids);
  ReserveMasks(state, ids, masks);
  state.ReserveChanges(state.tree.levels().level[0].size + ids.size());
  Inserted inserted(state, ids);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!state.records.Insert(ids[i], values.data() + i * planes)) return i;
    inserted.Add();
  }
  state.tree.InsertAs(ids, ColumnsOfRows(values.data(), ids.size(), planes));
  BvhState::Of(state.tree).ResetInsertions();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    SetMask(state, ids[i], masks.empty() ? BodyMasks() : masks[i]);
    state.records.SetChanged(ids[i]);
  }
  inserted.Keep();
  state.size.fetch_add(ids.size(), std::memory_order_relaxed);
  return ids.size();
}

}  // namespace

BroadPhaseCore::BroadPhaseCore(const BvhType& type,
                               const BroadPhaseOptions& options) {
  // Throws if no target can be chosen, so that later calls with exclusive
  // access do not throw for this reason.
  std::ignore = KernelsFor(type, Target(), "BroadPhase");
  const auto free_block = [&options](void* block) {
    FreeBlock(options.memory, block, sizeof(BroadPhaseState));
  };
  std::unique_ptr<void, decltype(free_block)> block(
      AllocateBlock(options.memory, sizeof(BroadPhaseState)), free_block);
  state_ = new (block.get()) BroadPhaseState(type, options);
  std::ignore = block.release();
}

BroadPhaseCore::~BroadPhaseCore() {
  if (state_ == nullptr) return;
  const MemoryResource memory = state_->options.memory;
  state_->~BroadPhaseState();
  FreeBlock(memory, state_, sizeof(BroadPhaseState));
}

void BroadPhaseCore::Insert(Span<const std::uint32_t> ids,
                            Span<const float> values,
                            Span<const BodyMasks> masks) {
  constexpr const char* kCall = "BroadPhase::Insert";
  state_->CheckList(kCall, ids, "bounds", values.data(),
                    values.size() / state_->planes(), alignof(float));
  if (!masks.empty()) {
    state_->CheckList(kCall, ids, "masks", masks.data(), masks.size(),
                      alignof(BodyMasks));
  }
  std::size_t i = 0;
  while (i < ids.size() && ids[i] < kMostObjects) ++i;
  if (i == ids.size()) i = InsertBodies(*state_, ids, values, masks);
  if (i == ids.size()) return;
  dispatch::ThrowInvalid(kCall, "ids",
                         ids[i] < kMostObjects
                             ? "an id that no body has, once in the list"
                             : "an id below 2^31",
                         std::to_string(ids[i]), i);
}

void BroadPhaseCore::Erase(Span<const std::uint32_t> ids) {
  constexpr const char* kCall = "BroadPhase::Erase";
  state_->CheckBodies(kCall, ids);
  const Changing changing(*state_);
  state_->tree.Erase(ids);
  for (const std::uint32_t id : ids) {
    if (!state_->records.Has(id)) continue;  // a second time in the list
    state_->records.Erase(id);
    state_->records.SetChanged(id);
    state_->size.fetch_sub(1, std::memory_order_relaxed);
  }
}

void BroadPhaseCore::Move(Span<const std::uint32_t> ids,
                          Span<const float> values) {
  constexpr const char* kCall = "BroadPhase::Move";
  state_->CheckList(kCall, ids, "bounds", values.data(),
                    values.size() / state_->planes(), alignof(float));
  state_->CheckBodies(kCall, ids);
  state_->records.Move(ids, values.data());
}

void BroadPhaseCore::SetMasks(Span<const std::uint32_t> ids,
                              Span<const BodyMasks> masks) {
  constexpr const char* kCall = "BroadPhase::SetMasks";
  state_->CheckList(kCall, ids, "masks", masks.data(), masks.size(),
                    alignof(BodyMasks));
  state_->CheckBodies(kCall, ids);
  const Changing changing(*state_);
  ReserveMasks(*state_, ids, masks);
  // Sets the first mask to its own value, which allocates before a mask has
  // changed.
  for (const BodyMasks& its : masks) {
    if (its.category == kAllBits) continue;
    state_->tree.SetMasks(ids[0], state_->MasksOf(ids[0]).category);
    break;
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    SetMask(*state_, ids[i], masks[i]);
    state_->records.SetChanged(ids[i]);
  }
}

void BroadPhaseCore::Update(const UpdateOptions& options) {
  Changing changing(*state_, Changing::kAllMarked);
  state_->Flush();
  Sort(*state_, changing, options);
}

void BroadPhaseCore::Rebuild(const Runner& run) {
  Changing changing(*state_, Changing::kAllMarked);
  changing.Begin(state_->tree.size());
  state_->Flush();
  BuildOptions options;
  options.run = run;
  state_->tree.Rebuild(options);
  state_->wear = {};
  state_->records.Clear(Records::kForOrder);
}

}  // namespace halfspace::detail

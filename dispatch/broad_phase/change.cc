// How a broad phase changes.
#include <algorithm>
#include <limits>

#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"
#include "kernels/exact/default_fp_mode.h"

namespace halfspace::detail {
namespace {

// The order is sorted again if queries visit so many times as many leaves.
constexpr double kDecayed = 1.25;
constexpr double kAllDecayed = 2;

constexpr const char* kInsert = "BroadPhase::Insert";

// Bodies and their bounds in the tree, which are larger by the margin.
class Bounded {
 public:
  explicit Bounded(const BroadPhaseState& state)
      : state_(state),
        ids_(state.options.memory),
        values_(state.options.memory) {}

  void Reserve(std::size_t count) {
    ids_.Reserve(count);
    values_.Reserve(count * state_.planes());
  }
  // In the default floating-point mode.
  void Add(std::uint32_t id, const float* planes) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const BvhShape& shape = state_.shape;
    ids_.Push(id);
    for (std::size_t p = 0; p < state_.planes(); ++p) {
      const bool is_max = p >= shape.axes;
      const bool is_d = p % shape.axes >= shape.dims;
      const float margin =
          state_.options.margin * static_cast<float>(is_d ? shape.dims : 1);
      const float value = is_max ? planes[p] + margin : planes[p] - margin;
      values_.Push(value == value ? value : is_max ? kInf : -kInf);
    }
  }

  Span<const std::uint32_t> ids() const { return ids_; }
  Span<const float> values() const { return values_; }

 private:
  const BroadPhaseState& state_;
  List<std::uint32_t> ids_;
  List<float> values_;
};

// The bodies of a call of Insert().
struct NewBodies {
  Span<const std::uint32_t> ids;
  const float* values = nullptr;
};

// How much of the order is sorted again.
struct Sorting {
  std::size_t budget = 0;
  bool is_forced = false;
  Runner run = {};
};

void Sort(BvhTree& tree, const Sorting& sorting) {
  const auto rebuild = [&] {
    BuildOptions options;
    options.run = sorting.run;
    tree.Rebuild(options);
  };
  if (sorting.is_forced) return rebuild();
  if (sorting.budget == 0 || tree.size() == 0) return;
  const double ratio = tree.CostRatio();
  if (!(ratio > kDecayed)) return;
  std::size_t budget = sorting.budget;
  if (budget == UpdateOptions::kAutomatic) {
    budget = tree.size() / 16;
  } else if (ratio > kAllDecayed && budget >= tree.size()) {
    return rebuild();
  }
  tree.RebuildPartial(std::max(budget, kPartSlots));
}

// Writes a version with a tree of all bodies and those that are added.
void Build(BroadPhaseState& state, const TakenMarks& moved,
           const NewBodies& added, const Sorting& sorting, Version& version) {
  const Version& old = *state.current.load();
  version.ClearPending();
  {
    const WithRacyReads reads;
    version.tree = BvhTree(old.tree, state.options.memory);
  }
  const std::size_t pending = old.PendingCount();
  List<std::uint32_t> gone(state.options.memory);
  Bounded stays(state);
  Bounded comes(state);
  gone.Reserve(moved.ids().size());
  stays.Reserve(moved.ids().size());
  comes.Reserve(pending + added.ids.size());
  const auto is_replaced = [&](std::uint32_t id) {
    return (state.bodies.MarksOf(id) & Bodies::kReplaced) != 0;
  };
  kernels::InDefaultFpMode([&] {
    Body body;
    for (const std::uint32_t id : moved.ids()) {
      if (!version.tree.Has(id)) continue;
      const bool is_body = state.bodies.Read(id, body);
      // A new body under an old id can be far from the leaf of the old one.
      const bool is_new = is_replaced(id);
      if (!is_body || is_new) gone.Push(id);
      if (is_body) (is_new ? comes : stays).Add(id, body.planes);
    }
    for (std::size_t i = 0; i < pending; ++i) {
      const std::uint32_t id = old.Pending(i);
      if (state.bodies.Read(id, body)) comes.Add(id, body.planes);
    }
    for (std::size_t i = 0; i < added.ids.size(); ++i) {
      comes.Add(added.ids[i], added.values + i * state.planes());
    }
  });
  version.tree.Erase(gone);
  version.tree.Set(stays.ids(), stays.values());
  version.tree.InsertAs(comes.ids(), comes.values());
  Sort(version.tree, sorting);
  for (const std::uint32_t id : moved.ids()) {
    if (is_replaced(id)) state.bodies.TakeMark(id, Bodies::kReplaced);
  }
}

// Frees the trees that nobody reads.
void FreeTrees(BroadPhaseState& state) {
  for (Version* v = state.versions; v != nullptr; v = v->next) {
    if (v != state.current.load() && !v->HasReaders()) {
      v->tree = BvhTree(state.shape, state.options.memory);
    }
  }
}

// Makes a version that was built the current one. Never throws.
void Publish(BroadPhaseState& state, Version& version) {
  Version& old = *state.current.load();
  state.upcoming.store(&version, std::memory_order_seq_cst);
  old.HasReaders();  // synchronizes with movers that did not see it
  ForEachMarked(state, Bodies::kMoved, [&](std::uint32_t id) {
    Body body;
    if (state.bodies.Read(id, body)) version.Widen(id, body.planes, true);
  });
  state.current.store(&version, std::memory_order_seq_cst);
  state.upcoming.store(nullptr, std::memory_order_seq_cst);
  FreeTrees(state);
}

void BuildAndPublish(BroadPhaseState& state, const Sorting& sorting) {
  TakenMarks moved(state, Bodies::kMoved);
  moved.Take();
  Version& version = *state.NewVersion();
  Build(state, moved, {}, sorting, version);
  moved.Keep();
  Publish(state, version);
}

constexpr auto kChanged =
    static_cast<std::uint8_t>(Bodies::kMoved | Bodies::kNewPairs);

// Whether a body that is inserted has to be added to the list.
bool IsNew(const Version& version, std::uint32_t id) {
  return !version.tree.Has(id) && !version.IsPending(id);
}

}  // namespace

void BroadPhaseCore::Insert(Span<const std::uint32_t> ids,
                            Span<const float> values,
                            Span<const BodyMasks> masks) {
  BroadPhaseState& state = *state_;
  const std::size_t planes = state.planes();
  state.CheckList(kInsert, ids, "bounds", values.data(), values.size() / planes,
                  alignof(float));
  if (!masks.empty()) {
    state.CheckList(kInsert, ids, "masks", masks.data(), masks.size(),
                    alignof(BodyMasks));
  }
  std::unique_lock lock(state.mutex);
  Version& version = *state.current.load();
  // An id that is listed twice is found by its mark.
  std::size_t checked = 0;
  std::size_t pending = version.PendingCount();
  std::size_t limit = state.id_limit;
  for (; checked < ids.size(); ++checked) {
    const std::uint32_t id = ids[checked];
    if (id >= state.max_ids || state.bodies.Has(id) ||
        state.bodies.AddMark(id, Bodies::kListed)) {
      break;
    }
    limit = std::max(limit, id + std::size_t{1});
    if (pending <= Version::kMostPending && IsNew(version, id)) ++pending;
  }
  for (std::size_t i = 0; i < checked; ++i) {
    state.bodies.TakeMark(ids[i], Bodies::kListed);
  }
  if (checked != ids.size()) {
    lock.unlock();
    state.ThrowTaken(kInsert, ids, checked);
  }

  const auto write_all = [&] {
    state.id_limit = limit;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const BodyMasks own = masks.empty() ? BodyMasks() : masks[i];
      state.bodies.Write(ids[i], values.data() + i * planes, &own, true);
      // One that is still in the tree, loose, has the mark of its Erase().
      state.bodies.AddMark(ids[i], Bodies::kNewPairs);
    }
    state.size.fetch_add(ids.size(), std::memory_order_relaxed);
  };
  if (pending > Version::kMostPending) {
    TakenMarks moved(state, Bodies::kMoved);
    moved.Take();
    Version& next = *state.NewVersion();
    Sorting sorting;
    sorting.budget = UpdateOptions::kAutomatic;
    Build(state, moved, {ids, values.data()}, sorting, next);
    moved.Keep();
    write_all();
    Publish(state, next);
    return;
  }
  write_all();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (IsNew(version, ids[i])) {
      version.AddPending(ids[i]);
    } else {  // in the tree since before it was erased, or in the list
      version.Widen(ids[i], values.data() + i * planes, false);
    }
  }
}

void BroadPhaseCore::Erase(Span<const std::uint32_t> ids) {
  constexpr const char* kCall = "BroadPhase::Erase";
  BroadPhaseState& state = *state_;
  state.CheckIds(kCall, ids);
  std::unique_lock lock(state.mutex);
  const std::size_t absent = state.FindAbsent(ids);
  if (absent != ids.size()) {
    lock.unlock();
    state.ThrowAbsent(kCall, ids, absent);
  }
  for (const std::uint32_t id : ids) {
    if (!state.bodies.Has(id)) continue;  // a second time in the list
    state.bodies.Write(id, nullptr, nullptr, false);
    state.bodies.AddMark(id, kChanged | Bodies::kReplaced);
    state.size.fetch_sub(1, std::memory_order_relaxed);
  }
}

void BroadPhaseCore::Move(Span<const std::uint32_t> ids,
                          Span<const float> values) {
  constexpr const char* kCall = "BroadPhase::Move";
  BroadPhaseState& state = *state_;
  const std::size_t planes = state.planes();
  state.CheckList(kCall, ids, "bounds", values.data(), values.size() / planes,
                  alignof(float));
  state.CheckBodies(kCall, ids);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    state.bodies.Write(ids[i], values.data() + i * planes, nullptr, true);
    state.bodies.SetMarks(
        ids[i], kChanged | (state.bodies.MarksOf(ids[i]) & Bodies::kReplaced));
  }
  // In this order: see state.h.
  const Held before(state);
  const Held upcoming(state.upcoming, Version::CounterOfThread());
  const auto widen = [&](Version* version) {
    for (std::size_t i = 0; i < ids.size(); ++i) {
      version->Widen(ids[i], values.data() + i * planes, false);
    }
  };
  if (upcoming.get() != nullptr) widen(upcoming.get());
  if (state.current.load(std::memory_order_seq_cst) == before.get()) {
    widen(before.get());
  } else {
    widen(Held(state).get());
  }
}

void BroadPhaseCore::SetMasks(Span<const std::uint32_t> ids,
                              Span<const BodyMasks> masks) {
  constexpr const char* kCall = "BroadPhase::SetMasks";
  BroadPhaseState& state = *state_;
  state.CheckList(kCall, ids, "masks", masks.data(), masks.size(),
                  alignof(BodyMasks));
  state.CheckBodies(kCall, ids);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    state.bodies.Write(ids[i], nullptr, &masks[i], true);
    state.bodies.AddMark(ids[i], Bodies::kNewPairs);
  }
}

void BroadPhaseCore::Update(const UpdateOptions& options) {
  BroadPhaseState& state = *state_;
  const std::scoped_lock lock(state.mutex);
  const Version& version = *state.current.load();
  bool is_due = version.PendingCount() > 0;
  for (std::size_t id = 0; id < state.id_limit && !is_due; ++id) {
    is_due = (state.bodies.MarksOf(id) & Bodies::kMoved) != 0;
  }
  if (!is_due) {
    const WithRacyReads reads;
    is_due = options.budget > 0 && version.tree.CostRatio() > kDecayed;
  }
  if (!is_due) return FreeTrees(state);
  Sorting sorting;
  sorting.budget = options.budget;
  sorting.run = options.run;
  BuildAndPublish(state, sorting);
}

void BroadPhaseCore::Rebuild(const Runner& run) {
  const std::scoped_lock lock(state_->mutex);
  Sorting sorting;
  sorting.is_forced = true;
  sorting.run = run;
  BuildAndPublish(*state_, sorting);
}

}  // namespace halfspace::detail

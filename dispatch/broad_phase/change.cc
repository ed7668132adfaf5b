// How a broad phase changes.
#include <algorithm>
#include <bit>

#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"
#include "dispatch/exact/default_fp_mode.h"

namespace halfspace::detail {
namespace {

// The order is sorted again if queries visit so many times as many leaves.
constexpr double kDecayed = 1.25;
constexpr double kAllDecayed = 2;

// Update() may leave a few bounds that are not tight. The last of so many calls
// in a row tightens them.
constexpr std::size_t kMostDeferred = 8;

// In a tree of any size, so many bounds may stay loose: they fill one leaf.
constexpr std::size_t kFewLoose = 64;

constexpr const char* kInsert = "BroadPhase::Insert";

// Bodies and their bounds in the tree, which are larger by the margin.
class Bounded {
 public:
  Bounded(const BroadPhaseState& state, Version& version)
      : state_(state),
        version_(version),
        ids_(state.options.memory),
        values_(state.options.memory) {}

  void Reserve(std::size_t count) {
    ids_.Reserve(count);
    values_.Reserve(count * state_.planes());
  }
  // `in_tree` are its planes there, or null. In the default floating-point
  // mode.
  void Add(std::uint32_t id, float* in_tree, const float* planes) {
    ids_.Push(id);
    const std::size_t begin = values_.size();
    values_.Resize(begin + state_.planes(), 0);
    float* const loose = values_.data() + begin;
    state_.Loosen(in_tree, planes, loose);
    std::uint32_t different = 0;
    for (std::size_t p = 0; p < state_.planes(); ++p) {
      different |= std::bit_cast<std::uint32_t>(loose[p]) ^
                   std::bit_cast<std::uint32_t>(planes[p]);
    }
    version_.SetOwnBound(id, different == 0);
  }

  Span<const std::uint32_t> ids() const { return ids_; }
  Columns columns() const {
    return ColumnsOfRows(values_.data(), ids_.size(), state_.planes());
  }

 private:
  const BroadPhaseState& state_;
  Version& version_;
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
void Build(BroadPhaseState& state, const IdSet& moved, const NewBodies& added,
           const Sorting& sorting, Version& version) {
  const Version& old = *state.current.load();
  version.ClearPending();
  {
    const WithRacyReads reads;
    version.tree = BvhTree(old.tree, state.options.memory);
  }
  version.CopyOwnBounds(old, state.id_limit);
  const std::size_t pending = old.PendingCount();
  List<std::uint32_t> gone(state.options.memory);
  Bounded stays(state, version);
  Bounded comes(state, version);
  const std::size_t moved_count = moved.size();
  gone.Reserve(moved_count);
  stays.Reserve(moved_count);
  comes.Reserve(pending + added.ids.size());
  dispatch::InDefaultFpMode([&] {
    Body body;
    const auto add = [&](Bounded& to, std::uint32_t id, float* in_tree) {
      to.Add(id, in_tree, body.planes);
      if (!state.bodies.HasMarks(id, Bodies::kNewPairs)) {
        state.bodies.AddMark(id, Bodies::kNewPairs);
      }
    };
    moved.ForEach([&](std::uint32_t id) {
      float* const in_tree = version.Find(id);
      if (in_tree == nullptr) return;
      const bool is_body = state.bodies.Read(id, body);
      // A new body under an old id can be far from the leaf of the old one.
      const bool is_new = state.bodies.HasMarks(id, Bodies::kReplaced);
      if (!is_body || is_new) gone.Push(id);
      if (is_body && is_new) add(comes, id, nullptr);
      if (is_body && !is_new) add(stays, id, in_tree);
    });
    for (std::size_t i = 0; i < pending; ++i) {
      const std::uint32_t id = old.Pending(i);
      if (state.bodies.Read(id, body)) add(comes, id, nullptr);
    }
    for (std::size_t i = 0; i < added.ids.size(); ++i) {
      comes.Add(added.ids[i], nullptr, added.values + i * state.planes());
    }
  });
  version.tree.Erase(gone);
  version.tree.Set(stays.ids(), stays.columns());
  version.tree.InsertAs(comes.ids(), comes.columns());
  Sort(version.tree, sorting);
  moved.ForEach([&](std::uint32_t id) {
    if (state.bodies.HasMarks(id, Bodies::kReplaced)) {
      state.bodies.TakeMark(id, Bodies::kReplaced);
    }
  });
}

// Frees the trees that nobody reads.
void FreeTrees(BroadPhaseState& state) {
  for (Version* v = state.versions; v != nullptr; v = v->next) {
    if (v->tree.bytes() > 0 && v != state.current.load() && !v->HasReaders()) {
      v->tree = BvhTree(state.shape, state.options.memory);
    }
  }
}

constexpr auto kChanged =
    static_cast<std::uint8_t>(Bodies::kMoved | Bodies::kNewPairs);

// While a version is built.
class Building {
 public:
  explicit Building(BroadPhaseState& state) : state_(state) {
    state.is_building.store(true, std::memory_order_seq_cst);
    // Synchronizes with movers that did not see it.
    state.current.load()->HasReaders();
  }
  Building(const Building&) = delete;
  Building& operator=(const Building&) = delete;
  ~Building() { state_.is_building.store(false, std::memory_order_seq_cst); }

 private:
  BroadPhaseState& state_;
};

// Makes a version that was built the current one. Never throws.
void Publish(BroadPhaseState& state, Version& version) {
  Version& old = *state.current.load();
  state.upcoming.store(&version, std::memory_order_seq_cst);
  old.HasReaders();  // synchronizes with movers that did not see it
  for (std::size_t w = 0; w < (state.id_limit + 63) / 64; ++w) {
    for (std::uint64_t bits = state.bodies.MovedOf(w); bits != 0;
         bits &= bits - 1) {
      const auto id = static_cast<std::uint32_t>(
          64 * w + static_cast<std::size_t>(std::countr_zero(bits)));
      Body body;
      if (!state.bodies.Read(id, body) || version.Find(id) == nullptr) continue;
      dispatch::InDefaultFpMode([&] { version.Widen(id, body.planes, false); });
      state.bodies.AddMark(id, Bodies::kNewPairs);
    }
  }
  state.current.store(&version, std::memory_order_seq_cst);
  state.upcoming.store(nullptr, std::memory_order_seq_cst);
  state.deferred = 0;
  FreeTrees(state);
}

void BuildAndPublish(BroadPhaseState& state, const Sorting& sorting) {
  const Building building(state);
  TakenMarks moved(state);
  moved.Take();
  Version& version = *state.NewVersion();
  Build(state, moved, {}, sorting, version);
  moved.Keep();
  Publish(state, version);
}

// The mark before says that the bound has to be tightened, and the one behind,
// if UpdatePairs() took the first, that it has grown.
void WidenMoved(BroadPhaseState& state, Version& version, std::uint32_t id,
                const float* planes) {
  state.bodies.SetMarks(id, kChanged);
  float* const in_tree = version.Find(id);
  if (in_tree == nullptr) return;
  float loose[kMostBodyPlanes];
  state.Loosen(in_tree, planes, loose);
  version.Widen(id, loose, true);
  state.bodies.SetMarks(id, kChanged);
}

// Widens the bodies that left their bounds, and without a margin all. Returns
// whether there are any.
[[gnu::noinline]] bool WidenAllMoved(BroadPhaseState& state, Version& version,
                                     Span<const std::uint32_t> ids,
                                     const float* planes) {
  return dispatch::InDefaultFpMode([&] {
    bool is_any = false;
    for (std::size_t begin = 0; begin < ids.size(); begin += 64) {
      const std::size_t count = std::min<std::size_t>(64, ids.size() - begin);
      const float* const some = planes + begin * state.planes();
      // Without a margin, the bound in the tree is no more the body's own.
      std::uint64_t bits =
          state.has_margin
              ? version.NotEnclosed({ids.data() + begin, count}, some)
              : ~std::uint64_t{0} >> (64 - count);
      for (; bits != 0; bits &= bits - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(bits));
        WidenMoved(state, version, ids[begin + i], some + i * state.planes());
        is_any = true;
      }
    }
    return is_any;
  });
}

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
        state.bodies.AddMarkAlone(id, Bodies::kListed)) {
      break;
    }
    limit = std::max(limit, id + std::size_t{1});
    if (pending <= Version::kMostPending && IsNew(version, id)) ++pending;
  }
  for (std::size_t i = 0; i < checked; ++i) {
    state.bodies.TakeMarkAlone(ids[i], Bodies::kListed);
  }
  if (checked != ids.size()) {
    lock.unlock();
    state.ThrowTaken(kInsert, ids, checked);
  }

  const auto write_all = [&] {
    state.id_limit = limit;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const BodyMasks own = masks.empty() ? BodyMasks() : masks[i];
      state.AddMasks(own);
      state.bodies.Write(ids[i], values.data() + i * planes, &own, true);
      // One that is still in the tree, loose, has the mark of its Erase().
      state.bodies.AddMarkAlone(ids[i], Bodies::kNewPairs);
    }
    state.size.fetch_add(ids.size(), std::memory_order_relaxed);
  };
  if (pending > Version::kMostPending) {
    const Building building(state);
    TakenMarks moved(state);
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
      WidenAllMoved(state, version, {&ids[i], 1}, values.data() + i * planes);
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
    state.current.load()->SetOwnBound(id, false);
    state.bodies.AddMarkAlone(id, kChanged | Bodies::kReplaced);
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
  state.bodies.Move(ids, values.data());
  // In this order: see state.h.
  const std::size_t counter = Version::CounterOfThread();
  for (bool is_done = false; !is_done;) {
    const Held current(state.current, counter);
    bool is_marked = false;
    if (state.is_building.load(std::memory_order_seq_cst)) {
      is_marked = true;
      for (const std::uint32_t id : ids) state.bodies.SetMarks(id, kChanged);
    }
    const Held upcoming(state.upcoming, counter);
    for (Version* const version : {upcoming.get(), current.get()}) {
      if (version == nullptr) continue;
      is_marked |= WidenAllMoved(state, *version, ids, values.data());
    }
    if (is_marked) current->CountAgain(counter);
    Version* const now = state.upcoming.load(std::memory_order_seq_cst);
    is_done = (now == nullptr || now == upcoming.get()) &&
              state.current.load(std::memory_order_seq_cst) == current.get();
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
    state.AddMasks(masks[i]);
    state.bodies.Write(ids[i], nullptr, &masks[i], true);
    state.bodies.AddMark(ids[i], Bodies::kNewPairs);
  }
}

void BroadPhaseCore::Update(const UpdateOptions& options) {
  BroadPhaseState& state = *state_;
  const std::scoped_lock lock(state.mutex);
  const Version& version = *state.current.load();
  // A bound that is not tight costs queries little, and a copy of the tree as
  // much as it costs to tighten a sixteenth of the bounds.
  std::size_t moved = 0;
  for (std::size_t w = 0; w < (state.id_limit + 63) / 64; ++w) {
    moved += static_cast<std::size_t>(std::popcount(state.bodies.MovedOf(w)));
  }
  bool is_due = version.PendingCount() > 0 ||
                moved > std::max(kFewLoose, version.tree.size() / 16) ||
                (moved > 0 && ++state.deferred >= kMostDeferred);
  if (!is_due) {
    const WithRacyReads reads;
    is_due = (options.budget > 0 || moved > 0) &&
             version.tree.CostRatio() > kDecayed;
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

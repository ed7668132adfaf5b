#include "tests/library/broad_phase/history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "halfspace/error.h"
#include "tests/library/bvh/searches_of.h"

namespace halfspace::testing {
namespace {

template <typename View>
std::vector<std::byte> BytesOfAny(const BroadPhase<View>& bodies) {
  std::vector<std::byte> bytes;
  bodies.Save([&](Span<const std::byte> some) {
    bytes.insert(bytes.end(), some.begin(), some.end());
  });
  std::uint64_t size = 0;
  EXPECT_GE(bytes.size(), sizeof(size));
  std::memcpy(&size, bytes.data(), sizeof(size));
  EXPECT_EQ(size, bytes.size());
  return bytes;
}

template <typename View, typename Held = BroadPhase<View>>
class BodiesOf final : public SearchesOf<AnyBodies, BroadPhase<View>, Held> {
  using Base = SearchesOf<AnyBodies, BroadPhase<View>, Held>;
  using Base::world_;

 public:
  using Base::Base;

  std::size_t FindPairs(const Searches*, const Span<const std::uint32_t>* ids,
                        Span<IdPair> pairs,
                        const PairOptions& options) const override {
    return PairsOf(world_, *ids, pairs, options);
  }
  void ForEachPair(const Searches*, const Span<const std::uint32_t>* ids,
                   const Searches::OnPairs& function,
                   const PairOptions& options) const override {
    ForEachPairOf(world_, *ids, function, options);
  }
  bool Has(std::uint32_t id) const override { return world_.Has(id); }
  Planes Get(std::uint32_t id) const override {
    return Base::PlanesOf(world_.Get(id));
  }
  BodyMasks MasksOf(std::uint32_t id) const override {
    return world_.MasksOf(id);
  }
  Planes Bounds() const override { return Base::PlanesOf(world_.Bounds()); }
  std::size_t id_limit() const override { return world_.id_limit(); }
  bool Validate() const override { return world_.Validate(); }
  BroadPhaseStatistics Statistics() const override {
    return world_.Statistics();
  }
  Span<const IdPair> pairs() const override { return world_.pairs(); }
  Span<const IdPair> began() const override { return world_.began(); }
  Span<const IdPair> ended() const override { return world_.ended(); }
  std::vector<std::byte> Save() const override { return BytesOfAny(world_); }
  std::unique_ptr<AnyBodies> Copy() const override {
    return std::make_unique<BodiesOf<View>>(world_);
  }

  void Insert(const Ids& ids, const std::vector<Planes>& bounds,
              const std::vector<BodyMasks>& masks) override {
    world_.Insert(ids, Base::BoundsOf(bounds), masks);
  }
  void Erase(const Ids& ids) override { world_.Erase(ids); }
  void Move(const Ids& ids, const std::vector<Planes>& bounds) override {
    world_.Move(ids, Base::BoundsOf(bounds));
  }
  void SetMasks(const Ids& ids, const std::vector<BodyMasks>& masks) override {
    world_.SetMasks(ids, masks);
  }
  void Update(const UpdateOptions& options) override { world_.Update(options); }
  void Rebuild(const Runner& run) override { world_.Rebuild(run); }
  void UpdatePairs(const Runner& run) override { world_.UpdatePairs(run); }
  void Load(const std::vector<std::byte>& bytes) override {
    world_.Load(bytes);
  }
};

using BoxBodiesByReference = BodiesOf<AabbView3, AabbBroadPhase3&>;

}  // namespace

std::unique_ptr<AnyBodies> MakeBodies(const Layout& layout,
                                      const BroadPhaseOptions& options) {
  const auto make = [&](auto view) -> std::unique_ptr<AnyBodies> {
    using View = decltype(view);
    return std::make_unique<BodiesOf<View>>(BroadPhase<View>(options));
  };
#if !defined(HALFSPACE_TEST_ONLY_3D)
  if (layout.dims == 2) {
    return layout.kind == Layout::kAabb ? make(AabbView2()) : make(AaboView2());
  }
#endif
  return layout.kind == Layout::kAabb ? make(AabbView3()) : make(AaboView3());
}

std::vector<std::byte> BytesOf(const AabbBroadPhase3& bodies) {
  return BytesOfAny(bodies);
}

Objects BodyModel::Seen() const {
  Objects objects;
  for (const auto& [id, body] : bodies) {
    objects[id] = {body.seen, body.masks.category};
  }
  return objects;
}

PairList BodyModel::Pairs() const {
  PairList pairs;
  for (const auto& [a, b] : PairsIn(layout, Seen())) {
    const BodyMasks& of_a = bodies.at(a).masks;
    const BodyMasks& of_b = bodies.at(b).masks;
    const bool matches = (of_a.category & of_b.collides_with) != 0 &&
                         (of_b.category & of_a.collides_with) != 0;
    if (keep == nullptr ? matches : keep(nullptr, a, b, matches)) {
      pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

bool LoadAltered(const Layout& layout, const std::vector<std::byte>& bytes) {
  const auto bodies = MakeBodies(layout);
  bodies->Insert({8}, {EmptyOf(layout)}, {});
  try {
    bodies->Load(bytes);
  } catch (const Error&) {
    EXPECT_TRUE(bodies->Has(8) && bodies->size() == 1);
    return false;
  }
  const Planes everything = AllPlanes(layout, kMost);
  const Shape all{Shape::kBound, {everything.begin(), everything.end()}};
  Ids ids(bodies->size());
  ids.resize(std::min(bodies->Find(all, ids, {}, 0), ids.size()));
  std::erase_if(ids, [&](std::uint32_t id) { return !bodies->Has(id); });
  (void)bodies->Validate();
  bodies->Move(ids, std::vector<Planes>(ids.size(), EverythingOf(layout)));
  bodies->UpdatePairs({});
  bodies->Rebuild({});
  bodies->Erase(ids);
  return true;
}

void ExpectAnswers(const AnyBodies& bodies, const BodyModel& model,
                   std::uint64_t seed) {
  Random random(seed);
  constexpr std::uint32_t kMasks[] = {0xFFFFFFFF, 1, 2, 0x80000002};
  ExpectAnswers(
      bodies, model.Seen(),
      {.mask = kMasks[random() % 4], .is_special = seed % 8 == 0, .shapes = 1},
      random);
  const Planes all = bodies.Bounds();
  for (const auto& [id, body] : model.bodies) {
    ASSERT_TRUE(bodies.Has(id)) << id;
    const Planes bound = bodies.Get(id);
    for (std::size_t p = 0; p < model.layout.plane_count; ++p) {
      ASSERT_EQ(std::bit_cast<std::uint32_t>(bound[p]),
                std::bit_cast<std::uint32_t>(body.bound[p]));
      const float v = body.seen[p];
      if (IsMin(model.layout, p)) {
        ASSERT_LE(all[p], std::isnan(v) ? -kInf : v);
      } else {
        ASSERT_GE(all[p], std::isnan(v) ? kInf : v);
      }
    }
    ASSERT_EQ(bodies.MasksOf(id), body.masks);
    ASSERT_LT(id, bodies.id_limit());
  }
}

void ExpectAnswers(const AabbBroadPhase3& bodies, const BodyModel& model,
                   std::uint64_t seed) {
  ExpectAnswers(BoxBodiesByReference(const_cast<AabbBroadPhase3&>(bodies)),
                model, seed);
}

void ExpectIsModel(const AabbBroadPhase3& bodies, BodyModel& model,
                   std::uint64_t seed) {
  ExpectAnswers(bodies, model, seed);
  ASSERT_TRUE(bodies.Validate());
  model.Update();
  ASSERT_EQ(bodies.Statistics().bodies, model.bodies.size());
}

void ExpectSameOrder(const AnyBodies& a, const AnyBodies& b,
                     std::uint64_t seed) {
  for (int kind = 0; kind <= Shape::kHalfSpaces; ++kind) {
    Random random(seed);
    const Shape shape = SomeShapes(a.layout, static_cast<Shape::Kind>(kind), 1,
                                   false, random)[0];
    Ids of_a(a.size());
    Ids of_b(a.size());
    ASSERT_EQ(a.Find(shape, of_a, {}, 0), b.Find(shape, of_b, {}, 0));
    ASSERT_EQ(of_a, of_b);
  }
  ASSERT_EQ(PairsFrom(a.pairs()), PairsFrom(b.pairs()));
  ASSERT_EQ(PairsFrom(a.began()), PairsFrom(b.began()));
  ASSERT_EQ(PairsFrom(a.ended()), PairsFrom(b.ended()));
  ASSERT_EQ(a.id_limit(), b.id_limit());
}

namespace {

// What is stored of the bodies, and their pairs.
Ids StateOf(const AnyBodies& bodies) {
  const Planes everything = AllPlanes(bodies.layout, kInf);
  const Shape all{Shape::kBound, {everything.begin(), everything.end()}};
  Ids ids(bodies.size());
  EXPECT_EQ(bodies.Find(all, ids, {}, 0), ids.size());
  Ids state = ids = InOrder(ids);
  for (const std::uint32_t id : ids) {
    for (const float value : bodies.Get(id)) {
      state.push_back(std::bit_cast<std::uint32_t>(value));
    }
    const BodyMasks masks = bodies.MasksOf(id);
    state.insert(state.end(), {masks.category, masks.collides_with});
  }
  for (const auto& [a, b] : InOrder(bodies.pairs(), false)) {
    state.insert(state.end(), {a, b});
  }
  return state;
}

}  // namespace

BodyHistory::BodyHistory(const Layout& layout, Choices& choices,
                         std::size_t most_bodies, std::uint32_t stride,
                         const BroadPhaseOptions& options, FpMode mode,
                         CountingMemory* memory)
    : choices_(choices),
      most_bodies_(most_bodies),
      stride_(stride),
      mode_(mode),
      memory_(memory) {
  all_.push_back(MakeBodies(layout, options));
  model_.layout = layout;
  model_.moves_wait = options.moves_wait_for_update;
  model_.keep = options.filter.keep;
}

void BodyHistory::Watch::Add(const Ids& found) {
  Ids both;
  Ids either;
  std::ranges::set_intersection(always, found, std::back_inserter(both));
  std::ranges::set_union(ever, found, std::back_inserter(either));
  always = std::move(both);
  ever = std::move(either);
}

void BodyHistory::Try(const AnyBodies& bodies,
                      const std::function<void()>& call) {
  if (memory_ == nullptr) return RunIn(mode_, call);
  const Ids before = StateOf(bodies);
  FailuresOf(*memory_, call, [&] { EXPECT_EQ(StateOf(bodies), before); });
}

void BodyHistory::Insert(std::size_t count) {
  const Ids ids = Some(count, false);
  const bool has_masks = choices_.Below(2) == 0;
  std::vector<Planes> bounds;
  std::vector<BodyMasks> masks;
  for (const std::uint32_t id : ids) {
    bounds.push_back(choices_.Next());
    if (has_masks) masks.push_back(choices_.Masks());
    model_.Insert(id, bounds.back(), has_masks ? masks.back() : BodyMasks());
  }
  Each([&](AnyBodies& bodies) { bodies.Insert(ids, bounds, masks); });
}

void BodyHistory::Move(std::size_t count) {
  const Ids ids = Some(count, true);
  std::vector<Planes> bounds;
  for (const std::uint32_t id : ids) {
    const Planes& before = model_.bodies.at(id).bound;
    bounds.push_back(choices_.Below(4) == 0 ? before : choices_.Moved(before));
    model_.Move(id, bounds.back());
  }
  Each([&](AnyBodies& bodies) { bodies.Move(ids, bounds); });
  for (Watch* const watch : watches_) watch->Add(Found(*watch));
}

void BodyHistory::Copy() {
  model_.Update();
  all_.resize(1);
  std::unique_ptr<AnyBodies> copy;
  Try(bodies(), [&] { copy = bodies().Copy(); });
  all_.push_back(std::move(copy));
}

std::size_t BodyHistory::Change() {
  const std::size_t what = choices_.Below(18);
  const std::size_t count = choices_.Below(8) == 0
                                ? choices_.Below(most_bodies_)
                                : choices_.Below(20);
  if (what < 4) {
    Insert(count);
  } else if (what < 6) {
    const Ids ids = Some(count, true);
    for (const std::uint32_t id : ids) model_.bodies.erase(id);
    Each([&](AnyBodies& bodies) { bodies.Erase(ids); });
  } else if (what < 9) {
    Move(2 * count);
  } else if (what == 9) {
    const Ids ids = Some(count, true);
    std::vector<BodyMasks> masks;
    for (const std::uint32_t id : ids) {
      masks.push_back(choices_.Masks());
      model_.bodies.at(id).masks = masks.back();
    }
    Each([&](AnyBodies& bodies) { bodies.SetMasks(ids, masks); });
  } else if (what == 10) {
    UpdateOptions update;
    if (choices_.Below(2) == 0) {
      update.budget = choices_.Below(2 * most_bodies_);
    }
    auto run = RunOnThreads;
    update.run = run;
    model_.Update();
    Each([&](AnyBodies& bodies) { bodies.Update(update); });
  } else if (what == 11) {
    model_.Update();
    Each([&](AnyBodies& bodies) { bodies.Rebuild(&RunOnThreads); });
  } else if (what < 14) {
    UpdatePairs();
  } else if (what < 16) {
    std::vector<std::byte> bytes;
    Try(bodies(), [&] { bytes = bodies().Save(); });
    Copy();
    if (what == 15) {
      Try(*all_[1], [&] { all_[1]->Load(bytes); });
      // Events are those of the next UpdatePairs() on.
      UpdatePairs();
    }
  } else if (what == 16 && all_.size() > 1) {  // The copy goes on.
    all_.erase(all_.begin());
  } else {
    QueryAndMove(choices_.Below(4));
  }
  return what;
}

void BodyHistory::ExpectIsModel(std::uint64_t seed) {
  ExpectAnswers(bodies(), model_, seed);
  for (std::size_t i = 1; i < all_.size(); ++i) {
    ExpectSameOrder(bodies(), *all_[i], seed);
  }
  ASSERT_FALSE(bodies().Has(0xFFFFFFFF));
  if (seed % 4 != 0) return;
  for (std::uint32_t i = 0; i < most_bodies_; ++i) {
    const std::uint32_t id = i * stride_;
    ASSERT_EQ(bodies().Has(id), model_.bodies.contains(id)) << id;
  }
  Each([&](AnyBodies& some) {
    ASSERT_TRUE(some.Validate());
    ASSERT_EQ(some.Statistics().bodies, model_.bodies.size());
    ASSERT_EQ(some.Statistics().pairs, pairs_.size());
  });
  model_.Update();  // Validate() copies moves into the tree
}

Ids BodyHistory::Found(const Watch& watch) const {
  return KeptBy(model_.layout, model_.Seen(), watch.query, watch.options.mask);
}

// The events are the differences between the lists of pairs.
void BodyHistory::UpdatePairs() {
  model_.Update();
  const PairList now = model_.Pairs();
  // Of the copy too, whose pairs must come in the same order.
  bool is_first = true;
  Each([&](AnyBodies& bodies) {
    bodies.UpdatePairs(std::exchange(is_first, false) ? Runner()
                                                      : Runner(&RunOnThreads));
  });
  PairList pairs = PairsFrom(bodies().pairs());
  std::sort(pairs.begin(), pairs.end());
  EXPECT_EQ(pairs, now);
  EXPECT_EQ(PairsFrom(bodies().began()), Difference(now, pairs_));
  EXPECT_EQ(PairsFrom(bodies().ended()), Difference(pairs_, now));
  pairs_ = now;
}

// A query whose function moves bodies, sees that, and begins another query.
void BodyHistory::QueryAndMove(std::size_t depth) {
  Watch watch;
  const Planes everything = AllPlanes(model_.layout, kMost);
  watch.query = {Shape::kBound, {everything.begin(), everything.end()}};
  if (choices_.Below(2) == 0) {
    watch.query = Spheres(model_.layout, 40, choices_.Below(100)).NextQuery();
  }
  if (choices_.Below(4) == 0) watch.options.mask = 1;
  watch.always = watch.ever = Found(watch);
  watches_.push_back(&watch);
  Ids found;
  std::size_t calls = 0;
  bodies().ForEach(
      watch.query,
      [&](Span<const std::uint32_t> some) {
        found.insert(found.end(), some.begin(), some.end());
        // Twice in the innermost: also between two parts of late bodies.
        if (calls++ > (depth == 0 ? 1 : 0)) return Visit::kContinue;
        Move(choices_.Below(2) == 0 ? 3 : choices_.Below(most_bodies_));
        ExpectAnswers(bodies(), model_, choices_.Below(200));
        if (depth > 0) QueryAndMove(depth - 1);
        return Visit::kContinue;
      },
      watch.options);
  watches_.pop_back();
  const Ids ids = InOrder(found);
  EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
  EXPECT_TRUE(std::ranges::includes(ids, watch.always));
  EXPECT_TRUE(std::ranges::includes(watch.ever, ids));
}

// Up to `count` ids that are in use, some of them twice, or that are free.
Ids BodyHistory::Some(std::size_t count, bool are_used) {
  Ids ids;
  std::vector<bool> is_listed(most_bodies_);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t number = choices_.Below(most_bodies_);
    const auto id = static_cast<std::uint32_t>(number) * stride_;
    if (model_.bodies.contains(id) != are_used) continue;
    if (!are_used && is_listed[number]) continue;
    is_listed[number] = true;
    ids.push_back(id);
  }
  return ids;
}

}  // namespace halfspace::testing

#include "tests/library/broad_phase/history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "dispatch/broad_phase/state.h"
#include "halfspace/error.h"

namespace halfspace::testing {
namespace {

// Their values, one after another.
std::vector<float> ValuesOf(const Layout& layout,
                            const std::vector<Planes>& bounds) {
  std::vector<float> values;
  for (const Planes& bound : bounds) {
    values.insert(values.end(), bound.begin(),
                  bound.begin() + layout.plane_count);
  }
  return values;
}

Planes BoundIn(const AnyBodies& bodies, const Layout& layout,
               std::uint32_t id) {
  Planes planes{};
  bodies.Get(id, {planes.data(), layout.plane_count});
  return planes;
}

}  // namespace

std::vector<std::byte> BytesOf(const AnyBodies& bodies) {
  std::vector<std::byte> bytes;
  bodies.Save(
      [](void* to, Span<const std::byte> some) {
        auto& all = *static_cast<std::vector<std::byte>*>(to);
        all.insert(all.end(), some.begin(), some.end());
      },
      &bytes);
  std::uint64_t size = 0;
  EXPECT_GE(bytes.size(), sizeof(size));
  std::memcpy(&size, bytes.data(), sizeof(size));
  EXPECT_EQ(size, bytes.size());
  return bytes;
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

namespace {

void AskAltered(const AnyBodies& bodies, const Layout& layout,
                const Ids& its_ids, Random& random) {
  const Searches world(layout, bodies);
  Ids ids(100);
  const auto kind =
      static_cast<Shape::Kind>(random() % (Shape::kHalfSpaces + 1));
  const std::vector<Shape> shapes = SomeShapes(layout, kind, 2, false, random);
  (void)world.Find(shapes[0], ids, {.mask = 3}, 0);
  (void)world.Count(shapes[0], {});
  (void)world.Any(shapes[0], {});
  std::vector<std::size_t> offsets(3);
  (void)world.FindEach(shapes, ids, offsets, {}, 0);
  (void)world.Nearest({.is_point = true}, ids, {}, kInf, {.mask = 2});
  world.Cast(SomeMotion(layout, Motion::kBall, false, random),
             [](std::uint32_t, float, const Planes&) { return Limit{kInf}; },
             {});
  const Span<const std::uint32_t> set = its_ids;
  (void)world.FindPairs(nullptr, &set, {}, {.mask = 3});
  (void)world.FindPairs(nullptr, &set, {}, {.wanted = its_ids, .margin = 1});
  for (const std::uint32_t id : its_ids) {
    (void)BoundIn(bodies, layout, id);
    (void)bodies.MasksOf(id);
  }
}

}  // namespace

bool LoadAltered(const Layout& layout, Span<const std::byte> bytes,
                 Random& random) {
  AnyBodies bodies(TypeOf(layout), {});
  bodies.Insert(Ids{8}, ValuesOf(layout, {EmptyOf(layout)}), {});
  try {
    bodies.Load(bytes);
  } catch (const Error&) {
    EXPECT_TRUE(bodies.Has(8) && bodies.size() == 1);
    return false;
  }
  const Searches world(layout, bodies);
  const Shape all = ShapeOf(AllPlanes(layout, kMost));
  Ids ids(bodies.size());
  ids.resize(std::min(world.Find(all, ids, {}, 0), ids.size()));
  std::erase_if(ids, [&](std::uint32_t id) { return !bodies.Has(id); });
  const auto values_of = [&](std::size_t count, const Planes& bound) {
    return ValuesOf(layout, std::vector<Planes>(count, bound));
  };
  (void)bodies.Validate();
  AskAltered(bodies, layout, ids, random);
  // In a query, so that some bodies are late.
  world.ForEach(all,
                [&](Span<const std::uint32_t>) {
                  bodies.Move(ids, values_of(ids.size(), EverythingOf(layout)));
                  AskAltered(bodies, layout, ids, random);
                  return Visit::kStop;
                },
                {});
  bodies.UpdatePairs(PairKernelsOf(layout), {});
  const Ids few(ids.data(), ids.data() + ids.size() / 8);
  bodies.SetMasks(few, std::vector<BodyMasks>(few.size(), {3, 1}));
  bodies.Move(few, values_of(few.size(), Planes{}));
  bodies.UpdatePairs(PairKernelsOf(layout), {});
  bodies.Erase(few);
  Ids added;
  for (std::uint32_t id = 0; added.size() < 100; ++id) {
    if (!bodies.Has(id)) added.push_back(id);
  }
  bodies.Insert(added, values_of(added.size(), Planes{}), {});
  bodies.Update({});
  AnyBodies copy(bodies);
  bodies.Load(BytesOf(copy));
  for (AnyBodies* const one : {&bodies, &copy}) {
    AskAltered(*one, layout, added, random);
    one->UpdatePairs(PairKernelsOf(layout), {});
    one->Rebuild({});
    (void)one->Validate();
    (void)one->Statistics();
    std::erase_if(ids, [&](std::uint32_t id) { return !one->Has(id); });
    one->Erase(ids);
  }
  return true;
}

void ExpectAnswers(const AnyBodies& bodies, const BodyModel& model,
                   std::uint64_t seed) {
  const Layout& layout = model.layout;
  Random random(seed);
  constexpr std::uint32_t kMasks[] = {0xFFFFFFFF, 1, 2, 0x80000002};
  ExpectAnswers(
      Searches(layout, bodies), model.Seen(),
      {.mask = kMasks[random() % 4], .is_special = seed % 8 == 0, .shapes = 1},
      random);
  Planes all{};
  bodies.Bounds({all.data(), layout.plane_count});
  for (const auto& [id, body] : model.bodies) {
    ASSERT_TRUE(bodies.Has(id)) << id;
    const Planes bound = BoundIn(bodies, layout, id);
    for (std::size_t p = 0; p < layout.plane_count; ++p) {
      ASSERT_EQ(std::bit_cast<std::uint32_t>(bound[p]),
                std::bit_cast<std::uint32_t>(body.bound[p]));
      const float v = body.seen[p];
      if (IsMin(layout, p)) {
        ASSERT_LE(all[p], std::isnan(v) ? -kInf : v);
      } else {
        ASSERT_GE(all[p], std::isnan(v) ? kInf : v);
      }
    }
    ASSERT_EQ(bodies.MasksOf(id), body.masks);
    ASSERT_LT(id, bodies.id_limit());
  }
}

void ExpectIsModel(const AnyBodies& bodies, BodyModel& model,
                   std::uint64_t seed) {
  ExpectAnswers(bodies, model, seed);
  ASSERT_TRUE(bodies.Validate());
  model.Update();
  ASSERT_EQ(bodies.Statistics().bodies, model.bodies.size());
}

void BodyHistory::ExpectSameOrder(const AnyBodies& copy,
                                  std::uint64_t seed) const {
  const Layout& layout = model_.layout;
  for (int kind = 0; kind <= Shape::kHalfSpaces; ++kind) {
    Random random(seed);
    const Shape shape =
        SomeShapes(layout, static_cast<Shape::Kind>(kind), 1, false, random)[0];
    Ids ids(bodies().size());
    Ids of_copy(ids.size());
    ASSERT_EQ(Searches(layout, bodies()).Find(shape, ids, {}, 0),
              Searches(layout, copy).Find(shape, of_copy, {}, 0));
    ASSERT_EQ(ids, of_copy);
  }
  const auto& events = bodies().events();
  ASSERT_EQ(PairsFrom(events.pairs()), PairsFrom(copy.events().pairs()));
  ASSERT_EQ(PairsFrom(events.began()), PairsFrom(copy.events().began()));
  ASSERT_EQ(PairsFrom(events.ended()), PairsFrom(copy.events().ended()));
  ASSERT_EQ(bodies().id_limit(), copy.id_limit());
}

namespace {

// What is stored of the bodies, and their pairs.
Ids StateOf(const Layout& layout, const AnyBodies& bodies) {
  const Shape all = ShapeOf(AllPlanes(layout, kInf));
  Ids ids(bodies.size());
  EXPECT_EQ(Searches(layout, bodies).Find(all, ids, {}, 0), ids.size());
  Ids state = ids = InOrder(ids);
  for (const std::uint32_t id : ids) {
    for (const float value : BoundIn(bodies, layout, id)) {
      state.push_back(std::bit_cast<std::uint32_t>(value));
    }
    const BodyMasks masks = bodies.MasksOf(id);
    state.insert(state.end(), {masks.category, masks.collides_with});
  }
  for (const auto& [a, b] : InOrder(bodies.events().pairs(), false)) {
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
  all_.emplace_back(TypeOf(layout), options);
  model_.layout = layout;
  model_.moves_wait = !options.moves_are_seen_at_once;
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
  const Ids before = StateOf(model_.layout, bodies);
  FailuresOf(*memory_, call,
             [&] { EXPECT_EQ(StateOf(model_.layout, bodies), before); });
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
  Each([&](AnyBodies& bodies) {
    bodies.Insert(ids, ValuesOf(model_.layout, bounds), masks);
  });
}

void BodyHistory::Move(std::size_t count) {
  const Ids ids = Some(count, true);
  std::vector<Planes> bounds;
  for (const std::uint32_t id : ids) {
    const Planes& before = model_.bodies.at(id).bound;
    bounds.push_back(choices_.Below(4) == 0 ? before : choices_.Moved(before));
    model_.Move(id, bounds.back());
  }
  Each([&](AnyBodies& bodies) {
    bodies.Move(ids, ValuesOf(model_.layout, bounds));
  });
  for (Watch* const watch : watches_) watch->Add(Found(*watch));
}

void BodyHistory::Copy() {
  model_.Update();
  if (all_.size() > 1 && choices_.Below(2) == 0) {
    Try(all_[1], [&] { all_[1] = bodies(); });
    return;
  }
  all_.erase(all_.begin() + 1, all_.end());
  Try(bodies(), [&] { all_.push_back(bodies()); });
}

std::size_t BodyHistory::Change() {
  for (AnyBodies& bodies : all_) {
    detail::BroadPhaseState& state = bodies.state();
    if (state.options.moves_are_seen_at_once || state.options.caller_locks) {
      continue;
    }
    // As if queries of other threads had waited.
    state.beside = static_cast<std::uint32_t>(choices_.Below(3));
  }
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
    Try(bodies(), [&] { bytes = BytesOf(bodies()); });
    Copy();
    if (what == 15) {
      Try(all_[1], [&] { all_[1].Load(bytes); });
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
    ExpectSameOrder(all_[i], seed);
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
    bodies.UpdatePairs(
        PairKernelsOf(model_.layout),
        std::exchange(is_first, false) ? Runner() : Runner(&RunOnThreads));
  });
  PairList pairs = PairsFrom(bodies().events().pairs());
  std::sort(pairs.begin(), pairs.end());
  EXPECT_EQ(pairs, now);
  EXPECT_EQ(PairsFrom(bodies().events().began()), Difference(now, pairs_));
  EXPECT_EQ(PairsFrom(bodies().events().ended()), Difference(pairs_, now));
  pairs_ = now;
}

// A query whose function moves bodies, sees that, and begins another query.
void BodyHistory::QueryAndMove(std::size_t depth) {
  Watch watch;
  watch.query = ShapeOf(AllPlanes(model_.layout, kMost));
  if (choices_.Below(2) == 0) {
    watch.query = Spheres(model_.layout, 40, choices_.Below(100)).NextQuery();
  }
  if (choices_.Below(4) == 0) watch.options.mask = 1;
  watch.always = watch.ever = Found(watch);
  watches_.push_back(&watch);
  Ids found;
  std::size_t calls = 0;
  Searches(model_.layout, bodies())
      .ForEach(
          watch.query,
          [&](Span<const std::uint32_t> some) {
            found.insert(found.end(), some.begin(), some.end());
            // Twice in the innermost: also between two parts of late bodies.
            if (calls++ > (depth == 0 ? 1 : 0)) return Visit::kContinue;
#if !defined(_WIN32)  // where the DLL does not export it
            // As if a query of another thread ran: moved bodies stay late.
            detail::BroadPhaseState& state = bodies().state();
            std::optional<detail::Reading> other;
            if (!state.options.caller_locks && choices_.Below(2) == 0) {
              other.emplace(state);
            }
#endif
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

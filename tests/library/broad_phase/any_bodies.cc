#include "tests/library/broad_phase/any_bodies.h"

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
    const Place place = SomePlace(a.layout, kind % 2 == 0, false, random);
    ASSERT_EQ(a.Nearest(place, of_a, {}, kInf, {}),
              b.Nearest(place, of_b, {}, kInf, {}));
    ASSERT_EQ(of_a, of_b);
    const Motion motion = SomeMotion(
        a.layout, static_cast<Motion::Kind>(kind % 3), false, random);
    const auto hits = [&](const AnyBodies& bodies) {
      Ids ids;
      bodies.Cast(motion,
                  [&](std::uint32_t id, float t, const Planes&) {
                    ids.push_back(id);
                    ids.push_back(std::bit_cast<std::uint32_t>(t));
                    return Limit{kInf};
                  },
                  {});
      return ids;
    };
    ASSERT_EQ(hits(a), hits(b));
  }
  ASSERT_EQ(PairsFrom(a.pairs()), PairsFrom(b.pairs()));
  ASSERT_EQ(PairsFrom(a.began()), PairsFrom(b.began()));
  ASSERT_EQ(PairsFrom(a.ended()), PairsFrom(b.ended()));
  ASSERT_EQ(a.id_limit(), b.id_limit());
}

}  // namespace halfspace::testing

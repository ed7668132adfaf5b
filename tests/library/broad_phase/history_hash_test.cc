// One seeded history per bound type, and two constants for all its answers: the
// same on every target, compiler and machine. The order of ids is that of
// libstdc++. Changes run on the target of the process.
//
// The second is of the answers as they came, and changes with the tree's
// arrangement.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fnv_hash.h"
#include "tests/library/support/known_hashes.h"

namespace halfspace::testing {
namespace {

template <int... kDims>
using BodiesOf =
    ::testing::Types<Whole<AabbView<kDims>>..., Whole<AaboView<kDims>>...>;
using BroadPhaseCases =
    std::conditional_t<kTestsOnly3d, BodiesOf<3>, BodiesOf<2, 3>>;
template <typename Case>
class BroadPhaseHashTest : public ::testing::Test {};
TYPED_TEST_SUITE(BroadPhaseHashTest, BroadPhaseCases, CaseNames);

template <typename Case>
void ExpectKnownAnswers(Target target) {
  using View = typename Case::View;
  using Bound = typename View::Bound;
  constexpr int kDims = Bound::kDimensions;
  constexpr std::size_t kBodies = 6000;  // with three levels of nodes
  FnvHash sorted;
  FnvHash order;
  // Of one call: hashes of its answers.
  std::vector<std::uint64_t> answers;
  const auto add = [&](Span<const std::uint32_t> ids) {
    answers.insert(answers.end(), ids.begin(), ids.end());
  };
  const auto add_hit = [&](std::uint32_t id, float t, const Bound& bound) {
    FnvHash hash;
    hash.Add(id);
    hash.AddFloat(t);
    hash.AddAllFloats(bound.min);
    hash.AddAllFloats(bound.max);
    answers.push_back(hash.value());
  };
  const auto add_pairs = [&](Span<const IdPair> pairs) {
    for (const IdPair& pair : pairs) {
      const auto [a, b] = std::minmax(pair.a, pair.b);
      answers.push_back(std::uint64_t{a} << 32 | b);
    }
  };
  const auto end_call = [&] {
    order.AddAll(answers);
    std::sort(answers.begin(), answers.end());
    sorted.AddAll(answers);
    sorted.Add(answers.size());
    answers.clear();
  };
  Spread<View> spread(1.0f, 5);
  Random random(6);
  BroadPhase<View> bodies;
  Ids ids;
  std::vector<Bound> bounds;
  for (std::uint32_t id = 0; id < kBodies; ++id) {
    ids.push_back(3 * id);
    bounds.push_back(spread.NextObject());
  }
  bodies.Insert(ids, bounds);
  for (std::size_t step = 0; step < 40; ++step) {
    Ids some;
    std::vector<Bound> moved;
    for (std::size_t i = 0; i < (step % 5 == 0 ? 4000 : 500); ++i) {
      const std::size_t body = random() % kBodies;
      if (!bodies.Has(ids[body])) continue;
      const float way = static_cast<float>(random() % 64) / 64;
      for (std::size_t k = 0; k < Bound::kAxes; ++k) {
        bounds[body].min[k] += way;
        bounds[body].max[k] += way;
      }
      if (random() % 16 == 0) bounds[body] = spread.NextObject();
      some.push_back(ids[body]);
      moved.push_back(bounds[body]);
    }
    bodies.Move(some, moved);
    if (step % 4 == 0) {
      bodies.Erase(some);
    } else if (step % 4 == 1) {
      for (std::size_t body = 0; body < kBodies; ++body) {
        if (!bodies.Has(ids[body])) bodies.Insert(ids[body], bounds[body]);
      }
    }
    if (step % 3 == 0) bodies.Update();
    if (step == 20) bodies.Rebuild();
    Spread<View> queries(4.0f * static_cast<float>(step % 3), step);
    ForEachSurvivor(bodies, queries.NextQuery(), add, {.target = target});
    // The walk of one bound has another order in plain code (bvh.h).
    std::sort(answers.begin(), answers.end());
    end_call();
    Sphere<kDims> sphere{};
    sphere.radius = static_cast<float>(step);
    ForEachSurvivor(bodies, sphere, add, {.target = target});
    end_call();
    Ray<kDims> ray{};
    ray.direction.fill(1);
    ray.direction[0] = static_cast<float>(step) - 12;
    ray.max_t = 40;
    RayCast(bodies, ray, add_hit, {.target = target});
    end_call();
    Aabb<kDims> box{};
    box.max.fill(1);
    BoxCast(bodies, box, ray.direction, 40, add_hit, {.target = target});
    end_call();
    SphereCast(bodies, Sphere<kDims>{{}, 2}, ray.direction, 40, add_hit,
               {.target = target});
    end_call();
    if (step % 4 != 0) {
      some.resize(200);
      PairOptions options;
      options.margin = 0.5f;
      options.target = target;
      ForEachPairOf(bodies, some, add_pairs, options);
      end_call();
    }
    bodies.UpdatePairs();
    add_pairs(bodies.began());
    add_pairs(bodies.ended());
    sorted.AddAll(answers);  // they come sorted
    answers.clear();
  }
  ASSERT_GT(bodies.pairs().size(), 100u);
  ASSERT_TRUE(bodies.Validate());
  const std::string name = "BroadPhase" + NameOf(Case());
  EXPECT_TRUE(IsKnown(name, sorted.value()));
#if defined(__GLIBCXX__)
  // How std::nth_element arranges elements is up to the standard library.
  EXPECT_TRUE(IsKnown(name + "Order", order.value()));
#endif
}

TYPED_TEST(BroadPhaseHashTest, AnswersAreTheSameEverywhere) {
  for (Target target : TargetsUnderTest()) {
    SCOPED_TRACE(target.name());
    ExpectKnownAnswers<TypeParam>(target);
  }
}

}  // namespace
}  // namespace halfspace::testing

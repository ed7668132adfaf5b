// One seeded history per bound type, and two constants for all its answers: the
// same on every target, compiler and machine. A broad phase has the target of
// the process, so ctest runs this once for each (environment.cmake).
//
// HALFSPACE_TEST_SCALE does not count here. If an answer or the order is meant
// to change, the message of the failed test has the new constant.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ios>
#include <map>
#include <string>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/broad_phase/history.h"
#include "tests/library/support/fnv_hash.h"

namespace halfspace::testing {
namespace {

struct Hashes {
  std::uint64_t answers;  // sorted
  std::uint64_t order;    // as they came; changes with the way of the tree
};
const std::map<std::string, Hashes> kExpected = {
    {"Aabb2", {0x4b40f5b3ceb62011, 0xabc7ed59cfbb47f9}},
    {"Aabb3", {0x479f9e0ed9ed4631, 0x773ec467286f7631}},
    {"Aabo2", {0x8c01fe04221ab8f9, 0x94dbe4c3612cb185}},
    {"Aabo3", {0xc50defe2bd092865, 0x296993ffb029745d}},
};

template <typename Case>
class BroadPhaseHashTest : public ::testing::Test {};
TYPED_TEST_SUITE(BroadPhaseHashTest, BroadPhaseCases, CaseNames);

TYPED_TEST(BroadPhaseHashTest, AnswersAreTheSameEverywhere) {
  if (!DescribeTargetChoice().error.empty()) GTEST_SKIP();
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  constexpr int kDims = Bound::kDimensions;
  constexpr std::size_t kBodies = 6000;  // with three levels of nodes
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  FnvHash sorted;
  FnvHash order;
  // Of one call: hashes of its answers.
  std::vector<std::uint64_t> answers;
  const auto add = [&](std::uint32_t id, const Bound& bound) {
    FnvHash hash;
    hash.Add(id);
    hash.AddAllFloats(bound.min);
    hash.AddAllFloats(bound.max);
    answers.push_back(hash.value());
  };
  const auto add_hit = [&](std::uint32_t id, float t, const Bound&) {
    FnvHash hash;
    hash.Add(id);
    hash.AddFloat(t);
    answers.push_back(hash.value());
  };
  const auto add_pair = [&](std::uint32_t a, std::uint32_t b) {
    answers.push_back(std::uint64_t{a} << 32 | b);
  };
  const auto add_either = [&](std::uint32_t a, std::uint32_t b) {
    add_pair(std::min(a, b), std::max(a, b));
  };
  const auto end_call = [&] {
    order.AddAll(answers);
    std::sort(answers.begin(), answers.end());
    sorted.AddAll(answers);
    sorted.Add(answers.size());
    answers.clear();
  };
  for (const float margin : {0.0f, 0.3f}) {
    Spread<View> spread(1.0f, 5);
    Random random(6);
    BroadPhaseOptions options;
    options.margin = margin;
    BroadPhase<View> bodies(kBodies, options);
    Ids ids;
    std::vector<Bound> bounds;
    for (std::uint32_t id = 0; id < kBodies; ++id) {
      ids.push_back(id);
      bounds.push_back(spread.NextObject());
    }
    bodies.Insert(ids, bounds);
    for (std::size_t step = 0; step < 24; ++step) {
      Ids some;
      std::vector<Bound> moved;
      for (std::size_t i = 0; i < 1000; ++i) {
        const std::size_t id = random() % kBodies;
        if (!bodies.Has(ids[id])) continue;
        const float way = static_cast<float>(random() % 64) / 64;
        for (std::size_t k = 0; k < Bound::kAxes; ++k) {
          bounds[id].min[k] += way;
          bounds[id].max[k] += way;
        }
        if (random() % 16 == 0) bounds[id] = spread.NextObject();
        some.push_back(ids[id]);
        moved.push_back(bounds[id]);
      }
      bodies.Move(some, moved);
      if (step % 4 == 0) {
        bodies.Erase(some);
      } else if (step % 4 == 1) {
        for (const std::uint32_t id : ids) {
          if (!bodies.Has(id)) bodies.Insert(id, bounds[id]);
        }
      }
      if (step % 3 == 0) bodies.Update();
      if (step == 20) bodies.Rebuild();
      Spread<View> queries(4.0f * static_cast<float>(step % 3), step);
      bodies.ForEach(queries.NextQuery(), kAll, add);
      end_call();
      Sphere<kDims> sphere{};
      sphere.radius = static_cast<float>(step);
      bodies.ForEach(sphere, 1, add);
      end_call();
      Ray<kDims> ray{};
      ray.direction.fill(1);
      ray.direction[0] = static_cast<float>(step) - 12;
      ray.max_t = 40;
      bodies.ForEachCast(ray, 1, add_hit);
      end_call();
      Aabb<kDims> box{};
      box.max.fill(1);
      bodies.ForEachCast(box, ray.direction, 40, kAll, add_hit);
      end_call();
      if (step % 4 != 0) {
        some.resize(200);
        bodies.ForEachPairOf(some, 0.5f, add_either);
        end_call();
      }
      bodies.UpdatePairs(add_pair, add_pair);
      sorted.AddAll(answers);  // they come sorted
      answers.clear();
    }
    ASSERT_GT(bodies.Statistics().pairs, 100u);
    ASSERT_TRUE(bodies.Validate());
  }
  const std::string name = NameOf(TypeParam());
  const Hashes& expected = kExpected.at(name);
  EXPECT_EQ(sorted.value(), expected.answers)
      << name << ": 0x" << std::hex << sorted.value();
  EXPECT_EQ(order.value(), expected.order)
      << name << ": 0x" << std::hex << order.value();
}

}  // namespace
}  // namespace halfspace::testing

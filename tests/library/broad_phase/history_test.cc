// A broad phase answers as a list of its bodies does, after any history.
#include "tests/library/broad_phase/history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/broad_phase/bodies.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class BroadPhaseHistoryTest : public ::testing::Test {};
TYPED_TEST_SUITE(BroadPhaseHistoryTest, BroadPhaseCases, CaseNames);

TYPED_TEST(BroadPhaseHistoryTest, AnyHistoryIsThatOfTheModel) {
  using View = typename TypeParam::View;
  const std::size_t rounds = std::max<std::size_t>(2, Scaled(12));
  for (std::size_t round = 0; round < rounds; ++round) {
    BodyMaker<View> maker(round);
    // One with three levels of nodes.
    const bool is_large = round == 1;
    const std::size_t max_ids = is_large ? 9000 : round % 3 == 0 ? 200 : 1500;
    BroadPhaseOptions options;
    constexpr float kMargins[] = {0.3f, 0.0f, 5.0f,
                                  std::numeric_limits<float>::max()};
    options.margin = kMargins[round % 4];
    if (round % 3 == 0) options.filter.keep = &KeepsSome;
    BodyHistory<View, BodyMaker<View>> history(maker, max_ids, options);
    if (is_large) history.Insert(max_ids);
    const std::size_t steps = is_large ? 12 : 10 + Scaled(40);
    for (std::size_t step = 0; step < steps; ++step) {
      const std::size_t what = history.Change();
      ExpectIsModel(history.bodies(), history.model(), maker.random()());
      EXPECT_EQ(history.bodies().Statistics().trees, 1u);
      if (maker.Below(3) == 0) {
        history.ExpectEvents();
        history.ExpectPairsOfSome(maker.Below(100),
                                  maker.Below(2) == 0 ? 0.0f : 0.7f);
      }
      if (this->HasFailure()) {
        FAIL() << "round " << round << ", step " << step << ", " << what;
      }
    }
  }
}

// Changes never trap, and flush no subnormal of a bound.
TEST(BroadPhaseFpModesTest, ChangesAreTheSameInEachMode) {
  using View = AabbView3;
  BodyMaker<View> maker(7);
  std::vector<Aabb3> any(800);
  for (Aabb3& bound : any) bound = maker.Next();
  const auto change = [&](AabbBroadPhase3& bodies, BodyModel<View>& model) {
    for (std::uint32_t id = 0; id < 400; ++id) {
      Aabb3 bound = any[id];
      if (id % 3 == 0) bound = {{-0x1p-149f, -0x1p-140f, 0}, {0, 0, 0x1p-130f}};
      model.objects[id] = {bound, {}};
      bodies.Insert(id, bound);
    }
    bodies.Update();
    for (std::uint32_t id = 0; id < 400; ++id) {
      Aabb3& bound = model.objects[id].bound;
      bound = id % 3 == 0 ? Aabb3{{0, 0, 0}, {0x1p-149f, 0x1p-149f, 0}}
                          : any[400 + id];
      bodies.Move(id, bound);
      if (id % 5 == 0) {
        bodies.Erase(id);
        model.objects.erase(id);
      }
      if (id == 200) bodies.Rebuild();
    }
  };
  const auto expect = [](AabbBroadPhase3& bodies, BodyModel<View>& model) {
    ExpectIsModel(bodies, model, 1);
    ExpectFindsSame(bodies, model, model.Found(1),
                    Aabb3{{0x1p-149f, 0, 0}, {1, 1, 1}}, 1);
    PairsByEvents pairs;
    {
      const FlushDenormals mode;
      pairs.Update(bodies);
    }
    EXPECT_EQ(pairs.pairs(), model.Pairs());
  };
  for (const float margin : {0.0f, 0x1p-149f, 1.0f}) {
    BroadPhaseOptions options;
    options.margin = margin;
    AabbBroadPhase3 bodies(400, options);
    BodyModel<View> model;
    {
      const TrapExceptions mode;
      change(bodies, model);
    }
    expect(bodies, model);
    AabbBroadPhase3 flushed(400, options);
    model = {};
    {
      const FlushDenormals mode;
      change(flushed, model);
    }
    expect(flushed, model);
  }
}

}  // namespace
}  // namespace halfspace::testing

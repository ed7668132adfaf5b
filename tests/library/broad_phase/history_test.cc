// A broad phase answers as a list of its bodies does, after any history.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
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

// The events of UpdatePairs() are the differences between the sets of pairs.
template <typename View>
void ExpectEvents(BroadPhase<View>& bodies, const BodyModel<View>& model,
                  IdPairs& pairs) {
  const IdPairs now = model.Pairs();
  IdPairs began;
  IdPairs ended;
  bodies.UpdatePairs(
      [&](std::uint32_t a, std::uint32_t b) { began.emplace_back(a, b); },
      [&](std::uint32_t a, std::uint32_t b) {
        ASSERT_TRUE(began.empty());
        ended.emplace_back(a, b);
      });
  IdPairs expected;
  std::set_difference(now.begin(), now.end(), pairs.begin(), pairs.end(),
                      std::back_inserter(expected));
  ASSERT_EQ(began, expected);
  expected.clear();
  std::set_difference(pairs.begin(), pairs.end(), now.begin(), now.end(),
                      std::back_inserter(expected));
  ASSERT_EQ(ended, expected);
  ASSERT_EQ(bodies.Statistics().pairs, now.size());
  pairs = now;
}

TYPED_TEST(BroadPhaseHistoryTest, AnyHistoryIsThatOfTheModel) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  const std::size_t rounds = std::max<std::size_t>(2, Scaled(12));
  for (std::size_t round = 0; round < rounds; ++round) {
    BodyMaker<View> maker(round);
    Random& random = maker.random();
    // One with three levels of nodes.
    const bool is_large = round == 1;
    const std::size_t max_ids = is_large ? 9000 : round % 3 == 0 ? 200 : 1500;
    BroadPhaseOptions options;
    options.margin = round % 2 == 0 ? 0.3f : round % 4 == 1 ? 0.0f : 5.0f;
    BroadPhase<View> bodies(max_ids, options);
    BodyModel<View> model;
    IdPairs pairs;
    const auto backwards = [](std::size_t parts, const Runner::Part& part) {
      while (parts-- > 0) part(parts);
    };
    // Up to `count` ids that are in use, some of them twice, or that are free.
    const auto some = [&](std::size_t count, bool are_used) {
      Ids ids;
      for (std::size_t i = 0; i < count; ++i) {
        const auto id = static_cast<std::uint32_t>(random() % max_ids);
        if (model.objects.contains(id) != are_used) continue;
        if (!are_used && std::find(ids.begin(), ids.end(), id) != ids.end()) {
          continue;
        }
        ids.push_back(id);
      }
      return ids;
    };
    const std::size_t steps = is_large ? 12 : 10 + Scaled(40);
    for (std::size_t step = 0; step < steps; ++step) {
      const bool is_first_of_large = is_large && step == 0;
      const std::size_t what = is_first_of_large ? 0 : random() % 12;
      const std::size_t count = is_first_of_large   ? max_ids
                                : random() % 8 == 0 ? random() % max_ids
                                                    : random() % 20;
      std::vector<Bound> bounds;
      std::vector<BodyMasks> masks;
      if (what < 4) {
        const Ids ids = some(count, false);
        const bool has_masks = random() % 2 == 0;
        for (const std::uint32_t id : ids) {
          bounds.push_back(maker.Next());
          if (has_masks) masks.push_back(maker.Masks());
          model.objects[id] = {bounds.back(),
                               has_masks ? masks.back() : BodyMasks()};
        }
        bodies.Insert(ids, bounds, masks);
      } else if (what < 6) {
        const Ids ids = some(count, true);
        for (const std::uint32_t id : ids) model.objects.erase(id);
        bodies.Erase(ids);
      } else if (what < 9) {
        const Ids ids = some(2 * count, true);
        for (const std::uint32_t id : ids) {
          bounds.push_back(maker.Moved(model.objects[id].bound));
          model.objects[id].bound = bounds.back();
        }
        bodies.Move(ids, bounds);
      } else if (what == 9) {
        const Ids ids = some(count, true);
        for (const std::uint32_t id : ids) {
          masks.push_back(maker.Masks());
          model.objects[id].masks = masks.back();
        }
        bodies.SetMasks(ids, masks);
      } else if (what == 10) {
        UpdateOptions update;
        if (random() % 2 == 0) update.budget = random() % (2 * max_ids);
        update.run = backwards;
        bodies.Update(update);
      } else {
        bodies.Rebuild(backwards);
      }
      ExpectIsModel(bodies, model, random());
      if (random() % 3 == 0) {
        ExpectEvents(bodies, model, pairs);
        const Ids set = some(random() % 100, true);
        std::vector<std::uint64_t> wanted;
        for (std::size_t i = 0; i < set.size() && step % 2 == 0; ++i) {
          wanted.push_back(random() % 4 == 0 ? ~std::uint64_t{0}
                                             : maker.Masks().category);
        }
        ExpectPairsOfSet(bodies, model, set, wanted,
                         random() % 2 == 0 ? 0.0f : 0.7f);
      }
      if (this->HasFatalFailure() || this->HasNonfatalFailure()) {
        FAIL() << "round " << round << ", step " << step << ", " << what;
      }
    }
  }
}

// Enough bodies for several parts of both halves of UpdatePairs(). All of them
// move, first inside the margin and then beyond.
TEST(BroadPhasePairsTest, EventsDoNotDependOnTheRunner) {
  const auto on_threads = [](std::size_t threads) {
    return [threads](std::size_t parts, const Runner::Part& part) {
      std::atomic<std::size_t> next{0};
      std::vector<std::jthread> pool;
      for (std::size_t t = 0; t < threads; ++t) {
        pool.emplace_back([&] {
          for (std::size_t i = next++; i < parts; i = next++) part(i);
        });
      }
    };
  };
  const auto two = on_threads(2);
  const auto seven = on_threads(7);
  std::size_t calls_of_many = 0;
  const auto backwards = [&](std::size_t parts, const Runner::Part& part) {
    calls_of_many += parts > 1 ? 1 : 0;
    while (parts-- > 0) part(parts);
  };
  struct Stop {};
  const auto stops = [](std::size_t parts, const Runner::Part& part) {
    part(parts - 1);
    throw Stop();
  };
  const std::vector<Runner> runs = {Runner(), two, seven, backwards};
  constexpr std::uint32_t kCount = 20'000;
  std::vector<IdPairs> events(runs.size());
  for (std::size_t r = 0; r < runs.size(); ++r) {
    BroadPhaseOptions options;
    options.margin = 0.5f;
    AabbBroadPhase3 bodies(kCount, options);
    Spread<AabbView3> spread(1.2f, 3);
    Ids ids;
    std::vector<Aabb3> boxes;
    for (std::uint32_t id = 0; id < kCount; ++id) {
      ids.push_back(id);
      boxes.push_back(spread.NextObject());
    }
    bodies.Insert(ids, boxes);
    const auto update = [&](const Runner& run) {
      bodies.UpdatePairs([&](std::uint32_t a,
                             std::uint32_t b) { events[r].emplace_back(a, b); },
                         [&](std::uint32_t a, std::uint32_t b) {
                           events[r].emplace_back(b, a);
                         },
                         run);
    };
    for (const float step : {0.0f, 0.25f, 1.0f}) {
      for (std::uint32_t id = 0; id < kCount; ++id) {
        const std::size_t k = id % 3;
        boxes[id].min[k] += step;
        boxes[id].max[k] += step;
      }
      bodies.Move(ids, boxes);
      EXPECT_THROW(update(stops), Stop);
      update(runs[r]);
    }
    EXPECT_GT(bodies.Statistics().pairs, 16'384u);
    EXPECT_EQ(events[r], events[0]);
  }
  // The first and the last update find pairs, the second and the last merge.
  EXPECT_EQ(calls_of_many, 4u);
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

// Threads that move, query and change a broad phase at the same time.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/broad_phase/bodies.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// Each kind of thread has ids of its own, kIds of them.
constexpr std::size_t kMovers = 5;
constexpr std::size_t kChangers = 3;
constexpr std::size_t kQueriers = 6;
constexpr std::size_t kUpdaters = 2;
constexpr std::uint32_t kIds = 300;
constexpr std::uint32_t kResting = 0;  // the first id of those that rest
constexpr std::uint32_t kMoving = kIds;
constexpr std::uint32_t kChanging = kMoving + kMovers * kIds;
constexpr std::uint32_t kAllIds = kChanging + kChangers * kIds;

// A box that says whose it is, so that one of two moves would show.
Aabb3 BoxOf(std::uint32_t id, std::size_t move) {
  const auto at = static_cast<float>(move % 1000);
  const float size = 1.0f + static_cast<float>(id % 7);
  Aabb3 box;
  box.min = {at / 10, static_cast<float>(id % 101),
             at / 10 + static_cast<float>(id % 13)};
  for (std::size_t k = 0; k < 3; ++k) box.max[k] = box.min[k] + size;
  return box;
}
bool IsBoxOf(std::uint32_t id, const Aabb3& box) {
  const auto move = static_cast<std::size_t>(box.min[0] * 10 + 0.5f);
  return box == BoxOf(id, move);
}

Aabb3 RestingBox(std::uint32_t id) { return BoxOf(id, id * 37); }

// All that a thread found wrong, in words.
class Complaints {
 public:
  void Check(bool is_right, const char* what) {
    if (!is_right) wrong_.store(what);
  }
  ~Complaints() { EXPECT_EQ(wrong_.load(), nullptr) << wrong_.load(); }

 private:
  std::atomic<const char*> wrong_{nullptr};
};

class BroadPhaseThreads {
 public:
  explicit BroadPhaseThreads(float margin)
      : bodies_(kAllIds, OptionsOf(margin)), last_(kAllIds) {
    Ids ids;
    std::vector<Aabb3> boxes;
    for (std::uint32_t id = 0; id < kChanging; ++id) {
      ids.push_back(id);
      boxes.push_back(id < kMoving ? RestingBox(id) : BoxOf(id, id));
      last_[id] = boxes.back();
    }
    bodies_.Insert(ids, boxes);
  }

  // Moves bodies of its own, one or many, and finds them where they are.
  void Move(std::size_t thread) {
    Random random(thread);
    const auto first = static_cast<std::uint32_t>(kMoving + thread * kIds);
    for (std::size_t i = 0; i < Scaled(1500); ++i) {
      Ids ids;
      std::vector<Aabb3> boxes;
      for (std::size_t n = random() % 8 == 0 ? 200 : 2; n-- > 0;) {
        const auto id = first + static_cast<std::uint32_t>(random() % kIds);
        ids.push_back(id);
        boxes.push_back(BoxOf(id, random()));
        last_[id] = boxes.back();
      }
      bodies_.Move(ids, boxes);
      ExpectFound(ids.back());
      // One that may have moved while a tree was built.
      ExpectFound(first + static_cast<std::uint32_t>(random() % kIds));
    }
  }

  // Inserts and erases bodies of its own.
  void Change(std::size_t thread) {
    Random random(100 + thread);
    const auto first = static_cast<std::uint32_t>(kChanging + thread * kIds);
    std::vector<bool> has(kIds);
    for (std::size_t i = 0; i < Scaled(600); ++i) {
      Ids ids;
      std::vector<Aabb3> boxes;
      const bool inserts = random() % 2 == 0;
      for (std::size_t n = random() % 8 == 0 ? 250 : 2; n-- > 0;) {
        const std::size_t number = random() % kIds;
        if (has[number] == inserts) continue;
        has[number] = inserts;
        const auto id = first + static_cast<std::uint32_t>(number);
        ids.push_back(id);
        boxes.push_back(BoxOf(id, random()));
        last_[id] = inserts ? boxes.back() : Aabb3::Empty();
      }
      if (inserts) {
        bodies_.Insert(ids, boxes);
      } else {
        bodies_.Erase(ids);
      }
      if (ids.empty()) continue;
      complaints_.Check(bodies_.Has(ids[0]) == inserts, "not as just changed");
      if (inserts) ExpectFound(ids[0]);
    }
    for (std::uint32_t i = 0; i < kIds; ++i) {
      if (!has[i]) last_[first + i] = Aabb3::Empty();
    }
  }

  // Finds each resting body once, and the others as they were or are.
  void Query(std::size_t thread) {
    Random random(200 + thread);
    Ids resting;
    for (std::uint32_t id = kResting; id < kMoving; ++id) resting.push_back(id);
    for (std::size_t i = 0; i < Scaled(1500); ++i) {
      const Aabb3 query =
          BoxOf(static_cast<std::uint32_t>(random() % kAllIds), random());
      std::vector<int> found(kAllIds);
      bodies_.ForEach(query, ~std::uint64_t{0},
                      [&](std::uint32_t id, const Aabb3& box) {
                        ++found[id];
                        CheckBox(id, box);
                        complaints_.Check(Touch(query, box), "does not touch");
                        if (found[id] + id % 50 == 1) CallBack(box);
                      });
      for (std::uint32_t id = 0; id < kAllIds; ++id) {
        complaints_.Check(found[id] <= 1, "found twice");
        if (id >= kMoving) continue;
        complaints_.Check((found[id] == 1) == Touch(query, RestingBox(id)),
                          "resting body missed");
      }
      if (i % 8 == 0) QueryMore(query, resting);
    }
  }

  void Update(std::size_t thread) {
    Random random(300 + thread);
    for (std::size_t i = 0; i < Scaled(400); ++i) {
      if (random() % 16 == 0) {
        bodies_.Rebuild();
      } else {
        bodies_.Update();
      }
      if (thread == 0 && i % 4 == 0) pairs_.Update(bodies_);
      // Others find time to read a tree that is replaced.
      std::this_thread::yield();
    }
  }

  // When no other thread runs: as a list of where all bodies went last.
  void ExpectIsAsTheThreadsLeftIt() {
    BodyModel<AabbView3> model;
    for (std::uint32_t id = 0; id < kAllIds; ++id) {
      if (last_[id] != Aabb3::Empty()) model.objects[id] = {last_[id], {}};
    }
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      ExpectIsModel(bodies_, model, seed);
    }
    pairs_.Update(bodies_);
    EXPECT_EQ(pairs_.pairs(), model.Pairs());
    bodies_.Update();
    ExpectIsModel(bodies_, model, 5);
    EXPECT_EQ(bodies_.Statistics().trees, 1u);
  }

 private:
  static BroadPhaseOptions OptionsOf(float margin) {
    BroadPhaseOptions options;
    options.margin = margin;
    return options;
  }

  static bool Touch(const Aabb3& a, const Aabb3& b) {
    return BodyModel<AabbView3>::Overlap(a, b, 0);
  }

  void CheckBox(std::uint32_t id, const Aabb3& box) {
    complaints_.Check(IsBoxOf(id, box), "half of a move");
  }

  // The calling thread's own body, which no other thread moves.
  void ExpectFound(std::uint32_t id) {
    int found = 0;
    const std::uint64_t mask = id % 2 == 0 ? 1 : ~std::uint64_t{0};
    bodies_.ForEach(last_[id], mask,
                    [&](std::uint32_t other, const Aabb3& box) {
                      if (other != id) return;
                      ++found;
                      complaints_.Check(box == last_[id], "not where it went");
                    });
    complaints_.Check(found == 1, "lost by its mover");
  }

  // What an engine does in a callback.
  void CallBack(const Aabb3& box) {
    const std::scoped_lock lock(engine_);
    bodies_.ForEach(box, 1, [&](std::uint32_t id, const Aabb3& other) {
      CheckBox(id, other);
      return Visit::kStop;
    });
  }

  void QueryMore(const Aabb3& query, const Ids& resting) {
    std::vector<int> found(kMoving);
    bodies_.ForEachCast(query, {0, 50, 0}, 1, ~std::uint64_t{0},
                        [&](std::uint32_t id, float, const Aabb3& box) {
                          CheckBox(id, box);
                          if (id < kMoving) ++found[id];
                        });
    Aabb3 swept = query;
    swept.max[1] += 50;
    for (std::uint32_t id = 0; id < kMoving; ++id) {
      complaints_.Check((found[id] == 1) == Touch(swept, RestingBox(id)),
                        "cast missed a resting body");
    }
    IdPairs pairs;
    bodies_.ForEachPairOf(resting, 0, [&](std::uint32_t a, std::uint32_t b) {
      if (a >= kMoving || b >= kMoving) return;
      pairs.emplace_back(std::min(a, b), std::max(a, b));
    });
    std::sort(pairs.begin(), pairs.end());
    BodyModel<AabbView3> model;
    for (const std::uint32_t id : resting) {
      model.objects[id] = {RestingBox(id), {}};
    }
    complaints_.Check(pairs == model.Pairs(), "pairs of resting bodies");
    const Aabb3 bounds = bodies_.Bounds();
    for (const std::uint32_t id : resting) {
      complaints_.Check(Touch(bounds, RestingBox(id)), "outside all");
    }
  }

  AabbBroadPhase3 bodies_;
  std::vector<Aabb3> last_;  // each written by the thread that has the id
  PairsByEvents pairs_;      // of one updater
  std::mutex engine_;
  Complaints complaints_;
};

// Without a margin, queries read the bounds of the tree.
TEST(BroadPhaseThreadsTest, MovesQueriesAndChangesAtTheSameTime) {
  for (const float margin : {2.0f, 0.0f}) {
    BroadPhaseThreads test(margin);
    {
      std::vector<std::jthread> threads;
      const auto start = [&](std::size_t count, auto member) {
        for (std::size_t t = 0; t < count; ++t) {
          threads.emplace_back([&test, member, t] { (test.*member)(t); });
        }
      };
      start(kMovers, &BroadPhaseThreads::Move);
      start(kChangers, &BroadPhaseThreads::Change);
      start(kQueriers, &BroadPhaseThreads::Query);
      start(kUpdaters, &BroadPhaseThreads::Update);
    }
    test.ExpectIsAsTheThreadsLeftIt();
  }
}

// Without anything else, so that reads meet writes often.
TEST(BroadPhaseThreadsTest, ABoundIsReadAsItWasWritten) {
  AabbBroadPhase3 bodies(1);
  bodies.Insert(0, BoxOf(0, 0));
  std::atomic<bool> is_done{false};
  const std::jthread mover([&] {
    for (std::size_t i = 0; i < Scaled(300'000); ++i) {
      bodies.Move(0, BoxOf(0, i));
      if (i % 16 == 0) {
        bodies.SetMasks(0, {.category = i + 1, .collides_with = i + 1});
      }
    }
    is_done.store(true);
  });
  Complaints complaints;
  while (!is_done.load()) {
    complaints.Check(IsBoxOf(0, bodies.Get(0)), "half of a move");
    const BodyMasks masks = bodies.MasksOf(0);
    complaints.Check(
        masks == BodyMasks() || masks.category == masks.collides_with,
        "half of a mask");
  }
}

// A query that is running keeps its tree, and changes do not wait for it.
TEST(BroadPhaseThreadsTest, AFunctionMayChangeWhatIsQueried) {
  AabbBroadPhase3 bodies(2000);
  for (std::uint32_t id = 0; id < 1000; ++id) {
    bodies.Insert(id, BoxOf(id, id));
  }
  bodies.Update();
  std::size_t found = 0;
  bodies.ForEach(Aabb3::Everything(), 1,
                 [&](std::uint32_t id, const Aabb3& box) {
                   ++found;
                   bodies.Insert(1000 + id, box);
                   bodies.Move(id, BoxOf(id, id + 1));
                   if (id % 100 == 0) bodies.Rebuild();
                   if (id % 100 == 1)
                     bodies.UpdatePairs([](auto...) {}, [](auto...) {});
                   if (id % 3 == 0) bodies.Erase(id);
                 });
  EXPECT_EQ(found, 1000u);
  EXPECT_EQ(bodies.size(), 2000u - 334);
  EXPECT_GT(bodies.Statistics().trees, 1u);
  bodies.Update();
  EXPECT_EQ(bodies.Statistics().trees, 1u);
  EXPECT_TRUE(bodies.Validate());
}

// Enough bodies for several parts of both halves of UpdatePairs(). All of them
// move, first inside the margin and then beyond.
TEST(BroadPhaseThreadsTest, EventsDoNotDependOnTheRunner) {
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

}  // namespace
}  // namespace halfspace::testing

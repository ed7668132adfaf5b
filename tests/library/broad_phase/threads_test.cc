// Threads that move, query and change a broad phase at the same time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "dispatch/broad_phase/state.h"
#include "halfspace/error.h"
#include "halfspace/halfspace.h"
#include "tests/library/broad_phase/history.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// Each kind of thread has ids of its own, kIds of them.
constexpr std::size_t kMovers = 4;
constexpr std::size_t kChangers = 2;
constexpr std::size_t kQueriers = 4;
constexpr std::uint32_t kIds = 200;
constexpr std::uint32_t kChanging = kMovers * kIds;
constexpr std::uint32_t kAllIds = kChanging + kChangers * kIds;

// Bodies are in one of two places, so a query of both finds each body once. The
// boxes say whose they are, so that one of two moves would show.
Aabb3 PlaceOf(std::uint32_t id, bool is_second) {
  Aabb3 box;
  box.min = {is_second ? 60.0f : 0.0f, static_cast<float>(id % 101),
             static_cast<float>(id % 13)};
  const float size = is_second ? 3.0f + static_cast<float>(id % 5)
                               : 1.0f + static_cast<float>(id % 7);
  for (std::size_t k = 0; k < 3; ++k) box.max[k] = box.min[k] + size;
  return box;
}
bool IsPlaceOf(std::uint32_t id, const Aabb3& box) {
  return box == PlaceOf(id, false) || box == PlaceOf(id, true);
}
Aabb3 BothOf(std::uint32_t id) {
  return Merge(PlaceOf(id, false), PlaceOf(id, true));
}
bool Touch(const Aabb3& a, const Aabb3& b) {
  return !IsEmpty(Intersection(a, b));
}

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
  explicit BroadPhaseThreads(const BroadPhaseOptions& options)
      : bodies_(options), sees_moves_(options.moves_are_seen_at_once) {
    Ids ids;
    std::vector<Aabb3> boxes;
    for (std::uint32_t id = 0; id < kChanging; ++id) {
      ids.push_back(id);
      boxes.push_back(PlaceOf(id, false));
    }
    bodies_.Insert(ids, boxes);
  }

  // Moves bodies of its own, one or many, and finds them where they are.
  void Move(std::size_t thread) {
    Random random(thread);
    const auto first = static_cast<std::uint32_t>(thread * kIds);
    for (std::size_t i = 0; i < Scaled(4000); ++i) {
      Ids ids;
      std::vector<Aabb3> boxes;
      for (std::size_t n = random() % 8 == 0 ? 200 : 1; n-- > 0;) {
        const auto id = first + static_cast<std::uint32_t>(random() % kIds);
        ids.push_back(id);
        is_second_[id] = random() % 2 != 0;
        boxes.push_back(PlaceOf(id, is_second_[id]));
      }
      if (i % 3 == 0) {
        const std::scoped_lock lock(engine_);  // as Jolt does
        bodies_.Move(ids, boxes);
      } else {
        bodies_.Move(ids, boxes);
      }
      complaints_.Check(bodies_.Get(ids.back()) == boxes.back(), "not moved");
      ExpectFound(ids.back());
      // One whose move may be in the tree by now.
      ExpectFound(first + static_cast<std::uint32_t>(random() % kIds));
    }
  }

  // Inserts and erases bodies of its own.
  void Change(std::size_t thread) {
    Random random(100 + thread);
    const auto first = static_cast<std::uint32_t>(kChanging + thread * kIds);
    for (std::size_t i = 0; i < Scaled(600); ++i) {
      Ids ids;
      std::vector<Aabb3> boxes;
      const bool inserts = random() % 2 == 0;
      for (std::size_t n = random() % 8 == 0 ? 150 : 2; n-- > 0;) {
        const auto id = first + static_cast<std::uint32_t>(random() % kIds);
        if (is_there_[id] == inserts) continue;
        is_there_[id] = inserts;
        is_second_[id] = random() % 2 != 0;
        ids.push_back(id);
        boxes.push_back(PlaceOf(id, is_second_[id]));
      }
      if (inserts) {
        bodies_.Insert(ids, boxes);
      } else {
        bodies_.Erase(ids);
      }
      if (ids.empty()) continue;
      complaints_.Check(bodies_.Has(ids[0]) == inserts, "not as just changed");
      if (inserts) {
        bodies_.SetMasks(ids[0], {.category = 3});
        ExpectFound(ids[0]);
      }
    }
  }

  // Finds each body that moves in one of its places.
  void Query(std::size_t thread) {
    Random random(200 + thread);
    for (std::size_t i = 0; i < Scaled(1500); ++i) {
      const auto asked = static_cast<std::uint32_t>(random() % kChanging);
      const Aabb3 query = i % 16 == 0  ? Aabb3::Everything()
                          : i % 2 == 0 ? BothOf(asked)
                                       : PlaceOf(asked, i % 4 == 1);
      std::vector<int> found(kAllIds);
      std::size_t calls = 0;
      const auto check = [&](Span<const std::uint32_t> some) {
        for (const std::uint32_t id : some) ++found[id];
        if (calls++ == 0 && i % 3 == 0) CallBack(asked);
      };
      switch (random() % 5) {
        case 0:
        case 1:
          ForEachSurvivor(bodies_, query, check);
          break;
        case 2: {
          Ids ids(kAllIds);
          ids.resize(
              std::min<std::size_t>(kAllIds, Survivors(bodies_, query, ids)));
          check(ids);
          break;
        }
        case 3:
          BoxCast(bodies_, query, {0, 0, 0}, 1,
                  [&](std::uint32_t id, float, const Aabb3& box) {
                    complaints_.Check(IsPlaceOf(id, box), "half of a move");
                    check({&id, 1});
                  });
          break;
        default: {
          Ids ids(kAllIds);
          std::array<std::size_t, 2> offsets;
          const std::vector<Aabb3> queries = {query};
          ids.resize(SurvivorsOfEach(bodies_, queries, ids, offsets));
          check(ids);
        }
      }
      for (std::uint32_t id = 0; id < kAllIds; ++id) {
        complaints_.Check(found[id] <= 1, "found twice");
        const bool both =
            Touch(query, PlaceOf(id, false)) && Touch(query, PlaceOf(id, true));
        const bool none = !Touch(query, PlaceOf(id, false)) &&
                          !Touch(query, PlaceOf(id, true));
        complaints_.Check(!none || found[id] == 0, "does not touch");
        if (id >= kChanging) continue;
        complaints_.Check(!both || found[id] == 1, "missed");
      }
      complaints_.Check(IsPlaceOf(asked, bodies_.Get(asked)), "half of a move");
      if (i % 8 == 0) QueryMore(asked);
    }
  }

  void Update(std::size_t /*thread*/) {
    Random random(300);
    for (std::size_t i = 0; i < Scaled(400); ++i) {
      switch (random() % 16) {
        case 0:
          bodies_.Rebuild();
          break;
        case 1: {
          const AabbBroadPhase3 copy(bodies_);
          complaints_.Check(copy.Validate(), "a wrong copy");
          Check(copy);
          break;
        }
        case 2: {
          AabbBroadPhase3 loaded;
          loaded.Load(BytesOf(CoreOf(bodies_)));
          Check(loaded);
          break;
        }
        default:
          bodies_.Update();
      }
      if (i % 4 == 0) {
        UpdatePairs();
      }
      std::this_thread::yield();
    }
  }

  // When no other thread runs: as a list of where all bodies went last.
  void ExpectIsAsTheThreadsLeftIt() {
    BodyModel model;
    for (std::uint32_t id = 0; id < kAllIds; ++id) {
      if (id >= kChanging && !is_there_[id]) continue;
      model.Insert(id, PlanesOf(PlaceOf(id, is_second_[id])),
                   bodies_.MasksOf(id));
    }
    UpdatePairs();
    EXPECT_EQ(PairList(pairs_.begin(), pairs_.end()), model.Pairs());
    ExpectIsModel(CoreOf(bodies_), model, 5);
  }

 private:
  void UpdatePairs() {
    bodies_.UpdatePairs();
    for (const IdPair& pair : bodies_.ended()) {
      complaints_.Check(pairs_.erase({pair.a, pair.b}) == 1, "ended twice");
    }
    for (const IdPair& pair : bodies_.began()) {
      complaints_.Check(pairs_.emplace(pair.a, pair.b).second, "began twice");
    }
  }

  void Check(const AabbBroadPhase3& copy) {
    for (std::uint32_t id = 0; id < kAllIds; ++id) {
      complaints_.Check(id >= kChanging || copy.Has(id), "not copied");
      if (copy.Has(id)) {
        complaints_.Check(IsPlaceOf(id, copy.Get(id)), "copied in halves");
      }
    }
  }

  // The calling thread's own body, which no other thread moves.
  void ExpectFound(std::uint32_t id) {
    const Aabb3 place = PlaceOf(id, is_second_[id]);
    const Aabb3 query = sees_moves_ ? place : BothOf(id);
    int found = 0;
    QueryOptions options;
    if (id % 2 == 0) options.mask = 1;
    ForEachSurvivor(
        bodies_, query,
        [&](Span<const std::uint32_t> some) {
          found += static_cast<int>(std::count(some.begin(), some.end(), id));
        },
        options);
    complaints_.Check(found == 1, "lost by its mover");
    if (id % 4 != 0 || !sees_moves_) return;
    found = 0;
    const Ray3 ray{place.min, {1, 0, 0}, 0};
    RayCast(bodies_, ray, [&](std::uint32_t other, float, const Aabb3& box) {
      if (other != id) return;
      ++found;
      complaints_.Check(box == place, "not where it went");
    });
    complaints_.Check(found == 1, "not hit by its mover");
  }

  // What an engine does in a callback.
  void CallBack(std::uint32_t asked) {
    const std::scoped_lock lock(engine_);
    complaints_.Check(AnySurvivor(bodies_, BothOf(asked)).has_value(),
                      "none in a callback");
    complaints_.Check(CountSurvivors(bodies_, Aabb3::Everything()) >= kChanging,
                      "missed in a callback");
  }

  void QueryMore(std::uint32_t asked) {
    Ids nearest(kAllIds);
    const std::size_t count =
        KNearest(bodies_, BothOf(asked), nearest, {}, 0.0f);
    complaints_.Check(
        std::count(nearest.begin(), nearest.begin() + static_cast<int>(count),
                   asked) == 1,
        "not near");
    // It and the body of the same places, if it is in the same one.
    const Ids set = {asked};
    ForEachPairOf(bodies_, set, [&](Span<const IdPair> some) {
      for (const IdPair& pair : some) {
        complaints_.Check(pair.a == asked, "a is not of the set");
        complaints_.Check(Touch(BothOf(pair.a), BothOf(pair.b)),
                          "a pair of bodies that never met");
      }
    });
    const Aabb3 bounds = bodies_.Bounds();
    complaints_.Check(Touch(bounds, PlaceOf(asked, false)) ||
                          Touch(bounds, PlaceOf(asked, true)),
                      "outside all");
    // It may be there or not, but this is no reason to fail otherwise.
    const auto id =
        static_cast<std::uint32_t>(kChanging + asked % (kChangers * kIds));
    try {
      const BodyMasks masks = bodies_.MasksOf(id);
      complaints_.Check(masks.collides_with == 0xFFFFFFFF, "no mask");
      complaints_.Check(IsPlaceOf(id, bodies_.Get(id)), "no bound");
    } catch (const halfspace::Error&) {
    }
  }

  AabbBroadPhase3 bodies_;
  const bool sees_moves_;
  // Each written by the thread that has the id.
  std::array<bool, kAllIds> is_second_{};
  std::array<bool, kAllIds> is_there_{};
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs_;  // by the events
  std::mutex engine_;
  Complaints complaints_;
};

TEST(BroadPhaseThreadsTest, MovesQueriesAndChangesAtTheSameTime) {
  for (const bool moves_wait : {false, true}) {
    BroadPhaseOptions options;
    options.moves_are_seen_at_once = !moves_wait;
    BroadPhaseThreads test(options);
    std::vector<std::thread> threads;
    // At first each thread has a line of the lock for itself. After so many
    // threads all new ones share a line.
    for (std::size_t t = 0; moves_wait && t < 64; ++t) {
      std::thread([] {
        (void)CountSurvivors(AabbBroadPhase3(), Aabb3());
      }).join();
    }
    const auto start = [&](std::size_t count, auto member) {
      for (std::size_t t = 0; t < count; ++t) {
        threads.emplace_back([&test, member, t] { (test.*member)(t); });
      }
    };
    start(kMovers, &BroadPhaseThreads::Move);
    start(kChangers, &BroadPhaseThreads::Change);
    start(kQueriers, &BroadPhaseThreads::Query);
    start(1, &BroadPhaseThreads::Update);
    for (std::thread& thread : threads) thread.join();
    test.ExpectIsAsTheThreadsLeftIt();
  }
}

// Without anything else, so that moves meet flushes often: no move is lost, and
// no half of one is read.
TEST(BroadPhaseThreadsTest, AMoveThatMeetsAFlushIsNotLost) {
  constexpr std::uint32_t kCount = 64 * 4;
  AabbBroadPhase3 bodies({.moves_are_seen_at_once = true});
  for (std::uint32_t id = 0; id < kCount; ++id) {
    bodies.Insert(id, PlaceOf(id, false));
  }
  Complaints complaints;
  std::atomic<bool> is_done{false};
  {
    std::vector<std::thread> movers;
    for (std::uint32_t thread = 0; thread < 2; ++thread) {
      movers.emplace_back([&, thread] {
        bool is_second = false;
        for (std::size_t i = 0; i < Scaled(100'000); ++i) {
          // Neighbors, of which the threads move every second one.
          const auto id = static_cast<std::uint32_t>(2 * i + thread) % kCount;
          if (id < 2) is_second = !is_second;
          bodies.Move(id, PlaceOf(id, is_second));
          Ids ids(kCount);
          ids.resize(Survivors(bodies, PlaceOf(id, is_second), ids));
          complaints.Check(std::count(ids.begin(), ids.end(), id) == 1,
                           "lost by its mover");
        }
        is_done.store(true);
      });
    }
    while (!is_done.load()) {
      bodies.Update();
      for (std::uint32_t id = 0; id < kCount; ++id) {
        complaints.Check(IsPlaceOf(id, bodies.Get(id)), "half of a move");
      }
    }
    for (std::thread& mover : movers) mover.join();
  }
  EXPECT_TRUE(bodies.Validate());
}

// The function of a query can wait for a change of another thread, such as one
// that holds a lock which the function needs.
TEST(BroadPhaseThreadsTest, TheFunctionOfAQueryMayWaitForAChange) {
  AabbBroadPhase3 bodies;
  for (std::uint32_t id = 0; id < 100; ++id) {
    bodies.Insert(id, PlaceOf(id, false));
  }
  for (const auto& [name, call] : CallsThatRunAlone(bodies)) {
    std::size_t calls = 0;
    const auto function = [&](auto...) {
      if (calls++ == 0) std::thread(call).join();
    };
    ForEachSurvivor(bodies, Aabb3::Everything(), function);
    EXPECT_GT(calls, 0u) << name;
  }
  std::size_t calls = 0;
  BoxCast(bodies, Aabb3::Everything(), {0, 0, 0}, 1, [&](std::uint32_t, float) {
    if (calls++ == 0) std::thread([&] { bodies.Rebuild(); }).join();
  });
  EXPECT_EQ(calls, bodies.size());
}

// As after a query and an update that have waited for each other.
TEST(BroadPhaseThreadsTest, QueriesGoOnDuringAnUpdate) {
  constexpr std::uint32_t kCount = 4096;
  const auto box_at = [](std::uint32_t place) {
    const auto x = static_cast<float>(place);
    return Aabb3{{x, 0, 0}, {x + 0.5f, 1, 1}};
  };
  Ids ids;
  std::vector<Aabb3> before;
  std::vector<Aabb3> after;
  for (std::uint32_t id = 0; id < kCount; ++id) {
    ids.push_back(id);
    before.push_back(box_at(id));
    // In neighbors that are far apart: all have to be sorted again.
    after.push_back(box_at(id * 1021 % kCount));
  }
  AabbBroadPhase3 bodies;
  const auto expect_at = [&](const std::vector<Aabb3>& boxes) {
    std::thread([&] {
      for (std::uint32_t id = 0; id < kCount; id += 99) {
        Ids found(4);
        found.resize(Survivors(bodies, boxes[id], found));
        EXPECT_EQ(found, Ids{id});
      }
    }).join();
  };
  bodies.Insert(ids, before);
  bodies.Rebuild();
  const std::size_t bytes = bodies.Statistics().bytes;
  CoreOf(bodies).state().beside = 2;
  std::size_t runs = 0;
  const auto run = [&](std::size_t count, const Runner::Part& part) {
    if (runs++ == 0) expect_at(before);
    for (std::size_t i = 0; i < count; ++i) part(i);
  };
  bodies.Move(ids, after);
  bodies.Update({.budget = kCount, .run = run});
  EXPECT_GT(runs, 0u);
  EXPECT_GT(bodies.Statistics().bytes, bytes);
  expect_at(after);
  // Also during a search for pairs, at once at the new bounds.
  runs = 0;
  bodies.Move(ids, before);
  bodies.UpdatePairs([&](std::size_t count, const Runner::Part& part) {
    if (runs++ == 0) expect_at(before);
    for (std::size_t i = 0; i < count; ++i) part(i);
  });
  EXPECT_GT(runs, 0u);
  // Nothing has waited since, so the copy is no longer needed.
  EXPECT_LE(bodies.Statistics().bytes - 8 * bodies.Statistics().pairs, bytes);
}

}  // namespace
}  // namespace halfspace::testing

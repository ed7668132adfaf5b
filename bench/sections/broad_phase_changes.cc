#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/machine.h"
#include "bench/measure/team.h"
#include "bench/sections/broad_phase_parts.h"
#include "halfspace/broad_phase.h"
#include "halfspace/bvh_pairs.h"

namespace halfspace::bench {
namespace {

using Ids = std::vector<std::uint32_t>;
using Ns = std::vector<double>;

// CPU time of this thread in ns, without that of two looks at the clock.
template <typename Work>
double NsOf(Work work) {
  const auto time = [](auto timed) {
    const double start = ThreadSeconds();
    timed();
    return 1e9 * (ThreadSeconds() - start);
  };
  static const double clock = [&] {
    double least = time([] {});
    for (int i = 0; i < 1000; ++i) least = std::min(least, time([] {}));
    return least;
  }();
  return std::max(0.0, time(work) - clock);
}

Ns Less(Ns a, const Ns& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}
Ns Divided(Ns a, double by) {
  for (double& x : a) x /= by;
  return a;
}

// One scene: a broad phase and a Bvh of the same bodies.
template <int kDims>
class BodyChanges {
  using Scene = BodyScene<kDims>;
  using Box = Aabb<kDims>;
  using Boxes = std::vector<Box>;
  using Space = BroadPhase<AabbView<kDims>>;
  using Tree = Bvh<AabbView<kDims>>;

 public:
  BodyChanges(BodyKind kind, std::size_t bodies, std::uint64_t seed,
              Throughput& throughput, BroadPhaseResult& result)
      : kind_(kind),
        scene_(kind, bodies, seed),
        throughput_(throughput),
        result_(result),
        random_(seed + 4),
        all_(scene_.AllIds()),
        boxes_(scene_.At(all_, 0)),
        tree_(boxes_),
        world_(std::string(NameOf(kind)) + (kDims == 2 ? " 2D" : " 3D")) {
    space_.Insert(all_, boxes_);
    space_.Rebuild();
  }

  // Some bodies move, the same ones in each frame. Each step is timed by
  // itself, the two worlds in turns.
  void RunFrames(std::size_t percent) {
    const Ids moved = percent == 100 ? all_ : scene_.Some(percent);
    if (moved.empty()) return;
    const bool are_all = moved.size() == all_.size();
    std::vector<Boxes> states;
    for (std::size_t s = 0; s < Scene::kStates; ++s) {
      states.push_back(scene_.At(moved, s));
    }
    std::vector<IdPair> pairs(Pairs(tree_, {}) + all_.size());
    enum Step { kPlainChange, kPlainSearch, kChange, kSearch, kEvents, kSteps };
    std::array<Ns, kSteps> ns;
    std::array<std::size_t, kSteps> found{};
    const auto run = [&](std::size_t step, const Boxes& boxes) {
      switch (step) {
        case kPlainChange:
          ChangeTree<kDims>(tree_, moved, boxes);
          break;
        case kPlainSearch:
          found[step] =
              are_all ? Pairs(tree_, pairs) : PairsOf(tree_, moved, pairs);
          break;
        case kChange:
          space_.Move(moved, boxes);
          space_.Update();
          break;
        case kSearch:
          found[step] = PairsOf(space_, moved, pairs);
          break;
        default:
          space_.UpdatePairs();
          found[step] = space_.pairs().size();
      }
    };
    const std::size_t frames =
        throughput_.is_quick()
            ? 3
            : std::clamp<std::size_t>((1u << 20) / all_.size(), 33, 400);
    for (std::size_t f = 0; f < frames + 2; ++f) {
      const std::size_t turn = f % (2 * Scene::kStates - 2);
      const Boxes& boxes =
          states[std::min(turn, 2 * Scene::kStates - 2 - turn)];
      // The broad phase comes first in every other frame.
      for (std::size_t i = 0; i < kSteps; ++i) {
        const std::size_t step = f % 2 == 0 ? i : (i < 3 ? kChange + i : i - 3);
        const double time = NsOf([&] { run(step, boxes); });
        if (f >= 2) ns[step].push_back(time);
      }
      const std::size_t expected = Pairs(tree_, {});
      if (found[kSearch] != found[kPlainSearch] || found[kEvents] != expected) {
        throw WrongAnswer("broad_phase: the pairs are not those of a Bvh");
      }
    }
    const std::string what = "frame of " + std::to_string(percent) + " %, ";
    const bool has_aims = all_.size() >= 1000;
    Add(what + "move and update", moved.size(), ns[kChange], ns[kPlainChange],
        !has_aims       ? nullptr
        : are_all       ? &aims::kChangeOfAll
        : percent == 10 ? &aims::kChangeOfTenth
                        : &aims::kChangeOfHundredth);
    Add(what + "pairs", moved.size(), ns[kSearch], ns[kPlainSearch],
        has_aims ? &aims::kBodyPairs : nullptr);
    const bool is_pile = kind_ == BodyKind::kPile;
    const bool has_events = percent > 1 && (is_pile || kind_ == BodyKind::kGas);
    Add(what + "pairs and events", moved.size(), ns[kEvents], ns[kPlainSearch],
        !has_aims || !has_events ? nullptr
        : is_pile                ? &aims::kEventsOfPile
                                 : &aims::kEvents);
    if (percent > 1 || !has_aims || found[kEvents] == 0) return;
    AddAim(aims::kKeptPair, what + "events: ns of a kept pair",
           Divided(Less(ns[kEvents], ns[kSearch]),
                   static_cast<double>(found[kEvents])));
  }

  // Bodies that do not move, and moves by themselves.
  void RunMoves() {
    const Boxes moved = scene_.At(all_, 1);
    Ns still;
    Ns list;
    Ns single;
    Repeat([&] {
      still.push_back(NsOf([&] {
        space_.Move(all_, boxes_);
        space_.Update();
      }));
      list.push_back(NsOf([&] { space_.Move(all_, moved); }));
      space_.Update();
      single.push_back(NsOf([&] {
        for (std::size_t i = 0; i < all_.size(); ++i) {
          space_.Move(all_[i], boxes_[i]);
        }
      }));
      space_.Update();
    });
    Add("moves of a list", all_.size(), list);
    Add("single moves", all_.size(), single);
    Add("still bodies, move and update", all_.size(), still);
    AddAim(aims::kStillBody, "still bodies: ns of a body",
           Divided(still, static_cast<double>(all_.size())));
  }

  // A move before each query.
  void RunAlternation(bool is_of_few) {
    constexpr std::size_t kSteps = 4096;
    Boxes queries;
    Ids moved;
    for (std::size_t i = 0; i < kSteps; ++i) {
      queries.push_back(scene_.AnyBox(2, random_));
      moved.push_back(static_cast<std::uint32_t>(random_.Below(
          is_of_few ? std::min<std::size_t>(8, all_.size()) : all_.size())));
    }
    const std::array<Boxes, 2> places = {scene_.At(moved, 1),
                                         scene_.At(moved, 0)};
    std::array<Ns, 3> ns;
    std::array<std::size_t, 2> found{};
    std::size_t turn = 0;
    Repeat([&] {
      const Boxes& to = places[turn++ % 2];
      found = {};
      for (std::size_t way = 0; way < 3; ++way) {
        ns[way].push_back(NsOf([&] {
          for (std::size_t i = 0; i < kSteps; ++i) {
            if (way == 0) {
              space_.Move(moved[i], to[i]);
              found[0] += CountOf(space_, queries[i]);
            } else if (way == 1) {
              tree_.Set(moved[i], to[i]);
              found[1] += CountOf(tree_, queries[i]);
            } else {
              KeepResult(
                  static_cast<std::uint32_t>(CountOf(space_, queries[i])));
            }
          }
        }));
      }
      if (found[0] != found[1]) {
        throw WrongAnswer("broad_phase: a query misses a move");
      }
    });
    const std::string what = std::string("move of ") +
                             (is_of_few ? "one of 8" : "any body") +
                             " and a query";
    Add(what, kSteps, ns[0], ns[1], is_of_few ? nullptr : &aims::kMoveOfAny);
    if (is_of_few) {
      AddAim(aims::kMoveOfFew, what + ": ns more than the query",
             Divided(Less(ns[0], ns[2]), kSteps));
    }
    space_.Move(all_, boxes_);
    space_.Update();
    tree_.Refit(boxes_);
  }

  // 16 bodies at a time leave and come back, and all of them.
  void RunInserts() {
    constexpr std::size_t kSome = 16;
    for (const std::size_t count : {kSome, all_.size()}) {
      Ns inserts;
      Ns erasures;
      for (std::size_t r = 0; r < 10 * throughput_.repetitions(); ++r) {
        Ids some = all_;
        if (count < all_.size()) {
          for (std::size_t i = 0; i < count; ++i) {
            std::swap(some[i], some[i + random_.Below(some.size() - i)]);
          }
          some.resize(count);
        } else if (r >= 5) {
          break;
        }
        Boxes boxes;
        for (std::uint32_t id : some) boxes.push_back(boxes_[id]);
        erasures.push_back(NsOf([&] {
          space_.Erase(some);
          space_.Update();
        }));
        inserts.push_back(NsOf([&] {
          space_.Insert(some, boxes);
          space_.Update();
        }));
      }
      const std::string of = count == kSome ? " of 16" : " of all";
      for (const auto& [what, ns] :
           {std::pair("insert", &inserts), std::pair("erasure", &erasures)}) {
        Add(what + of + ", and update", count, *ns);
        if (count != kSome) continue;
        AddAim(aims::kChangeOfFew, what + of + ": ns of a body",
               Divided(*ns, static_cast<double>(kSome)));
      }
    }
  }

  // Queries after many bodies were erased and inserted elsewhere.
  void RunDecay(std::size_t changes) {
    Boxes places = boxes_;
    const std::size_t in_frame = std::max<std::size_t>(1, all_.size() / 64);
    for (std::size_t done = 0; done < changes; done += in_frame) {
      // Neighbours by id are not neighbours in space.
      const std::size_t first = random_.Below(all_.size() - in_frame + 1);
      for (std::size_t i = first; i < first + in_frame; ++i) {
        places[i] = scene_.AnyBox(1 + 0.5f * random_.Signed(), random_);
      }
      const Span<const std::uint32_t> some(all_.data() + first, in_frame);
      space_.Erase(some);
      space_.Insert(some, Span<const Box>(places.data() + first, in_frame));
      space_.Update();
    }
    Space rebuilt;
    rebuilt.Insert(all_, places);
    rebuilt.Rebuild();
    Boxes queries;
    for (std::size_t q = 0; q < kTimedQueries; ++q) {
      queries.push_back(scene_.AnyBox(2, random_));
    }
    std::array<Ns, 2> ns;
    std::array<std::size_t, 2> found{};
    Repeat([&] {
      found = {};
      for (std::size_t i = 0; i < 2; ++i) {
        ns[i].push_back(NsOf([&] {
          for (const Box& query : queries) {
            found[i] += CountOf(i == 0 ? space_ : rebuilt, query);
          }
        }));
      }
      if (found[0] != found[1]) {
        throw WrongAnswer("broad_phase: queries after many changes differ");
      }
    });
    AddAim(aims::kDecay,
           "queries after " + Grouped(changes) +
               " erasures and inserts: time / time after a rebuild",
           RatioOf(ns[0], ns[1]));
  }

  // Bodies cross the world and turn back at its walls.
  void RunLongestUpdate() {
    Ns ns;
    const std::size_t frames = throughput_.is_quick() ? 50 : 1000;
    for (std::size_t f = 1; f <= frames; ++f) {
      space_.Move(all_, scene_.Within(f));
      ns.push_back(NsOf([&] { space_.Update(); }));
    }
    const double median = RangeOf(ns).median;
    AddAim(aims::kLongestUpdate,
           "longest Update() of " + std::to_string(frames) +
               " frames over the median",
           *std::max_element(ns.begin(), ns.end()) / median);
    space_.Move(all_, boxes_);
    space_.Rebuild();
  }

  // Each thread has a half of the bodies, and queries around these. CPU time,
  // so that other programs do not count.
  void RunThreads() {
    if (UsableCpus() < 2) {
      throughput_.NotReached("two threads: this run may use one CPU");
      return;
    }
    const Boxes moved = scene_.At(all_, 1);
    Space waits({.moves_wait_for_update = true});
    waits.Insert(all_, boxes_);
    waits.Update();
    const auto move = [&](Space& space, std::size_t begin, std::size_t end,
                          const Boxes& to) {
      space.Move({all_.data() + begin, end - begin},
                 {to.data() + begin, end - begin});
    };
    // Two threads share a piece of work, or one thread does all of it.
    const auto halves = [&](std::size_t threads, std::size_t thread,
                            const auto& work) {
      const std::size_t middle = all_.size() / 2;
      if (threads == 1 || thread == 0) work(std::size_t{0}, middle);
      if (threads == 1 || thread == 1) work(middle, all_.size());
    };
    const auto queries = [&](const auto& world, std::size_t begin,
                             std::size_t end) {
      std::size_t found = 0;
      for (std::size_t i = begin; i < end; ++i) {
        found += CountOf(world, moved[i]);
      }
      KeepResult(static_cast<std::uint32_t>(found));
    };
    const auto mixed = [&](Space& space, std::size_t begin, std::size_t end) {
      constexpr std::size_t kSome = 16;
      for (const Boxes* to : {&moved, &std::as_const(boxes_)}) {
        for (std::size_t i = begin; i < end; i += kSome) {
          const std::size_t last = std::min(i + kSome, end);
          move(space, i, last, *to);
          queries(space, i, last);
        }
      }
    };
    try {
      AddThreads(
          aims::kTwoThreads, "two threads in phases",
          [&](std::size_t threads, std::size_t thread) {
            halves(threads, thread, [&](std::size_t b, std::size_t e) {
              move(space_, b, e, moved);
            });
          },
          [&] { space_.Update(); },
          [&](std::size_t threads, std::size_t thread) {
            halves(threads, thread, [&](std::size_t b, std::size_t e) {
              queries(space_, b, e);
            });
          },
          [&] {
            space_.Move(all_, boxes_);
            space_.Update();
          });
      const auto nothing = [](auto...) {};
      for (Space* space : {&waits, &space_}) {
        AddThreads(
            space == &waits ? aims::kTwoThreads : aims::kTwoThreadsMixed,
            std::string("two threads that move and query all the time") +
                (space == &waits ? ", moves wait for Update()" : ""),
            [&](std::size_t threads, std::size_t thread) {
              halves(threads, thread, [&](std::size_t b, std::size_t e) {
                mixed(*space, b, e);
              });
            },
            nothing, nothing, [&] { space->Update(); });
      }
      std::array<Ns, 2> ns;
      Repeat([&] {
        const auto time = [&](const auto& world) {
          std::array<double, 2> of_thread{};
          RunTeam(2, [&](std::size_t thread) {
            of_thread[thread] = NsOf([&] { queries(world, 0, all_.size()); });
          });
          return std::max(of_thread[0], of_thread[1]);
        };
        ns[0].push_back(time(space_));
        ns[1].push_back(time(tree_));
      });
      AddAim(aims::kLockOfTwo, "queries of two threads: ns over a Bvh",
             Divided(Less(ns[0], ns[1]), static_cast<double>(all_.size())));
    } catch (const std::system_error& error) {
      throughput_.NotReached(std::string("two threads: ") + error.what());
    }
  }

  void AddBytes() {
    const auto bytes = [&](const Space& space) {
      return static_cast<double>(space.Statistics().bytes);
    };
    const auto of_body = [&](const Space& space) {
      return bytes(space) / static_cast<double>(all_.size()) - sizeof(Box);
    };
    Space space;
    space.Insert(all_, boxes_);
    space.Move(all_, scene_.At(all_, 1));
    space.Update();
    const double before = bytes(space);
    AddAim(aims::kBytesOfBody, "bytes of a body beyond its bound",
           of_body(space));
    space.UpdatePairs();
    AddAim(aims::kBytesOfPair, "bytes of a pair",
           (bytes(space) - before) / static_cast<double>(space.pairs().size()));
    Space masked;
    masked.Insert(all_, boxes_,
                  std::vector<BodyMasks>(all_.size(), BodyMasks{1, 1}));
    AddAim(aims::kBytesWithMasks, "bytes of a body with masks beyond its bound",
           of_body(masked));
  }

 private:
  template <typename World>
  static std::size_t CountOf(const World& world, const Box& query) {
    std::size_t count = 0;
    ForEachSurvivor(world, query, [&](Span<const std::uint32_t> ids) {
      count += ids.size();
    });
    return count;
  }

  template <typename Work>
  void Repeat(Work work) const {
    for (std::size_t r = 0; r < 3 * throughput_.repetitions(); ++r) work();
  }

  // First and last run in each of the threads, with `alone` between them.
  template <typename First, typename Alone, typename Last, typename Reset>
  void AddThreads(const Aim& aim, const std::string& what, const First& first,
                  const Alone& alone, const Last& last, const Reset& reset) {
    std::array<Ns, 2> ns;
    Repeat([&] {
      for (std::size_t threads : {1, 2}) {
        double sum = 0;
        const auto run = [&](const auto& work) {
          std::array<double, 2> of_thread{};
          RunTeam(threads, [&](std::size_t thread) {
            of_thread[thread] = NsOf([&] { work(threads, thread); });
          });
          sum += std::max(of_thread[0], of_thread[1]);
        };
        run(first);
        sum += NsOf(alone);
        run(last);
        ns[threads - 1].push_back(sum);
        reset();
      }
    });
    AddAim(aim, what + ": times the rate of one, by CPU time",
           RatioOf(ns[0], ns[1]));
  }

  void Add(const std::string& what, std::size_t bodies, const Ns& ours,
           const Ns& plain = {}, const Aim* aim = nullptr) {
    const auto of_body = [bodies](const Ns& ns) {
      return SpreadOf({"", Divided(ns, static_cast<double>(bodies))});
    };
    Row row = {what, world_, all_.size(), of_body(ours), Cell(), Cell()};
    if (!plain.empty()) {
      row[4] = of_body(plain);
      row[5] = RatioOf(ours, plain);
      if (aim != nullptr) AddAim(*aim, what + ": time over a Bvh", row[5]);
    }
    result_.changes.Add(std::move(row));
  }
  void AddAim(const Aim& aim, const std::string& what, const Cell& value) {
    throughput_.AddRatio(aim, ChosenTarget(),
                         world_ + " " + Grouped(all_.size()) + ", " + what,
                         value);
  }
  void AddAim(const Aim& aim, const std::string& what, const Ns& ns) {
    AddAim(aim, what, Cell(SpreadOf({"", ns})));
  }

  BodyKind kind_;
  Scene scene_;
  Throughput& throughput_;
  BroadPhaseResult& result_;
  Random random_;
  Ids all_;
  Boxes boxes_;
  Tree tree_;
  Space space_;
  std::string world_;
};

template <int kDims>
void AddFrames(std::size_t most, std::uint64_t seed, BroadPhaseResult& result,
               ThroughputParts& parts) {
  for (BodyKind kind : {BodyKind::kGas, BodyKind::kSparse, BodyKind::kPile,
                        BodyKind::kLogNormal, BodyKind::kBepu}) {
    for (std::size_t bodies : {100, 1024, 4096, 16384, 65536}) {
      if (bodies > most) continue;
      parts.push_back([=, &result](Throughput& to) {
        for (std::size_t percent : {1, 10, 100}) {
          BodyChanges<kDims>(kind, bodies, seed, to, result).RunFrames(percent);
        }
      });
    }
  }
}

}  // namespace

void AddBodyChanges(std::size_t most, std::uint64_t seed,
                    BroadPhaseResult& result, ThroughputParts& parts) {
  AddFrames<3>(most, seed, result, parts);
  AddFrames<2>(most, seed, result, parts);
  for (std::size_t bodies : {1024, 4096, 16384, 65536}) {
    if (bodies > most) continue;
    parts.push_back([=, &result](Throughput& to) {
      BodyChanges<3> changes(BodyKind::kGas, bodies, seed, to, result);
      changes.RunMoves();
      if (bodies >= 4096 || to.is_quick()) changes.RunLongestUpdate();
      changes.RunThreads();
      changes.AddBytes();
      if (bodies == most) {
        changes.RunAlternation(true);
        changes.RunAlternation(false);
        changes.RunInserts();
      }
      if (bodies == std::min<std::size_t>(most, 16384)) {
        changes.RunDecay(to.is_quick() ? 10'000 : 1'000'000);
      }
    });
  }
}

}  // namespace halfspace::bench

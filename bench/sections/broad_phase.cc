// BroadPhase next to the broad phases of other libraries and to a plain Bvh.
#include "halfspace/broad_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/body_space.h"
#include "bench/measure/team.h"
#include "bench/sections/contest.h"
#include "bench/sections/sections.h"
#include "bench/worlds/body_scene.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_pairs.h"

namespace halfspace::bench {
namespace {

using Ids = std::vector<std::uint32_t>;
using Ns = std::vector<double>;

struct Result {
  Table times{"broad_phase",
              "frames, next to the broad phases of others",
              {Key("world"), Key("bodies"), Key("what"), Key("by"),
               Lower("time", "us", 3), Higher("times the fastest")}};
  Table changes{
      "broad_phase: changes",
      "next to the same of a Bvh",
      {Key("what"), Key("world"), Key("bodies"), Lower("time", "ns/body", 1),
       Value("Bvh", "ns/body", 1), Lower("over the Bvh")}};
};

// Gives bodies other bounds. A Bvh sorts about a 16th of its objects if the
// order has decayed, as BroadPhase::Update() does. All ids are 0, 1, and so on.
template <int kDims>
void Change(BroadPhase<AabbView<kDims>>& world,
            std::span<const std::uint32_t> ids,
            std::span<const Aabb<kDims>> boxes) {
  world.Move(ids, boxes);
  world.Update();
}
template <int kDims>
void Change(Bvh<AabbView<kDims>>& tree, std::span<const std::uint32_t> ids,
            std::span<const Aabb<kDims>> boxes) {
  if (ids.size() == tree.size()) {
    tree.Refit(boxes);
  } else {
    tree.Set(ids, boxes);
  }
  if (tree.CostRatio() > 1.25) {
    tree.RebuildPartial(std::max<std::size_t>(1, tree.size() / 16));
  }
}

template <int kDims, typename World>
class OurSpace : public BodySpace<kDims> {
  using Base = BodySpace<kDims>;
  using typename Base::Boxes;
  using typename Base::Ids;

 public:
  OurSpace(std::size_t bodies, World world)
      : Base(bodies), world_(std::move(world)) {}

  void Insert(Ids ids, Boxes boxes) override {
    if constexpr (std::is_same_v<World, Bvh<AabbView<kDims>>>) {
      world_ = World(boxes);
    } else {
      world_.Insert(ids, boxes);
      world_.Update();
    }
  }
  void Step(Ids ids, Boxes boxes) override {
    Change<kDims>(world_, ids, boxes);
  }
  void PairsOf(Ids ids, std::vector<IndexPair>& found) override {
    ForEachPairOf(world_, ids, [&](Span<const IdPair> pairs) {
      for (const IdPair& pair : pairs) found.push_back({pair.a, pair.b});
    });
  }

 private:
  World world_;
};

// All broad phases on one scene.
template <int kDims>
class BodyContest {
  using Box = Aabb<kDims>;
  using Boxes = std::vector<Box>;
  using Scene = BodyScene<kDims>;
  using Space = BodySpace<kDims>;

 public:
  BodyContest(Run& run, BodyKind kind, std::size_t bodies, Result& result)
      : run_(run),
        scene_(kind, bodies, run.options.seed),
        result_(result),
        world_(std::string(NameOf(kind)) + (kDims == 2 ? " 2D" : " 3D")),
        all_(scene_.AllIds()) {
    const auto add = [&](std::string name, Who who,
                         std::unique_ptr<Space> space) {
      space->Insert(all_, scene_.At(all_, 0));
      contestants_.push_back({std::move(name), who, std::move(space), 0});
    };
    const auto add_ours = [&](const char* name, auto world) {
      add(name, Who::kOurs,
          std::make_unique<OurSpace<kDims, decltype(world)>>(bodies,
                                                             std::move(world)));
    };
    using View = AabbView<kDims>;
    add_ours("halfspace", BroadPhase<View>());
    add_ours("halfspace, caller's lock",
             BroadPhase<View>({.caller_locks = true}));
    add_ours("halfspace Bvh", Bvh<View>());
    for (const auto& competitor : Registered<Space>::All()) {
      if (bodies > competitor.most) continue;
      add(competitor.name, Who::kCompetitor, competitor.make(bodies));
    }
  }

  // A frame: `percent` of the bodies move, and then the pairs of these are
  // listed.
  void RunFrames(std::size_t percent) {
    const Ids moved = percent == 100 ? all_ : scene_.Some(percent);
    if (moved.empty()) return;
    std::vector<Boxes> frames;
    for (std::size_t s = 0; s < Scene::kStates; ++s) {
      frames.push_back(scene_.At(moved, s));
    }
    constexpr std::size_t kBodiesOfRun = 16384;
    const std::size_t frames_of_run =
        std::clamp<std::size_t>(kBodiesOfRun / scene_.size(), 2, 32);
    const std::string what = "frame of " + std::to_string(percent) + " %";
    Contest contest(run_, PlaceOf(what));
    for (Contestant& contestant : contestants_) {
      const auto frame = [this, &contestant, &moved, &frames] {
        // Through the states and back.
        constexpr std::size_t kLast = Scene::kStates - 1;
        const std::size_t turn = ++contestant.frame % (2 * kLast);
        const std::size_t state = std::min(turn, 2 * kLast - turn);
        contestant.space->Step(moved, frames[state]);
        found_.clear();
        contestant.space->PairsOf(moved, found_);
        return state;
      };
      Case c;
      c.items = static_cast<double>(frames_of_run);
      c.check = [this, frame, &contestant, &moved] {
        return CheckPairs(moved, frame(), contestant.space->Slack());
      };
      c.run = [frame, frames_of_run] {
        for (std::size_t f = 0; f < frames_of_run; ++f) std::ignore = frame();
      };
      contest.Add(contestant.name, "", contestant.who, std::move(c));
    }
    Time(contest, what);
  }

 private:
  struct Contestant {
    std::string name;
    Who who;
    std::unique_ptr<Space> space;
    std::size_t frame;
  };

  std::string PlaceOf(const std::string& what) const {
    return "broad_phase/" + world_ + "/" + std::to_string(scene_.size()) + "/" +
           what;
  }

  // Whether boxes touch that are smaller by this share of their distance from
  // 0.
  static bool TouchesWell(const Box& a, const Box& b, float share) {
    float square = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      const float far = std::max(std::abs(a.min[k]), std::abs(a.max[k])) +
                        std::max(std::abs(b.min[k]), std::abs(b.max[k]));
      square += far * far;
    }
    Box less = a;
    for (std::size_t k = 0; k < kDims; ++k) {
      less.min[k] += share * std::sqrt(square);
      less.max[k] -= share * std::sqrt(square);
    }
    return Touches(less, b);
  }

  std::string CheckPairs(const Ids& moved, std::size_t state, float slack) {
    Boxes boxes = scene_.At(all_, 0);
    const Boxes now = scene_.At(moved, state);
    std::vector<bool> is_moved(boxes.size());
    for (std::size_t i = 0; i < moved.size(); ++i) {
      boxes[moved[i]] = now[i];
      is_moved[moved[i]] = true;
    }
    const Bvh<AabbView<kDims>> bvh(boxes);
    std::vector<IdPair> all(Pairs(bvh, {}));
    std::ignore = Pairs(bvh, all);
    std::vector<IndexPair> expected;
    for (const IdPair& pair : all) {
      if (is_moved[pair.a] || is_moved[pair.b]) {
        expected.push_back({pair.a, pair.b});
      }
    }
    for (std::vector<IndexPair>* pairs : {&expected, &found_}) {
      for (IndexPair& pair : *pairs) std::sort(pair.begin(), pair.end());
      std::sort(pairs->begin(), pairs->end());
    }
    std::vector<IndexPair> missing;
    std::set_difference(expected.begin(), expected.end(), found_.begin(),
                        found_.end(), std::back_inserter(missing));
    const bool has_all = std::none_of(
        missing.begin(), missing.end(), [&](const IndexPair& pair) {
          return TouchesWell(boxes[pair[0]], boxes[pair[1]], slack);
        });
    return has_all && found_.size() + missing.size() == expected.size()
               ? ""
               : "the pairs are not those of a BVH";
  }

  void Time(Contest& contest, const std::string& what) {
    contest.Time(std::min<std::size_t>(run_.effort.repetitions,
                                       scene_.size() < 10'000 ? 5 : 3));
    for (std::size_t i = 0; i < contest.size(); ++i) {
      Ratio us = SpreadOf(contest.timing(i));
      us = {us.median / 1e3, us.low / 1e3, us.high / 1e3};
      result_.times.Add({world_, scene_.size(), what, contest.name(i), us,
                         contest.OverFastest(i)});
    }
  }

  Run& run_;
  Scene scene_;
  Result& result_;
  std::string world_;
  Ids all_;
  std::vector<Contestant> contestants_;
  std::vector<IndexPair> found_;
};

// A broad phase and a Bvh of the same bodies: each step of a frame by itself,
// the two worlds in turns.
template <int kDims>
class BodyChanges {
  using Scene = BodyScene<kDims>;
  using Box = Aabb<kDims>;
  using Boxes = std::vector<Box>;

 public:
  BodyChanges(Run& run, BodyKind kind, std::size_t bodies, Result& result)
      : run_(run),
        scene_(kind, bodies, run.options.seed),
        result_(result),
        random_(run.options.seed + 4),
        all_(scene_.AllIds()),
        boxes_(scene_.At(all_, 0)),
        tree_(boxes_),
        world_(std::string(NameOf(kind)) + (kDims == 2 ? " 2D" : " 3D")) {
    space_.Insert(all_, boxes_);
    space_.Rebuild();
  }

  // Some bodies move, the same ones in each frame.
  void RunFrames(std::size_t percent) {
    const Ids moved = percent == 100 ? all_ : scene_.Some(percent);
    if (moved.empty()) return;
    std::vector<Boxes> states;
    for (std::size_t s = 0; s < Scene::kStates; ++s) {
      states.push_back(scene_.At(moved, s));
    }
    std::vector<IdPair> pairs(Pairs(tree_, {}) + all_.size());
    std::array<std::size_t, 3> found{};
    const Boxes* to = nullptr;
    const std::size_t frames =
        run_.is_quick()
            ? 3
            : std::clamp<std::size_t>((1u << 20) / all_.size(), 33, 400);
    const std::vector<Ns> ns =
        TimeSteps(frames, 2,
                  [&](std::size_t frame) {
                    if (frame != 0 && (found[0] != found[1] ||
                                       found[2] != Pairs(tree_, {}))) {
                      throw WrongAnswer(
                          "broad_phase: a Bvh of the bodies has other pairs");
                    }
                    const std::size_t turn = frame % (2 * Scene::kStates - 2);
                    to = &states[std::min(turn, 2 * Scene::kStates - 2 - turn)];
                  },
                  {[&] { Change<kDims>(tree_, moved, *to); },
                   [&] {
                     found[0] = moved.size() == all_.size()
                                    ? Pairs(tree_, pairs)
                                    : PairsOf(tree_, moved, pairs);
                   },
                   [&] { Change<kDims>(space_, moved, *to); },
                   [&] { found[1] = PairsOf(space_, moved, pairs); },
                   [&] {
                     space_.UpdatePairs();
                     found[2] = space_.pairs().size();
                   }});
    const std::string what = "frame of " + std::to_string(percent) + " %, ";
    Add(what + "move and update", moved.size(), ns[2], ns[0]);
    Add(what + "the longest of them", moved.size(),
        {*std::max_element(ns[2].begin(), ns[2].end())},
        {*std::max_element(ns[0].begin(), ns[0].end())});
    Add(what + "pairs", moved.size(), ns[3], ns[1]);
    Add(what + "pairs and events, over pairs", moved.size(), ns[4], ns[1]);
  }

  // A move before each query.
  void RunAlternation(bool is_of_few) {
    constexpr std::size_t kMoves = 4096;
    Boxes queries;
    Ids moved;
    for (std::size_t i = 0; i < kMoves; ++i) {
      queries.push_back(scene_.AnyBox(2, random_));
      moved.push_back(static_cast<std::uint32_t>(random_.Below(
          is_of_few ? std::min<std::size_t>(8, all_.size()) : all_.size())));
    }
    const std::array<Boxes, 2> places = {scene_.At(moved, 0),
                                         scene_.At(moved, 1)};
    std::array<std::size_t, 2> found{};
    const Boxes* to = nullptr;
    const std::vector<Ns> ns =
        TimeSteps(Rounds(), 1,
                  [&](std::size_t round) {
                    if (found[0] != found[1]) {
                      throw WrongAnswer("broad_phase: a query misses a move");
                    }
                    found = {};
                    to = &places[round % 2];
                  },
                  {[&] {
                     for (std::size_t i = 0; i < kMoves; ++i) {
                       space_.Move(moved[i], (*to)[i]);
                       found[0] += CountOf(space_, queries[i]);
                     }
                   },
                   [&] {
                     for (std::size_t i = 0; i < kMoves; ++i) {
                       tree_.Set(moved[i], (*to)[i]);
                       found[1] += CountOf(tree_, queries[i]);
                     }
                   }});
    Add(std::string("move of ") + (is_of_few ? "one of 8" : "any body") +
            " and a query",
        kMoves, ns[0], ns[1]);
    space_.Move(all_, boxes_);
    space_.Update();
    tree_.Refit(boxes_);
  }

  // 16 bodies at a time leave and come back, and all of them.
  void RunInserts() {
    for (const std::size_t count : {std::size_t{16}, all_.size()}) {
      Ids some = all_;
      some.resize(std::min(count, some.size()));
      Boxes boxes = boxes_;
      const std::vector<Ns> ns = TimeSteps(
          count == all_.size() ? 5 : 3 * Rounds(), 0,
          [&](std::size_t) {
            for (std::size_t i = 0; count < all_.size() && i < count; ++i) {
              // Each from a range of its own, so that none comes twice.
              const std::size_t share = all_.size() / count;
              some[i] = all_[i * share + random_.Below(share)];
            }
            for (std::size_t i = 0; i < some.size(); ++i) {
              boxes[i] = boxes_[some[i]];
            }
          },
          {[&] {
             space_.Erase(some);
             space_.Update();
           },
           [&] {
             space_.Insert(some, {boxes.data(), some.size()});
             space_.Update();
           }});
      const std::string of = (count == all_.size() ? " of all" : " of 16") +
                             std::string(", and update");
      Add("erasure" + of, some.size(), ns[0]);
      Add("insert" + of, some.size(), ns[1]);
    }
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

  std::size_t Rounds() const { return 3 * run_.effort.repetitions; }

  void Add(const std::string& what, std::size_t bodies, const Ns& ours,
           const Ns& plain = {}) {
    const auto of_body = [bodies](Ns ns) {
      for (double& x : ns) x /= static_cast<double>(bodies);
      return SpreadOf({"", ns});
    };
    Row row = {what, world_, all_.size(), of_body(ours), Cell(), Cell()};
    if (!plain.empty()) {
      row[4] = of_body(plain);
      row[5] = RatioOf(ours, plain);
    }
    result_.changes.Add(std::move(row));
  }

  Run& run_;
  Scene scene_;
  Result& result_;
  Random random_;
  Ids all_;
  Boxes boxes_;
  Bvh<AabbView<kDims>> tree_;
  BroadPhase<AabbView<kDims>> space_;
  std::string world_;
};

template <int kDims>
void AddParts(Run& run, std::size_t most, Result& result, Parts& parts) {
  for (BodyKind kind : {BodyKind::kGas, BodyKind::kSparse, BodyKind::kPile,
                        BodyKind::kLogNormal, BodyKind::kBepu}) {
    for (std::size_t bodies : UpTo(most, {100, 1024, 4096, 16384, 65536})) {
      for (std::size_t percent : {10, 100}) {
        parts.emplace_back([&run, &result, kind, bodies, percent] {
          BodyContest<kDims>(run, kind, bodies, result).RunFrames(percent);
        });
      }
      parts.emplace_back([&run, &result, kind, bodies] {
        for (std::size_t percent : {1, 10, 100}) {
          BodyChanges<kDims>(run, kind, bodies, result).RunFrames(percent);
        }
      });
    }
  }
}

}  // namespace

Tables RunBroadPhase(Run& run) {
  Result result;
  std::size_t most = run.is_quick() ? 1024 : 65536;
  if (run.options.objects != 0) most = std::min(most, run.options.objects);
  Parts parts;
  AddParts<3>(run, most, result, parts);
  AddParts<2>(run, most, result, parts);
  parts.emplace_back([&] {
    BodyChanges<3> changes(run, BodyKind::kGas, most, result);
    changes.RunAlternation(true);
    changes.RunAlternation(false);
    changes.RunInserts();
  });
  RunParts(run, parts);
  return {result.times, result.changes};
}

}  // namespace halfspace::bench

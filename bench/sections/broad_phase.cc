#include "halfspace/broad_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/body_space.h"
#include "bench/sections/broad_phase_parts.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/worlds/body_scene.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_nearest.h"
#include "halfspace/bvh_pairs.h"
#include "halfspace/bvh_shapes.h"
#include "halfspace/pair_events.h"

namespace halfspace::bench {
namespace {

// A tree, and how it changes in a frame: what BroadPhase is measured by.
template <int kDims>
struct PlainTree {
  using Tree = Bvh<AabbView<kDims>>;

  void Insert(std::span<const std::uint32_t> /*ids*/,
              std::span<const Aabb<kDims>> boxes) {
    tree = Tree(boxes);
    events.Update(tree);
  }
  void Step(std::span<const std::uint32_t> ids,
            std::span<const Aabb<kDims>> boxes) {
    ChangeTree(tree, ids, boxes);
  }
  std::size_t AllPairs(std::span<const std::uint32_t> moved) {
    if (moved.size() == tree.size()) {
      events.Update(tree);
    } else {
      events.Update(tree, moved);
    }
    return events.size();
  }
  Span<const IdPair> pairs() const { return events.pairs(); }
  const Tree& world() const { return tree; }

  Tree tree;
  PairEvents events;
};

template <int kDims>
struct Bodies {
  explicit Bodies(bool has_lock) : bodies({.caller_locks = !has_lock}) {}

  void Insert(std::span<const std::uint32_t> ids,
              std::span<const Aabb<kDims>> boxes) {
    bodies.Insert(ids, boxes);
    bodies.Update();
  }
  void Step(std::span<const std::uint32_t> ids,
            std::span<const Aabb<kDims>> boxes) {
    bodies.Move(ids, boxes);
    bodies.Update();
  }
  std::size_t AllPairs(std::span<const std::uint32_t> /*moved*/) {
    bodies.UpdatePairs();
    return bodies.pairs().size();
  }
  Span<const IdPair> pairs() const { return bodies.pairs(); }
  const BroadPhase<AabbView<kDims>>& world() const { return bodies; }

  BroadPhase<AabbView<kDims>> bodies;
};

// Their calls have the same names.
template <int kDims, typename Space>
class OurSpace : public BodySpace<kDims> {
  using Base = BodySpace<kDims>;
  using typename Base::Boxes;
  using typename Base::Ids;

 public:
  template <typename... Options>
  explicit OurSpace(std::size_t bodies, Options... options)
      : Base(bodies), space_(options...) {}

  void Insert(Ids ids, Boxes boxes) override { space_.Insert(ids, boxes); }
  void Step(Ids ids, Boxes boxes) override {
    space_.Step(ids, boxes);
    last_.assign(ids.begin(), ids.end());
  }
  void PairsOf(Ids ids, std::vector<IndexPair>& found) override {
    ForEachPairOf(space_.world(), ids, [&](Span<const IdPair> pairs) {
      for (const IdPair& pair : pairs) found.push_back({pair.a, pair.b});
    });
  }
  std::size_t AllPairs(std::vector<IndexPair>& /*found*/) override {
    return space_.AllPairs(last_);
  }
  void ListPairs(std::vector<IndexPair>& found) const override {
    for (const IdPair& pair : space_.pairs()) found.push_back({pair.a, pair.b});
  }

  void Find(const BodyQuery<kDims>& query,
            std::vector<std::uint32_t>& found) const override {
    using Kind = typename BodyQuery<kDims>::Kind;
    const auto ask = [&](const auto& shape) {
      if (query.is_first) {
        const auto any = AnySurvivor(space_.world(), shape);
        if (any) found.push_back(*any);
        return;
      }
      ForEachSurvivor(space_.world(), shape,
                      [&](Span<const std::uint32_t> ids) {
                        found.insert(found.end(), ids.begin(), ids.end());
                      });
    };
    if (query.kind == Kind::kBox) ask(query.box);
    if (query.kind == Kind::kSphere) ask(query.sphere);
    if (query.kind == Kind::kOrientedBox) ask(query.oriented);
  }
  void Cast(const BodyCast<kDims>& cast, CastHits& hits) const override {
    const auto hit = [&](std::uint32_t, float t) {
      ++hits.count;
      if (cast.is_closest) hits.limit = std::min(hits.limit, t);
      return Limit{hits.limit};
    };
    if (cast.IsRay()) {
      RayCast(space_.world(),
              Ray<kDims>{cast.box.min, cast.direction, cast.max_t}, hit);
    } else {
      BoxCast(space_.world(), cast.box, cast.direction, cast.max_t, hit);
    }
  }

 private:
  Space space_;
  std::vector<std::uint32_t> last_;  // that moved
};

// The scenes, and how many times as fast as the fastest competitor a frame of
// 4096 bodies and more has to be, if all move (in 3D and in 2D) or a tenth.
struct Scenes {
  BodyKind kind;
  double all[2];
  double tenth;
};
constexpr Scenes kScenes[] = {{BodyKind::kGas, {4, 6}, 8},
                              {BodyKind::kSparse, {1, 1}, 1},
                              {BodyKind::kPile, {2, 2}, 8},
                              {BodyKind::kLogNormal, {4, 6}, 8},
                              {BodyKind::kBepu, {4, 6}, 8}};

// What takes some contestants seconds is left out.
constexpr std::size_t kMostScanned = 4096;

struct Way {
  const char* name;
  float length;  // 0: through the world
  float side;
  bool is_closest;
};
constexpr std::array kWays = {
    Way{"ray of 10, closest", 10, 0, true},
    Way{"ray of 10, all", 10, 0, false},
    Way{"ray through the world, closest", 0, 0, true},
    Way{"ray through the world, all", 0, 0, false},
    Way{"box cast of 10, closest", 10, 1, true},
    Way{"box cast of 10, all", 10, 1, false},
    Way{"box cast through the world, closest", 0, 1, true},
    Way{"box cast through the world, all", 0, 1, false},
};

// All broad phases on one scene. The first kOurs are ours: BroadPhase, the same
// without a lock, and a Bvh with PairEvents.
template <int kDims>
class BodyContest {
 public:
  BodyContest(const Scenes& its, std::size_t bodies, std::uint64_t seed,
              Throughput& throughput, BroadPhaseResult& result)
      : its_(its),
        scene_(its.kind, bodies, seed),
        seed_(seed),
        throughput_(throughput),
        result_(result),
        world_(std::string(NameOf(its.kind)) + (kDims == 2 ? " 2D" : " 3D")),
        all_(scene_.AllIds()) {}

  // A frame: `percent` of the bodies move, and then the pairs of these are
  // listed, or all pairs are kept up to date.
  void RunFrames(std::size_t percent, bool are_kept) {
    Build();
    const Ids moved = percent == 100 ? all_ : scene_.Some(percent);
    if (moved.empty()) return;
    std::vector<Boxes> frames;
    for (std::size_t s = 0; s < Scene::kStates; ++s) {
      frames.push_back(scene_.At(moved, s));
    }
    constexpr std::size_t kBodiesOfRun = 16384;
    const std::size_t frames_of_run =
        std::clamp<std::size_t>(kBodiesOfRun / scene_.size(), 2, 32);
    std::vector<Case> cases;
    for (Contestant& contestant : contestants_) {
      const auto frame = [this, &contestant, &moved, &frames, are_kept] {
        // Through the states and back.
        constexpr std::size_t kLast = Scene::kStates - 1;
        const std::size_t turn = ++contestant.frame % (2 * kLast);
        const std::size_t state = std::min(turn, 2 * kLast - turn);
        contestant.space->Step(moved, frames[state]);
        found_.clear();
        if (are_kept) {
          pairs_ = contestant.space->AllPairs(found_);
        } else {
          contestant.space->PairsOf(moved, found_);
        }
        return state;
      };
      Case c;
      c.name = contestant.name;
      c.items = static_cast<double>(frames_of_run);
      c.check = [this, frame, &contestant, &moved, are_kept] {
        const std::size_t state = frame();
        if (are_kept && found_.empty()) contestant.space->ListPairs(found_);
        return CheckPairs(moved, state, are_kept, contestant.space->Slack());
      };
      c.run = [frame, frames_of_run] {
        for (std::size_t f = 0; f < frames_of_run; ++f) std::ignore = frame();
      };
      cases.push_back(std::move(c));
    }
    Time(std::move(cases),
         "frame of " + std::to_string(percent) + " %" +
             (are_kept ? ", all pairs" : ""),
         scene_.size() < 4000
             ? aims::kFramesOfFew
             : aims::WithLessOnAvx2(percent < 100 ? its_.tenth
                                                  : its_.all[3 - kDims]),
         false);
  }

  void RunQueries() {
    Build();
    for (const Contestant& contestant : contestants_) {
      for (std::size_t s = 1; s < 5; ++s) {
        contestant.space->Step(all_, scene_.At(all_, s));
      }
    }
    boxes_ = scene_.At(all_, 4);
    using Kind = typename BodyQuery<kDims>::Kind;
    RunQuery("point", Kind::kBox, 0, false);
    RunQuery("box of 2", Kind::kBox, 2, false);
    RunQuery("sphere of 2", Kind::kSphere, 2, false);
    RunQuery("oriented box of 2", Kind::kOrientedBox, 2, false);
    RunQuery("first hit of a box of 1", Kind::kBox, 1, true);
    for (const Way& way : kWays) RunCast(way);
  }

 private:
  using Box = Aabb<kDims>;
  using Scene = BodyScene<kDims>;
  using Ids = typename Scene::Ids;
  using Boxes = std::vector<Box>;

  static constexpr std::size_t kOurs = 3;
  static constexpr std::size_t kChecked = 200;

  struct Contestant {
    std::string name;
    BodySpacePtr<kDims> space;
    std::size_t frame = 0;
  };

  void Build() {
    contestants_.clear();
    const std::size_t bodies = scene_.size();
    Add("halfspace",
        std::make_unique<OurSpace<kDims, Bodies<kDims>>>(bodies, true));
    Add("halfspace, caller's lock",
        std::make_unique<OurSpace<kDims, Bodies<kDims>>>(bodies, false));
    Add("halfspace Bvh",
        std::make_unique<OurSpace<kDims, PlainTree<kDims>>>(bodies));
    if constexpr (kDims == 2) {
      Add("Box2D", MakeBox2dSpace(bodies));
    } else {
      Add("Bullet btDbvt", MakeBulletSpace(bodies));
      Add("FCL dynamic tree", MakeFclSpace(bodies));
    }
    if (bodies <= kMostScanned) Add("scan", MakeScanSpace<kDims>(bodies));
  }
  void Add(const char* name, BodySpacePtr<kDims> space) {
    if (space == nullptr) return;
    space->Insert(all_, scene_.At(all_, 0));
    contestants_.push_back({name, std::move(space), 0});
  }

  // Whether boxes touch that are smaller by this share of their distance from
  // 0.
  static bool TouchWell(const Box& a, const Box& b, float share) {
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
    return Touch(less, b);
  }

  std::string CheckPairs(const Ids& moved, std::size_t state, bool are_kept,
                         float slack) {
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
    if (are_kept && pairs_ != found_.size()) {
      return std::to_string(pairs_) + " pairs are counted, and " +
             std::to_string(found_.size()) + " listed";
    }
    std::vector<IndexPair> expected;
    for (const IdPair& pair : all) {
      if (are_kept || is_moved[pair.a] || is_moved[pair.b]) {
        expected.push_back({pair.a, pair.b});
      }
    }
    const auto sort = [](std::vector<IndexPair>& pairs) {
      for (IndexPair& pair : pairs) std::sort(pair.begin(), pair.end());
      std::sort(pairs.begin(), pairs.end());
    };
    sort(expected);
    sort(found_);
    std::vector<IndexPair> missing;
    std::set_difference(expected.begin(), expected.end(), found_.begin(),
                        found_.end(), std::back_inserter(missing));
    const bool has_all = std::none_of(
        missing.begin(), missing.end(), [&](const IndexPair& pair) {
          return TouchWell(boxes[pair[0]], boxes[pair[1]], slack);
        });
    return has_all && found_.size() + missing.size() == expected.size()
               ? ""
               : "the pairs are not those of a BVH";
  }

  BodyQuery<kDims> MakeQuery(typename BodyQuery<kDims>::Kind kind, float side,
                             bool is_first, Random& random) const {
    BodyQuery<kDims> query{kind, is_first, scene_.AnyBox(side, random), {}, {}};
    Point<kDims> center;
    for (std::size_t k = 0; k < kDims; ++k) {
      center[k] = 0.5f * (query.box.min[k] + query.box.max[k]);
    }
    query.sphere = {center, 0.5f * side};
    if (kind != BodyQuery<kDims>::Kind::kOrientedBox) return query;
    query.oriented.center = center;
    const Point<kDims> x = Scene::AnyDirection(random);
    query.oriented.axes[0] = x;
    if constexpr (kDims == 2) {
      query.oriented.axes[1] = {-x[1], x[0]};
    } else {
      // Any direction at a right angle, and the cross product.
      const float length = std::hypot(x[0], x[1]);
      const Point<3> y = {-x[1] / length, x[0] / length, 0};
      query.oriented.axes[1] = y;
      query.oriented.axes[2] = {x[1] * y[2] - x[2] * y[1],
                                x[2] * y[0] - x[0] * y[2],
                                x[0] * y[1] - x[1] * y[0]};
    }
    for (std::size_t k = 0; k < kDims; ++k) {
      query.oriented.half_extents[k] = 0.5f * side;
      float reach = 0;
      for (const Point<kDims>& axis : query.oriented.axes) {
        reach += 0.5f * side * std::abs(axis[k]);
      }
      query.box.min[k] = center[k] - reach;
      query.box.max[k] = center[k] + reach;
    }
    return query;
  }

  void RunQuery(const char* name, typename BodyQuery<kDims>::Kind kind,
                float side, bool is_first) {
    Random random(seed_ + 2);
    std::vector<BodyQuery<kDims>> queries(kTimedQueries);
    for (BodyQuery<kDims>& query : queries) {
      query = MakeQuery(kind, side, is_first, random);
    }
    const auto find = [&](const BodySpace<kDims>& space, std::size_t q) {
      ids_.clear();
      space.Find(queries[q], ids_);
    };
    std::vector<Ids> expected;
    for (std::size_t q = 0; q < kChecked; ++q) {
      expected.emplace_back();
      for (std::uint32_t id : all_) {
        if (queries[q].Touches(boxes_[id])) expected.back().push_back(id);
      }
    }
    const auto check = [&](const BodySpace<kDims>& space) -> std::string {
      std::size_t wrong = 0;
      for (std::size_t q = 0; q < kChecked; ++q) {
        find(space, q);
        std::sort(ids_.begin(), ids_.end());
        if (is_first) {
          wrong +=
              ids_.empty() != expected[q].empty() ||
                      !std::includes(expected[q].begin(), expected[q].end(),
                                     ids_.begin(), ids_.end())
                  ? 1
                  : 0;
        } else {
          wrong += ids_ == expected[q] ? 0 : 1;
        }
      }
      return Wrong(wrong, kChecked, kind != BodyQuery<kDims>::Kind::kBox);
    };
    std::vector<Case> cases;
    for (const Contestant& contestant : contestants_) {
      const BodySpace<kDims>& space = *contestant.space;
      if (!space.CanFind()) continue;
      cases.push_back(InTurn(contestant.name, queries, kTimedQueries,
                             QueriesOfRun(20000),
                             [&](const BodyQuery<kDims>& query) {
                               ids_.clear();
                               space.Find(query, ids_);
                             }));
      cases.back().name = contestant.name;
      cases.back().check = [&] { return check(space); };
    }
    Time(std::move(cases), name,
         is_first               ? aims::kFirstHit
         : scene_.size() < 4000 ? aims::kBodyQueriesOfFew
                                : aims::kBodyQueries,
         true);
  }

  void RunCast(const Way& way) {
    Random random(seed_ + 3);
    std::vector<BodyCast<kDims>> casts(kTimedQueries);
    const float length = scene_.world().max[0] * std::sqrt(float{kDims});
    for (BodyCast<kDims>& cast : casts) {
      cast.is_closest = way.is_closest;
      cast.box = scene_.AnyBox(way.side, random);
      cast.direction = Scene::AnyDirection(random);
      cast.max_t = way.length > 0 ? way.length : 2 * length;
      for (std::size_t k = 0; k < kDims; ++k) {
        cast.inverse[k] = 1 / cast.direction[k];
        if (way.length > 0) continue;
        cast.box.min[k] -= length * cast.direction[k];
        cast.box.max[k] = cast.box.min[k] + way.side;
      }
    }
    const auto find = [](const BodySpace<kDims>& space,
                         const BodyCast<kDims>& cast) {
      CastHits hits{0, cast.max_t};
      space.Cast(cast, hits);
      KeepResult(static_cast<std::uint32_t>(hits.count));
      return hits;
    };
    std::vector<CastHits> all_expected;
    for (std::size_t q = 0; q < kChecked; ++q) {
      all_expected.push_back({0, casts[q].max_t});
      for (const Box& box : boxes_) all_expected.back().Test(casts[q], box);
    }
    const auto check = [&](const BodySpace<kDims>& space) -> std::string {
      std::size_t wrong = 0;
      std::size_t all = 0;
      for (std::size_t q = 0; q < kChecked; ++q) {
        const CastHits& expected = all_expected[q];
        const CastHits hits = find(space, casts[q]);
        if (way.is_closest) {
          const float off = std::abs(hits.limit - expected.limit);
          wrong += off <= 1e-5f * (100 + casts[q].max_t) ? 0 : 1;
          ++all;
        } else {
          wrong += std::max(hits.count, expected.count) -
                   std::min(hits.count, expected.count);
          all += expected.count;
        }
      }
      return Wrong(wrong, all, true);
    };
    const std::size_t queries = way.length > 0 ? 20000 : 2000;
    // Where the whole way is a query.
    const std::size_t queries_by_way = way.length > 0 ? 20000 : 20;
    std::vector<Case> cases;
    for (const Contestant& contestant : contestants_) {
      const BodySpace<kDims>& space = *contestant.space;
      if (!space.CanCast()) continue;
      cases.push_back(InTurn(contestant.name, casts, kTimedQueries,
                             space.CanCastBoxes() || way.side == 0
                                 ? QueriesOfRun(queries)
                                 : QueriesOfRun(queries_by_way),
                             [&space, find](const BodyCast<kDims>& cast) {
                               std::ignore = find(space, cast);
                             }));
      cases.back().name = contestant.name;
      cases.back().check = [&] { return check(space); };
    }
    Time(std::move(cases), way.name,
         kDims == 2 ? aims::kBodyCasts2D : aims::kBodyCasts3D, true);
  }

  std::size_t QueriesOfRun(std::size_t queries) const {
    return throughput_.is_quick() ? std::max<std::size_t>(1, queries / 20)
                                  : queries;
  }

  // Of rounded tests, one in a hundred may differ where shapes just touch.
  static std::string Wrong(std::size_t wrong, std::size_t all,
                           bool is_rounded) {
    if (wrong <= (is_rounded ? all / 100 + 1 : 0)) return {};
    return std::to_string(wrong) + " of " + std::to_string(all) +
           " answers are not those of a loop over the bodies";
  }

  void Time(std::vector<Case> cases, const std::string& what, const Aim& aim,
            bool is_query) {
    const std::string place =
        world_ + "/" + std::to_string(scene_.size()) + "/" + what + "/";
    std::vector<std::string> names;
    std::vector<std::size_t> competitors;
    for (Case& c : cases) {
      if (names.size() >= kOurs) competitors.push_back(names.size());
      names.push_back(c.name);
      c.name = place + c.name;
    }
    const std::size_t most_repetitions = scene_.size() < 10'000 ? 5 : 3;
    const Timings timings = throughput_.TimeRuns(
        std::move(cases),
        std::min(throughput_.repetitions(), most_repetitions));
    for (std::size_t i = 0; i < timings.size(); ++i) {
      Ratio us = SpreadOf(timings[i]);
      us = {us.median / 1e3, us.low / 1e3, us.high / 1e3};
      Row row = {world_, scene_.size(), what, names[i], us, Cell()};
      if (!competitors.empty()) {
        row.back() =
            RatioOf(timings[FastestOf(timings, competitors)], timings[i]);
      }
      result_.times.Add(std::move(row));
    }
    const std::string name =
        world_ + " " + Grouped(scene_.size()) + ", " + what;
    const Target target = ChosenTarget();
    if (is_query) {
      const auto over_bvh = [&](std::size_t ours) {
        std::vector<double> ns = timings[ours].samples;
        for (std::size_t i = 0; i < ns.size(); ++i) {
          ns[i] -= timings[kOurs - 1].samples[i];
        }
        return SpreadOf({"", ns});
      };
      throughput_.AddRatio(aims::kLock, target, name + ": ns over a Bvh",
                           over_bvh(0));
      throughput_.AddRatio(aims::kNoLock, target,
                           name + ", caller's lock: ns over a Bvh",
                           over_bvh(1));
    }
    if (competitors.empty()) return;
    const std::size_t fastest = FastestOf(timings, competitors);
    throughput_.AddRatio(aim, target, name + ": times " + names[fastest],
                         RatioOf(timings[fastest], timings[0]));
  }

  Scenes its_;
  Scene scene_;
  std::uint64_t seed_;
  Throughput& throughput_;
  BroadPhaseResult& result_;
  std::string world_;
  Ids all_;
  std::vector<Contestant> contestants_;
  Boxes boxes_;  // while queries run
  std::vector<IndexPair> found_;
  std::size_t pairs_ = 0;
  Ids ids_;
};

template <int kDims>
void AddParts(std::size_t most, std::uint64_t seed, BroadPhaseResult& result,
              ThroughputParts& parts) {
  for (const Scenes& its : kScenes) {
    for (std::size_t bodies : {100, 1024, 4096, 16384, 65536}) {
      if (bodies > most) continue;
      for (std::size_t percent : {10, 100}) {
        for (bool are_kept : {false, true}) {
          parts.push_back([=, &result](Throughput& to) {
            BodyContest<kDims>(its, bodies, seed, to, result)
                .RunFrames(percent, are_kept);
          });
        }
      }
      const bool has_queries =
          its.kind == BodyKind::kGas
              ? bodies > 1000
              : bodies == std::min<std::size_t>(most, 16384);
      if (!has_queries) continue;
      parts.push_back([=, &result](Throughput& to) {
        BodyContest<kDims>(its, bodies, seed, to, result).RunQueries();
      });
    }
  }
}

}  // namespace

Tables RunBroadPhase(Run& run) {
  BroadPhaseResult result;
  Throughput throughput(run, "broad_phase");
  std::size_t most = run.is_quick() ? 1024 : 65536;
  if (run.options.objects != 0) most = std::min(most, run.options.objects);
  const std::uint64_t seed = run.options.seed;
  ThroughputParts parts;
  AddParts<3>(most, seed, result, parts);
  AddParts<2>(most, seed, result, parts);
  AddBodyChanges(most, seed, result, parts);
  RunParts(parts, throughput);
  return {result.times, result.changes, throughput.Aims()};
}

}  // namespace halfspace::bench

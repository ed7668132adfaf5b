// BroadPhase next to the broad phases of other libraries and to a plain Bvh.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/body_space.h"
#include "bench/sections/contest.h"
#include "bench/worlds/body_scene.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_pairs.h"

namespace halfspace::bench {
namespace {

// Whether boxes touch that are smaller by this share of their distance from 0.
template <int kDims>
bool TouchesWell(const Aabb<kDims>& a, const Aabb<kDims>& b, float share) {
  float square = 0;
  for (std::size_t k = 0; k < kDims; ++k) {
    const float far = std::max(std::abs(a.min[k]), std::abs(a.max[k])) +
                      std::max(std::abs(b.min[k]), std::abs(b.max[k]));
    square += far * far;
  }
  Aabb<kDims> less = a;
  for (std::size_t k = 0; k < kDims; ++k) {
    less.min[k] += share * std::sqrt(square);
    less.max[k] -= share * std::sqrt(square);
  }
  return Touches(less, b);
}

// Compares the pairs that were found after some bodies have moved to a state.
template <int kDims>
std::string CheckPairs(const BodyScene<kDims>& scene,
                       const std::vector<std::uint32_t>& moved,
                       std::size_t state, float slack,
                       std::vector<IndexPair>& found) {
  std::vector<Aabb<kDims>> boxes = scene.At(scene.AllIds(), 0);
  const std::vector<Aabb<kDims>> now = scene.At(moved, state);
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
  for (std::vector<IndexPair>* pairs : {&expected, &found}) {
    for (IndexPair& pair : *pairs) std::sort(pair.begin(), pair.end());
    std::sort(pairs->begin(), pairs->end());
  }
  std::vector<IndexPair> missing;
  std::set_difference(expected.begin(), expected.end(), found.begin(),
                      found.end(), std::back_inserter(missing));
  const bool has_all =
      std::none_of(missing.begin(), missing.end(), [&](const IndexPair& pair) {
        return TouchesWell(boxes[pair[0]], boxes[pair[1]], slack);
      });
  return has_all && found.size() + missing.size() == expected.size()
             ? ""
             : "the pairs are not those of a BVH";
}

// A frame: `percent` of the bodies move, and then the pairs of these are
// listed.
template <int kDims>
void RunFrames(Run& run, BodyKind kind, std::size_t bodies, std::size_t percent,
               Table& table) {
  const BodyScene<kDims> scene(kind, bodies, run.options.seed);
  const std::vector<std::uint32_t> all = scene.AllIds();
  const auto moved = percent == 100 ? all : scene.Some(percent);
  if (moved.empty()) return;
  std::vector<std::vector<Aabb<kDims>>> states;
  for (std::size_t s = 0; s < BodyScene<kDims>::kStates; ++s) {
    states.push_back(scene.At(moved, s));
  }
  constexpr std::size_t kBodiesOfRun = 16384;
  const std::size_t frames_of_run =
      std::clamp<std::size_t>(kBodiesOfRun / bodies, 2, 32);
  std::vector<IndexPair> found;
  Contest contest(run, "broad_phase");
  for (const auto& each : Registered<BodySpace<kDims>>::AllFor(bodies)) {
    const std::shared_ptr<BodySpace<kDims>> space = each.make(bodies);
    space->Insert(all, scene.At(all, 0));
    const auto frame = [&, space](std::size_t state) {
      space->Step(moved, states[state]);
      found.clear();
      space->PairsOf(moved, found);
    };
    // Through the states and back, from the one after that of the check.
    constexpr std::size_t kTurns = 2 * (BodyScene<kDims>::kStates - 1);
    Case c = InTurn(kTurns, frames_of_run, [frame](std::size_t i) {
      const std::size_t turn = (i + 2) % kTurns;
      frame(std::min(turn, kTurns - turn));
    });
    c.check = [&, space, frame] {
      frame(1);
      return CheckPairs(scene, moved, 1, space->Slack(), found);
    };
    contest.Add(
        {std::string(NameOf(kind)) + (kDims == 2 ? " 2D" : " 3D"), bodies,
         "frame of " + std::to_string(percent) + " %", each.name},
        std::move(c), each.is_ours ? Who::kOurs : Who::kCompetitor);
  }
  contest.TimeOnce(
      std::min<std::size_t>(run.effort.repetitions, bodies < 10'000 ? 5 : 3));
  contest.AddTo(table, [&](std::size_t i) -> Row {
    const Ratio ns = SpreadOf(contest.timing(i));
    return {Ratio{ns.median / 1e3, ns.low / 1e3, ns.high / 1e3},
            contest.OverFastest(i)};
  });
}

}  // namespace

Tables RunBroadPhase(Run& run) {
  Table table{"broad_phase",
              "frames, next to the broad phases of others",
              {Key("world"), Key("bodies"), Key("what"), Key("by"),
               Lower("time", "us", 3), Higher("times the fastest")}};
  std::size_t most = run.is_quick() ? 1024 : 65536;
  if (run.options.objects != 0) most = std::min(most, run.options.objects);
  Parts parts;
  for (const auto frames : {&RunFrames<3>, &RunFrames<2>}) {
    for (BodyKind kind : {BodyKind::kGas, BodyKind::kSparse, BodyKind::kPile,
                          BodyKind::kLogNormal, BodyKind::kBepu}) {
      for (std::size_t bodies : UpTo(most, {100, 1024, 4096, 16384, 65536})) {
        for (std::size_t percent : {10, 100}) {
          parts.emplace_back([&run, &table, frames, kind, bodies, percent] {
            frames(run, kind, bodies, percent, table);
          });
        }
      }
    }
  }
  RunParts(run, parts);
  return {table};
}

}  // namespace halfspace::bench

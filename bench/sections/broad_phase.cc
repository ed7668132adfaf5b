// BroadPhase next to the broad phases of other libraries and to a plain Bvh.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/baselines/body_space.h"
#include "bench/sections/contest.h"
#include "bench/worlds/body_scene.h"

namespace halfspace::bench {
namespace {

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
    c.check = CheckOf(1, "not the pairs of a BVH", [&, space, frame](auto) {
      frame(1);
      return scene.ArePairs(moved, 1, space->Slack(), found);
    });
    contest.Add(
        {std::string(NameOf(kind)) + (kDims == 2 ? " 2D" : " 3D"), bodies,
         "frame of " + std::to_string(percent) + " %", each.name},
        std::move(c), each.is_ours ? Who::kOurs : Who::kCompetitor);
  }
  contest.TimeOnce(run.AtMostRepetitions(bodies < 10'000 ? 5 : 3));
  contest.AddTo(table, [&](std::size_t i) -> Row {
    return {SpreadOf(contest.timing(i)).Times(1e-3), contest.OverFastest(i)};
  });
}

}  // namespace

Tables RunBroadPhase(Run& run) {
  Table table{"broad_phase",
              "frames, next to the broad phases of others",
              {Key("world"), Key("bodies"), Key("what"), Key("by"),
               Lower("time", "us", 3), Higher("times the fastest")}};
  const std::size_t most = run.MostObjects(65536, /*of_quick=*/1024);
  for (const auto frames : {&RunFrames<3>, &RunFrames<2>}) {
    for (BodyKind kind :
         {BodyKind::kGas, BodyKind::kSparse, BodyKind::kPile,
          BodyKind::kLogNormal, BodyKind::kBepu, BodyKind::kFast}) {
      for (std::size_t bodies : UpTo(most, {100, 1024, 4096, 16384, 65536})) {
        for (std::size_t percent : {10, 100}) {
          frames(run, kind, bodies, percent, table);
        }
      }
    }
  }
  return {table};
}

}  // namespace halfspace::bench

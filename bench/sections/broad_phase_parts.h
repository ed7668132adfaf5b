// The parts of the section `broad_phase`.
#ifndef HALFSPACE_BENCH_SECTIONS_BROAD_PHASE_PARTS_H_
#define HALFSPACE_BENCH_SECTIONS_BROAD_PHASE_PARTS_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "bench/sections/throughput.h"
#include "bench/worlds/body_scene.h"
#include "halfspace/bvh.h"

namespace halfspace::bench {

struct BroadPhaseResult {
  Table times{"broad_phase",
              "frames and queries, next to the broad phases of others",
              {Key("world"), Key("bodies"), Key("what"), Key("by"),
               Lower("time", "us", 3), Higher("times the fastest")}};
  Table changes{
      "broad_phase: changes",
      "next to the same of a Bvh",
      {Key("what"), Key("world"), Key("bodies"), Lower("time", "ns/body", 1),
       Value("Bvh", "ns/body", 1), Lower("over the Bvh")}};
};

// Gives objects of a Bvh other bounds, as BroadPhase::Update() does: it sorts
// about a 16th of the objects if the order has decayed. All ids are
// 0, 1, and so on.
template <int kDims>
void ChangeTree(Bvh<AabbView<kDims>>& tree, std::span<const std::uint32_t> ids,
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

// Frames next to those of a Bvh, inserts, erasures, moves, decay, threads and
// memory.
void AddBodyChanges(std::size_t most, std::uint64_t seed,
                    BroadPhaseResult& result, ThroughputParts& parts);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_BROAD_PHASE_PARTS_H_

// The parts of the section `broad_phase`.
#ifndef HALFSPACE_BENCH_SECTIONS_BROAD_PHASE_PARTS_H_
#define HALFSPACE_BENCH_SECTIONS_BROAD_PHASE_PARTS_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "bench/sections/throughput.h"
#include "bench/worlds/body_scene.h"

namespace halfspace::bench {

// A tenth of the usual size of a body.
inline constexpr float kBodyMargin = 0.1f;

struct BroadPhaseResult {
  Table times{"broad_phase",
              "frames and queries, next to the broad phases of others",
              {Key("world"), Key("bodies"), Key("what"), Key("by"),
               Lower("time", "us", 3), Higher("times the fastest")}};
  Table changes{"broad_phase: changes",
                "what a change costs",
                {Key("what"), Key("bodies"), Lower("time", "ns/body", 1)}};
};

// Inserts, erasures, moves, decay, threads and memory.
void RunBodyChanges(std::size_t bodies, std::uint64_t seed,
                    Throughput& throughput, BroadPhaseResult& result);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_BROAD_PHASE_PARTS_H_

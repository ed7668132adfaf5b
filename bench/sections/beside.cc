// Queries of a broad phase while another thread changes it.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/machine.h"
#include "bench/measure/team.h"
#include "bench/sections/run.h"
#include "bench/worlds/body_scene.h"
#include "halfspace/broad_phase.h"
#include "halfspace/transform.h"

namespace halfspace::bench {
namespace {

enum class Other { kNothing, kMoves, kFrames, kFramesWithPairs };
constexpr std::array<const char*, 4> kOthers = {"does nothing", "moves 64",
                                                "updates", "finds pairs"};

// A thread that queries a broad phase of the gas while another thread works.
class Beside {
 public:
  explicit Beside(std::size_t bodies)
      : scene_(BodyKind::kGas, bodies, 1), ids_(scene_.AllIds()) {
    for (std::size_t s = 0; s < Scene::kStates; ++s) {
      states_.push_back(scene_.At(ids_, s));
    }
    // In any state the body touches it.
    queries_ = states_[0];
    for (Aabb3& query : queries_) query = InflateByBox(query, kMoved);
    bodies_.Insert(ids_, states_[0]);
    bodies_.Rebuild();
    bodies_.UpdatePairs();
  }

  struct Result {
    TeamTime time;
    double queries = 0;  // a second
    double p99 = 0;      // seconds of a query
    double longest = 0;
  };
  Result Run(Other other) {
    std::atomic<bool> is_done{false};
    Result result;
    result.time = RunTeam(other == Other::kNothing ? 1 : 2, [&](std::size_t i) {
      if (i == 0) {
        Query(result);
        is_done.store(true);
      }
      while (i == 1 && !is_done.load()) Change(other);
    });
    return result;
  }

 private:
  using Scene = BodyScene<3>;
  using Clock = std::chrono::steady_clock;
  static constexpr float kMoved = 0.1f * Scene::kStates;

  void Query(Result& result) {
    std::vector<double> times;
    std::array<std::uint32_t, 512> found;
    const Clock::time_point start = Clock::now();
    Clock::time_point last = start;
    while (last - start < std::chrono::milliseconds(20)) {
      // A prime, so that neighbors do not follow each other.
      const std::size_t q = 7919 * times.size() % queries_.size();
      const std::size_t count = Survivors(bodies_, queries_[q], found);
      const auto ids = std::span(found).first(std::min(count, found.size()));
      if (std::find(ids.begin(), ids.end(), ids_[q]) == ids.end()) {
        throw WrongAnswer("threads: a query has missed a body");
      }
      const Clock::time_point now = Clock::now();
      times.push_back(std::chrono::duration<double>(now - last).count());
      last = now;
    }
    result.queries = static_cast<double>(times.size()) /
                     std::chrono::duration<double>(last - start).count();
    std::sort(times.begin(), times.end());
    result.p99 = times[times.size() * 99 / 100];
    result.longest = times.back();
  }

  void Change(Other other) {
    const std::size_t state = ++changes_ % Scene::kStates;
    if (other == Other::kMoves) {
      const std::size_t first = changes_ * 64 % (ids_.size() - 64);
      bodies_.Move(std::span(ids_).subspan(first, 64),
                   std::span(states_[state]).subspan(first, 64));
      return;
    }
    bodies_.Move(ids_, states_[state]);
    bodies_.Update();
    if (other == Other::kFramesWithPairs) bodies_.UpdatePairs();
  }

  Scene scene_;
  Scene::Ids ids_;
  std::vector<std::vector<Aabb3>> states_;
  std::vector<Aabb3> queries_;
  AabbBroadPhase3 bodies_;
  std::size_t changes_ = 0;
};

}  // namespace

Tables RunBeside(Run& run) {
  Table table{"beside",
              "queries of a broad phase while another thread changes it",
              {Key("bodies"), Key("the other thread"),
               Value("Mqueries/s", "", 3), Value("share of alone"),
               Value("us, p99", "", 2), Value("us, longest", "", 0)}};
  if (UsableCpus() < 2) {
    table.notes = {"Not measured: this run may use one CPU."};
    return {table};
  }
  for (const std::size_t size : {1024u, 16'384u, 65'536u}) {
    Beside beside(size);
    std::array<std::vector<double>, kOthers.size()> queries;
    std::array<std::vector<double>, kOthers.size()> shares;
    std::array<std::vector<double>, kOthers.size()> p99;
    std::array<std::vector<double>, kOthers.size()> longest;
    for (std::size_t t = 0; t < run.effort.repetitions; ++t) {
      double alone = 0;
      for (std::size_t o = 0; o < kOthers.size(); ++o) {
        const Beside::Result result = beside.Run(static_cast<Other>(o));
        if (result.time.cpu_share < kWholeCpu) continue;
        if (o == 0) alone = result.queries;
        queries[o].push_back(1e-6 * result.queries);
        if (alone > 0) shares[o].push_back(result.queries / alone);
        p99[o].push_back(1e6 * result.p99);
        longest[o].push_back(1e6 * result.longest);
      }
    }
    for (std::size_t o = 0; o < kOthers.size(); ++o) {
      const auto cell = [](const std::vector<double>& values, bool is_range) {
        if (values.empty()) return Cell();
        return is_range ? Cell(RangeOf(values)) : Cell(RangeOf(values).median);
      };
      table.Add({size, kOthers[o], cell(queries[o], false),
                 cell(shares[o], true), cell(p99[o], false),
                 cell(longest[o], false)});
    }
  }
  table.notes = {
      "\"moves 64\" calls Move() for 64 bodies all the time, \"updates\" moves "
      "all bodies and calls Update(), and \"finds pairs\" also UpdatePairs(). "
      "There is no figure if other programs took the CPUs."};
  return {table};
}

}  // namespace halfspace::bench

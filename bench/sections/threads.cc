// Scans that threads share, against one thread. And queries of a broad phase,
// while another thread changes it.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/machine.h"
#include "bench/measure/team.h"
#include "bench/sections/run.h"
#include "bench/worlds/body_scene.h"
#include "halfspace/broad_phase.h"
#include "halfspace/reject_many.h"
#include "halfspace/transform.h"

namespace halfspace::bench {
namespace {

// A thread that had less of a CPU shared it with other programs.
constexpr double kLeastShare = 0.9;
// Long enough that a thread which starts late does not count.
constexpr double kSeconds = 0.02;

// A scan that threads share: each takes a range of the objects, in whole words.
// Real time: the CPU time of a thread alone does not see that it waits for
// memory that the others take. Runs in which another program took a CPU are
// left out.
void AddRows(Run& run, const std::string& name, const SimplexView3& view,
             std::span<const DownSimplex3> queries,
             const std::vector<std::size_t>& counts, Table& table) {
  constexpr std::size_t kFewest = 3;
  constexpr double kWidest = 2.0;  // a range as wide answers nothing
  const Target target = run.best();
  const std::size_t words = MaskWords(view.size);
  std::vector<std::uint64_t> masks(queries.size() * words);
  const auto scan = [&](const Range& range) {
    const Options options{.target = target, .range = range};
    const auto to = std::span(masks).subspan(range.begin / 64);
    if (queries.size() == 1) {
      SurvivorMask(view, queries[0], to, options);
    } else {
      SurvivorMasks(view, queries, to, options, words);
    }
  };
  scan({0, view.size});
  const std::vector<std::uint64_t> expected = masks;
  const double once = SecondsOf([&] { scan({0, view.size}); });
  const auto rounds =
      static_cast<std::size_t>(std::clamp(kSeconds / once, 1.0, 1e6));
  std::vector<std::vector<double>> ns(counts.size());
  const std::size_t tries = std::max<std::size_t>(10, run.effort.repetitions);
  for (std::size_t t = 0; t < tries * counts.size(); ++t) {
    const std::size_t c = t % counts.size();
    std::fill(masks.begin(), masks.end(), 0x5555555555555555);
    const TeamTime time = RunTeam(counts[c], [&](std::size_t i) {
      const Range part = {
          words * i / counts[c] * 64,
          std::min(view.size, words * (i + 1) / counts[c] * 64)};
      for (std::size_t r = 0; r < rounds; ++r) scan(part);
    });
    if (masks != expected) {
      throw WrongAnswer("threads/" + name +
                        ": the masks are not those of one thread");
    }
    if (time.cpu_share < kLeastShare) continue;
    ns[c].push_back(1e9 * time.seconds /
                    static_cast<double>(queries.size() * view.size * rounds));
  }
  for (std::size_t c = 0; c < counts.size(); ++c) {
    const Ratio one = RangeOf(ns[0]);
    const Ratio all = RangeOf(ns[c]);
    const Ratio times{one.median / all.median, one.low / all.high,
                      one.high / all.low};
    const bool is_timed = std::min(ns[0].size(), ns[c].size()) >= kFewest &&
                          times.high < kWidest * times.low;
    table.Add({name, counts[c], is_timed ? Cell(all.median) : Cell(),
               is_timed ? Cell(times) : Cell()});
    if (!is_timed && counts[c] != 1) {
      table.notes.push_back(std::to_string(counts[c]) + " threads, " + name +
                            ": not measured. Other programs took the CPUs, "
                            "or the times differed by a factor of 2.");
    }
  }
}

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

Table BesideTable(const Run& run) {
  Table table{"threads: beside",
              "queries of a broad phase while another thread changes it",
              {Key("bodies"), Key("the other thread"),
               Value("Mqueries/s", "", 3), Value("share of alone"),
               Value("us, p99", "", 2), Value("us, longest", "", 0)}};
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
        if (result.time.cpu_share < kLeastShare) continue;
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
      "\"moves 64\" calls Move() all the time. \"updates\" moves all bodies "
      "and "
      "calls Update(), and \"finds pairs\" also UpdatePairs(). Without a "
      "figure "
      "if other programs took the CPUs."};
  return table;
}

}  // namespace

Tables RunThreads(Run& run) {
  Table table{"threads",
              "scans that threads share, real time",
              {Key("work"), Key("threads"), Value("ns/pair", "", 4),
               Value("times as fast as one")}};
  const int cpus = UsableCpus();
  if (cpus < 2) {
    table.notes = {"Not measured: this run may use one CPU."};
    return {table};
  }
  // 1, 2, 4, ... and all CPUs.
  std::vector<std::size_t> counts;
  for (std::size_t n = 1; n < static_cast<std::size_t>(cpus); n *= 2) {
    counts.push_back(n);
  }
  counts.push_back(static_cast<std::size_t>(cpus));
  constexpr std::size_t kObjects = std::size_t{1} << 16;
  constexpr std::size_t kQueries = 32;
  const AaboWorld3 cached = ResizedTo(run.Measured().objects, kObjects);
  const std::vector<Aabo3>& all = run.Measured().queries;
  std::vector<DownSimplex3> queries;
  for (std::size_t i = 0; i < kQueries; ++i) {
    queries.push_back(all[i % all.size()].down());
  }
  try {
    AddRows(run, "many queries, cache", cached.view().simplex(), queries,
            counts, table);
    for (WorkingSet* set : run.Sets({"memory"})) {
      AddRows(run, "one query, " + set->name(), set->view().simplex(),
              std::span(queries).first(1), counts, table);
    }
  } catch (const std::system_error& error) {
    table.notes.push_back(std::string("No thread can be started: ") +
                          error.what() + ".");
  }
  run.threads = table;
  // The page has the answers alone.
  return run.is_page() ? Tables() : Tables{table, BesideTable(run)};
}

}  // namespace halfspace::bench

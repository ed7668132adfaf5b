#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <system_error>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/machine.h"
#include "bench/measure/team.h"
#include "bench/sections/broad_phase_parts.h"
#include "halfspace/broad_phase.h"

namespace halfspace::bench {
namespace {

using Ids = std::vector<std::uint32_t>;
using Boxes = std::vector<Aabb3>;
using Scene = BodyScene<3>;

constexpr std::uint64_t kAll = ~std::uint64_t{0};

class BodyChanges {
 public:
  BodyChanges(std::size_t bodies, std::uint64_t seed, Throughput& throughput,
              BroadPhaseResult& result)
      : scene_(BodyKind::kGas, bodies, seed),
        seed_(seed),
        throughput_(throughput),
        result_(result),
        all_(scene_.AllIds()),
        boxes_(scene_.At(all_, 0)),
        size_(" of " + Grouped(bodies)) {}

  void RunInserts() {
    std::vector<double> inserts;
    std::vector<double> erasures;
    AabbBroadPhase3 space(all_.size());
    Repeat([&] {
      inserts.push_back(NsOf(all_.size(), [&] { space.Insert(all_, boxes_); }));
      space.Update();
      erasures.push_back(NsOf(all_.size(), [&] { space.Erase(all_); }));
      space.Update();
    });
    Add("insert of all", inserts, aims::kChangeOfMany);
    Add("erasure of all", erasures, aims::kChangeOfMany);

    // Of a world that stays.
    space.Insert(all_, boxes_);
    space.Update();
    const Ids some = scene_.Some(12);
    const Boxes boxes = scene_.At(some, 0);
    inserts.clear();
    erasures.clear();
    Repeat([&] {
      erasures.push_back(NsOf(some.size(), [&] { space.Erase(some); }));
      space.Update();
      inserts.push_back(NsOf(some.size(), [&] { space.Insert(some, boxes); }));
      space.Update();
    });
    Add("insert of 12 %", inserts, aims::kChangeOfMany);
    Add("erasure of 12 %", erasures, aims::kChangeOfMany);

    // Those of a frame, and more.
    for (std::size_t count : {200, 4000}) {
      if (count > some.size()) continue;
      inserts.clear();
      erasures.clear();
      Repeat([&] {
        erasures.push_back(NsOf(count, [&] {
          for (std::size_t i = 0; i < count; ++i) space.Erase(some[i]);
        }));
        space.Update();
        inserts.push_back(NsOf(count, [&] {
          for (std::size_t i = 0; i < count; ++i) {
            space.Insert(some[i], boxes[i]);
          }
        }));
        space.Update();
      });
      const std::string of = std::to_string(count);
      Add(of + " single inserts", inserts, aims::kChangeOfOne);
      Add(of + " single erasures", erasures, aims::kChangeOfOne);
    }
  }

  void RunMoves() {
    AabbBroadPhase3 space(all_.size(), {.margin = kBodyMargin});
    space.Insert(all_, boxes_);
    space.Update();
    const auto shifted = [this](float by) {
      Boxes boxes = boxes_;
      for (Aabb3& box : boxes) {
        for (float& x : box.min) x += by;
        for (float& x : box.max) x += by;
      }
      return boxes;
    };
    const Boxes near = shifted(0.5f * kBodyMargin);
    const Boxes far = shifted(5 * kBodyMargin);
    std::vector<double> within;
    std::vector<double> single;
    std::vector<double> beyond;
    Repeat([&] {
      within.push_back(NsOf(all_.size(), [&] { space.Move(all_, near); }));
      single.push_back(NsOf(all_.size(), [&] {
        for (std::size_t i = 0; i < all_.size(); ++i) {
          space.Move(all_[i], boxes_[i]);
        }
      }));
      beyond.push_back(NsOf(all_.size(), [&] { space.Move(all_, far); }));
      space.Update();
      space.Move(all_, boxes_);
      space.Update();
    });
    Add("move within the margin", within, aims::kMoveWithin);
    Add("single move within the margin", single, aims::kMoveWithin);
    Add("move beyond the margin", beyond, aims::kMoveBeyond);
  }

  // Bodies that are erased and inserted elsewhere, some each frame: in the same
  // frame or in the next one.
  void RunDecay(std::size_t changes, bool is_later) {
    AabbBroadPhase3 space(all_.size());
    space.Insert(all_, boxes_);
    space.Update();
    Random random(seed_ + 4);
    Boxes places = boxes_;
    const std::size_t in_frame = std::max<std::size_t>(1, all_.size() / 64);
    for (std::size_t done = 0; done < changes; done += in_frame) {
      Ids some;
      Boxes boxes;
      // Neighbours by id are not neighbours in space.
      const std::size_t first = random.Below(all_.size() - in_frame + 1);
      for (std::size_t i = first; i < first + in_frame; ++i) {
        places[i] = scene_.AnyBox(1 + 0.5f * random.Signed(), random);
        some.push_back(all_[i]);
        boxes.push_back(places[i]);
      }
      space.Erase(some);
      if (is_later) space.Update();
      space.Insert(some, boxes);
      space.Update();
    }
    AabbBroadPhase3 rebuilt(all_.size());
    rebuilt.Insert(all_, places);
    rebuilt.Rebuild();
    Boxes queries;
    for (std::size_t q = 0; q < kTimedQueries; ++q) {
      queries.push_back(scene_.AnyBox(2, random));
    }
    std::vector<Case> cases;
    std::array<std::size_t, 2> found{};
    for (const AabbBroadPhase3* each : {&space, &rebuilt}) {
      const auto find = [each](const Aabb3& query) {
        std::size_t count = 0;
        each->ForEach(query, kAll,
                      [&](std::uint32_t, const Aabb3&) { ++count; });
        return count;
      };
      cases.push_back(
          InTurn(each == &space ? "changed" : "rebuilt", queries,
                 queries.size(), queries.size(), [find](const Aabb3& query) {
                   KeepResult(static_cast<std::uint32_t>(find(query)));
                 }));
      cases.back().check = [&, find, each]() -> std::string {
        std::size_t& sum = found[each == &space ? 0 : 1];
        for (const Aabb3& query : queries) sum += find(query);
        return each == &space || found[0] == found[1] ? ""
                                                      : "the answers differ";
      };
    }
    const Timings timings =
        throughput_.TimeRuns(std::move(cases), throughput_.repetitions());
    throughput_.AddRatio(aims::kDecay, ChosenTarget(),
                         "queries" + size_ + " after " + Grouped(changes) +
                             " erasures and inserts" +
                             (is_later ? " a frame later" : "") +
                             ": time / time after a rebuild",
                         RatioOf(timings[0], timings[1]));
  }

  // CPU time, so that other programs do not count. Each thread has bodies of
  // its own, and queries them all.
  void RunThreads() {
    if (UsableCpus() < 2) {
      throughput_.NotReached("two threads: this run may use one CPU");
      return;
    }
    AabbBroadPhase3 space(all_.size(), {.margin = kBodyMargin});
    space.Insert(all_, boxes_);
    space.Update();
    const Boxes moved = scene_.At(all_, 1);
    std::array<std::vector<double>, 2> seconds;
    try {
      Repeat([&] {
        for (std::size_t threads : {1, 2}) {
          std::array<double, 2> of_thread{};
          RunTeam(threads, [&](std::size_t thread) {
            const double start = ThreadSeconds();
            std::uint32_t found = 0;
            for (std::size_t i = thread; i < all_.size(); i += 2) {
              space.Move(all_[i], moved[i]);
              space.ForEach(moved[i], kAll,
                            [&](std::uint32_t, const Aabb3&) { ++found; });
              space.Move(all_[i], boxes_[i]);
            }
            KeepResult(found);
            of_thread[thread] = ThreadSeconds() - start;
          });
          seconds[threads - 1].push_back(
              *std::max_element(of_thread.begin(), of_thread.end()));
        }
      });
    } catch (const std::system_error& error) {
      throughput_.NotReached(std::string("two threads: ") + error.what());
      return;
    }
    const Ratio ratio = RatioOf(seconds[0], seconds[1]);
    throughput_.AddRatio(
        aims::kTwoThreads, ChosenTarget(),
        "two threads that move and query" + size_ +
            ": times the rate of one, by CPU time",
        Ratio{2 * ratio.median, 2 * ratio.low, 2 * ratio.high});
  }

  void AddBytes() {
    AabbBroadPhase3 space(all_.size());
    space.Insert(all_, boxes_);
    space.Update();
    AddBytesOf(space, "at rest");
    space.Move(all_, scene_.At(all_, 1));
    space.Update();
    AddBytesOf(space, "after a frame");
    const auto ignore = [](std::uint32_t, std::uint32_t) {};
    space.UpdatePairs(ignore, ignore);
    AddBytesOf(space, "with all pairs");
  }

 private:
  // CPU time of this thread.
  template <typename Work>
  static double NsOf(std::size_t bodies, Work work) {
    const double start = ThreadSeconds();
    work();
    return 1e9 * (ThreadSeconds() - start) / static_cast<double>(bodies);
  }
  template <typename Work>
  void Repeat(Work work) const {
    for (std::size_t r = 0; r < 2 * throughput_.repetitions(); ++r) work();
  }

  void Add(const std::string& what, const std::vector<double>& ns,
           const Aim& aim) {
    const Timing timing{what, ns};
    result_.changes.Add({what, all_.size(), SpreadOf(timing)});
    throughput_.AddRatio(aim, ChosenTarget(), what + size_ + ": ns a body",
                         SpreadOf(timing));
  }
  void AddBytesOf(const AabbBroadPhase3& space, const std::string& when) {
    throughput_.AddRatio(
        aims::kBytesOfBody, ChosenTarget(),
        "bytes of a body beyond its bound" + size_ + ", " + when,
        static_cast<double>(space.Statistics().bytes) /
                static_cast<double>(all_.size()) -
            static_cast<double>(sizeof(Aabb3)));
  }

  Scene scene_;
  std::uint64_t seed_;
  Throughput& throughput_;
  BroadPhaseResult& result_;
  Ids all_;
  Boxes boxes_;
  std::string size_;
};

}  // namespace

void RunBodyChanges(std::size_t bodies, std::uint64_t seed,
                    Throughput& throughput, BroadPhaseResult& result) {
  for (std::size_t size : {1024, 16384, 65536}) {
    if (size > bodies && size != 1024) continue;
    BodyChanges changes(std::min(size, bodies), seed, throughput, result);
    changes.RunInserts();
    changes.RunMoves();
    if (size == 65536) continue;
    for (bool is_later : {false, true}) {
      changes.RunDecay(throughput.is_quick() ? 10'000 : 1'000'000, is_later);
    }
    changes.RunThreads();
    changes.AddBytes();
  }
}

}  // namespace halfspace::bench

// Which structure, for how many queries between two changes of the world.
#include "bench/sections/structures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "bench/measure/curves.h"
#include "bench/measure/groups.h"
#include "bench/sections/run.h"
#include "bench/worlds/scene.h"
#include "halfspace/bvh.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

constexpr std::array<std::size_t, 5> kSizes = {100, 1000, 10'000, 100'000,
                                               1'000'000};
constexpr double kShare = 0.02;  // of the world's side: the paper's density
constexpr std::size_t kQueries = 2000;
constexpr std::size_t kCheckedQueries = 64;

// A world of boxes in three structures.
class Structures {
 public:
  Structures(std::size_t objects, std::uint64_t seed, Target target)
      : scene_(SceneOfSize(kShare, objects, seed, kQueries)),
        view_(scene_.objects.view().aabb()),
        quantized_(view_),
        bvh_(view_, kFast),
        options_({.target = target}),
        found_(objects) {
    for (const Aabo3& query : scene_.queries) queries_.push_back(query.aabb());
  }

  // The query in each structure, and the two builds.
  enum Job : std::size_t { kScan, kQuantized, kBvh, kEncode, kBuild };
  std::vector<Case> Cases() {
    std::vector<Case> cases;
    const auto query = [&](const char* name, std::size_t per_run, auto find) {
      cases.push_back(InTurn(name, queries_, queries_.size(), per_run,
                             [find](const Aabb3& box) { (void)find(box); }));
      cases.back().check = [this, find]() -> std::string {
        for (std::size_t q = 0; q < kCheckedQueries; ++q) {
          const Options flat{.schedule = Schedule::kFlat};
          if (find(queries_[q]) != CountSurvivors(view_, queries_[q], flat)) {
            return "the survivors are not as many as a flat scan finds";
          }
        }
        return {};
      };
    };
    const std::size_t in_a_scan = std::clamp<std::size_t>(
        (std::size_t{1} << 16) / view_.size, 1, kCheckedQueries);
    query("structures/scan", in_a_scan, [this](const Aabb3& box) {
      return Survivors(view_, box, found_, options_);
    });
    query("structures/quantized", in_a_scan, [this](const Aabb3& box) {
      return Survivors(quantized_, box, found_, options_);
    });
    query("structures/BVH", kCheckedQueries, [this](const Aabb3& box) {
      return Survivors(bvh_, box, found_, {.target = options_.target});
    });
    cases.resize(5);
    cases[kEncode].name = "structures/encode";
    cases[kEncode].run = [this] {
      const Quantized made(view_);
      KeepResult(static_cast<std::uint32_t>(made.size()));
    };
    cases[kBuild].name = "structures/build";
    cases[kBuild].run = [this] {
      const Tree made(view_, kFast);
      KeepResult(static_cast<std::uint32_t>(made.size()));
    };
    return cases;
  }

 private:
  using Quantized = QuantizedWorld<AabbView3>;
  using Tree = Bvh<AabbView3>;
  static constexpr BuildOptions kFast = {.quality = BuildQuality::kFast};

  Workload scene_;
  AabbView3 view_;
  Quantized quantized_;
  Tree bvh_;
  Options options_;
  std::vector<Aabb3> queries_;
  std::vector<std::uint32_t> found_;
};

// The number of queries, or "never".
Cell QueriesCell(const Ratio& queries) {
  if (!std::isfinite(queries.median)) return "never";
  return Ratio{std::ceil(queries.median), std::ceil(queries.low),
               std::ceil(queries.high)};
}

}  // namespace

Table StructuresTable(Run& run) {
  Table table{
      "answers: structures",
      "time of a query and of making a structure, and the queries between two "
      "changes of the world from which that pays",
      {Key("objects"), Value("scan", "us"), Value("quantized", "us"),
       Value("BVH", "us"), Value("encode", "us", 0), Value("build", "us", 0),
       Value("encoding pays from", "", 0), Value("a BVH pays from", "", 0)}};
  table.chart = Chart{
      "objects", {"encoding pays from", "a BVH pays from"}, "", true, true};
  Effort effort = run.effort;
  effort.repetitions =
      run.options.repetitions != 0 ? run.options.repetitions : 9;
  for (std::size_t objects : kSizes) {
    if (run.options.objects != 0 && objects > run.options.objects) continue;
    Structures structures(objects, run.options.seed, run.best());
    const std::vector<Timing> ns = run.Time(structures.Cases(), effort);
    std::vector<double> encoding;
    std::vector<double> bvh;
    for (std::size_t r = 0; r < effort.repetitions; ++r) {
      const auto of = [&](Structures::Job job) { return ns[job].samples[r]; };
      const StructureCost scan{0.0, of(Structures::kScan)};
      const StructureCost quantized{of(Structures::kEncode),
                                    of(Structures::kQuantized)};
      const StructureCost tree{of(Structures::kBuild), of(Structures::kBvh)};
      encoding.push_back(PaysFrom(quantized, scan));
      bvh.push_back(PaysFrom(tree, scan));
      // Where encoding takes longer than the scan, nobody encodes.
      if (encoding.back() < bvh.back()) {
        bvh.back() = std::max(bvh.back(), PaysFrom(tree, quantized));
      }
    }
    const auto us = [&](Structures::Job job) { return ns[job].Median() / 1e3; };
    table.Add({objects, us(Structures::kScan), us(Structures::kQuantized),
               us(Structures::kBvh), us(Structures::kEncode),
               us(Structures::kBuild), QueriesCell(GroupRange(encoding)),
               QueriesCell(GroupRange(bvh))});
  }
  // The page needs the answers alone.
  if (run.is_page()) {
    const auto drop = [](auto& list) {
      list.erase(list.begin() + 4, list.begin() + 6);
    };
    drop(table.columns);
    for (Row& row : table.rows) drop(row);
  }
  table.notes = {
      "Boxes that take 2 % of the world's side, a list of survivors for each "
      "query, one thread, the BVH by its fast build. A BVH whose objects move "
      "a little can be refitted instead, in less time: section bvh."};
  return table;
}

}  // namespace halfspace::bench

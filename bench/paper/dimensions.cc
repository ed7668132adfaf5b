#include "bench/paper/dimensions.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/sections/run.h"
#include "bench/worlds/scene_of_dimension.h"
#include "bench/worlds/working_set.h"
#include "halfspace/reject.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kObjectsStep = 4096;
constexpr std::size_t kCheckedQueries = 2;
constexpr std::size_t kCountedPairs = std::size_t{1} << 27;

// The library's calls in the scene of so many dimensions.
template <int kDims>
class DimensionCases {
 public:
  DimensionCases(std::size_t bytes, std::uint64_t seed)
      : scene_(MakeSceneOf<kDims>(
            std::max(kObjectsStep,
                     bytes / sizeof(Aabo<kDims>) / kObjectsStep * kObjectsStep),
            kTimedQueries, seed)),
        view_(scene_.objects.view()),
        mask_(MaskWords(view_.size)) {}

  void AddRow(Run& run, Table& table) {
    const Target target = run.best();
    const auto simplex = [this](const Aabo<kDims>& query, auto&& f) {
      f(view_.simplex(), query.down());
    };
    const auto box = [this](const Aabo<kDims>& query, auto&& f) {
      f(view_.aabb(), query.aabb());
    };
    const auto all = [this](const Aabo<kDims>& query, auto&& f) {
      f(view_, query);
    };
    const Options flat = {.schedule = Schedule::kFlat, .target = target};
    const Options staged = {.schedule = Schedule::kStaged, .target = target};
    const std::vector<Timing> ns = run.Time(
        {MakeCase("simplex/flat", flat, simplex),
         MakeCase("aabb/flat", flat, box), MakeCase("aabb/staged", staged, box),
         MakeCase("aabo/flat", flat, all),
         MakeCase("aabo/staged", staged, all)});
    const std::size_t fastest_box = ns[1].Median() <= ns[2].Median() ? 1 : 2;
    const std::size_t fastest_aabo = ns[3].Median() <= ns[4].Median() ? 3 : 4;
    PerShape<double> sums;
    const std::size_t queries =
        std::min(scene_.queries.size(), kCountedPairs / view_.size);
    for (std::size_t q = 0; q < queries; ++q) {
      const Aabo<kDims>& query = scene_.queries[q];
      const auto add = [](double& sum, std::size_t count) {
        sum += static_cast<double>(count);
      };
      add(sums.aabb, CountSurvivors(view_.aabb(), query.aabb()));
      add(sums.simplex, CountSurvivors(view_.simplex(), query.down()));
      add(sums.aabo, CountSurvivors(view_, query));
    }
    table.Add({std::size_t{kDims}, NameOf(target), ns[0].Median(),
               RatioOf(ns[1], ns[0]), RatioOf(ns[fastest_box], ns[0]),
               RatioOf(ns[fastest_aabo], ns[0]), sums.simplex / sums.aabb,
               sums.aabo / sums.aabb});
  }

 private:
  // with_shape(query, f) calls f(view, query) of a shape.
  template <typename WithShape>
  Case MakeCase(const std::string& name, const Options& options,
                const WithShape& with_shape) {
    const std::string group = "volumes/" + std::to_string(kDims) + "D/";
    const std::size_t per_run =
        std::max<std::size_t>(1, kObjectsPerRun / view_.size);
    const auto scan = [this, options, with_shape](const Aabo<kDims>& query) {
      with_shape(query, [&](const auto& view, const auto& shape) {
        RejectMask(view, shape, mask_, options);
      });
    };
    Case c;
    c.name = group + name;
    c.group = group;
    c.items = static_cast<double>(view_.size * per_run);
    c.check = [this, scan, with_shape]() -> std::string {
      std::vector<std::uint64_t> expected(mask_.size());
      for (std::size_t q = 0; q < kCheckedQueries; ++q) {
        with_shape(scene_.queries[q], [&](const auto& view, const auto& shape) {
          reference::RejectMask(view, shape, expected.data());
        });
        scan(scene_.queries[q]);
        if (mask_ != expected) return "the mask is not the scalar reference's";
      }
      return {};
    };
    c.run = [this, scan, per_run, next = std::size_t{0}]() mutable {
      for (std::size_t i = 0; i < per_run; ++i) {
        scan(scene_.queries[next]);
        next = next + 1 == scene_.queries.size() ? 0 : next + 1;
      }
    };
    return c;
  }

  SceneOf<kDims> scene_;
  AaboView<kDims> view_;
  std::vector<std::uint64_t> mask_;
};

}  // namespace

Table DimensionsTable() {
  return {"volumes: dimensions",
          "the scene in 2, 3 and 4 dimensions, L2: times over the simplex's",
          {Key("dimensions"), Key("target"), Value("simplex", "ns", 4),
           Higher("flat AABB"), Higher("best AABB"), Lower("best AABO"),
           Value("c of simplex"), Value("c of AABO")}};
}

void AddDimension(Run& run, std::size_t dimensions, std::size_t bytes,
                  Table& table) {
  const std::uint64_t seed = run.options.seed;
  switch (dimensions) {
    case 2:
      return DimensionCases<2>(bytes, seed).AddRow(run, table);
    case 3:
      return DimensionCases<3>(bytes, seed).AddRow(run, table);
    default:
      return DimensionCases<4>(bytes, seed).AddRow(run, table);
  }
}

}  // namespace halfspace::bench

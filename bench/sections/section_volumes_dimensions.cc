#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/sections/alternatives.h"
#include "bench/sections/plan.h"
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

  DimensionRow Run(const Context& context) {
    const Target target = context.targets.front();
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
    const Timings timings = TimeCases(
        {MakeCase("simplex/flat", flat, simplex),
         MakeCase("aabb/flat", flat, box), MakeCase("aabb/staged", staged, box),
         MakeCase("aabo/flat", flat, all),
         MakeCase("aabo/staged", staged, all)},
        context.effort, context);
    DimensionRow row;
    row.dimensions = kDims;
    row.target = target.name();
    row.objects = view_.size;
    row.scale = scene_.scale;
    row.simplex_ns = timings[0].Median();
    row.aabb_flat_ns = timings[1].Median();
    row.aabb_staged_ns = timings[2].Median();
    row.aabo_flat_ns = timings[3].Median();
    row.aabo_staged_ns = timings[4].Median();
    row.simplex_over_flat_aabb = RatioOf(timings[0], timings[1]);
    row.simplex_over_fastest_aabb = RatioOf(
        timings[0], timings[row.aabb_flat_ns <= row.aabb_staged_ns ? 1 : 2]);
    row.queries = std::min(scene_.queries.size(), kCountedPairs / view_.size);
    for (std::size_t q = 0; q < row.queries; ++q) {
      const Aabo<kDims>& query = scene_.queries[q];
      row.aabb_survivors += CountSurvivors(view_.aabb(), query.aabb());
      row.simplex_survivors += CountSurvivors(view_.simplex(), query.down());
      row.aabo_survivors += CountSurvivors(view_, query);
    }
    return row;
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

DimensionRow RunDimension(std::size_t dimensions, std::size_t bytes,
                          std::uint64_t seed, const Context& context) {
  switch (dimensions) {
    case 2:
      return DimensionCases<2>(bytes, seed).Run(context);
    case 3:
      return DimensionCases<3>(bytes, seed).Run(context);
    default:
      return DimensionCases<4>(bytes, seed).Run(context);
  }
}

}  // namespace halfspace::bench

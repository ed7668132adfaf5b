#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/baselines/axes_builder.h"
#include "bench/sections/alternatives.h"
#include "bench/sections/plan.h"
#include "bench/worlds/cloud_bounds.h"
#include "bench/worlds/point_source.h"
#include "bench/worlds/regular_bounds.h"
#include "halfspace/fit.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kCounted = 32768;
constexpr std::size_t kCountedQueries = 8192;

Aabo3 BoundOnStandardAxes(std::span<const float> points) {
  return BoundPoints(Points3{points.data(), points.size() / 3});
}

struct BothBounds {
  Aabo3 standard;
  Aabo3 regular;
};

BothBounds BoundBoth(std::span<const float> points) {
  return {BoundOnStandardAxes(points), BoundOnRegularAxes(points)};
}

void CountWorld(const PointSource& source, const Context& context,
                std::vector<AlignmentRow>& rows) {
  AaboWorld3 standard;
  AaboWorld3 regular;
  for (std::size_t i = 0; i < source.objects; ++i) {
    const BothBounds both = BoundBoth(source.next_object());
    standard.Push(both.standard);
    regular.Push(both.regular);
  }
  AlignmentRow row;
  row.world = source.name;
  row.objects = source.objects;
  row.queries = std::min(kCountedQueries, 4 * source.objects);
  row.axes = "standard";
  AlignmentRow on_regular = row;
  on_regular.axes = "regular";
  for (std::size_t q = 0; q < row.queries; ++q) {
    const BothBounds query = BoundBoth(source.next_query());
    row.aabb_survivors +=
        CountSurvivors(standard.view().aabb(), query.standard.aabb());
    const auto count = [](const AaboWorld3& world, const Aabo3& with,
                          AlignmentRow& to) {
      const AaboView3 view = world.view();
      to.simplex_survivors += CountSurvivors(view.simplex(), with.down());
      to.aabo_survivors += CountSurvivors(view, with);
    };
    count(standard, query.standard, row);
    count(regular, query.regular, on_regular);
    if (q % 256 == 0) {
      context.progress.Update(static_cast<double>(q) /
                              static_cast<double>(row.queries));
    }
  }
  on_regular.aabb_survivors = row.aabb_survivors;
  rows.push_back(row);
  rows.push_back(on_regular);
}

void PlanConstruction(Plan<ConstructionRow>& plan, CloudBounds& clouds,
                      Target target) {
  const std::string prefix = "axes/" + std::string(target.name()) + "/";
  std::size_t standard = 0;
  for (Axes axes : kAllAxes) {
    Case c = clouds.MakeCase(prefix + NameOf(axes), axes, target);
    c.group = prefix;
    const std::size_t place = plan.AddCase(std::move(c));
    if (axes == Axes::kStandard) standard = place;
    ConstructionRow row;
    row.axes = NameOf(axes);
    row.target = target.name();
    row.clouds = clouds.size();
    row.flops_per_point = FlopsOf(axes);
    row.rounded_planes = RoundedPlanesOf(axes);
    row.pad_over_extent = clouds.MeanPad(axes, target);
    plan.AddRow(std::move(row), [place, standard](const Timings& timings,
                                                  ConstructionRow& timed) {
      timed.ns_per_cloud = timings[place].Median();
      timed.over_standard = RatioOf(timings[place], timings[standard]);
    });
  }
}

}  // namespace

AxesResult RunAxes(const Workload* input, std::uint64_t seed,
                   const Context& context) {
  AxesResult result;
  result.seed = seed;
  std::vector<PointSource> worlds = {BallSource(kCounted, seed),
                                     BoxSource(kCounted, seed),
                                     MixedSource(kCounted, seed)};
  if (input != nullptr) worlds.push_back(FileSource(*input, kCounted, seed));
  const std::size_t parts = worlds.size() + 1;
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    context.progress.BeginPart(w, parts);
    CountWorld(worlds[w], context, result.alignment);
  }
  context.progress.BeginPart(worlds.size(), parts);
  // 512 clouds are 300 KB: they sit in most second-level caches.
  constexpr std::size_t kClouds = 512;
  CloudBounds clouds(BallSource(kClouds, seed));
  Plan<ConstructionRow> plan;
  for (Target target : context.targets) {
    PlanConstruction(plan, clouds, target);
  }
  plan.Run(context.effort, context, result.construction);
  return result;
}

}  // namespace halfspace::bench

// Survivors with the paper's axes and with the axes of a regular simplex.
#include <array>
#include <cstddef>
#include <vector>

#include "bench/paper/points.h"
#include "bench/sections/run.h"
#include "halfspace/fit.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kObjects = 32768;
constexpr std::size_t kQueries = 8192;

// Of the same points, on each kind of axes.
using Bounds = std::array<Aabo3, 2>;
constexpr std::array<const char*, 2> kAxes = {"standard", "regular"};

Bounds BoundNext(const NextPoints& next) {
  const std::span<const float> points = next();
  return {BoundPoints(Points3{points.data(), points.size() / 3}),
          BoundOnRegularAxes(points)};
}

void AddRows(Run& run, const char* name, const NextPoints& next, Table& table) {
  std::array<AaboWorld3, 2> worlds;
  for (std::size_t i = 0; i < kObjects; ++i) {
    const Bounds object = BoundNext(next);
    for (std::size_t a : {0, 1}) worlds[a].Push(object[a]);
  }
  std::array<std::size_t, 2> simplex{};
  std::array<std::size_t, 2> aabo{};
  std::size_t boxes = 0;
  for (std::size_t q = 0; q < kQueries; ++q) {
    const Bounds query = BoundNext(next);
    boxes += CountSurvivors(worlds[0].view().aabb(), query[0].aabb());
    for (std::size_t a : {0, 1}) {
      simplex[a] += CountSurvivors(worlds[a].view().simplex(), query[a].down());
      aabo[a] += CountSurvivors(worlds[a].view(), query[a]);
    }
    run.progress.Update(static_cast<double>(q) / kQueries);
  }
  const auto over = [boxes](std::size_t survivors) {
    return static_cast<double>(survivors) / static_cast<double>(boxes);
  };
  for (std::size_t a : {0, 1}) {
    table.Add({name, kAxes[a], "simplex", simplex[a], over(simplex[a])});
    table.Add({name, kAxes[a], "AABO", aabo[a], over(aabo[a])});
  }
}

}  // namespace

Tables RunAxes(Run& run) {
  const std::uint64_t seed = run.options.seed;
  Table table{"axes",
              "survivors with the axes X, Y, Z, -(X + Y + Z) and with those of "
              "a regular simplex",
              {Key("world"), Key("axes"), Key("shape"),
               Value("survivors", "", 0), Value("over AABB")}};
  AddRows(run, "balls", ScenePoints(seed), table);
  AddRows(run, "boxes", BoxPoints(seed), table);
  return {table};
}

}  // namespace halfspace::bench

// Survivors with the paper's axes and with the axes of a regular simplex.
#include <array>
#include <cstddef>
#include <span>

#include "bench/base/shape.h"
#include "bench/paper/points.h"
#include "bench/sections/run.h"
#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kObjects = 32768;
constexpr std::size_t kQueries = 8192;

void AddRows(const char* name, const NextPoints& next, Table& table) {
  // Bounds of the same points, on each kind of axes.
  constexpr std::array<const char*, 2> kAxes = {"standard", "regular"};
  const auto bound_next = [&next]() -> std::array<Aabo3, 2> {
    const std::span<const float> points = next();
    return {BoundPoints(Points3{points.data(), points.size() / 3}),
            BoundOnRegularAxes(points)};
  };
  std::array<AaboWorld3, 2> worlds;
  for (std::size_t i = 0; i < kObjects; ++i) {
    const auto object = bound_next();
    for (std::size_t a : {0, 1}) worlds[a].Push(object[a]);
  }
  std::array<PerShape<std::size_t>, 2> survivors;
  for (std::size_t q = 0; q < kQueries; ++q) {
    const auto query = bound_next();
    for (std::size_t a : {0, 1}) {
      AddSurvivors(worlds[a].view(), query[a], survivors[a]);
    }
  }
  for (std::size_t a : {0, 1}) {
    for (ShapeKind shape : {ShapeKind::kSimplex, ShapeKind::kAabo}) {
      const std::size_t count = survivors[a].Of(shape);
      table.Add({name, kAxes[a], NameOf(shape), count,
                 static_cast<double>(count) /
                     static_cast<double>(survivors[0].aabb)});
    }
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
  AddRows("balls", ScenePoints(seed), table);
  AddRows("boxes", BoxPoints(seed), table);
  return {table};
}

}  // namespace halfspace::bench

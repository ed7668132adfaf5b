#include "bench/baselines/exact_tests.h"

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/queries_in_turn.h"
#include "bench/sections/exact_tests.h"
#include "bench/sections/run.h"
#include "bench/worlds/random.h"

namespace halfspace::bench {
namespace {

template <typename Shape>
Case TestCase(const char* name, const std::vector<std::pair<Shape, Shape>>& all,
              std::size_t& touching) {
  Case c = InTurn(std::string("exact/") + name, all, all.size(), all.size(),
                  [&touching](const std::pair<Shape, Shape>& pair) {
                    touching += Touch(pair.first, pair.second) ? 1 : 0;
                  });
  c.group = "exact";
  c.check = [&all]() -> std::string {
    for (const auto& [a, b] : all) {
      if (Touch(a, b) != Touch(b, a)) return "a pair touches one way only";
    }
    return {};
  };
  return c;
}

}  // namespace

std::vector<ExactTest> MeasureExactTests(Run& run) {
  // So many that no predictor learns them, around each other as candidates are.
  constexpr float kBetween = 0.75f;
  Random random(run.options.seed);
  const auto vector = [&random](float scale) {
    Vector3 v;
    for (float& x : v) x = scale * random.Signed();
    return v;
  };
  const auto moved = [](Vector3 v, const Vector3& by) {
    for (std::size_t k = 0; k < 3; ++k) v[k] += by[k];
    return v;
  };
  const auto triangle = [&] {
    const Vector3 at = vector(kBetween);
    return Triangle{moved(vector(0.5f), at), moved(vector(0.5f), at),
                    moved(vector(0.5f), at)};
  };
  const auto sphere = [&] { return Sphere3{vector(kBetween), 0.5f}; };
  // Turned about one axis by an angle of a Pythagorean triple: unit vectors.
  const auto box = [&] {
    OrientedBox b{vector(kBetween), {}, {0.5f, 0.3f, 0.2f}};
    const std::size_t up = random.Below(3);
    b.axes[up][up] = 1.0f;
    const std::size_t x = (up + 1) % 3;
    const std::size_t y = (up + 2) % 3;
    b.axes[x][x] = b.axes[y][y] = 0.8f;
    b.axes[x][y] = 0.6f;
    b.axes[y][x] = -0.6f;
    return b;
  };
  std::vector<std::pair<Triangle, Triangle>> triangles;
  std::vector<std::pair<Sphere3, Sphere3>> spheres;
  std::vector<std::pair<OrientedBox, OrientedBox>> boxes;
  for (std::size_t i = 0; i < kTimedQueries; ++i) {
    triangles.emplace_back(triangle(), triangle());
    spheres.emplace_back(sphere(), sphere());
    boxes.emplace_back(box(), box());
  }
  std::size_t touching = 0;
  const std::vector<Case> cases = {
      TestCase("triangle-triangle", triangles, touching),
      TestCase("sphere-sphere", spheres, touching),
      TestCase("box-box", boxes, touching)};
  const std::vector<Timing> timings = run.Time(cases);
  KeepResult(static_cast<std::uint32_t>(touching));
  std::vector<ExactTest> tests;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    tests.push_back(
        {std::array{"triangle-triangle", "sphere-sphere", "box-box"}[i],
         SpreadOf(timings[i])});
  }
  return tests;
}

}  // namespace halfspace::bench

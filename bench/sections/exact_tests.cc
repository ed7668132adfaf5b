#include "bench/sections/exact_tests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/measure.h"
#include "bench/sections/run.h"
#include "bench/worlds/random.h"
#include "halfspace/shapes.h"

namespace halfspace::bench {
namespace {

// Tests of two shapes by separating axes, in floats, as engines have them. True
// if the shapes have a point in common.
using Vector3 = std::array<float, 3>;
using Triangle = std::array<Vector3, 3>;

struct OrientedBox {
  Vector3 center;
  std::array<Vector3, 3> axes;  // unit vectors
  Vector3 half;                 // along each of them
};

Vector3 Minus(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

float Dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector3 Cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}

bool IsSeparatedBy(const Vector3& axis, const Triangle& a, const Triangle& b) {
  const Vector3 of_a = {Dot(axis, a[0]), Dot(axis, a[1]), Dot(axis, a[2])};
  const Vector3 of_b = {Dot(axis, b[0]), Dot(axis, b[1]), Dot(axis, b[2])};
  const auto least = [](const Vector3& v) {
    return std::min(std::min(v[0], v[1]), v[2]);
  };
  const auto most = [](const Vector3& v) {
    return std::max(std::max(v[0], v[1]), v[2]);
  };
  return least(of_a) > most(of_b) || most(of_a) < least(of_b);
}

Triangle EdgesOf(const Triangle& t) {
  return {Minus(t[1], t[0]), Minus(t[2], t[1]), Minus(t[0], t[2])};
}

// The radius of a box along an axis.
float Reach(const OrientedBox& box, const Vector3& axis) {
  float reach = 0.0f;
  for (std::size_t k = 0; k < 3; ++k) {
    reach += box.half[k] * std::abs(Dot(box.axes[k], axis));
  }
  return reach;
}

bool Touch(const Triangle& a, const Triangle& b) {
  const Triangle edges_a = EdgesOf(a);
  const Triangle edges_b = EdgesOf(b);
  const Vector3 normal_a = Cross(edges_a[0], edges_a[1]);
  const Vector3 normal_b = Cross(edges_b[0], edges_b[1]);
  if (IsSeparatedBy(normal_a, a, b) || IsSeparatedBy(normal_b, a, b)) {
    return false;
  }
  for (const Vector3& edge_a : edges_a) {
    for (const Vector3& edge_b : edges_b) {
      if (IsSeparatedBy(Cross(edge_a, edge_b), a, b)) return false;
    }
  }
  // In one plane, all of the above are that plane's normal.
  for (std::size_t k = 0; k < 3; ++k) {
    if (IsSeparatedBy(Cross(normal_a, edges_a[k]), a, b)) return false;
    if (IsSeparatedBy(Cross(normal_b, edges_b[k]), a, b)) return false;
  }
  return true;
}

bool Touch(const Sphere3& a, const Sphere3& b) {
  const Vector3 between = Minus(a.center, b.center);
  const float reach = a.radius + b.radius;
  return Dot(between, between) <= reach * reach;
}

bool Touch(const OrientedBox& a, const OrientedBox& b) {
  const Vector3 between = Minus(b.center, a.center);
  const auto is_separated_by = [&](const Vector3& axis) {
    return std::abs(Dot(between, axis)) > Reach(a, axis) + Reach(b, axis);
  };
  for (const Vector3& axis : a.axes) {
    if (is_separated_by(axis)) return false;
  }
  for (const Vector3& axis : b.axes) {
    if (is_separated_by(axis)) return false;
  }
  for (const Vector3& axis_a : a.axes) {
    for (const Vector3& axis_b : b.axes) {
      if (is_separated_by(Cross(axis_a, axis_b))) return false;
    }
  }
  return true;
}

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

// What an exact test of a pair costs.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bench/sections/run.h"
#include "bench/worlds/random.h"

namespace halfspace::bench {
namespace {

// A test by separating axes, in floats, as engines have it. True if the
// triangles have a point in common.
using Vector3 = std::array<float, 3>;
using Triangle = std::array<Vector3, 3>;

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

}  // namespace

ExactTest MeasureExactTest(Run& run) {
  // So many that no predictor learns them, around each other as candidates are.
  constexpr float kBetween = 0.75f;
  Random random(run.options.seed);
  const auto triangle = [&random] {
    Vector3 at;
    for (float& x : at) x = kBetween * random.Signed();
    Triangle corners;
    for (Vector3& corner : corners) {
      for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = at[k] + 0.5f * random.Signed();
      }
    }
    return corners;
  };
  std::vector<std::pair<Triangle, Triangle>> pairs;
  for (std::size_t i = 0; i < kTimedQueries; ++i) {
    pairs.emplace_back(triangle(), triangle());
  }
  std::size_t touching = 0;
  Case c = InTurn("exact/triangle-triangle", pairs, pairs.size(), pairs.size(),
                  [&touching](const std::pair<Triangle, Triangle>& pair) {
                    touching += Touch(pair.first, pair.second) ? 1 : 0;
                  });
  c.check = [&pairs]() -> std::string {
    for (const auto& [a, b] : pairs) {
      if (Touch(a, b) != Touch(b, a)) return "a pair touches one way only";
    }
    return {};
  };
  const Ratio ns = SpreadOf(run.Time({c}).front());
  KeepResult(static_cast<std::uint32_t>(touching));
  return {"triangle-triangle", ns};
}

}  // namespace halfspace::bench

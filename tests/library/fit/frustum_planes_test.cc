// FrustumPlanes: no point that a matrix takes into clip space is lost, and no
// point far outside is kept. Clip coordinates are computed in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "halfspace/frustum.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

using Exact = long double;
using Matrix = std::array<std::array<float, 4>, 4>;  // [row][column]
using Vector = std::array<double, 3>;

enum Projection {
  kOpenGl,
  kDirect3d,
  kReversed,
  kOrthographic,
  kInfinite,
  kReversedInfinite,
  kProjections
};

struct Camera {
  Vector eye, forward, right, up;
  double near, far, tangent, aspect;
  Projection projection;
  ClipDepth depth;
  Matrix matrix;

  bool is_infinite() const {
    return projection == kInfinite || projection == kReversedInfinite;
  }
  // A point at a depth, and at places from -1 to 1 of its cross section.
  std::array<Exact, 3> At(double distance, double x, double y) const {
    const double height =
        projection == kOrthographic ? tangent : tangent * distance;
    std::array<Exact, 3> point;
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = Exact{eye[k]} + Exact{forward[k]} * distance +
                 Exact{right[k]} * (x * height * aspect) +
                 Exact{up[k]} * (y * height);
    }
    return point;
  }
  bool Sees(const std::array<Exact, 3>& point) const {
    std::array<Exact, 4> clip;
    for (std::size_t r = 0; r < 4; ++r) {
      clip[r] = matrix[r][3];
      for (std::size_t k = 0; k < 3; ++k) clip[r] += matrix[r][k] * point[k];
    }
    const auto& [x, y, z, w] = clip;
    return std::abs(x) <= w && std::abs(y) <= w && z <= w &&
           z >= (depth == ClipDepth::kZeroToOne ? 0 : -w);
  }
};

Camera RandomCamera(SeededNumbers& random, Projection projection) {
  const auto unit = [&] { return random.Below(1u << 30) * 0x1p-30; };
  Camera camera{};
  camera.projection = projection;
  camera.depth = projection == kOpenGl || projection == kOrthographic
                     ? ClipDepth::kMinusOneToOne
                     : ClipDepth::kZeroToOne;
  camera.tangent = std::tan(0.01 + 1.3 * unit());
  if (projection == kOrthographic) camera.tangent *= 100;
  camera.aspect = 0.5 + 2 * unit();
  camera.near = std::exp2(6 * unit() - 4);
  camera.far = camera.near * std::exp2(0.2 + 20 * unit());
  // Also along an axis, where sides are axis-aligned or have no y.
  const double yaw = random.Below(4) == 0 ? 0 : 6.3 * unit();
  const double pitch = random.Below(4) == 0 ? 0 : 3 * unit() - 1.5;
  camera.forward = {std::cos(yaw) * std::cos(pitch), std::sin(pitch),
                    std::sin(yaw) * std::cos(pitch)};
  camera.right = {-std::sin(yaw), 0, std::cos(yaw)};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t j = (k + 1) % 3;
    const std::size_t l = (k + 2) % 3;
    camera.up[k] = camera.right[j] * camera.forward[l] -
                   camera.right[l] * camera.forward[j];
    camera.eye[k] = (unit() - 0.5) * std::exp2(12 * unit());
  }
  const double n = camera.near;
  const double f = camera.far;
  std::array<double, 2> depth{};  // of -z and of 1
  switch (projection) {
    case kOpenGl:
      depth = {(f + n) / (f - n), -2 * f * n / (f - n)};
      break;
    case kDirect3d:
      depth = {f / (f - n), -f * n / (f - n)};
      break;
    case kReversed:
      depth = {-n / (f - n), f * n / (f - n)};
      break;
    case kOrthographic:
      depth = {2 / (f - n), -(f + n) / (f - n)};
      break;
    case kInfinite:
      depth = {1, -n};
      break;
    default:
      depth = {0, n};
      break;
  }
  const bool is_flat = projection == kOrthographic;
  for (std::size_t c = 0; c < 4; ++c) {
    const auto of_view = [&](const Vector& axis) {
      if (c < 3) return axis[c];
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) sum -= axis[k] * camera.eye[k];
      return sum;
    };
    const double last = c == 3 ? 1 : 0;
    const auto along = static_cast<float>(of_view(camera.forward));
    Matrix& m = camera.matrix;
    m[0][c] = static_cast<float>(of_view(camera.right) /
                                 (camera.tangent * camera.aspect));
    m[1][c] = static_cast<float>(of_view(camera.up) / camera.tangent);
    m[2][c] = static_cast<float>(depth[0]) * along +
              static_cast<float>(depth[1] * last);
    m[3][c] = is_flat ? static_cast<float>(last) : along;
  }
  return camera;
}

Frustum3 PlanesOf(const Camera& camera) {
  std::array<float, 16> columns;
  for (std::size_t r = 0; r < 4; ++r) {
    for (std::size_t c = 0; c < 4; ++c) {
      columns[4 * c + r] = camera.matrix[r][c];
    }
  }
  return FrustumPlanes(columns.data(), camera.depth);
}

// How far a point is behind the half-spaces, at most 0 if it is kept.
Exact Behind(const Frustum3& frustum, const std::array<Exact, 3>& point) {
  Exact most = -1;
  for (const HalfSpace3& side : frustum) {
    Exact sum = -Exact{side.offset};
    for (std::size_t k = 0; k < 3; ++k) sum -= side.normal[k] * point[k];
    most = std::max(most, sum);
  }
  return most;
}

TEST(FrustumPlanesTest, HoldWhatIsSeenAndLittleMore) {
  SeededNumbers random(1);
  std::size_t seen = 0;
  std::size_t kept = 0;
  std::size_t bounded = 0;
  for (int round = 0; round < 3000; ++round) {
    SCOPED_TRACE(round);
    const Camera camera =
        RandomCamera(random, static_cast<Projection>(round % kProjections));
    const Frustum3 frustum = PlanesOf(camera);
    ASSERT_NE(frustum[0].normal, Point3{});
    const bool has_box = frustum[6].normal != Point3{};
    EXPECT_EQ(has_box, !camera.is_infinite());
    bounded += has_box;
    double size = camera.far * (1 + camera.tangent * (1 + camera.aspect));
    for (const double coordinate : camera.eye) size += std::abs(coordinate);
    // A point that is kept is so near to the frustum that it is inside after a
    // small step to a place deep inside.
    const bool is_flat = camera.projection == kOrthographic;
    const auto deep = camera.At((camera.near + 3 * camera.far) / 4, 0, 0);
    const double room = std::min(
        (camera.far - camera.near) / 4,
        camera.tangent * (is_flat ? 1 : camera.far / 2) *
            std::min(1.0, camera.aspect) / std::hypot(1, camera.tangent));
    const Exact step = Exact{size} * 0x1p-20 / room;
    for (int p = 0; p < 50; ++p) {
      // On edges, on faces, or anywhere, also a little outside.
      const auto place = [&] {
        return random.Below(2) == 0 ? (random.Below(2) == 0 ? -1. : 1.)
                                    : 1.2 * (random.Below(2049) * 0x1p-10 - 1);
      };
      auto point = camera.At(
          camera.near * std::pow(camera.far / camera.near, 0.5 + 0.5 * place()),
          place(), place());
      const bool is_kept = Behind(frustum, point) <= 0;
      if (camera.Sees(point)) {
        ++seen;
        ASSERT_TRUE(is_kept);
      } else if (is_kept && has_box && step < 0.5) {
        ++kept;
        for (std::size_t k = 0; k < 3; ++k) {
          point[k] += step * (deep[k] - point[k]);
        }
        EXPECT_TRUE(camera.Sees(point)) << "projection " << camera.projection;
      }
    }
  }
  EXPECT_GT(kept, 1000u);
  EXPECT_GT(seen, 50'000u);
  EXPECT_GT(bounded, 1900u);
}

TEST(FrustumPlanesTest, RowsAndColumns) {
  SeededNumbers random(2);
  const Camera camera = RandomCamera(random, kOpenGl);
  const Frustum3 columns = PlanesOf(camera);
  const Frustum3 rows = FrustumPlanes(camera.matrix[0].data(), camera.depth,
                                      MatrixOrder::kRowMajor);
  for (std::size_t f = 0; f < rows.size(); ++f) {
    EXPECT_EQ(rows[f].normal, columns[f].normal);
    EXPECT_EQ(rows[f].offset, columns[f].offset);
  }
}

TEST(FrustumPlanesTest, WhatIsNoFrustumKeepsEverything) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  SeededNumbers random(3);
  for (std::size_t row = 0; row < 4; ++row) {
    for (const float value : {0.f, kInfinity, kNan}) {
      Camera camera = RandomCamera(random, kDirect3d);
      camera.matrix[row][random.Below(4)] = value;
      if (value == 0) camera.matrix = {};
      for (const HalfSpace3& side : PlanesOf(camera)) {
        EXPECT_EQ(side.normal, Point3{});
        EXPECT_EQ(side.offset, 0);
      }
    }
  }
}

TEST(FrustumPlanesTest, Errors) {
  const std::array<float, 16> matrix{};
  const auto refused = [](const float* pointer, int depth, int order) {
    return [=] {
      (void)FrustumPlanes(pointer, static_cast<ClipDepth>(depth),
                          static_cast<MatrixOrder>(order));
    };
  };
  EXPECT_TRUE(Refuses(refused(nullptr, 0, 0), {"FrustumPlanes", "matrix"}));
  EXPECT_TRUE(Refuses(refused(Misaligned(matrix.data()), 0, 0), {"matrix"}));
  EXPECT_TRUE(Refuses(refused(matrix.data(), 2, 0), {"depth", "2"}));
  EXPECT_TRUE(Refuses(refused(matrix.data(), 0, 2), {"order", "2"}));
}

}  // namespace
}  // namespace halfspace::testing

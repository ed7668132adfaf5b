// Random samples of every shape, for every_builder.h.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_RANDOM_EVERY_SHAPE_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_RANDOM_EVERY_SHAPE_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "halfspace/fit.h"
#include "tests/library/fit/every_builder.h"
#include "tests/library/support/random_shapes.h"

namespace halfspace::testing {

// A box whose faces lean a little: as a frustum its corners take quotients.
inline std::array<HalfSpace3, 6> RandomFrustum(PointKind kind, Random& random) {
  std::array<HalfSpace3, 6> planes{};
  for (std::size_t i = 0; i < planes.size(); ++i) {
    auto& [normal, offset] = planes[i];
    for (float& x : normal) {
      x = 0.1f * RandomPointOf<2, float>(PointKind::kUniform, random)[0] / 100;
    }
    normal[i / 2] = i % 2 == 0 ? 1.f : -1.f;
    offset = RandomLength<float>(kind, random) + 1.f;
  }
  return planes;
}

template <int kDims>
EveryShape<kDims> RandomEveryShape(PointKind kind, Random& random) {
  EveryShape<kDims> s;
  const auto point = [&] { return RandomPointOf<kDims, float>(kind, random); };
  const auto box = [&] {
    const auto b = RandomBox<kDims, float>(kind, random);
    return Aabb<kDims>{b.min, b.max};
  };
  for (auto& p : s.points) p = point();
  for (auto& p : s.wide_points) p = RandomPointOf<kDims, double>(kind, random);
  s.ray = RandomRay<kDims>(kind, random);
  s.box = box();
  s.wide_box = RandomBox<kDims, double>(kind, random);
  s.oriented_box = RandomOrientedBox<kDims>(kind, random);
  s.sphere = RandomSphere<kDims, float>(kind, random);
  s.wide_sphere = RandomSphere<kDims, double>(kind, random);
  s.capsule = RandomCapsule<kDims>(kind, random);
  s.map = RandomAffine<kDims>(kind, s.points[0], random);
  s.planes = RandomFrustum(kind, random);
  s.wide_ray = RandomRay<kDims, double>(kind, random);
  s.wide_oriented_box = RandomOrientedBox<kDims, double>(kind, random);
  s.wide_capsule = RandomCapsule<kDims, double>(kind, random);
  s.wide_map = RandomAffine<kDims, double>(kind, s.wide_box.min, random);
  for (std::size_t i = 0; i < s.planes.size(); ++i) {
    const auto& [normal, offset] = s.planes[i];
    for (std::size_t k = 0; k < 3; ++k) {
      s.wide_planes[i].normal[k] = WithMoreBits(normal[k], random);
    }
    s.wide_planes[i].offset = WithMoreBits(offset, random);
  }
  s.bound = BoundAabb(s.box);
  s.simplex = s.bound.up();
  s.move = point();
  s.length = std::min(RandomLength<float>(kind, random), 100.f);
  s.factor = -std::fabs(RandomFactor(kind, random));
  for (auto& b : s.boxes) b = box();
  for (auto& sphere : s.spheres)
    sphere = RandomSphere<kDims, float>(kind, random);
  for (auto& v : s.vertices) v = point();
  for (auto& i : s.indices) {
    i = static_cast<std::uint32_t>(random() % s.vertices.size());
  }
  for (std::size_t i = 0; i < s.ends.size(); ++i) s.ends[i] = i + 1;
  return s;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_RANDOM_EVERY_SHAPE_H_

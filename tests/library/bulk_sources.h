// The sources of the bulk builders, all with the same members, so that one test
// serves them all:
//
//   Random(kind, count, random)   some shapes
//   Place(arena, stride)          puts them into memory; stride 1: columns
//   Bound(planes, options, status)
//   Truncate(count)               forgets the shapes from there on
//   size(), Single(i), Hull(i)    shape i by the single builder, and exactly
//   Give(i, is_tightest)          what D of shape i may give way
#ifndef HALFSPACE_TESTS_LIBRARY_BULK_SOURCES_H_
#define HALFSPACE_TESTS_LIBRARY_BULK_SOURCES_H_

#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspace/fit.h"
#include "halfspace/fit_many.h"
#include "tests/library/arena.h"
#include "tests/library/exact_hull.h"
#include "tests/library/random_shapes.h"

namespace halfspace::testing {

// Values `stride` apart.
inline float* NewColumn(Arena& arena, std::size_t count, std::size_t stride) {
  return arena.New<float>(count == 0 ? 0 : (count - 1) * stride + 1);
}

template <int kDims>
struct BoxSource {
  static constexpr int kDimensions = kDims;
  static constexpr const char* kName = "Boxes";

  std::vector<Aabb<kDims>> shapes;
  Boxes<kDims> boxes;

  static BoxSource Random(PointKind kind, std::size_t count, Random& random) {
    BoxSource source;
    for (std::size_t i = 0; i < count; ++i) {
      const auto box = RandomBox<kDims, float>(kind, random);
      source.shapes.push_back({box.min, box.max});
    }
    return source;
  }

  void Place(Arena& arena, std::size_t stride) {
    boxes.count = shapes.size();
    boxes.stride = stride;
    for (std::size_t k = 0; k < kDims; ++k) {
      float* min = NewColumn(arena, shapes.size(), stride);
      float* max = NewColumn(arena, shapes.size(), stride);
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        min[i * stride] = shapes[i].min[k];
        max[i * stride] = shapes[i].max[k];
      }
      boxes.min[k] = min;
      boxes.max[k] = max;
    }
  }

  template <typename Planes>
  Target Bound(const Planes& planes, const FitOptions& options = {},
               FitStatus* status = nullptr) const {
    return BoundBoxes(boxes, planes, options, status);
  }

  void Truncate(std::size_t count) { shapes.resize(count); }
  std::size_t size() const { return shapes.size(); }
  Aabo<kDims> Single(std::size_t i) const { return BoundAabb(shapes[i]); }
  ExactHull<kDims> Hull(std::size_t i) const {
    ExactHull<kDims> hull;
    hull.AddPoint(ExactPointOf(shapes[i].min));
    hull.AddPoint(ExactPointOf(shapes[i].max));
    return hull;
  }
  double Give(std::size_t, bool) const { return 0.0; }
};

template <int kDims>
struct SphereSource {
  static constexpr int kDimensions = kDims;
  static constexpr const char* kName = "Spheres";

  std::vector<Sphere<kDims>> shapes;
  Spheres<kDims> spheres;

  static SphereSource Random(PointKind kind, std::size_t count,
                             Random& random) {
    SphereSource source;
    for (std::size_t i = 0; i < count; ++i) {
      source.shapes.push_back(RandomSphere<kDims, float>(kind, random));
    }
    return source;
  }

  void Place(Arena& arena, std::size_t stride) {
    spheres.count = shapes.size();
    spheres.stride = stride;
    for (std::size_t k = 0; k <= kDims; ++k) {
      float* column = NewColumn(arena, shapes.size(), stride);
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        column[i * stride] =
            k == kDims ? shapes[i].radius : shapes[i].center[k];
      }
      (k == kDims ? spheres.radius : spheres.center[k]) = column;
    }
  }

  template <typename Planes>
  Target Bound(const Planes& planes, const FitOptions& options = {},
               FitStatus* status = nullptr) const {
    return BoundSpheres(spheres, planes, options, status);
  }

  void Truncate(std::size_t count) { shapes.resize(count); }
  std::size_t size() const { return shapes.size(); }
  Aabo<kDims> Single(std::size_t i) const { return BoundSphere(shapes[i]); }
  ExactHull<kDims> Hull(std::size_t i) const {
    ExactHull<kDims> hull;
    hull.AddBall(ExactPointOf(shapes[i].center), Exact(shapes[i].radius));
    return hull;
  }
  double Give(std::size_t i, bool is_tightest) const {
    double sum = shapes[i].radius;
    if (is_tightest) return sum * 0x1p-100;
    for (float x : shapes[i].center) sum += std::fabs(x);
    return sum * 0x1p-49;
  }
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BULK_SOURCES_H_

// The sources of the bulk builders, all with the same members, so that one test
// serves them all:
//
//   Random(kind, count, random)   some shapes
//   Place(arena, layout)          puts them into memory
//   Bound(planes, options, status)
//   Truncate(count)               forgets the shapes from there on
//   Cycle(count)                  repeats them up to that many
//   size(), Single(i), Hull(i)    shape i by the single builder, and exactly
//   Give(i, is_tightest)          what D of shape i may give way
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_SOURCES_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_SOURCES_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "halfspace/fit.h"
#include "halfspace/fit_many.h"
#include "tests/library/fit_many/arena.h"
#include "tests/library/support/exact_hull.h"
#include "tests/library/support/random_shapes.h"

namespace halfspace::testing {

// Where the numbers of shapes or points lie.
enum class Layout {
  kColumns,  // each column on its own, one value after the other
  kStrided,  // each column on its own, with gaps
  kPacked,   // an array of structures with nothing else in it
  kSpread,   // an array of structures with gaps
};

inline constexpr std::array kLayouts = {Layout::kColumns, Layout::kStrided,
                                        Layout::kPacked, Layout::kSpread};

// Columns to be filled: value c of element i is columns[c][i * stride].
template <typename Scalar>
struct Columns {
  std::vector<Scalar*> columns;
  std::size_t stride;

  Columns(Arena& arena, Layout layout, std::size_t columns_count,
          std::size_t count) {
    const bool is_structure =
        layout == Layout::kPacked || layout == Layout::kSpread;
    stride = layout == Layout::kColumns  ? 1
             : layout == Layout::kPacked ? columns_count
                                         : columns_count + 3;
    const std::size_t width = is_structure ? columns_count : 1;
    const std::size_t scalars = count == 0 ? 0 : (count - 1) * stride + width;
    for (std::size_t c = 0; c < columns_count; ++c) {
      columns.push_back(is_structure && c > 0 ? columns[0] + c
                                              : arena.New<Scalar>(scalars));
    }
  }

  void Set(std::size_t c, std::size_t i, Scalar value) const {
    columns[c][i * stride] = value;
  }
};

template <int kDims, typename Scalar = float>
struct BoxSource {
  static constexpr int kDimensions = kDims;
  static constexpr const char* kName =
      std::is_same_v<Scalar, float> ? "Boxes" : "BoxesOfDoubles";

  std::vector<Box<kDims, Scalar>> shapes;
  Boxes<kDims, Scalar> boxes;

  static BoxSource Random(PointKind kind, std::size_t count, Random& random) {
    BoxSource source;
    for (std::size_t i = 0; i < count; ++i) {
      source.shapes.push_back(RandomBox<kDims, Scalar>(kind, random));
    }
    return source;
  }

  void Place(Arena& arena, Layout layout) {
    const Columns<Scalar> to(arena, layout, 2 * kDims, shapes.size());
    boxes.count = shapes.size();
    boxes.stride = to.stride;
    for (std::size_t k = 0; k < kDims; ++k) {
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        to.Set(k, i, shapes[i].min[k]);
        to.Set(kDims + k, i, shapes[i].max[k]);
      }
      boxes.min[k] = to.columns[k];
      boxes.max[k] = to.columns[kDims + k];
    }
  }

  template <typename Planes>
  Target Bound(const Planes& planes, const FitOptions& options = {},
               FitStatus* status = nullptr) const {
    return BoundBoxes(boxes, planes, options, status);
  }

  void Truncate(std::size_t count) { shapes.resize(count); }
  void Cycle(std::size_t count) {
    const std::size_t period = shapes.size();
    for (std::size_t i = period; i < count; ++i) {
      shapes.push_back(shapes[i - period]);
    }
  }
  // Stride 0.
  void Repeat(std::size_t count) {
    boxes.count = count;
    boxes.stride = 0;
  }
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

template <int kDims, typename Scalar = float>
struct SphereSource {
  static constexpr int kDimensions = kDims;
  static constexpr const char* kName =
      std::is_same_v<Scalar, float> ? "Spheres" : "SpheresOfDoubles";

  std::vector<Sphere<kDims, Scalar>> shapes;
  Spheres<kDims, Scalar> spheres;

  static SphereSource Random(PointKind kind, std::size_t count,
                             Random& random) {
    SphereSource source;
    for (std::size_t i = 0; i < count; ++i) {
      source.shapes.push_back(RandomSphere<kDims, Scalar>(kind, random));
    }
    return source;
  }

  void Place(Arena& arena, Layout layout) {
    const Columns<Scalar> to(arena, layout, kDims + 1, shapes.size());
    spheres.count = shapes.size();
    spheres.stride = to.stride;
    spheres.radius = to.columns[kDims];
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      for (std::size_t k = 0; k < kDims; ++k) {
        spheres.center[k] = to.columns[k];
        to.Set(k, i, shapes[i].center[k]);
      }
      to.Set(kDims, i, shapes[i].radius);
    }
  }

  template <typename Planes>
  Target Bound(const Planes& planes, const FitOptions& options = {},
               FitStatus* status = nullptr) const {
    return BoundSpheres(spheres, planes, options, status);
  }

  void Truncate(std::size_t count) { shapes.resize(count); }
  void Cycle(std::size_t count) {
    const std::size_t period = shapes.size();
    for (std::size_t i = period; i < count; ++i) {
      shapes.push_back(shapes[i - period]);
    }
  }
  // Stride 0.
  void Repeat(std::size_t count) {
    spheres.count = count;
    spheres.stride = 0;
  }
  std::size_t size() const { return shapes.size(); }
  Aabo<kDims> Single(std::size_t i) const { return BoundSphere(shapes[i]); }
  ExactHull<kDims> Hull(std::size_t i) const {
    ExactHull<kDims> hull;
    hull.AddSphere(ExactPointOf(shapes[i].center), Exact(shapes[i].radius));
    return hull;
  }
  double Give(std::size_t i, bool is_tightest) const {
    double sum = shapes[i].radius;
    if (std::is_same_v<Scalar, double>) return RoundD(sum).d_slack;
    if (is_tightest) return sum * 0x1p-100;
    for (Scalar x : shapes[i].center) sum += std::fabs(x);
    return sum * 0x1p-49;
  }
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_SOURCES_H_

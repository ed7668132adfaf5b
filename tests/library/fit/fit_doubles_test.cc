// Builders and bounds of bounds give floats; whoever passes boxes or planes of
// doubles is told so by the compiler. Here: no such call is well-formed. That
// the calls of floats are, fit/build.cc and fit_many_test.cc show.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "halfspace/fit.h"
#include "halfspace/fit_many.h"
#include "halfspace/world.h"

namespace halfspace::testing {
namespace {

// By any call of transform.h.
template <typename Bound>
concept IsChanged = requires(const Bound& bound) {
  Merge(bound, bound);
}
|| requires(const Bound& bound) { Inflate(bound, 1.f); }
|| requires(const Bound& bound) { InflateByBox(bound, 1.f); }
|| requires(const Bound& bound, const Point<Bound::kDimensions>& by) {
  Translate(bound, by);
}
|| requires(const Bound& bound, const Point<Bound::kDimensions>& by) {
  TranslateVertices(bound, by);
}
|| requires(const Bound& bound) { Scale(bound, 2.f); }
|| requires(const Bound& bound, const Point<Bound::kDimensions>& motion) {
  Sweep(bound, motion);
}
|| requires(const Bound& bound) { Circumscribe(bound); };

// Of a program, with what a bound has.
struct Foreign {
  static constexpr int kDimensions = 3;
  std::array<float, 3> min;
  std::array<float, 3> max;
};

static_assert(IsChanged<Aabb<3>> && !IsChanged<Foreign>);
static_assert(!IsChanged<Aabb<2, double>> && !IsChanged<Aabb<3, double>> &&
              !IsChanged<Aabb<4, double>>);

template <typename Planes>
concept IsBuiltInBulk = requires(const Planes& planes, const Boxes3& boxes) {
  BoundBoxes(boxes, planes);
}
|| requires(const Planes& planes, const Spheres3& spheres) {
  BoundSpheres(spheres, planes);
}
|| requires(const Planes& planes, const Points3& points,
            std::span<const std::uint32_t> indices) {
  BoundTriangles(points, indices, planes);
}
|| requires(const Planes& planes, const PointsSoa3& points,
            std::span<const std::size_t> ends) {
  BoundPointSets(points, ends, planes);
};

static_assert(IsBuiltInBulk<AabbPlanes<3, float>>);
static_assert(!IsBuiltInBulk<AabbPlanes<3, double>>);

}  // namespace
}  // namespace halfspace::testing

// What the kernels of shapes compute for one bound, in scalars: the same
// operations in the same order.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_SHAPE_REFERENCE_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_SHAPE_REFERENCE_H_

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "halfspace/halfspace.h"
#include "kernels/bvh/shape.h"
#include "tests/library/support/cases.h"

namespace halfspace::testing {

// Plane p of a bound: all minima, then all maxima.
template <typename View>
using PlaneValues = std::array<float, kPlanes<View>>;

template <typename View>
PlaneValues<View> PlanesOf(typename View::Bound bound) {
  PlaneValues<View> values;
  for (std::size_t p = 0; p < values.size(); ++p) {
    values[p] = StoredValue<View>(bound, p);
  }
  return values;
}

inline float SquaredDistanceOf(std::span<const float> planes,
                               const detail::Ball& ball) {
  float sum = 0;
  for (std::size_t k = 0; k < ball.center.dims; ++k) {
    float gap = planes[k] - ball.center.low[k];
    if (!(gap > 0)) gap = 0;
    if (ball.center.max_plane != 0) {
      const float above =
          ball.center.low[k] - planes[ball.center.max_plane + k];
      if (above > gap) gap = above;
    }
    sum = sum + gap * gap;
  }
  return sum;
}

inline bool IsInReach(std::span<const float> planes, const detail::Ball& ball) {
  if (SquaredDistanceOf(planes, ball) > ball.limit) return false;
  return ball.d_axis == 0 ||
         !(planes[ball.d_axis] > ball.d_max ||
           (ball.center.max_plane != 0 &&
            planes[ball.center.max_plane + ball.d_axis] < ball.d_min));
}

// Infinite if the line does not enter.
inline float EntryOf(std::span<const float> planes, const detail::Line& line) {
  float enter = 0;
  float exit = line.max_t;
  for (std::size_t p = 0; p < line.planes; ++p) {
    const float t = (planes[line.plane[p].plane] - line.plane[p].offset) *
                    line.plane[p].inverse;
    if (p < line.entering) {
      if (t > enter) enter = t;
    } else if (t < exit) {
      exit = t;
    }
  }
  return enter > exit + detail::kApartOnLine
             ? std::numeric_limits<float>::infinity()
             : enter;
}

inline bool IsBehind(std::span<const float> planes,
                     const detail::Front& front) {
  float sum = front.offset;
  for (std::size_t t = 0; t < front.terms; ++t) {
    const float value = planes[front.term[t].plane];
    const float more = value * front.term[t].more;
    const float less = value * front.term[t].less;
    sum = sum + (more > less ? more : less);
  }
  return sum < 0;
}

template <int kDims>
detail::Line LineOf(const detail::PlaneLayout& planes,
                    const Capsule<kDims>& capsule) {
  double origin[3] = {};
  double direction[3] = {};
  for (std::size_t k = 0; k < kDims; ++k) {
    origin[k] = capsule.a[k];
    direction[k] = double{capsule.b[k]} - capsule.a[k];
  }
  detail::Line line;
  detail::MakeLine(planes, origin, origin, direction, 1, capsule.radius, line);
  return line;
}

template <typename View, int kDims>
detail::Ball BallOf(const Sphere<kDims>& sphere) {
  detail::Ball ball;
  detail::MakeBall(detail::kLayoutOf<typename View::Bound>,
                   sphere.center.data(), sphere.radius, ball);
  return ball;
}

// Whether a walk takes a shape for its bound: a builder cannot bound it, or its
// radius is too large to be squared, or no axis limits its line.
template <typename View, std::size_t kDims>
bool IsBound(const std::array<float, kDims>&) {
  return true;
}
template <typename View, int kDims>
bool IsBound(const Sphere<kDims>& sphere) {
  return BoundSphere(sphere) == Aabo<kDims>::Everything() ||
         BallOf<View>(sphere).limit == std::numeric_limits<float>::infinity();
}
template <typename View, int kDims>
bool IsBound(const Capsule<kDims>& capsule) {
  return BoundCapsule(capsule) == Aabo<kDims>::Everything() ||
         LineOf(detail::kLayoutOf<typename View::Bound>, capsule).planes == 0;
}
template <typename View, int kDims>
bool IsBound(const Segment<kDims>& segment) {
  return IsBound<View>(Capsule<kDims>{segment.a, segment.b, 0});
}

// Whether the test of the shape keeps a bound.
template <typename View, std::size_t kDims>
bool IsTouched(const typename View::Bound&, const std::array<float, kDims>&) {
  return true;
}
template <typename View, int kDims>
bool IsTouched(const typename View::Bound& bound, const Sphere<kDims>& sphere) {
  return IsBound<View>(sphere) ||
         IsInReach(PlanesOf<View>(bound), BallOf<View>(sphere));
}
template <typename View, int kDims>
bool IsTouched(const typename View::Bound& bound,
               const Capsule<kDims>& capsule) {
  return IsBound<View>(capsule) ||
         EntryOf(PlanesOf<View>(bound),
                 LineOf(detail::kLayoutOf<typename View::Bound>, capsule)) <= 1;
}
template <typename View, int kDims>
bool IsTouched(const typename View::Bound& bound,
               const Segment<kDims>& segment) {
  return IsTouched<View>(bound, Capsule<kDims>{segment.a, segment.b, 0});
}
template <typename View, int kDims>
bool IsTouched(const typename View::Bound& bound,
               const std::vector<HalfSpace<kDims>>& half_spaces) {
  for (const HalfSpace<kDims>& half_space : half_spaces) {
    if (IsBehind(
            PlanesOf<View>(bound),
            detail::MakeFront(detail::kLayoutOf<typename View::Bound>,
                              half_space.normal.data(), half_space.offset))) {
      return false;
    }
  }
  return true;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_SHAPE_REFERENCE_H_

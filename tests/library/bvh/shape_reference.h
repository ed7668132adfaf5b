// What the kernels of queries compute for one bound, in scalars: the same
// operations in the same order.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_SHAPE_REFERENCE_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_SHAPE_REFERENCE_H_

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "halfspace/halfspace.h"
#include "kernels/bvh/shape.h"
#include "tests/library/bvh/any_bvh.h"

namespace halfspace::testing {

// Of a point or a box, whose corners are `low` and `high`.
inline float SquaredDistanceOf(const Layout& layout, const Planes& planes,
                               const float* low, const float* high) {
  float sum = 0;
  for (std::size_t k = 0; k < layout.dims; ++k) {
    float gap = planes[k] - high[k];
    if (!(gap > 0)) gap = 0;
    if (layout.has_max) {
      const float above = low[k] - planes[layout.first_max + k];
      if (above > gap) gap = above;
    }
    sum = sum + gap * gap;
  }
  return sum;
}

inline bool IsInReach(const Layout& layout, const Planes& planes,
                      const detail::Ball& ball) {
  if (SquaredDistanceOf(layout, planes, ball.center.low, ball.center.high) >
      ball.limit) {
    return false;
  }
  return ball.d_axis == 0 ||
         !(planes[ball.d_axis] > ball.d_max ||
           (layout.has_max &&
            planes[layout.first_max + ball.d_axis] < ball.d_min));
}

// Infinite if the line does not enter.
inline float EntryOf(const Planes& planes, const detail::Line& line) {
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
  return enter > exit + detail::kApartOnLine ? kInf : enter;
}

inline bool IsBehind(const Planes& planes, const detail::HalfSpaceTest& test) {
  float sum = test.offset;
  for (std::size_t t = 0; t < test.terms; ++t) {
    const float value = planes[test.term[t].plane];
    const float more = value * test.term[t].more;
    const float less = value * test.term[t].less;
    sum = sum + (more > less ? more : less);
  }
  return sum < 0;
}

// Of an octahedron, the planes that a query of this layout is compared with.
template <int kDims>
Planes QueryPlanesOf(const Layout& layout, const Aabo<kDims>& bound) {
  Planes planes{};
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    planes[p] = IsMin(layout, p) ? bound.max[p] : bound.min[p - layout.axes];
  }
  return planes;
}

// The test of one shape, except of an oriented box.
class ShapeReference {
 public:
  ShapeReference(const Layout& layout, const Shape& shape)
      : layout_(layout), bound_(AllPlanes(layout, kInf)) {
    if (shape.kind == Shape::kBound) {
      std::copy_n(shape.numbers.begin(), layout.plane_count, bound_.begin());
    } else if (layout.dims == 2) {
      Make<2>(shape);
    } else {
      Make<3>(shape);
    }
  }

  bool Keeps(const Planes& planes) const {
    for (std::size_t p = 0; p < layout_.plane_count; ++p) {
      if (IsMin(layout_, p) ? planes[p] > bound_[p] : planes[p] < bound_[p]) {
        return false;
      }
    }
    return (!has_ball_ || IsInReach(layout_, planes, ball_)) &&
           (!has_line_ || EntryOf(planes, line_) <= 1) &&
           std::none_of(
               half_spaces_.begin(), half_spaces_.end(),
               [&](const auto& front) { return IsBehind(planes, front); });
  }

 private:
  // Of a rounded box, without a limit on D. Everything if a number is NaN.
  void SetLargerBox(const float* low, const float* high, double radius) {
    const auto sum = [&](double value) {
      const double larger = value + radius;
      return std::isinf(larger) ? static_cast<float>(larger)
                                : detail::RoundedUp(larger);
    };
    bool has_nan = false;
    for (std::size_t k = 0; k < layout_.dims; ++k) {
      has_nan |= std::isnan(low[k]) || std::isnan(high[k]);
    }
    for (std::size_t p = 0; p < layout_.plane_count; ++p) {
      const std::size_t k = p % layout_.axes;
      if (k >= layout_.dims) continue;
      bound_[p] = IsMin(layout_, p) ? sum(high[k]) : -sum(-double{low[k]});
      has_nan |= std::isnan(bound_[p]);
    }
    if (has_nan) bound_ = AllPlanes(layout_, kMost);
  }

  // A walk takes a shape for its bound if a builder cannot bound it, if its
  // radius is too large to be squared, or if no axis limits its line.
  template <int kDims>
  void Make(const Shape& shape) {
    const float* const n = shape.numbers.data();
    if (shape.kind == Shape::kHalfSpaces) {
      for (std::size_t i = 0; i < shape.numbers.size(); i += kDims + 1) {
        // One that is unusable keeps every object, also those that are Empty().
        if (!std::all_of(n + i, n + i + kDims + 1,
                         [](float x) { return std::isfinite(x); })) {
          continue;
        }
        half_spaces_.push_back(
            detail::MakeHalfSpaceTest(layout_, n + i, n[i + kDims]));
      }
    } else if (shape.kind == Shape::kPoint || shape.kind == Shape::kSphere) {
      Sphere<kDims> sphere{};
      std::copy_n(n, shape.numbers.size(), &sphere.center[0]);
      detail::MakeBall(layout_, n, n, sphere.radius, ball_);
      const Aabo<kDims> bound = BoundSphere(sphere);
      has_ball_ = shape.kind == Shape::kSphere &&
                  bound != Aabo<kDims>::Everything() && ball_.limit != kInf;
      if (!has_ball_) bound_ = QueryPlanesOf(layout_, bound);
    } else if (shape.kind == Shape::kRoundedBox) {
      Capsule<kDims> corners{};
      std::memcpy(&corners, n, shape.numbers.size() * sizeof(float));
      detail::MakeBall(layout_, n, n + kDims, corners.radius, ball_);
      has_ball_ = BoundCapsule(corners) != Aabo<kDims>::Everything() &&
                  ball_.limit != kInf;
      if (!has_ball_) SetLargerBox(n, n + kDims, corners.radius);
    } else {
      Capsule<kDims> capsule{};
      std::memcpy(&capsule, n, shape.numbers.size() * sizeof(float));
      double origin[3] = {};
      double direction[3] = {};
      for (std::size_t k = 0; k < kDims; ++k) {
        origin[k] = capsule.a[k];
        direction[k] = double{capsule.b[k]} - capsule.a[k];
      }
      detail::MakeLine(layout_, origin, origin, direction, 1, capsule.radius,
                       line_);
      has_line_ = BoundCapsule(capsule) != Aabo<kDims>::Everything() &&
                  line_.planes > 0;
      if (!has_line_) bound_ = AllPlanes(layout_, kMost);
    }
  }

  Layout layout_;
  Planes bound_;  // that the shape's must touch as well
  bool has_ball_ = false;
  bool has_line_ = false;
  detail::Ball ball_{};
  detail::Line line_{};
  std::vector<detail::HalfSpaceTest> half_spaces_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_SHAPE_REFERENCE_H_

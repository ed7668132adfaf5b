// What a query shape keeps, by hand: the inequalities of docs/bvh.md in
// scalars, with the same operations in the same order as in the kernels.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_SHAPE_REFERENCE_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_SHAPE_REFERENCE_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspace/halfspace.h"
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

// At least the value, and at most two ulps more.
inline float UpFrom(double value) {
  return static_cast<float>(value + std::fabs(value) * 0x1p-23 + 0x1p-149);
}

// Up to which squared distance a ball reaches.
inline float SquaredReachOf(float radius) {
  const float limit = radius * radius * (1 + 1.125f * 0x1p-18f) + 0x1p-124f;
  return limit < 0x1p127f * (2 - 0x1p-20f) ? limit : kInf;
}

// The ball around a point or a box.
inline bool IsInReach(const Layout& layout, const Planes& planes,
                      const float* low, const float* high, float radius) {
  if (SquaredDistanceOf(layout, planes, low, high) > SquaredReachOf(radius)) {
    return false;
  }
  if (layout.axes == layout.dims) return true;
  double least = 0;
  double most = 0;
  double width =
      std::sqrt(static_cast<double>(layout.dims)) * (1 + 0x1p-50) * radius;
  for (std::size_t k = 0; k < layout.dims; ++k) {
    least -= high[k];
    most -= low[k];
    width += 0x1p-50 * (std::fabs(double{low[k]}) + std::fabs(double{high[k]}));
  }
  return !(planes[layout.dims] > UpFrom(most + width) ||
           (layout.has_max &&
            planes[layout.first_max + layout.dims] < -UpFrom(width - least)));
}

// A box that is larger by a radius, and moves from `low` and `high` by t *
// direction.
struct MovingBox {
  // It misses a bound if it leaves one axis so much before it enters another.
  static constexpr float kApart = 0x1p-100f;

  // Infinite if it does not enter. `limits`: whether any axis could reject.
  float EntryOf(const Layout& layout, const Planes& planes,
                bool* limits = nullptr) const {
    float enter = 0;
    float exit = std::min(max_t, kMost);
    const auto pass_axis = [&](std::size_t k, double least, double most,
                               double rise, double width) {
      if (std::fabs(rise) < 0x1p-100) {  // counts as not moving
        if (rise != 0) width += std::fabs(rise) * double{max_t};
        rise = 0;
      }
      const double size = std::max(std::fabs(least), std::fabs(most)) + width;
      // An axis that could overflow, or has a NaN, rejects nothing.
      if (!(std::fabs(rise) < 0x1p120 && size < 0x1p99 && least <= most)) {
        return;
      }
      if (limits != nullptr) *limits = true;
      width += size * 0x1p-23 + 0x1p-124;
      const float inverse = 1 / static_cast<float>(rise);
      const auto pass = [&](float value, double offset, bool enters) {
        const float t = (value - static_cast<float>(offset)) *
                        (inverse * (enters ? 1 - 0x1p-20f : 1 + 0x1p-20f));
        if (enters && t > enter) enter = t;
        if (!enters && t < exit) exit = t;
      };
      pass(planes[k], most + width, inverse > 0);
      if (layout.has_max) {
        pass(planes[layout.first_max + k], least - width, inverse < 0);
      }
    };
    double least = 0;  // on D
    double most = 0;
    double rise = 0;
    double size = 0;
    double reach = 0;
    for (std::size_t k = 0; k < layout.dims; ++k) {
      pass_axis(k, low[k], high[k], direction[k], radius);
      least -= high[k];
      most -= low[k];
      rise -= direction[k];
      size += std::max(std::fabs(low[k]), std::fabs(high[k]));
      reach += std::fabs(direction[k]);
    }
    if (layout.axes > layout.dims) {
      // Where the direction nearly cancels out.
      if (std::fabs(rise) < 0x1p-24 * reach) size += reach * double{max_t};
      pass_axis(
          layout.dims, least, most, rise,
          radius * std::sqrt(static_cast<double>(layout.dims)) * (1 + 0x1p-50) +
              0x1p-50 * size);
    }
    return enter > exit + kApart ? kInf : enter;
  }

  double low[3] = {};
  double high[3] = {};
  double direction[3] = {};
  float max_t = 1;
  float radius = 0;
};

// The least float that is not below value + error, if both are finite. The
// error is less than half a step of doubles.
inline float NextUp(double value, double error) {
  const auto nearest = static_cast<float>(value);
  const bool is_below = nearest < value || (nearest == value && error > 0);
  return is_below ? std::nextafter(nearest, kInf) : nearest;
}

// Of a half-space of finite numbers.
inline bool IsBehind(const Layout& layout, const Planes& planes,
                     const float* normal, float offset) {
  // A side of a box.
  const auto* const component = std::find_if(normal, normal + layout.dims,
                                             [](float x) { return x != 0; });
  if (layout.has_max && component != normal + layout.dims &&
      std::count(normal, normal + layout.dims, 0.0f) ==
          std::ptrdiff_t{layout.dims} - 1) {
    const std::ptrdiff_t k = component - normal;
    const double side = -double{offset} / *component;
    return *component > 0
               ? side > -0x1p127 && planes[layout.first_max + k] <
                                        -UpFrom(-std::min(side, 0x1p127))
               : side < 0x1p127 && planes[k] > UpFrom(std::max(side, -0x1p127));
  }
  // Of minima alone, all factors are at most 0, also that of D.
  double most = 0;
  for (std::size_t k = 0; k < layout.dims && !layout.has_max; ++k) {
    most = std::max(most, double{normal[k]});
  }
  float sum = offset;
  for (std::size_t k = 0; k < 4; ++k) {
    const double factor = (k < layout.dims ? normal[k] : 0) - most;
    if (factor == 0 || (layout.has_max && k >= layout.dims)) continue;
    const float value =
        planes[layout.has_max && factor > 0 ? layout.first_max + k : k];
    // Those of minima are differences, and rounded both ways.
    const float up =
        layout.has_max ? static_cast<float>(factor) : UpFrom(factor);
    const float down = layout.has_max ? up : -UpFrom(-factor);
    const float more = NextUp(double{value} * up, 0);
    const float less = NextUp(double{value} * down, 0);
    const double term = more > less ? more : less;
    const double exact = sum + term;
    const double of_term = exact - sum;
    sum = NextUp(exact, (sum - (exact - of_term)) + (term - of_term));
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

// The test of one shape, except of an oriented box. A walk takes a shape for
// its bound if a builder cannot bound it, if its radius is too large to be
// squared, or if no axis limits its line. The bound of a point or a sphere is
// that of the builder, which has tests of its own.
class ShapeReference {
 public:
  ShapeReference(const Layout& layout, const Shape& shape)
      : layout_(layout), shape_(shape), bound_(AllPlanes(layout, kInf)) {
    const float* const n = shape.numbers.data();
    const std::size_t dims = layout.dims;
    if (shape.kind == Shape::kBound) {
      std::copy_n(n, layout.plane_count, bound_.begin());
    } else if (shape.kind == Shape::kHalfSpaces) {
      is_exact_ = true;
    } else if (shape.kind == Shape::kPoint || shape.kind == Shape::kSphere) {
      is_exact_ = shape.kind == Shape::kSphere && CanBeBounded(1) &&
                  SquaredReachOf(n[dims]) != kInf;
      if (!is_exact_) dims == 2 ? SetSphere<2>() : SetSphere<3>();
    } else if (shape.kind == Shape::kRoundedBox) {
      is_exact_ = CanBeBounded(2) && SquaredReachOf(n[2 * dims]) != kInf;
      if (!is_exact_) SetLargerBox(n, n + dims, n[2 * dims]);
    } else {
      if (shape.kind == Shape::kCapsule) line_.radius = n[2 * dims];
      for (std::size_t k = 0; k < dims; ++k) {
        line_.low[k] = line_.high[k] = n[k];
        line_.direction[k] = double{n[dims + k]} - n[k];
      }
      if (CanBeBounded(2)) (void)line_.EntryOf(layout, bound_, &is_exact_);
      if (!is_exact_) bound_ = AllPlanes(layout, kMost);
    }
  }

  bool Keeps(const Planes& planes) const {
    for (std::size_t p = 0; p < layout_.plane_count; ++p) {
      if (IsMin(layout_, p) ? planes[p] > bound_[p] : planes[p] < bound_[p]) {
        return false;
      }
    }
    if (!is_exact_) return true;
    const std::size_t dims = layout_.dims;
    const float* const n = shape_.numbers.data();
    switch (shape_.kind) {
      case Shape::kSphere:
        return IsInReach(layout_, planes, n, n, n[dims]);
      case Shape::kRoundedBox:
        return IsInReach(layout_, planes, n, n + dims, n[2 * dims]);
      case Shape::kHalfSpaces:
        for (std::size_t i = 0; i < shape_.numbers.size(); i += dims + 1) {
          // One that is unusable keeps every object, also those that are
          // Empty().
          const bool is_usable =
              std::all_of(n + i, n + i + dims,
                          [](float x) { return std::fabs(x) <= 0x1p126f; }) &&
              std::isfinite(n[i + dims]);
          if (is_usable && IsBehind(layout_, planes, n + i, n[i + dims])) {
            return false;
          }
        }
        return true;
      default:
        return line_.EntryOf(layout_, planes) <= 1;
    }
  }

 private:
  // Whether a builder can bound each of the points, with the radius.
  bool CanBeBounded(std::size_t points) const {
    const std::vector<float>& n = shape_.numbers;
    for (std::size_t p = 0; p < points; ++p) {
      float sum = 0;
      for (std::size_t k = 0; k < layout_.dims; ++k) {
        sum += std::fabs(n[p * layout_.dims + k]);
      }
      if (n.size() > points * layout_.dims) sum += n.back();
      if (!(sum <= 0x1p125f)) return false;
    }
    return true;
  }

  template <int kDims>
  void SetSphere() {
    Sphere<kDims> sphere{};
    std::copy_n(shape_.numbers.begin(), shape_.numbers.size(),
                &sphere.center[0]);
    bound_ = QueryPlanesOf(layout_, BoundSphere(sphere));
  }

  // Of a rounded box, without a limit on D. Everything if a number is NaN.
  void SetLargerBox(const float* low, const float* high, double radius) {
    const auto sum = [&](double value) {
      const double larger = value + radius;
      return std::isinf(larger) ? static_cast<float>(larger) : UpFrom(larger);
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

  Layout layout_;
  const Shape& shape_;
  Planes bound_;           // that the shape's must touch as well
  bool is_exact_ = false;  // not by its bound alone
  MovingBox line_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_SHAPE_REFERENCE_H_

// Queries by shapes (bvh_shapes.h).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <string>

#include "dispatch/bvh/layout.h"
#include "dispatch/bvh/shape_query.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/fit/bounding.h"
#include "dispatch/outward.h"
#include "dispatch/targets/chosen_target.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_shapes.h"
#include "halfspace/fit.h"

namespace halfspace::detail {
namespace {

template <int kDims>
Point<kDims> PointAt(const float* values) {
  Point<kDims> point;
  for (std::size_t k = 0; k < kDims; ++k) point[k] = values[k];
  return point;
}

bool HasRadius(const BvhShapeQuery& query) {
  return query.kind == BvhShapeQuery::kSphere ||
         query.kind == BvhShapeQuery::kCapsule ||
         query.kind == BvhShapeQuery::kRoundedBox;
}
std::size_t PointsOf(const BvhShapeQuery& query) {
  return query.kind == BvhShapeQuery::kPoint ||
                 query.kind == BvhShapeQuery::kSphere
             ? 1
             : 2;
}
float RadiusOf(const BvhShapeQuery& query) {
  return HasRadius(query) ? query.values[PointsOf(query) * query.dims] : 0;
}

// Throws unless the shape is valid. O(1). Called in the default floating-point
// mode.
void CheckShape(const BvhShapeQuery& query, const char* call) {
  if (!(RadiusOf(query) >= 0)) {
    dispatch::CheckLength(call, "radius", RadiusOf(query));
  }
  if (query.kind != BvhShapeQuery::kHalfSpaces) return;
  if (query.count > kMostHalfSpaces) {
    dispatch::ThrowInvalid(call, "half-spaces",
                           "at most " + std::to_string(kMostHalfSpaces),
                           std::to_string(query.count));
  }
  dispatch::CheckMemory(call, "half-spaces", query.values, query.count,
                        alignof(float));
}

// Whether a builder of fit.h can bound this point, sphere, segment, capsule or
// rounded box.
// Called in the default floating-point mode.
bool CanBeBounded(const BvhShapeQuery& query) {
  for (std::size_t p = 0; p < PointsOf(query); ++p) {
    dispatch::MagnitudeGuard<float> guard;
    guard.AddAll(std::span(query.values + p * query.dims, query.dims));
    guard.Add(RadiusOf(query));
    if (!guard.CanBeBounded()) return false;
  }
  return true;
}

// One shape in the form that the kernels read.
class Prepared {
 public:
  // In the default floating-point mode.
  Prepared(const BvhType& world, const BvhShapeQuery& query)
      : world_(world), query_(query) {
    switch (query.kind) {
      case BvhShapeQuery::kPoint:
        SetBounds();
        return;
      case BvhShapeQuery::kSphere:
      case BvhShapeQuery::kRoundedBox:
        SetBall();
        return;
      case BvhShapeQuery::kSegment:
      case BvhShapeQuery::kCapsule:
        SetLine();
        return;
      case BvhShapeQuery::kOrientedBox:
        SetSides();
        return;
      case BvhShapeQuery::kHalfSpaces:
        SetHalfSpaces();
    }
  }

  // Walks with this shape instead of the queries of `walk`.
  void Run(Walk walk, std::size_t target) const {
    const auto run = [&](const void* query, WalkFunction find,
                         WalkFunction count) {
      walk.queries = query;
      walk.query_count = 1;
      (walk.ids != nullptr ? find : count)(walk);
    };
    const BvhShapeKernels& shapes =
        KernelsOfAll<BvhShapeKernels>::kTargets[target];
    const BvhKernels& bounds = world_.kernels[target];
    const auto& planes = world_.has_max ? bounds.all : bounds.minima;
    switch (is_) {
      case kBounds:
        return run(bounds_.data(), planes.find, planes.count);
      case kBall:
        return run(&ball_, shapes.ball.find, shapes.ball.count);
      case kLine:
        return run(&line_, shapes.line.find, shapes.line.count);
      case kHalfSpaces:
        return run(&half_spaces_, shapes.half_spaces.find,
                   shapes.half_spaces.count);
    }
  }

 private:
  void SetBall() {
    const bool is_sphere = query_.kind == BvhShapeQuery::kSphere;
    MakeBall(world_, query_.values,
             query_.values + (is_sphere ? 0 : query_.dims), RadiusOf(query_),
             ball_);
    is_ = kBall;
    // A ball whose squared radius overflows rejects nothing. Its bound does.
    if (CanBeBounded(query_) && ball_.limit <= kMax<float>) return;
    if (is_sphere) {
      SetBounds();
    } else {
      SetLargerBox();
    }
  }

  // The box that is larger by the radius, without a limit on D, or everything
  // if a number is NaN.
  void SetLargerBox() {
    const auto sum = [](double a, double b) {
      return std::isinf(a + b) ? static_cast<float>(a + b)
                               : dispatch::RoundUpLoosely(a + b);
    };
    const double radius = RadiusOf(query_);
    is_ = kBounds;
    std::size_t v = 0;
    if (world_.has_max) {
      for (std::size_t k = 0; k < world_.axes; ++k) {
        bounds_[v++] =
            k < query_.dims ? -sum(radius, -query_.values[k]) : -kInf<float>;
      }
    }
    for (std::size_t k = 0; k < world_.axes; ++k) {
      bounds_[v++] = k < query_.dims
                         ? sum(radius, query_.values[query_.dims + k])
                         : kInf<float>;
    }
    const auto is_nan = [](float value) { return std::isnan(value); };
    if (std::any_of(query_.values, query_.values + 2 * query_.dims, is_nan) ||
        std::any_of(bounds_.data(), bounds_.data() + v, is_nan)) {
      SetBounds(true);
    }
  }

  void SetLine() {
    if (!CanBeBounded(query_)) return SetBounds();
    double origin[3] = {};
    double direction[3] = {};
    for (std::size_t k = 0; k < query_.dims; ++k) {
      origin[k] = query_.values[k];
      direction[k] = double{query_.values[query_.dims + k]} - origin[k];
    }
    MakeLine(world_, origin, origin, direction, 1, RadiusOf(query_), line_);
    is_ = kLine;
    // If no axis can reject, the line would keep Empty() objects.
    if (line_.planes == 0) SetBounds(true);
  }

  void SetHalfSpaces() {
    MakeHalfSpaceTests(world_, query_.values, query_.count, half_spaces_);
    is_ = kHalfSpaces;
  }

  void SetSides() {
    if (query_.dims == 2) {
      SetSidesOf<2>();
    } else {
      SetSidesOf<3>();
    }
  }

  // The sides of an oriented box, and the axis-aligned box around it.
  template <std::size_t kDims>
  void SetSidesOf() {
    half_spaces_.count = 0;
    if (world_.has_max) {
      SetBox<kDims>();
    } else {
      for (std::size_t k = 0; k < kDims; ++k) {
        double normal[kDims] = {};
        normal[k] = 1;
        AddSides<kDims>(normal);
      }
    }
    for (std::size_t k = 0; k < kDims; ++k) {
      double normal[kDims];
      // The normal is at right angles to the other axes.
      const float* const axes = query_.values + kDims;
      const float* const a = axes + (k + 1) % kDims * kDims;
      if constexpr (kDims == 2) {
        normal[0] = -a[1];
        normal[1] = a[0];
      } else {
        const float* const b = axes + (k + 2) % kDims * kDims;
        for (std::size_t i = 0; i < 3; ++i) {
          const std::size_t j = (i + 1) % 3;
          const std::size_t l = (i + 2) % 3;
          normal[i] = double{a[j]} * b[l] - double{a[l]} * b[j];
        }
      }
      AddSides<kDims>(normal);
    }
    is_ = kHalfSpaces;
  }

  // If a number is not finite, the box rejects nothing.
  template <std::size_t kDims>
  void SetBox() {
    const float* const half_extents = query_.values + kDims * (kDims + 1);
    half_spaces_.box_dims = kDims;
    half_spaces_.max_plane = world_.axes;
    bool is_finite = true;
    for (std::size_t k = 0; k < kDims; ++k) {
      const double middle = query_.values[k];
      double reach = 0;
      for (std::size_t a = 0; a < kDims; ++a) {
        reach += std::abs(double{query_.values[kDims * (a + 1) + k]} *
                          half_extents[a]);
      }
      is_finite &= std::isfinite(middle) && std::isfinite(reach);
      reach += (std::abs(middle) + reach) * 0x1p-48;
      half_spaces_.low[k] = -dispatch::RoundUpLoosely(reach - middle);
      half_spaces_.high[k] = dispatch::RoundUpLoosely(reach + middle);
    }
    for (std::size_t k = 0; k < kDims && !is_finite; ++k) {
      half_spaces_.low[k] = -kInf<float>;
      half_spaces_.high[k] = kInf<float>;
    }
  }

  // The half-spaces with this normal and its opposite that just hold an
  // oriented box. Right for any normal, as rounded to floats too.
  template <std::size_t kDims>
  void AddSides(const double* normal) {
    const float* const center = query_.values;
    const float* const half_extents = center + kDims * (kDims + 1);
    double largest = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      largest = std::max(largest, std::abs(normal[k]));
    }
    float up[kDims];
    double middle = 0;
    double size = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      up[k] = static_cast<float>(normal[k] / largest);
      middle += double{up[k]} * center[k];
      size += std::abs(double{up[k]} * center[k]);
    }
    double reach = 0;
    for (std::size_t a = 0; a < kDims; ++a) {
      const float* const axis = center + kDims * (a + 1);
      double along = 0;
      for (std::size_t k = 0; k < kDims; ++k) {
        along += double{up[k]} * axis[k];
        size += std::abs(double{up[k]} * axis[k] * half_extents[a]);
      }
      reach += std::abs(along * half_extents[a]);
    }
    reach += size * 0x1p-48;
    AddHalfSpace(up, dispatch::RoundUpLoosely(reach - middle));
    for (float& component : up) component = -component;
    AddHalfSpace(up, dispatch::RoundUpLoosely(reach + middle));
  }

  void AddHalfSpace(const float* normal, float offset) {
    MakeHalfSpaceTest(world_, normal, offset,
                      half_spaces_.test[half_spaces_.count++]);
  }

  // Uses the bound of a point or a sphere. Other shapes use Everything().
  void SetBounds(bool is_everything = false) {
    is_everything |= !CanBeBounded(query_);
    is_ = kBounds;
    if (!is_everything && query_.kind == BvhShapeQuery::kPoint &&
        world_.has_max && world_.axes == world_.dims) {
      // A box of one point, without the rounding of D.
      for (std::size_t k = 0; k < query_.dims; ++k) {
        bounds_[k] = bounds_[world_.axes + k] = query_.values[k];
      }
      return;
    }
    if (query_.dims == 2) {
      SetBoundsOf<2>(is_everything);
    } else {
      SetBoundsOf<3>(is_everything);
    }
  }

  template <int kDims>
  void SetBoundsOf(bool is_everything) {
    const auto bound =
        is_everything ? Aabo<kDims>::Everything()
                      : BoundSphere(Sphere<kDims>{PointAt<kDims>(query_.values),
                                                  RadiusOf(query_)});
    std::size_t v = 0;
    if (world_.has_max) {
      for (std::size_t k = 0; k < world_.axes; ++k) bounds_[v++] = bound.min[k];
    }
    for (std::size_t k = 0; k < world_.axes; ++k) bounds_[v++] = bound.max[k];
  }

  const BvhType& world_;
  const BvhShapeQuery& query_;
  enum { kBounds, kBall, kLine, kHalfSpaces } is_;
  std::array<float, 8> bounds_;
  Ball ball_;
  Line line_;
  HalfSpaceTests half_spaces_;
};

}  // namespace

void BvhWalkShapes(const BvhType& world, const BvhQueries& queries,
                   const QueryOptions& options, const char* call,
                   const Walk& walk) {
  const std::size_t target = dispatch::IndexOf(options.target, call);
  const auto at = [&](std::size_t q) {
    return queries.kind->at(queries.first, q);
  };
  const bool finds_nothing =
      walk.levels->level[0].size == 0 || options.mask == 0;
  if (queries.count != 1 || finds_nothing) {
    dispatch::InDefaultFpMode([&] {
      for (std::size_t q = 0; q < queries.count; ++q) CheckShape(at(q), call);
    });
  }
  if (finds_nothing) return;
  for (std::size_t q = 0; q < queries.count; ++q) {
    const BvhShapeQuery query = at(q);
    dispatch::InDefaultFpMode([&] {
      CheckShape(query, call);
      return Prepared(world, query);
    }).Run(walk, target);
  }
}

}  // namespace halfspace::detail

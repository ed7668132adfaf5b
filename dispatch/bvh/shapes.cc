// The calls of bvh_shapes.h: a shape becomes a query of planes, and a test
// of what that keeps.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>

#include "dispatch/bvh/layout.h"
#include "dispatch/targets/chosen_target.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_shapes.h"
#include "halfspace/fit.h"
#include "kernels/bvh/shape.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/exact/exact_bound.h"
#include "kernels/memory_checks.h"

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
         query.kind == BvhShapeQuery::kCapsule;
}
std::size_t PointsOf(const BvhShapeQuery& query) {
  return query.kind == BvhShapeQuery::kSphere ? 1 : 2;
}
float RadiusOf(const BvhShapeQuery& query) {
  return HasRadius(query) ? query.values[PointsOf(query) * query.dims] : 0;
}

// Throws unless the query is a shape. O(1). In the default floating-point mode.
void CheckShape(const BvhShapeQuery& query, const char* call) {
  if (HasRadius(query)) kernels::CheckLength(call, "radius", RadiusOf(query));
  if (query.kind != BvhShapeQuery::kHalfSpaces) return;
  if (query.count > kMostHalfSpaces) {
    kernels::ThrowInvalid(call, "half-spaces",
                          "at most " + std::to_string(kMostHalfSpaces),
                          std::to_string(query.count));
  }
  kernels::CheckMemory(call, "half-spaces", query.values, query.count,
                       alignof(float));
}

// Whether a builder of fit.h can bound the points of a sphere, a segment or a
// capsule. In the default floating-point mode.
bool CanBeBounded(const BvhShapeQuery& query) {
  for (std::size_t p = 0; p < PointsOf(query); ++p) {
    kernels::MagnitudeGuard<float> guard;
    guard.AddAll(std::span(query.values + p * query.dims, query.dims));
    guard.Add(RadiusOf(query));
    if (!guard.CanBeBounded()) return false;
  }
  return true;
}

// The greatest float that is at most a - b, which is no overflow.
float DifferenceDown(float a, float b) {
  const double x = a;
  const double y = -double{b};
  const double sum = x + y;
  const double rest = sum - x;
  const double error = (x - (sum - rest)) + (y - rest);
  const auto rounded = static_cast<float>(sum);
  const bool is_above = rounded > sum || (rounded == sum && error < 0);
  return is_above ? std::nextafter(rounded, -kInf<float>) : rounded;
}

// What a walk reads of a shape.
class Prepared {
 public:
  Prepared(const BvhTree& tree, const BvhShapeQuery& query,
           const QueryOptions& options, const char* call) {
    const auto& kernels =
        kBvhShapeKernels[dispatch::IndexOf(options.target, call)];
    const BvhShape& shape = tree.shape();
    kernels::InDefaultFpMode([&] {
      CheckShape(query, call);
      SetShape({query.dims, shape.axes, shape.has_max}, query, kernels);
      if (query.kind == BvhShapeQuery::kSphere && !is_everything_ &&
          shape.has_max && shape.axes == query.dims) {
        SetBox(query);
      } else if (query.dims == 2) {
        SetBound(shape, BoundOf<2>(query));
      } else {
        SetBound(shape, BoundOf<3>(query));
      }
    });
  }

  const float* bound() const { return bound_.data(); }
  const WalkShape* shape() const { return is_everything_ ? nullptr : &shape_; }

 private:
  void SetShape(const ShapePlanes& planes, const BvhShapeQuery& query,
                const BvhShapeKernels& kernels) {
    const float* const v = query.values;
    const std::size_t dims = planes.dims;
    is_everything_ =
        query.kind != BvhShapeQuery::kHalfSpaces && !CanBeBounded(query);
    if (is_everything_) return;
    switch (query.kind) {
      case BvhShapeQuery::kSphere:
        shape_.touching = kernels.ball;
        shape_.instead = nullptr;
        shape_.inside = kernels.in_ball;
        shape_.ball = MakeBall(planes, v, RadiusOf(query));
        return;
      case BvhShapeQuery::kSegment:
      case BvhShapeQuery::kCapsule: {
        double origin[3] = {};
        double direction[3] = {};
        for (std::size_t k = 0; k < dims; ++k) {
          origin[k] = v[k];
          direction[k] = double{v[dims + k]} - v[k];
        }
        shape_.instead = kernels.line;
        shape_.touching = nullptr;
        shape_.inside = nullptr;
        MakeLine(planes, origin, direction, 1, RadiusOf(query), shape_.line);
        // Too large for all axes: its test would keep Empty() objects.
        is_everything_ = shape_.line.planes == 0;
        return;
      }
      case BvhShapeQuery::kHalfSpaces:
        shape_.instead = kernels.fronts;
        shape_.touching = nullptr;
        shape_.inside = kernels.in_fronts;
        shape_.front_count = query.count;
        for (std::size_t f = 0; f < query.count; ++f) {
          const float* const plane = v + f * (dims + 1);
          shape_.fronts[f] = MakeFront(planes, plane, plane[dims]);
        }
    }
  }

  // Of a sphere its own. The other shapes are tested without one.
  template <int kDims>
  Aabo<kDims> BoundOf(const BvhShapeQuery& query) const {
    if (is_everything_) return Aabo<kDims>::Everything();
    if (query.kind == BvhShapeQuery::kSphere) {
      return BoundSphere(
          Sphere<kDims>{PointAt<kDims>(query.values), RadiusOf(query)});
    }
    return {Filled<kDims + 1>(-kInf<float>), Filled<kDims + 1>(kInf<float>)};
  }

  // The box of a sphere. The builder's octahedron takes 0.1 us longer.
  void SetBox(const BvhShapeQuery& query) {
    for (std::size_t k = 0; k < query.dims; ++k) {
      const float center = query.values[k];
      bound_[k] = DifferenceDown(center, RadiusOf(query));
      bound_[query.dims + k] = -DifferenceDown(-center, RadiusOf(query));
    }
  }

  template <typename Bound>
  void SetBound(const BvhShape& shape, const Bound& bound) {
    std::size_t v = 0;
    if (shape.has_max) {
      for (std::size_t k = 0; k < shape.axes; ++k) bound_[v++] = bound.min[k];
    }
    for (std::size_t k = 0; k < shape.axes; ++k) bound_[v++] = bound.max[k];
  }

  // Tested as a query of Everything() and nothing else.
  bool is_everything_;
  std::array<float, 8> bound_;
  WalkShape shape_;
};

}  // namespace

std::size_t BvhSurvivors(const BvhTree& tree, const BvhShapeQuery& query,
                         Span<std::uint32_t> ids, const QueryOptions& options) {
  const Prepared prepared(tree, query, options, "Survivors");
  return BvhSurvivors(tree, prepared.bound(), ids, options, prepared.shape());
}

std::size_t BvhCount(const BvhTree& tree, const BvhShapeQuery& query,
                     const QueryOptions& options) {
  const Prepared prepared(tree, query, options, "CountSurvivors");
  return BvhCount(tree, prepared.bound(), options, prepared.shape());
}

bool BvhAny(const BvhTree& tree, const BvhShapeQuery& query, std::uint32_t& id,
            const QueryOptions& options) {
  const Prepared prepared(tree, query, options, "AnySurvivor");
  return BvhAny(tree, prepared.bound(), id, options, prepared.shape());
}

void BvhForEach(const BvhTree& tree, const BvhShapeQuery& query,
                IdsFunction function, void* context,
                const QueryOptions& options) {
  const Prepared prepared(tree, query, options, "ForEachSurvivor");
  BvhForEach(tree, prepared.bound(), function, context, options,
             prepared.shape());
}

std::size_t BvhSurvivorsOfMany(const BvhTree& tree, const void* queries,
                               std::size_t query_count, std::size_t alignment,
                               ShapeQueryAt at, Span<std::uint32_t> ids,
                               Span<std::size_t> offsets,
                               const QueryOptions& options) {
  constexpr const char* kCall = "SurvivorsOfEach";
  std::ignore = KernelsFor(tree.shape(), options.target, kCall);
  CheckOfEach(kCall, queries, query_count, alignment, ids, offsets);
  // All of them before the first id is written.
  kernels::InDefaultFpMode([&] {
    for (std::size_t q = 0; q < query_count; ++q) {
      CheckShape(at(queries, q), kCall);
    }
  });
  offsets[0] = 0;
  std::size_t total = 0;
  for (std::size_t q = 0; q < query_count; ++q) {
    const Prepared prepared(tree, at(queries, q), options, kCall);
    const Span<std::uint32_t> rest =
        total < ids.size()
            ? Span<std::uint32_t>(ids.data() + total, ids.size() - total)
            : Span<std::uint32_t>();
    total +=
        BvhSurvivors(tree, prepared.bound(), rest, options, prepared.shape());
    offsets[q + 1] = total;
  }
  return total;
}

}  // namespace halfspace::detail

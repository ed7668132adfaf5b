// Half-spaces from a matrix: each is moved outward until it holds the corners
// of the frustum, or, without a far plane, turned until it holds the edges.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/outward.h"
#include "halfspace/frustum.h"

namespace halfspace {
namespace {

using Vector = std::array<double, 3>;

double Dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}
Vector Sum(const Vector& a, double factor, const Vector& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
double Length(const Vector& a) { return std::sqrt(Dot(a, a)); }

// A half-space. Its normal has the length 1, or is 0: then it is not used.
struct Plane {
  Vector normal{};
  double offset = 0;

  bool is_used() const { return normal != Vector{}; }
};

// Two rows of the matrix, added. Each sum of two floats is exact, or as good as
// exact.
Plane Added(const std::array<double, 4>& a, double factor,
            const std::array<double, 4>& b) {
  Plane plane;
  for (std::size_t k = 0; k < 3; ++k) plane.normal[k] = a[k] + factor * b[k];
  plane.offset = a[3] + factor * b[3];
  const double length = Length(plane.normal);
  if (length == 0) return {};
  for (double& component : plane.normal) component /= length;
  plane.offset /= length;
  return plane;
}

// The four edges of a frustum say what its half-spaces have to hold.
class Frustum {
 public:
  // Sides 0 to 3 are left, right, bottom and top. `w` is where w >= 0.
  Frustum(const std::array<Plane, 6>& sides, const Plane& w)
      : sides_(sides), w_(w) {}

  // Returns false if there is no such frustum.
  bool FindCorners() {
    if (!std::all_of(sides_.begin(), sides_.begin() + 4,
                     [](const Plane& side) { return side.is_used(); })) {
      return false;
    }
    for (std::size_t e = 0; e < 4; ++e) {
      if (!FindEdge(edges_[e], sides_[e % 2], sides_[2 + e / 2])) return false;
    }
    Orient();
    Use(sides_[4]);
    Use(sides_[5]);
    if (!has_begin()) Use(w_);
    return has_begin() &&
           std::all_of(edges_.begin(), edges_.end(),
                       [](const Edge& edge) { return edge.begin <= edge.end; });
  }

  Frustum3 HalfSpaces() const {
    Frustum3 result{};
    for (std::size_t f = 0; f < 6; ++f) {
      if (sides_[f].is_used()) result[f] = Outward(sides_[f].normal);
    }
    for (std::size_t k = 0; has_end() && k < 3; ++k) {
      for (std::size_t side = 0; side < 2; ++side) {
        Vector normal{};
        normal[k] = side == 0 ? 1 : -1;
        result[6 + 2 * k + side] = Outward(normal);
      }
    }
    return result;
  }

 private:
  static constexpr double kInf = std::numeric_limits<double>::infinity();
  // Errors are some 2^-50 of what is added.
  static constexpr double kError = 0x1p-44;

  // The points point + t * direction, begin <= t <= end.
  struct Edge {
    Vector point;
    Vector direction;
    double begin = -kInf;
    double end = kInf;
    double error = 0;  // of `point`, and of ends, relative to what is added
    double end_error = 0;
  };

  // All edges begin and end at the same planes.
  bool has_begin() const { return edges_[0].begin != -kInf; }
  bool has_end() const { return edges_[0].end != kInf; }

  static bool FindEdge(Edge& edge, const Plane& a, const Plane& b) {
    const Vector cross = Cross(a.normal, b.normal);
    const double sine = Length(cross);
    if (!(sine > 0x1p-10)) return false;
    edge.direction = Sum({}, 1 / sine, cross);
    // The point of both planes that is nearest to the origin.
    const Vector of_a = Cross(b.normal, cross);
    const Vector of_b = Cross(cross, a.normal);
    edge.point = Sum(Sum({}, -a.offset / (sine * sine), of_a),
                     -b.offset / (sine * sine), of_b);
    edge.error = kError / (sine * sine);
    return true;
  }

  // Edges go away from the eye, or, if they are parallel, all the same way.
  void Orient() {
    for (Edge& edge : edges_) {
      double along = Dot(w_.normal, edge.direction);
      if (std::abs(along) < 0x1p-30) {
        along = Dot(edges_[0].direction, edge.direction);
      }
      if (along < 0) edge.direction = Sum({}, -1, edge.direction);
    }
  }

  // Ends the edges at a plane. One that not all edges enter, or not all leave,
  // is not used.
  void Use(Plane& plane) {
    const auto along = [&](const Edge& edge) {
      return Dot(plane.normal, edge.direction);
    };
    const bool begins =
        std::all_of(edges_.begin(), edges_.end(),
                    [&](const Edge& edge) { return along(edge) > 0x1p-30; });
    const bool ends =
        std::all_of(edges_.begin(), edges_.end(),
                    [&](const Edge& edge) { return along(edge) < -0x1p-30; });
    if (!begins && !ends) {
      plane = {};
      return;
    }
    for (Edge& edge : edges_) {
      const double t =
          -(Dot(plane.normal, edge.point) + plane.offset) / along(edge);
      edge.end_error =
          std::max(edge.end_error, edge.error / std::abs(along(edge)));
      if (begins) edge.begin = std::max(edge.begin, t);
      if (ends) edge.end = std::min(edge.end, t);
    }
  }

  // The half-space with about this normal that holds all corners and edges, or
  // one that keeps everything.
  HalfSpace3 Outward(Vector normal) const {
    if (!has_end()) {
      // Turned by more than its rounding, so that the edges stay in front.
      Vector forward{};
      for (const Edge& edge : edges_) forward = Sum(forward, 1, edge.direction);
      normal = Sum(normal, 0x1p-20 / Length(forward), forward);
    }
    HalfSpace3 result{};
    for (std::size_t k = 0; k < 3; ++k) {
      result.normal[k] = static_cast<float>(normal[k]);
      if (std::abs(normal[k]) < 0x1p-40) result.normal[k] = 0;
      normal[k] = result.normal[k];
    }
    double offset = -kInf;
    for (const Edge& edge : edges_) {
      for (const double t : {edge.begin, edge.end}) {
        if (t == kInf) {
          if (!(Dot(normal, edge.direction) > edge.error)) return {};
          continue;
        }
        double size = 0x1p-120;
        for (std::size_t k = 0; k < 3; ++k) {
          size += std::abs(edge.point[k]) + std::abs(t * edge.direction[k]);
        }
        const Vector corner = Sum(edge.point, t, edge.direction);
        offset = std::max(offset, edge.end_error * size - Dot(normal, corner));
      }
    }
    if (!(std::abs(offset) < 0x1p126)) return {};
    result.offset = dispatch::RoundUpLoosely(offset);
    return result;
  }

  std::array<Plane, 6> sides_;
  Plane w_;
  std::array<Edge, 4> edges_;
};

}  // namespace

Frustum3 FrustumPlanes(const float* matrix, ClipDepth depth,
                       MatrixOrder order) {
  constexpr const char* kCall = "FrustumPlanes";
  dispatch::CheckMemory(kCall, "matrix", matrix, 16, alignof(float));
  if (depth > ClipDepth::kZeroToOne) {
    dispatch::ThrowInvalid(kCall, "depth", "one of the enumerators",
                           std::to_string(static_cast<int>(depth)));
  }
  if (order > MatrixOrder::kRowMajor) {
    dispatch::ThrowInvalid(kCall, "order", "one of the enumerators",
                           std::to_string(static_cast<int>(order)));
  }
  return dispatch::InDefaultFpMode([&] {
    std::array<std::array<double, 4>, 4> row;
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c) {
        row[r][c] = order == MatrixOrder::kRowMajor ? matrix[4 * r + c]
                                                    : matrix[4 * c + r];
      }
    }
    for (const auto& numbers : row) {
      for (const double number : numbers) {
        if (!std::isfinite(number)) return Frustum3{};
      }
    }
    const auto& w = row[3];
    Frustum frustum({Added(w, 1, row[0]), Added(w, -1, row[0]),
                     Added(w, 1, row[1]), Added(w, -1, row[1]),
                     Added(row[2], depth == ClipDepth::kZeroToOne ? 0 : 1, w),
                     Added(w, -1, row[2])},
                    Added(w, 0, w));
    return frustum.FindCorners() ? frustum.HalfSpaces() : Frustum3{};
  });
}

}  // namespace halfspace

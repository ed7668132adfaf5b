// Bounds of what six planes enclose, against exact corners.
#include <gmpxx.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <ostream>
#include <vector>

#include "halfspace/fit.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_real.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"

namespace halfspace::testing {
namespace {

using Vector = ExactPoint<3>;

Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}

mpq_class Dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct ExactPlane {
  Vector normal;
  mpq_class offset;
};

// The intersection of half-spaces.
class Polytope {
 public:
  void Add(const ExactPlane& plane) { planes_.push_back(plane); }

  // Whether some direction never leaves the planes' front sides. If all
  // normals lie in a plane one does; else, if any, one that two planes share.
  bool IsOpen() const {
    bool is_flat = true;
    for (const ExactPlane& a : planes_) {
      for (const ExactPlane& b : planes_) {
        const Vector direction = Cross(a.normal, b.normal);
        if (Dot(direction, direction) == 0) continue;
        bool falls = false;
        for (const ExactPlane& plane : planes_) {
          const int slope = sgn(Dot(plane.normal, direction));
          falls |= slope < 0;
          is_flat &= slope == 0;
        }
        if (!falls) return true;
      }
    }
    return is_flat;
  }

  std::vector<Vector> Corners() const {
    std::vector<Vector> corners;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t k = 0; k < j; ++k) {
          const auto point = Meet(planes_[i], planes_[j], planes_[k]);
          if (point && Contains(*point)) corners.push_back(*point);
        }
      }
    }
    return corners;
  }

 private:
  static std::optional<Vector> Meet(const ExactPlane& a, const ExactPlane& b,
                                    const ExactPlane& c) {
    const Vector bc = Cross(b.normal, c.normal);
    const Vector ca = Cross(c.normal, a.normal);
    const Vector ab = Cross(a.normal, b.normal);
    const mpq_class determinant = Dot(a.normal, bc);
    if (determinant == 0) return std::nullopt;
    Vector point;
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = -(a.offset * bc[k] + b.offset * ca[k] + c.offset * ab[k]) /
                 determinant;
    }
    return point;
  }

  bool Contains(const Vector& point) const {
    for (const ExactPlane& plane : planes_) {
      if (Dot(plane.normal, point) + plane.offset < 0) return false;
    }
    return true;
  }

  std::vector<ExactPlane> planes_;
};

class Frustum {
 public:
  explicit Frustum(Bytes& bytes) : mode_(bytes) {
    // Mostly what closes: the first planes are those of a box, tilted.
    const std::size_t tilted = bytes.Below(7);
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      HalfSpace3& plane = planes_[i];
      if (i < tilted) {
        plane = {{}, 1};
        plane.normal[i / 2] = i % 2 == 0 ? 1.f : -1.f;
        plane.normal[bytes.Below(3)] = bytes.Float();
        if (bytes.Below(2) == 0) plane.offset = bytes.Float();
      } else {
        bytes.Fill(plane.normal);
        plane.offset = bytes.Float();
      }
    }
  }

  ::testing::AssertionResult Check() const {
    Aabo3 bound;
    mode_.Run([&] { bound = BoundFrustum(planes_); });
    if (bound == Aabo3::Everything()) return ::testing::AssertionSuccess();
    Polytope polytope;
    for (const auto& [normal, offset] : planes_) {
      for (float value : {normal[0], normal[1], normal[2], offset}) {
        if (!std::isfinite(value)) {
          return ::testing::AssertionFailure() << "bounds what is not finite";
        }
      }
      polytope.Add({ExactOf<3>(normal), mpq_class(offset)});
    }
    if (polytope.IsOpen()) {
      return ::testing::AssertionFailure() << "bounds what is open";
    }
    for (const Vector& corner : polytope.Corners()) {
      ExactShape<3> exact;
      exact.AddPoint(corner);
      auto result = exact.CheckEncloses(bound);
      if (!result) {
        return result << "\nthe bound: min " << Print(bound.min) << ", max "
                      << Print(bound.max);
      }
    }
    return ::testing::AssertionSuccess();
  }

  friend std::ostream& operator<<(std::ostream& out, const Frustum& frustum) {
    out << "the planes";
    for (const auto& [normal, offset] : frustum.planes_) {
      out << ' ' << Print(normal) << " . p + " << Print(std::array{offset})
          << " >= 0,";
    }
    return out << " in the mode " << frustum.mode_;
  }

 private:
  CallerMode mode_;
  std::array<HalfSpace3, 6> planes_;
};

}  // namespace

void RunInput(Bytes& bytes) { Run<Frustum>(bytes); }

}  // namespace halfspace::testing

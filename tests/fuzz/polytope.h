// What lies in front of planes, exactly: Cramer's rule in whole numbers.
#ifndef HALFSPACE_TESTS_FUZZ_POLYTOPE_H_
#define HALFSPACE_TESTS_FUZZ_POLYTOPE_H_

#include <gmpxx.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspace/fit.h"
#include "tests/fuzz/exact_shape.h"

namespace halfspace::testing {

using Vector = std::array<mpz_class, 3>;

inline Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}

inline mpz_class Dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// As a multiple of the smallest float.
inline mpz_class Whole(float value) {
  return mpz_class(std::ldexp(double{value}, 149));
}

struct ExactPlane {
  explicit ExactPlane(const HalfSpace3& plane) : offset(Whole(plane.offset)) {
    for (std::size_t k = 0; k < 3; ++k) normal[k] = Whole(plane.normal[k]);
  }

  Vector normal;
  mpz_class offset;
};

// The intersection of half-spaces.
class Polytope {
 public:
  void Add(const HalfSpace3& plane) { planes_.emplace_back(plane); }

  // Whether some direction never leaves the planes' front sides. If all
  // normals lie in a plane one does; else, if any, one that two planes share.
  bool IsOpen() const {
    bool is_flat = true;
    for (const ExactPlane& a : planes_) {
      for (const ExactPlane& b : planes_) {
        const Vector direction = Cross(a.normal, b.normal);
        if (direction == Vector{}) continue;
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

  // Where three planes meet, behind none of the others.
  std::vector<ExactPoint<3>> FindCorners() const {
    std::vector<ExactPoint<3>> corners;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t k = 0; k < j; ++k) Meet(i, j, k, corners);
      }
    }
    return corners;
  }

 private:
  // By Cramer's rule: a point times its divisor, which is made positive.
  void Meet(std::size_t i, std::size_t j, std::size_t k,
            std::vector<ExactPoint<3>>& corners) const {
    const ExactPlane& a = planes_[i];
    const ExactPlane& b = planes_[j];
    const ExactPlane& c = planes_[k];
    const Vector bc = Cross(b.normal, c.normal);
    const Vector ca = Cross(c.normal, a.normal);
    const Vector ab = Cross(a.normal, b.normal);
    mpz_class divisor = Dot(a.normal, bc);
    if (divisor == 0) return;
    const int sign = sgn(divisor);
    divisor *= sign;
    Vector point;
    for (std::size_t n = 0; n < 3; ++n) {
      point[n] =
          -sign * (a.offset * bc[n] + b.offset * ca[n] + c.offset * ab[n]);
    }
    for (const ExactPlane& plane : planes_) {
      if (plane.offset * divisor + Dot(plane.normal, point) < 0) return;
    }
    ExactPoint<3> corner;
    for (std::size_t n = 0; n < 3; ++n) {
      corner[n] = mpq_class(point[n], divisor);
      corner[n].canonicalize();
    }
    corners.push_back(corner);
  }

  std::vector<ExactPlane> planes_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_POLYTOPE_H_

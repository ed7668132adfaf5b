// What lies in front of planes, exactly: the corners, by Cramer's rule in whole
// numbers.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_EXACT_FRUSTUM_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_EXACT_FRUSTUM_H_

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "halfspace/shapes.h"
#include "tests/library/fit/exact_shapes.h"
#include "tests/library/support/exact.h"

namespace halfspace::testing {

class ExactFrustum {
 public:
  template <typename Scalar, std::size_t kCount>
  explicit ExactFrustum(
      const std::array<HalfSpace<3, Scalar>, kCount>& planes) {
    for (const auto& p : planes) {
      planes_.push_back(
          Whole({p.normal[0], p.normal[1], p.normal[2], p.offset}));
    }
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t k = 0; k < j; ++k) Meet(i, j, k);
      }
    }
  }

  bool IsEmpty() const { return corners_.empty(); }

  // Whether some direction never leaves the planes' front sides. If all normals
  // lie in a plane one does. Otherwise, if any does, one that two planes share.
  bool IsOpen() const {
    bool is_flat = true;
    for (const Four& a : planes_) {
      for (const Four& b : planes_) {
        const Four direction = {a[1] * b[2] - a[2] * b[1],
                                a[2] * b[0] - a[0] * b[2],
                                a[0] * b[1] - a[1] * b[0], 0};
        if (direction == Four{}) continue;
        bool falls = false;
        for (const Four& plane : planes_) {
          const int slope = sgn(Height(plane, direction));
          falls |= slope < 0;
          is_flat &= slope == 0;
        }
        if (!falls) return true;
      }
    }
    return is_flat;
  }

  ExactHull Hull() const {
    ExactHull hull(3);
    for (const auto& corner : corners_) hull.AddPoint(corner);
    return hull;
  }

  // The largest sum of a corner's magnitudes.
  mpq_class Magnitude() const {
    mpq_class most = 0;
    for (const auto& c : corners_) {
      const mpq_class sum = abs(c[0]) + abs(c[1]) + abs(c[2]);
      if (sum > most) most = sum;
    }
    return most;
  }

 private:
  using Four = std::array<mpz_class, 4>;  // a normal and an offset

  // As multiples of the smallest float, or, if that is not enough, of the
  // smallest double.
  static Four Whole(const std::array<double, 4>& numbers) {
    const bool is_float = std::all_of(
        numbers.begin(), numbers.end(),
        [](double number) { return number == static_cast<float>(number); });
    Four whole;
    for (std::size_t n = 0; n < 4; ++n) {
      whole[n] = Exact(numbers[n]) * (mpz_class(1) << (is_float ? 149 : 1074));
    }
    return whole;
  }

  static mpz_class Height(const Four& plane, const Four& point) {
    mpz_class height = 0;
    for (std::size_t n = 0; n < 4; ++n) height += plane[n] * point[n];
    return height;
  }

  static mpz_class Determinant(const Four& a, const Four& b, const Four& c,
                               std::size_t x, std::size_t y, std::size_t z) {
    return a[x] * (b[y] * c[z] - b[z] * c[y]) +
           a[y] * (b[z] * c[x] - b[x] * c[z]) +
           a[z] * (b[x] * c[y] - b[y] * c[x]);
  }

  void Meet(std::size_t i, std::size_t j, std::size_t k) {
    const Four& a = planes_[i];
    const Four& b = planes_[j];
    const Four& c = planes_[k];
    const mpz_class divisor = Determinant(a, b, c, 0, 1, 2);
    if (divisor == 0) return;
    // A point times the divisor, and the divisor, with a positive one.
    Four point = {-Determinant(a, b, c, 3, 1, 2),
                  -Determinant(a, b, c, 0, 3, 2),
                  -Determinant(a, b, c, 0, 1, 3), divisor};
    if (divisor < 0) {
      for (mpz_class& x : point) x = -x;
    }
    for (const Four& plane : planes_) {
      if (Height(plane, point) < 0) return;
    }
    ExactPoint corner;
    for (std::size_t n = 0; n < 3; ++n) {
      corner.emplace_back(point[n], point[3]).canonicalize();
    }
    corners_.push_back(corner);
  }

  std::vector<Four> planes_;
  std::vector<ExactPoint> corners_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_EXACT_FRUSTUM_H_

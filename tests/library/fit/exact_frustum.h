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

// A box farther out than any corner closes what is open, so that an open set
// has a corner on it.
class ExactFrustum {
 public:
  template <typename Scalar, std::size_t kCount>
  explicit ExactFrustum(
      const std::array<HalfSpace<3, Scalar>, kCount>& planes) {
    for (const auto& p : planes) {
      planes_.push_back({Whole(p.normal[0]), Whole(p.normal[1]),
                         Whole(p.normal[2]), Whole(p.offset)});
    }
    for (std::size_t k = 0; k < 3; ++k) {
      for (int side : {-1, 1}) {
        Four plane{0, 0, 0, FarAway()};
        plane[k] = side;
        planes_.push_back(plane);
      }
    }
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      for (std::size_t j = i + 1; j < planes_.size(); ++j) {
        for (std::size_t k = j + 1; k < planes_.size(); ++k) Meet(i, j, k);
      }
    }
  }

  bool IsEmpty() const { return corners_.empty(); }
  bool IsOpen() const { return is_open_; }

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

  static mpz_class FarAway() { return mpz_class(1) << 1000; }

  // A number as a multiple of the smallest one of its type.
  static mpz_class Whole(float value) {
    return mpz_class(Exact(value) * (mpz_class(1) << 149));
  }
  static mpz_class Whole(double value) {
    return mpz_class(Exact(value) * (mpz_class(1) << 1074));
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
      mpz_class height = 0;
      for (std::size_t n = 0; n < 4; ++n) height += plane[n] * point[n];
      if (height < 0) return;
    }
    is_open_ |= std::max({i, j, k}) >= planes_.size() - 6;
    ExactPoint corner;
    for (std::size_t n = 0; n < 3; ++n) {
      corner.emplace_back(point[n], point[3]).canonicalize();
    }
    corners_.push_back(corner);
  }

  std::vector<Four> planes_;  // the last six: the box
  std::vector<ExactPoint> corners_;
  bool is_open_ = false;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_EXACT_FRUSTUM_H_

// The calls of transform.h that change each plane of a bound on its own, and
// what they mean exactly. Maxima are the minima of the mirrored shape: `sign`
// is -1 for those.
//
// An operation on a Bound is made from Bytes, can be printed, and has
//   bool IsRefused() const;
//   bool IsFinite() const;
//   Bound Before(bound)        what the next three are about; mostly the bound
//   ... Exact(minimum, axis, sign)   what the new minimum has to enclose
//   Tolerance ToleranceOf(axis)
//   Bound Call(bound, status)
#ifndef HALFSPACE_TESTS_FUZZ_TRANSFORM_OPS_H_
#define HALFSPACE_TESTS_FUZZ_TRANSFORM_OPS_H_

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <vector>

#include "halfspace/transform.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/exact_real.h"
#include "tests/fuzz/print.h"
#include "tests/library/support/cases.h"

namespace halfspace::testing {

template <typename Bound>
constexpr bool IsD(std::size_t axis) {
  return axis == std::size_t{Bound::kDimensions};
}

// A bound that grows by one number; `Self` says how.
template <typename Bound, typename Self>
class GrowingOp {
 public:
  explicit GrowingOp(Bytes& bytes) : amount_(bytes.Float()) {}

  bool IsRefused() const { return !(amount_ >= 0); }
  bool IsFinite() const { return std::isfinite(amount_); }
  Bound Before(const Bound& bound) const { return bound; }

  friend std::ostream& operator<<(std::ostream& out, const GrowingOp& op) {
    return out << Self::kName << " by " << Print(std::array{op.amount_});
  }

 protected:
  float amount_;
};

template <typename Bound>
class InflateOp : public GrowingOp<Bound, InflateOp<Bound>> {
 public:
  static constexpr const char* kName = "Inflate";
  using GrowingOp<Bound, InflateOp>::GrowingOp;

  std::vector<ExactReal> Exact(float minimum, std::size_t axis, int) const {
    const mpq_class radius(this->amount_);
    if (!IsD<Bound>(axis)) return {{mpq_class(minimum) - radius}};
    return {{minimum, Bound::kDimensions * radius * radius, -sgn(radius)}};
  }
  Tolerance ToleranceOf(std::size_t axis) const {
    if (!IsD<Bound>(axis)) return {};
    return {.ulps = 1, .slack = mpq_class(this->amount_) * 0x1p-100};
  }
  Bound Call(const Bound& bound, FitStatus* status) const {
    return Inflate(bound, this->amount_, status);
  }
};

template <typename Bound>
class InflateByBoxOp : public GrowingOp<Bound, InflateByBoxOp<Bound>> {
 public:
  static constexpr const char* kName = "InflateByBox";
  using GrowingOp<Bound, InflateByBoxOp>::GrowingOp;

  std::vector<ExactReal> Exact(float minimum, std::size_t axis, int) const {
    const int times = IsD<Bound>(axis) ? Bound::kDimensions : 1;
    return {{mpq_class(minimum) - times * mpq_class(this->amount_)}};
  }
  Tolerance ToleranceOf(std::size_t) const { return {}; }
  Bound Call(const Bound& bound, FitStatus* status) const {
    return InflateByBox(bound, this->amount_, status);
  }
};

template <typename Bound>
class TranslateOp {
 public:
  explicit TranslateOp(Bytes& bytes) { bytes.Fill(by_); }

  bool IsRefused() const { return false; }
  bool IsFinite() const {
    return std::all_of(by_.begin(), by_.end(),
                       [](float x) { return std::isfinite(x); });
  }
  Bound Before(const Bound& bound) const { return bound; }
  std::vector<ExactReal> Exact(float minimum, std::size_t axis,
                               int sign) const {
    mpq_class move = 0;
    if (IsD<Bound>(axis)) {
      for (float x : by_) move -= mpq_class(x);
    } else {
      move = by_[axis];
    }
    return {{mpq_class(minimum) + sign * move}};
  }
  Tolerance ToleranceOf(std::size_t) const { return {}; }
  Bound Call(const Bound& bound, FitStatus* status) const {
    return Translate(bound, by_, status);
  }
  friend std::ostream& operator<<(std::ostream& out, const TranslateOp& op) {
    return out << "Translate or Sweep by " << Print(op.by_);
  }

 protected:
  Point<Bound::kDimensions> by_;
};

template <typename Bound>
class SweepOp : public TranslateOp<Bound> {
 public:
  using TranslateOp<Bound>::TranslateOp;

  std::vector<ExactReal> Exact(float minimum, std::size_t axis,
                               int sign) const {
    auto both = TranslateOp<Bound>::Exact(minimum, axis, sign);
    both.push_back({minimum});
    return both;
  }
  Bound Call(const Bound& bound, FitStatus* status) const {
    return Sweep(bound, this->by_, status);
  }
};

template <typename Bound>
class ScaleOp {
 public:
  explicit ScaleOp(Bytes& bytes) : factor_(bytes.Float()) {}

  bool IsRefused() const {
    return kHasBothSides ? std::isnan(factor_) : !(factor_ >= 0);
  }
  bool IsFinite() const { return std::isfinite(factor_); }
  Bound Before(const Bound& bound) const {
    Bound turned = bound;
    if constexpr (kHasBothSides) {
      for (std::size_t k = 0; factor_ < 0 && k < Bound::kAxes; ++k) {
        turned.min[k] = -bound.max[k];
        turned.max[k] = -bound.min[k];
      }
    }
    return turned;
  }
  std::vector<ExactReal> Exact(float minimum, std::size_t, int) const {
    return {{mpq_class(minimum) * abs(mpq_class(factor_))}};
  }
  Tolerance ToleranceOf(std::size_t) const { return {}; }
  Bound Call(const Bound& bound, FitStatus* status) const {
    return Scale(bound, factor_, status);
  }
  friend std::ostream& operator<<(std::ostream& out, const ScaleOp& op) {
    return out << "Scale by " << Print(std::array{op.factor_});
  }

 private:
  static constexpr bool kHasBothSides = HasMinima<Bound> && HasMaxima<Bound>;

  float factor_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_TRANSFORM_OPS_H_

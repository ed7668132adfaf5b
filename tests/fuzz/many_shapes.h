// Sources of the bulk builders: a few different shapes, and which of them each
// element is.
//
// A source is made from Bytes and the choices of the elements, and has
//   Distinct()   how many different shapes there are
//   Describe(shape, options, exact)   the shape with that number
//   Call(planes, options, status)   bounds all elements
#ifndef HALFSPACE_TESTS_FUZZ_MANY_SHAPES_H_
#define HALFSPACE_TESTS_FUZZ_MANY_SHAPES_H_

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <vector>

#include "halfspace/fit_many.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/print.h"

namespace halfspace::testing {

using Choices = std::span<const std::size_t>;

inline constexpr std::size_t kMostDistinct = 4;

// Rows of floats, one per element, in one block that ends with the last.
template <std::size_t kColumns>
class Rows {
 public:
  explicit Rows(Bytes& bytes) : gap_(bytes.Below(4)) {
    for (auto& row : distinct_) bytes.Fill(row);
  }

  void Choose(Choices choices) {
    stride_ = gap_ == 0 ? 1 : kColumns + gap_ - 1;
    const std::size_t step = gap_ == 0 ? choices.size() : 1;
    if (choices.empty()) return;
    block_.resize((choices.size() - 1) * stride_ + (kColumns - 1) * step + 1);
    for (std::size_t c = 0; c < kColumns; ++c) {
      columns_[c] = block_.data() + c * step;
      for (std::size_t i = 0; i < choices.size(); ++i) {
        block_[i * stride_ + c * step] = distinct_[choices[i]][c];
      }
    }
  }

  const float* column(std::size_t c) const { return columns_[c]; }
  std::size_t stride() const { return stride_; }
  std::array<float, kColumns>& operator[](std::size_t i) {
    return distinct_[i];
  }
  const std::array<float, kColumns>& operator[](std::size_t i) const {
    return distinct_[i];
  }

  friend std::ostream& operator<<(std::ostream& out, const Rows& rows) {
    out << "stride " << rows.stride_ << ", distinct shapes";
    for (const auto& row : rows.distinct_) out << ' ' << Print(row);
    return out;
  }

 private:
  std::size_t gap_;
  std::array<std::array<float, kColumns>, kMostDistinct> distinct_;
  std::vector<float> block_;
  std::array<const float*, kColumns> columns_{};
  std::size_t stride_ = 1;
};

template <int kDims>
class ManyBoxes {
 public:
  ManyBoxes(Bytes& bytes, Choices choices)
      : rows_(bytes), count_(choices.size()) {
    const std::size_t sorted = bytes.Below(16);
    for (std::size_t i = 0; i < kMostDistinct; ++i) {
      for (std::size_t k = 0; k < kDims; ++k) {
        auto& row = rows_[i];
        if ((sorted >> i & 1) != 0 && row[k] > row[kDims + k]) {
          std::swap(row[k], row[kDims + k]);
        }
      }
    }
    rows_.Choose(choices);
  }

  void Describe(std::size_t shape, const FitOptions& options,
                ExactShape<kDims>& exact) const {
    const std::span<const float> row(rows_[shape]);
    const auto low = row.first(kDims);
    const auto high = row.last(kDims);
    bool is_inverted = false;
    bool is_empty = true;
    bool is_number = true;
    for (std::size_t k = 0; k < kDims; ++k) {
      is_inverted |= low[k] > high[k];
      is_empty &= low[k] >= FLT_MAX && high[k] <= -FLT_MAX;
      is_number &= !std::isnan(low[k]) && !std::isnan(high[k]);
    }
    const bool empties = options.inverted == Inverted::kEmpty && is_number;
    if (is_empty || (is_inverted && empties)) return;
    if (is_inverted) return exact.BeEverything();
    if (!exact.Accept(row)) return;
    for (auto corner : {low, high}) {
      const auto point = ExactOf<std::size_t{kDims}>(corner);
      exact.Weigh(SumOfMagnitudes(point));
      exact.AddPoint(point);
    }
    exact.Tolerate({}, {.ulps = options.tightest ? 0 : 1});
  }

  template <typename Planes>
  Target Call(const Planes& planes, const FitOptions& options,
              FitStatus* status) const {
    Boxes<kDims> boxes{.count = count_, .stride = rows_.stride()};
    for (std::size_t k = 0; k < kDims; ++k) {
      boxes.min[k] = rows_.column(k);
      boxes.max[k] = rows_.column(kDims + k);
    }
    return BoundBoxes(boxes, planes, options, status);
  }

  friend std::ostream& operator<<(std::ostream& out, const ManyBoxes& many) {
    return out << "boxes in " << kDims << "D, " << many.rows_;
  }

 private:
  Rows<2 * kDims> rows_;
  std::size_t count_;
};

template <int kDims>
class ManySpheres {
 public:
  ManySpheres(Bytes& bytes, Choices choices)
      : rows_(bytes), count_(choices.size()) {
    rows_.Choose(choices);
  }

  void Describe(std::size_t shape, const FitOptions& options,
                ExactShape<kDims>& exact) const {
    const std::span<const float> row(rows_[shape]);
    if (!(row[kDims] >= 0)) return exact.BeEverything();
    if (!exact.Accept(row)) return;
    const auto center = ExactOf<std::size_t{kDims}>(row.first(kDims));
    const mpq_class radius(row[kDims]);
    const mpq_class weight = SumOfMagnitudes(center) + radius;
    exact.Weigh(weight);
    exact.AddSphere(center, radius);
    const Tolerance tightest = {.slack = radius * 0x1p-100};
    const Tolerance within_ulp = {.ulps = 1, .slack = weight * 0x1p-49};
    exact.Tolerate({}, options.tightest ? tightest : within_ulp);
  }

  template <typename Planes>
  Target Call(const Planes& planes, const FitOptions& options,
              FitStatus* status) const {
    Spheres<kDims> spheres{.radius = rows_.column(kDims),
                           .count = count_,
                           .stride = rows_.stride()};
    for (std::size_t k = 0; k < kDims; ++k) {
      spheres.center[k] = rows_.column(k);
    }
    return BoundSpheres(spheres, planes, options, status);
  }

  friend std::ostream& operator<<(std::ostream& out, const ManySpheres& many) {
    return out << "spheres in " << kDims << "D, " << many.rows_;
  }

 private:
  Rows<kDims + 1> rows_;
  std::size_t count_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_MANY_SHAPES_H_

// Bounds of affine images of points and boxes, against exact arithmetic.
#include <algorithm>
#include <array>
#include <cstddef>
#include <ostream>
#include <utility>
#include <vector>

#include "halfspace/fit.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/fit_input.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"

namespace halfspace::testing {
namespace {

template <int kDims>
class Map {
 public:
  explicit Map(Bytes& bytes) {
    for (auto& row : map_.linear) bytes.Fill(row);
    bytes.Fill(map_.translation);
  }

  const Affine<kDims>& affine() const { return map_; }

  void AddImage(const Point<kDims>& point, ExactShape<kDims>& exact) const {
    bool finite = exact.Accept(point) && exact.Accept(map_.translation);
    for (const auto& row : map_.linear) finite = finite && exact.Accept(row);
    if (!finite) return;
    auto image = ExactOf<std::size_t{kDims}>(map_.translation);
    mpq_class weight = SumOfMagnitudes(image);
    for (std::size_t i = 0; i < kDims; ++i) {
      for (std::size_t j = 0; j < kDims; ++j) {
        const mpq_class term =
            mpq_class(map_.linear[i][j]) * mpq_class(point[j]);
        image[i] += term;
        weight += abs(term);
      }
    }
    exact.Weigh(weight);
    exact.AddPoint(image);
  }

  friend std::ostream& operator<<(std::ostream& out, const Map& map) {
    out << "the map with rows";
    for (const auto& row : map.map_.linear) out << ' ' << Print(row);
    return out << " and translation " << Print(map.map_.translation);
  }

 private:
  Affine<kDims> map_;
};

template <int kTheDims>
class ImageOfPoints {
 public:
  static constexpr int kDims = kTheDims;

  explicit ImageOfPoints(Bytes& bytes) : map_(bytes), coords_() {
    coords_.resize(bytes.Below(4) * kDims);
    for (float& x : coords_) x = bytes.Float();
  }

  void Describe(ExactShape<kDims>& exact) const {
    for (std::size_t i = 0; i < coords_.size(); i += kDims) {
      Point<kDims> point;
      std::copy_n(coords_.data() + i, kDims, point.begin());
      map_.AddImage(point, exact);
    }
  }
  Aabo<kDims> Build(FitStatus* status) const {
    const Points<kDims> points{coords_.data(), coords_.size() / kDims};
    return BoundTransformed(points, map_.affine(), status);
  }
  friend std::ostream& operator<<(std::ostream& out,
                                  const ImageOfPoints& shape) {
    return out << shape.map_ << "\nof the points " << Print(shape.coords_);
  }

 private:
  Map<kDims> map_;
  std::vector<float> coords_;
};

template <int kTheDims>
class ImageOfBox {
 public:
  static constexpr int kDims = kTheDims;

  explicit ImageOfBox(Bytes& bytes) : map_(bytes) {
    bytes.Fill(box_.min);
    bytes.Fill(box_.max);
    if (bytes.Below(4) == 0) return;
    for (std::size_t k = 0; k < kDims; ++k) {
      if (box_.min[k] > box_.max[k]) std::swap(box_.min[k], box_.max[k]);
    }
  }

  void Describe(ExactShape<kDims>& exact) const {
    if (IsEmpty(box_)) return;
    for (std::size_t k = 0; k < kDims; ++k) {
      if (box_.min[k] > box_.max[k]) return exact.Refuse();
    }
    for (std::size_t corner = 0; corner < std::size_t{1} << kDims; ++corner) {
      Point<kDims> point;
      for (std::size_t k = 0; k < kDims; ++k) {
        point[k] = (corner >> k & 1) == 0 ? box_.min[k] : box_.max[k];
      }
      map_.AddImage(point, exact);
    }
  }
  Aabo<kDims> Build(FitStatus* status) const {
    return BoundTransformed(box_, map_.affine(), status);
  }
  friend std::ostream& operator<<(std::ostream& out, const ImageOfBox& shape) {
    return out << shape.map_ << "\nof the box, min " << Print(shape.box_.min)
               << ", max " << Print(shape.box_.max);
  }

 private:
  Map<kDims> map_;
  Aabb<kDims> box_;
};

template <int kDims>
using Inputs = ::testing::Types<FitInput<ImageOfPoints<kDims>>,
                                FitInput<ImageOfBox<kDims>>>;

}  // namespace

void RunInput(Bytes& bytes) { RunOneOfAllDims<Inputs>(bytes); }

}  // namespace halfspace::testing

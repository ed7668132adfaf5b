// Bounds of points, against exact arithmetic.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <vector>

#include "halfspace/fit.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/fit_input.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"

namespace halfspace::testing {
namespace {

template <int kTheDims, typename Scalar>
void Add(const Point<kTheDims, Scalar>& point, ExactShape<kTheDims>& exact) {
  if (!exact.Accept(point)) return;
  const auto coords = ExactOf<std::size_t{kTheDims}>(point);
  exact.Weigh(SumOfMagnitudes(coords));
  exact.AddPoint(coords);
}

// A few points, which end where their memory does; they may overlap.
template <int kTheDims, typename Scalar>
class PointSet {
 public:
  static constexpr int kDims = kTheDims;

  explicit PointSet(Bytes& bytes)
      : count_(bytes.Below(6)), stride_(bytes.Below(kDims + 3)) {
    if (count_ == 0) return;
    coords_.resize((count_ - 1) * stride_ + kDims);
    for (Scalar& x : coords_) x = bytes.Number<Scalar>();
  }

  std::size_t count() const { return count_; }
  Points<kDims, Scalar> points() const {
    return {coords_.data(), count_, stride_};
  }
  Point<kDims, Scalar> operator[](std::size_t i) const {
    Point<kDims, Scalar> point;
    std::copy_n(coords_.data() + i * stride_, kDims, point.begin());
    return point;
  }

  void Describe(ExactShape<kDims>& exact) const {
    for (std::size_t i = 0; i < count_; ++i) Add<kDims>((*this)[i], exact);
  }
  Aabo<kDims> Build(FitStatus* status) const {
    return BoundPoints(points(), status);
  }
  friend std::ostream& operator<<(std::ostream& out, const PointSet& set) {
    return out << set.count_ << " points in " << kDims << "D, of "
               << sizeof(Scalar) << " bytes, stride " << set.stride_ << ": "
               << Print(set.coords_);
  }

 private:
  std::size_t count_;
  std::size_t stride_;
  std::vector<Scalar> coords_;
};

template <int kDims, typename Scalar>
class PointSetSoa : public PointSet<kDims, Scalar> {
 public:
  explicit PointSetSoa(Bytes& bytes) : PointSet<kDims, Scalar>(bytes) {
    for (std::size_t i = 0; i < this->count(); ++i) {
      for (std::size_t k = 0; k < kDims; ++k) {
        columns_[k].push_back((*this)[i][k]);
      }
    }
    for (auto& column : columns_) column.shrink_to_fit();
  }

  PointsSoa<kDims, Scalar> points() const {
    PointsSoa<kDims, Scalar> points{.count = this->count()};
    for (std::size_t k = 0; k < kDims; ++k) {
      points.coords[k] = columns_[k].data();
    }
    return points;
  }
  Aabo<kDims> Build(FitStatus* status) const {
    return BoundPoints(points(), status);
  }

 private:
  std::array<std::vector<Scalar>, std::size_t{kDims}> columns_;
};

template <typename Set>
class IndexedPoints {
 public:
  static constexpr int kDims = Set::kDims;

  explicit IndexedPoints(Bytes& bytes) : set_(bytes) {
    indices_.resize(bytes.Below(6));
    for (std::uint32_t& index : indices_) {
      index = static_cast<std::uint32_t>(bytes.Below(set_.count() + 2));
      if (index > set_.count()) index = bytes.Word();
    }
  }

  void Describe(ExactShape<kDims>& exact) const {
    for (std::uint32_t index : indices_) {
      if (index >= set_.count()) return exact.Refuse();
      Add<kDims>(set_[index], exact);
    }
  }
  Aabo<kDims> Build(FitStatus* status) const {
    return BoundPoints<kDims>(set_.points(), indices_, status);
  }
  friend std::ostream& operator<<(std::ostream& out,
                                  const IndexedPoints& points) {
    return out << points.set_ << ", indices " << Print(points.indices_);
  }

 private:
  Set set_;
  std::vector<std::uint32_t> indices_;
};

template <int kTheDims>
class Corners {
 public:
  static constexpr int kDims = kTheDims;

  explicit Corners(Bytes& bytes) : count_(1 + bytes.Below(3)) {
    for (auto& point : points_) bytes.Fill(point);
  }

  void Describe(ExactShape<kDims>& exact) const {
    for (const auto& point : Used()) Add<kDims>(point, exact);
  }
  Aabo<kDims> Build(FitStatus* status) const {
    const auto& [a, b, c] = points_;
    if (count_ == 1) return BoundPoint<kDims>(a, status);
    if (count_ == 2) return BoundSegment<kDims>({a, b}, status);
    return BoundTriangle<kDims>({a, b, c}, status);
  }
  friend std::ostream& operator<<(std::ostream& out, const Corners& corners) {
    out << "the corners";
    for (const auto& point : corners.Used()) out << ' ' << Print(point);
    return out;
  }

 private:
  std::span<const Point<kDims>> Used() const {
    return std::span(points_).first(count_);
  }

  std::size_t count_;
  std::array<Point<kDims>, 3> points_;
};

template <int kDims>
using Inputs = ::testing::Types<
    FitInput<PointSet<kDims, float>>, FitInput<PointSet<kDims, double>>,
    FitInput<PointSetSoa<kDims, float>>, FitInput<PointSetSoa<kDims, double>>,
    FitInput<IndexedPoints<PointSet<kDims, float>>>,
    FitInput<IndexedPoints<PointSetSoa<kDims, float>>>,
    FitInput<Corners<kDims>>>;

}  // namespace

void RunInput(Bytes& bytes) { RunOneOfAllDims<Inputs>(bytes); }

}  // namespace halfspace::testing

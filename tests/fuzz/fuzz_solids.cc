// Bounds of boxes, spheres and capsules, against exact arithmetic.
#include <array>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <type_traits>
#include <utility>

#include "halfspace/fit.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/fit_input.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"

namespace halfspace::testing {
namespace {

// `AnyBox` is an Aabb or a Box.
template <int kTheDims, typename AnyBox>
class BoxShape {
 public:
  static constexpr int kDims = kTheDims;

  explicit BoxShape(Bytes& bytes) {
    bytes.Fill(box_.min);
    bytes.Fill(box_.max);
    if (bytes.Below(4) == 0) return;
    for (std::size_t k = 0; k < kDims; ++k) {
      if (box_.min[k] > box_.max[k]) std::swap(box_.min[k], box_.max[k]);
    }
  }

  void Describe(ExactShape<kDims>& exact) const {
    if (IsEmpty(Aabb<kDims, Scalar>{box_.min, box_.max})) return;
    for (std::size_t k = 0; k < kDims; ++k) {
      if (box_.min[k] > box_.max[k]) return exact.Refuse();
    }
    if (!exact.Accept(box_.min) || !exact.Accept(box_.max)) return;
    const auto min = ExactOf<std::size_t{kDims}>(box_.min);
    const auto max = ExactOf<std::size_t{kDims}>(box_.max);
    exact.Weigh(SumOfMagnitudes(min));
    exact.Weigh(SumOfMagnitudes(max));
    for (std::size_t corner = 0; corner < std::size_t{1} << kDims; ++corner) {
      auto point = min;
      for (std::size_t k = 0; k < kDims; ++k) {
        if ((corner >> k & 1) != 0) point[k] = max[k];
      }
      exact.AddPoint(point);
    }
  }
  Aabo<kDims> Build(FitStatus* status) const { return BoundAabb(box_, status); }
  friend std::ostream& operator<<(std::ostream& out, const BoxShape& shape) {
    return out << "the box, of " << sizeof(Scalar) << " bytes, min "
               << Print(shape.box_.min) << ", max " << Print(shape.box_.max);
  }

 private:
  using Scalar = std::decay_t<decltype(AnyBox().min[0])>;

  AnyBox box_;
};

// All points within a radius of one center, or of the segment between two.
template <int kTheDims, typename Scalar, std::size_t kCenters>
class RoundShape {
 public:
  static constexpr int kDims = kTheDims;

  explicit RoundShape(Bytes& bytes) : radius_(bytes.Number<Scalar>()) {
    for (auto& center : centers_) bytes.Fill(center);
  }

  void Describe(ExactShape<kDims>& exact) const {
    if (!(radius_ >= 0)) return exact.Refuse();
    if (!exact.Accept(std::array{radius_})) return;
    const mpq_class radius(radius_);
    for (const auto& center : centers_) {
      if (!exact.Accept(center)) return;
      const auto coords = ExactOf<std::size_t{kDims}>(center);
      exact.Weigh(SumOfMagnitudes(coords) + radius);
      exact.AddSphere(coords, radius);
    }
    exact.Tolerate({}, {.ulps = 1, .slack = radius * 0x1p-100});
  }
  Aabo<kDims> Build(FitStatus* status) const {
    if constexpr (kCenters == 1) {
      const Sphere<kDims, Scalar> sphere{centers_[0], radius_};
      return BoundSphere(sphere, status);
    } else {
      return BoundCapsule<kDims>({centers_[0], centers_[1], radius_}, status);
    }
  }
  friend std::ostream& operator<<(std::ostream& out, const RoundShape& shape) {
    out << "the radius " << Print(std::array{shape.radius_}) << ", of "
        << sizeof(Scalar) << " bytes, around";
    for (const auto& center : shape.centers_) out << ' ' << Print(center);
    return out;
  }

 private:
  Scalar radius_;
  std::array<Point<kDims, Scalar>, kCenters> centers_;
};

template <int kTheDims>
class OrientedBoxShape {
 public:
  static constexpr int kDims = kTheDims;

  explicit OrientedBoxShape(Bytes& bytes) {
    bytes.Fill(box_.center);
    bytes.Fill(box_.half_extents);
    for (auto& axis : box_.axes) bytes.Fill(axis);
    if (bytes.Below(4) == 0) return;
    for (float& extent : box_.half_extents) extent = std::fabs(extent);
  }

  void Describe(ExactShape<kDims>& exact) const {
    for (float extent : box_.half_extents) {
      if (!(extent >= 0)) return exact.Refuse();
    }
    bool finite = exact.Accept(box_.center) && exact.Accept(box_.half_extents);
    for (const auto& axis : box_.axes) finite = finite && exact.Accept(axis);
    if (!finite) return;
    const auto center = ExactOf<std::size_t{kDims}>(box_.center);
    mpq_class weight = SumOfMagnitudes(center);
    std::array<ExactPoint<std::size_t{kDims}>, std::size_t{kDims}> arms;
    for (std::size_t i = 0; i < kDims; ++i) {
      arms[i] = ExactOf<std::size_t{kDims}>(box_.axes[i]);
      for (mpq_class& x : arms[i]) x *= mpq_class(box_.half_extents[i]);
      weight += SumOfMagnitudes(arms[i]);
    }
    exact.Weigh(weight);
    for (std::size_t corner = 0; corner < std::size_t{1} << kDims; ++corner) {
      auto point = center;
      for (std::size_t i = 0; i < kDims; ++i) {
        for (std::size_t k = 0; k < kDims; ++k) {
          if ((corner >> i & 1) != 0) {
            point[k] += arms[i][k];
          } else {
            point[k] -= arms[i][k];
          }
        }
      }
      exact.AddPoint(point);
    }
  }
  Aabo<kDims> Build(FitStatus* status) const {
    return BoundOrientedBox(box_, status);
  }
  friend std::ostream& operator<<(std::ostream& out,
                                  const OrientedBoxShape& shape) {
    out << "the oriented box around " << Print(shape.box_.center)
        << ", half extents " << Print(shape.box_.half_extents) << ", axes";
    for (const auto& axis : shape.box_.axes) out << ' ' << Print(axis);
    return out;
  }

 private:
  OrientedBox<kDims> box_;
};

template <int kDims>
using Inputs = ::testing::Types<FitInput<BoxShape<kDims, Aabb<kDims>>>,
                                FitInput<BoxShape<kDims, Box<kDims, double>>>,
                                FitInput<RoundShape<kDims, float, 1>>,
                                FitInput<RoundShape<kDims, double, 1>>,
                                FitInput<RoundShape<kDims, float, 2>>,
                                FitInput<OrientedBoxShape<kDims>>>;

}  // namespace

void RunInput(Bytes& bytes) { RunOneOfAllDims<Inputs>(bytes); }

}  // namespace halfspace::testing

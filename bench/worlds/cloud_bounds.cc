#include "bench/worlds/cloud_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace halfspace::bench {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kMostFloat = std::numeric_limits<float>::max();

float RoundedDown(double value) {
  if (value < -kMostFloat) return -kInfinity;
  const auto rounded = static_cast<float>(std::min(value, kMostFloat));
  return rounded > value ? std::nextafter(rounded, -kInfinity) : rounded;
}

}  // namespace

CloudBounds::CloudBounds(const PointSource& source) : size_(source.objects) {
  for (std::size_t c = 0; c < size_; ++c) {
    const auto points = source.next_object();
    points_ = points.size() / 3;
    for (std::size_t i = 0; i < points.size(); ++i) {
      coordinates_[i % 3].push_back(points[i]);
    }
  }
  for (std::size_t k = 0; k < min_.size(); ++k) {
    min_[k].resize(size_);
    max_[k].resize(size_);
  }
}

void CloudBounds::Bound(Axes axes, Target target) {
  const std::array<const float*, 3> coordinates = {
      coordinates_[0].data(), coordinates_[1].data(), coordinates_[2].data()};
  const std::array<float*, 4> min = {min_[0].data(), min_[1].data(),
                                     min_[2].data(), min_[3].data()};
  const std::array<float*, 4> max = {max_[0].data(), max_[1].data(),
                                     max_[2].data(), max_[3].data()};
  LoopsFor(target).bound_clouds(axes, coordinates.data(), size_, points_,
                                min.data(), max.data());
}

CloudBounds::Extent CloudBounds::ExtentOf(Axes axes, std::size_t axis,
                                          std::size_t cloud) const {
  const auto row = MatrixOf(axes)[axis];
  Extent extent{std::numeric_limits<double>::infinity(),
                -std::numeric_limits<double>::infinity()};
  for (std::size_t i = cloud * points_; i < (cloud + 1) * points_; ++i) {
    const double along = row[0] * coordinates_[0][i] +
                         row[1] * coordinates_[1][i] +
                         row[2] * coordinates_[2][i];
    extent.min = std::min(extent.min, along);
    extent.max = std::max(extent.max, along);
  }
  return extent;
}

std::string CloudBounds::Check(Axes axes, Target target) {
  // Of the coordinates' magnitudes; more would be no rounding.
  constexpr double kMost = 0x1p-20;
  Bound(axes, target);
  for (std::size_t c = 0; c < size_; ++c) {
    double most = 0.0;
    for (std::size_t k = 0; k < coordinates_.size(); ++k) {
      const Extent exact = ExtentOf(Axes::kStandard, k, c);
      most += kMost * std::max(std::abs(exact.min), std::abs(exact.max));
    }
    for (std::size_t k = 0; k < min_.size(); ++k) {
      const Extent exact = ExtentOf(axes, k, c);
      const double below = exact.min - min_[k][c];
      const double above = max_[k][c] - exact.max;
      if (!(below >= 0) || !(above >= 0) || below > most || above > most) {
        return "cloud " + std::to_string(c) + ", axis " + std::to_string(k) +
               ": the bound is not that of its points";
      }
    }
  }
  return {};
}

Case CloudBounds::MakeCase(std::string name, Axes axes, Target target) {
  Case c;
  c.name = std::move(name);
  c.items = static_cast<double>(size_);
  c.check = [this, axes, target] { return Check(axes, target); };
  c.run = [this, axes, target] { Bound(axes, target); };
  return c;
}

double CloudBounds::MeanPad(Axes axes, Target target) {
  Bound(axes, target);
  double sum = 0.0;
  for (std::size_t c = 0; c < size_; ++c) {
    for (std::size_t k = 0; k < min_.size(); ++k) {
      const Extent exact = ExtentOf(axes, k, c);
      sum += (exact.min - min_[k][c] + max_[k][c] - exact.max) /
             (exact.max - exact.min);
    }
  }
  return sum / static_cast<double>(2 * min_.size() * size_);
}

Aabo3 BoundOnRegularAxes(std::span<const float> points) {
  std::array<double, Aabo3::kAxes> min;
  std::array<double, Aabo3::kAxes> max;
  min.fill(std::numeric_limits<double>::infinity());
  max.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    const double x = points[i];
    const double y = points[i + 1];
    const double z = points[i + 2];
    const std::array<double, Aabo3::kAxes> along = {x + y + z, x - y - z,
                                                    y - x - z, z - x - y};
    // Two sums round, by half of 2^-52 each.
    const double error = 0x1p-51 * (std::abs(x) + std::abs(y) + std::abs(z));
    for (std::size_t k = 0; k < Aabo3::kAxes; ++k) {
      min[k] = std::min(min[k], along[k] - error);
      max[k] = std::max(max[k], along[k] + error);
    }
  }
  Aabo3 bound;
  for (std::size_t k = 0; k < Aabo3::kAxes; ++k) {
    bound.min[k] = RoundedDown(min[k]);
    bound.max[k] = -RoundedDown(-max[k]);
  }
  return bound;
}

}  // namespace halfspace::bench

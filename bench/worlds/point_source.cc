#include "bench/worlds/point_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "bench/worlds/moved_clouds.h"
#include "bench/worlds/random.h"

namespace halfspace::bench {
namespace {

using Corners = std::array<float, 24>;

Corners CornersOf(const Aabb3& box) {
  Corners corners;
  for (std::size_t c = 0; c < 8; ++c) {
    for (std::size_t k = 0; k < 3; ++k) {
      corners[3 * c + k] = (c >> k & 1) == 0 ? box.min[k] : box.max[k];
    }
  }
  return corners;
}

// Reads the objects of a file by their number.
class FileObjects {
 public:
  FileObjects(const Workload& file, std::size_t objects, std::uint64_t seed)
      : file_(file), objects_(objects), random_(seed) {}

  std::span<const float> Next() { return PointsOf(next_++); }
  std::span<const float> Any() { return PointsOf(random_.Below(objects_)); }

 private:
  std::span<const float> PointsOf(std::size_t i) {
    if (!file_.corners.empty()) {
      return std::span(file_.corners).subspan(9 * i, 9);
    }
    corners_ = CornersOf(file_.objects.Get(i).aabb());
    return corners_;
  }

  const Workload& file_;
  std::size_t objects_;
  Random random_;
  std::size_t next_ = 0;
  Corners corners_{};
};

class BallsAndBoxes {
 public:
  explicit BallsAndBoxes(std::uint64_t seed) : random_(seed) {}

  std::span<const float> NextBall() {
    const std::array<float, 3> to = Place();
    for (std::size_t i = 0; i < ball_.size(); i += 3) {
      const std::array<float, 3> point = PointInUnitSphere(random_);
      for (std::size_t k = 0; k < 3; ++k) ball_[i + k] = point[k] + to[k];
    }
    return ball_;
  }

  std::span<const float> NextBox() {
    constexpr float kHalfOfLongest = 1.75f;
    const std::array<float, 3> to = Place();
    Aabb3 box;
    for (std::size_t k = 0; k < 3; ++k) {
      const float half = kHalfOfLongest * (random_.Signed() + 1) / 2;
      box.min[k] = to[k] - half;
      box.max[k] = to[k] + half;
    }
    box_ = CornersOf(box);
    return box_;
  }

  std::span<const float> NextOfBoth() {
    is_ball_ = !is_ball_;
    return is_ball_ ? NextBall() : NextBox();
  }

 private:
  std::array<float, 3> Place() {
    return {kHalfCube * random_.Signed(), kHalfCube * random_.Signed(),
            kHalfCube * random_.Signed()};
  }

  Random random_;
  std::array<float, 150> ball_{};
  Corners box_{};
  bool is_ball_ = false;
};

PointSource SourceOf(std::string name, std::size_t objects, std::uint64_t seed,
                     std::span<const float> (BallsAndBoxes::*next)()) {
  const auto made = std::make_shared<BallsAndBoxes>(seed);
  const NextPoints points = [made, next] { return (made.get()->*next)(); };
  return {std::move(name), objects, points, points};
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kMostFloat = std::numeric_limits<float>::max();

float RoundedDown(double value) {
  if (value < -kMostFloat) return -kInfinity;
  const auto rounded = static_cast<float>(std::min(value, kMostFloat));
  return rounded > value ? std::nextafter(rounded, -kInfinity) : rounded;
}

}  // namespace

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

PointSource SceneSource(std::size_t objects, std::uint64_t seed) {
  const auto clouds = std::make_shared<MovedClouds<3>>(seed);
  const NextPoints points = [clouds] { return clouds->Next(); };
  return {"scene", objects, points, points};
}

PointSource FileSource(const Workload& file, std::size_t most,
                       std::uint64_t seed) {
  const std::size_t objects = std::min(most, file.objects.size());
  const auto made = std::make_shared<FileObjects>(file, objects, seed);
  return {file.name, objects, [made] { return made->Next(); },
          [made] { return made->Any(); }};
}

PointSource BallSource(std::size_t objects, std::uint64_t seed) {
  return SourceOf("balls", objects, seed, &BallsAndBoxes::NextBall);
}
PointSource BoxSource(std::size_t objects, std::uint64_t seed) {
  return SourceOf("boxes", objects, seed, &BallsAndBoxes::NextBox);
}
PointSource MixedSource(std::size_t objects, std::uint64_t seed) {
  return SourceOf("mixed", objects, seed, &BallsAndBoxes::NextOfBoth);
}

}  // namespace halfspace::bench

// Clouds of 50 points as planes, and their bounds on three kinds of axes.
#ifndef HALFSPACE_BENCH_WORLDS_CLOUD_BOUNDS_H_
#define HALFSPACE_BENCH_WORLDS_CLOUD_BOUNDS_H_

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "bench/base/aligned_vector.h"
#include "bench/baselines/target_loops.h"
#include "bench/measure/measure.h"
#include "bench/worlds/point_source.h"
#include "halfspace/bounds.h"

namespace halfspace::bench {

class CloudBounds {
 public:
  // All objects of the source have as many points as the first.
  explicit CloudBounds(const PointSource& source);

  std::size_t size() const { return size_; }

  // Fills the bounds.
  void Bound(Axes axes, Target target);
  float min(std::size_t axis, std::size_t cloud) const {
    return min_[axis][cloud];
  }
  float max(std::size_t axis, std::size_t cloud) const {
    return max_[axis][cloud];
  }

  // Bounds all clouds; checked, and timed per cloud.
  Case MakeCase(std::string name, Axes axes, Target target);

  // How far planes lie outside the exact ones, in extents of the cloud on their
  // axis; the mean of all planes.
  double MeanPad(Axes axes, Target target);

 private:
  struct Extent {
    double min;
    double max;
  };

  // Exact but for the rounding of doubles.
  Extent ExtentOf(Axes axes, std::size_t axis, std::size_t cloud) const;
  std::string Check(Axes axes, Target target);

  std::size_t size_;
  std::size_t points_ = 0;  // of a cloud
  std::array<AlignedVector<float>, 3> coordinates_;
  std::array<AlignedVector<float>, 4> min_;
  std::array<AlignedVector<float>, 4> max_;
};

// An octahedron around points, x y z each, at least one, whose axes are
// (1, 1, 1), (1, -1, -1), (-1, 1, -1) and (-1, -1, 1): four normals of a
// regular tetrahedron, which sum to zero. The kernels know planes, and no
// directions.
Aabo3 BoundOnRegularAxes(std::span<const float> points);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_CLOUD_BOUNDS_H_

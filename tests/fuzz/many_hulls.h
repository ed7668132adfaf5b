// More sources of the bulk builders, as many_shapes.h has them: triangles and
// point sets, over a few points.
#ifndef HALFSPACE_TESTS_FUZZ_MANY_HULLS_H_
#define HALFSPACE_TESTS_FUZZ_MANY_HULLS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <utility>
#include <vector>

#include "halfspace/fit_many.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/many_shapes.h"
#include "tests/fuzz/print.h"

namespace halfspace::testing {

// Points as an array of structures, or as a structure of arrays.
template <int kDims>
class Cloud {
 public:
  Cloud(std::vector<float> coords, std::size_t gap)
      : count_(coords.size() / kDims), gap_(gap), points_(std::move(coords)) {
    if (count_ == 0) return;
    const std::size_t stride = kDims + gap_ - 1;
    block_.resize(gap_ == 0 ? count_ * kDims : (count_ - 1) * stride + kDims);
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t k = 0; k < kDims; ++k) {
        const std::size_t at = gap_ == 0 ? k * count_ + i : i * stride + k;
        block_[at] = points_[i * kDims + k];
      }
    }
  }

  std::size_t count() const { return count_; }
  float coordinate(std::size_t i) const { return points_[i]; }

  void AddTo(ExactShape<kDims>& exact, std::size_t i) const {
    const auto point = std::span(points_).subspan(i * kDims, kDims);
    if (!exact.Accept(point)) return;
    const auto coords = ExactOf<std::size_t{kDims}>(point);
    exact.Weigh(SumOfMagnitudes(coords));
    exact.AddPoint(coords);
  }

  // Calls build(points), which is one of the two forms.
  template <typename Build>
  Target With(const Build& build) const {
    if (gap_ != 0) {
      return build(
          Points<kDims>{block_.data(), count_, std::size_t{kDims} + gap_ - 1});
    }
    PointsSoa<kDims> points{.count = count_};
    for (std::size_t k = 0; k < kDims; ++k) {
      points.coords[k] = block_.data() + k * count_;
    }
    return build(points);
  }

  friend std::ostream& operator<<(std::ostream& out, const Cloud& cloud) {
    return out << cloud.count_ << " points in " << kDims << "D, gap "
               << cloud.gap_ << ", " << Print(cloud.points_);
  }

 private:
  std::size_t count_;
  std::size_t gap_;  // 0: a structure of arrays; else the stride is larger
  std::vector<float> points_;
  std::vector<float> block_;
};

template <int kDims>
Cloud<kDims> DecodeCloud(std::size_t most, Bytes& bytes) {
  const std::size_t gap = bytes.Below(4);
  std::vector<float> coords(bytes.Below(most + 1) * kDims);
  for (float& x : coords) x = bytes.Float();
  return Cloud<kDims>(std::move(coords), gap);
}

template <int kDims>
class ManyTriangles {
 public:
  ManyTriangles(Bytes& bytes, Choices choices)
      : vertices_(DecodeCloud<kDims>(6, bytes)) {
    for (auto& corners : distinct_) {
      for (std::uint32_t& index : corners) {
        index = static_cast<std::uint32_t>(bytes.Below(8));
      }
    }
    for (std::size_t choice : choices) {
      const auto& corners = distinct_[choice];
      indices_.insert(indices_.end(), corners.begin(), corners.end());
    }
    indices_.shrink_to_fit();
  }

  void Describe(std::size_t shape, const FitOptions& options,
                ExactShape<kDims>& exact) const {
    for (std::uint32_t index : distinct_[shape]) {
      if (index >= vertices_.count()) return exact.BeEverything();
      vertices_.AddTo(exact, index);
    }
    exact.Tolerate({}, {.ulps = options.tightest ? 0 : 1});
  }

  template <typename Planes>
  Target Call(const Planes& planes, const FitOptions& options,
              FitStatus* status) const {
    return vertices_.With([&](const auto& vertices) {
      return BoundTriangles(vertices, indices_, planes, options, status);
    });
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const ManyTriangles& many) {
    out << "triangles over " << many.vertices_ << ", distinct ones";
    for (const auto& corners : many.distinct_) out << ' ' << Print(corners);
    return out;
  }

 private:
  Cloud<kDims> vertices_;
  std::array<std::array<std::uint32_t, 3>, kMostDistinct> distinct_;
  std::vector<std::uint32_t> indices_;
};

template <int kDims>
class ManyPointSets {
 public:
  // Every element repeats its shape's points.
  ManyPointSets(Bytes& bytes, Choices choices)
      : few_(DecodeCloud<kDims>(40, bytes)), all_({}, 0) {
    for (auto& size : sizes_) size = bytes.Below(48);
    const std::size_t gap = bytes.Below(4);
    std::vector<float> coords;
    for (std::size_t choice : choices) {
      const std::size_t size = SizeOf(choice);
      for (std::size_t i = 0; i < size * kDims; ++i) {
        coords.push_back(few_.coordinate(i));
      }
      ends_.push_back(coords.size() / kDims);
    }
    ends_.shrink_to_fit();
    all_ = Cloud<kDims>(std::move(coords), gap);
  }

  void Describe(std::size_t shape, const FitOptions& options,
                ExactShape<kDims>& exact) const {
    for (std::size_t i = 0; i < SizeOf(shape); ++i) few_.AddTo(exact, i);
    exact.Tolerate({}, {.ulps = options.tightest ? 0 : 1});
  }

  template <typename Planes>
  Target Call(const Planes& planes, const FitOptions& options,
              FitStatus* status) const {
    return all_.With([&](const auto& points) {
      return BoundPointSets(points, ends_, planes, options, status);
    });
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const ManyPointSets& many) {
    return out << "point sets, the first " << Print(many.sizes_) << " of "
               << many.few_;
  }

 private:
  std::size_t SizeOf(std::size_t shape) const {
    return std::min(sizes_[shape], few_.count());
  }

  Cloud<kDims> few_;
  Cloud<kDims> all_;
  std::array<std::size_t, kMostDistinct> sizes_;
  std::vector<std::size_t> ends_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_MANY_HULLS_H_

// Triangles and point sets as sources of the bulk builders: see bulk_sources.h.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_POINT_SOURCES_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_POINT_SOURCES_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "halfspace/fit.h"
#include "halfspace/fit_many.h"
#include "tests/library/fit_many/arena.h"
#include "tests/library/fit_many/bulk_sources.h"
#include "tests/library/support/exact_hull.h"
#include "tests/library/support/random_shapes.h"

namespace halfspace::testing {

// What triangles and point sets have in common. Columns of points have no
// stride: for Layout::kStrided they are structures too.
template <int kDims, typename Scalar>
struct PointSource {
  std::vector<Point<kDims, Scalar>> points;
  Points<kDims, Scalar> aos;
  PointsSoa<kDims, Scalar> soa;
  bool is_soa = false;

  void PlacePoints(Arena& arena, Layout layout) {
    is_soa = layout == Layout::kColumns;
    if (layout == Layout::kStrided) layout = Layout::kSpread;
    const Columns<Scalar> to(arena, layout, kDims, points.size());
    for (std::size_t k = 0; k < kDims; ++k) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        to.Set(k, i, points[i][k]);
      }
      soa.coords[k] = to.columns[k];
    }
    soa.count = points.size();
    aos = {to.columns[0], points.size(), to.stride};
  }
};

template <int kDims, typename Scalar = float>
struct TriangleSource : PointSource<kDims, Scalar> {
  static constexpr int kDimensions = kDims;
  static constexpr const char* kName =
      std::is_same_v<Scalar, float> ? "Triangles" : "TrianglesOfDoubles";

  std::vector<std::uint32_t> corners;
  std::span<const std::uint32_t> indices;

  static TriangleSource Random(PointKind kind, std::size_t count,
                               Random& random) {
    TriangleSource source;
    source.points.resize(count + 2);
    for (auto& p : source.points)
      p = RandomPointOf<kDims, Scalar>(kind, random);
    for (std::size_t i = 0; i < 3 * count; ++i) {
      source.corners.push_back(
          static_cast<std::uint32_t>(random() % source.points.size()));
    }
    return source;
  }

  void Place(Arena& arena, Layout layout) {
    this->PlacePoints(arena, layout);
    auto* memory = arena.New<std::uint32_t>(corners.size());
    std::copy(corners.begin(), corners.end(), memory);
    indices = {memory, corners.size()};
  }

  template <typename Planes>
  Target Bound(const Planes& planes, const FitOptions& options = {},
               FitStatus* status = nullptr) const {
    if (this->is_soa) {
      return BoundTriangles(this->soa, indices, planes, options, status);
    }
    return BoundTriangles(this->aos, indices, planes, options, status);
  }

  void Truncate(std::size_t count) { corners.resize(3 * count); }
  void Cycle(std::size_t count) {
    const std::size_t period = corners.size();
    for (std::size_t i = period; i < 3 * count; ++i) {
      corners.push_back(corners[i - period]);
    }
  }
  std::size_t size() const { return corners.size() / 3; }
  const Point<kDims, Scalar>& Corner(std::size_t i, std::size_t corner) const {
    return this->points[corners[3 * i + corner]];
  }
  Aabo<kDims> Single(std::size_t i) const {
    return BoundTriangle(
        Triangle<kDims, Scalar>{Corner(i, 0), Corner(i, 1), Corner(i, 2)});
  }
  ExactHull<kDims> Hull(std::size_t i) const {
    ExactHull<kDims> hull;
    for (std::size_t c = 0; c < 3; ++c) {
      hull.AddPoint(ExactPointOf(Corner(i, c)));
    }
    return hull;
  }
  double Give(std::size_t, bool) const { return 0.0; }
};

// Of 1 to 4 points, or, now and then, of more than fill some vectors.
template <int kDims, typename Scalar = float>
struct PointSetSource : PointSource<kDims, Scalar> {
  static constexpr int kDimensions = kDims;
  static constexpr const char* kName =
      std::is_same_v<Scalar, float> ? "PointSets" : "PointSetsOfDoubles";

  std::vector<std::size_t> set_ends;
  std::span<const std::size_t> ends;

  static PointSetSource Random(PointKind kind, std::size_t count,
                               Random& random) {
    PointSetSource source;
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t size = 1 + random() % 4;
      if (OneIn(16, random)) size += random() % 150;
      for (std::size_t n = 0; n < size; ++n) {
        source.points.push_back(RandomPointOf<kDims, Scalar>(kind, random));
      }
      source.set_ends.push_back(source.points.size());
    }
    return source;
  }

  void Place(Arena& arena, Layout layout) {
    this->PlacePoints(arena, layout);
    auto* memory = arena.New<std::size_t>(set_ends.size());
    std::copy(set_ends.begin(), set_ends.end(), memory);
    ends = {memory, set_ends.size()};
  }

  template <typename Planes>
  Target Bound(const Planes& planes, const FitOptions& options = {},
               FitStatus* status = nullptr) const {
    if (this->is_soa) {
      return BoundPointSets(this->soa, ends, planes, options, status);
    }
    return BoundPointSets(this->aos, ends, planes, options, status);
  }

  // Sets of some sizes, repeated.
  void Cycle(std::size_t count) {
    const std::size_t sets = set_ends.size();
    const std::size_t period = this->points.size();
    for (std::size_t i = sets; i < count; ++i) {
      const std::size_t end = set_ends[i - sets] + period;
      for (std::size_t n = set_ends[i - 1]; n < end; ++n) {
        this->points.push_back(this->points[n - period]);
      }
      set_ends.push_back(end);
    }
  }
  void Truncate(std::size_t count) {
    set_ends.resize(count);
    this->points.resize(count == 0 ? 0 : set_ends.back());
  }
  std::size_t size() const { return set_ends.size(); }
  std::span<const Point<kDims, Scalar>> Set(std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : set_ends[i - 1];
    return std::span(this->points).subspan(begin, set_ends[i] - begin);
  }
  Aabo<kDims> Single(std::size_t i) const {
    return BoundPoints(
        Points<kDims, Scalar>{Set(i).front().data(), Set(i).size()});
  }
  ExactHull<kDims> Hull(std::size_t i) const {
    ExactHull<kDims> hull;
    for (const auto& point : Set(i)) hull.AddPoint(ExactPointOf(point));
    return hull;
  }
  double Give(std::size_t, bool) const { return 0.0; }
};

#if defined(HALFSPACE_TEST_ONLY_3D)
using AllBulkSources =
    ::testing::Types<BoxSource<3>, SphereSource<3>, TriangleSource<3>,
                     PointSetSource<3>, BoxSource<3, double>,
                     SphereSource<3, double>, TriangleSource<3, double>,
                     PointSetSource<3, double>>;
#else
using AllBulkSources =
    ::testing::Types<BoxSource<2>, BoxSource<3>, BoxSource<4>, SphereSource<2>,
                     SphereSource<3>, SphereSource<4>, TriangleSource<2>,
                     TriangleSource<3>, TriangleSource<4>, PointSetSource<2>,
                     PointSetSource<3>, PointSetSource<4>, BoxSource<2, double>,
                     BoxSource<3, double>, SphereSource<3, double>,
                     SphereSource<4, double>, TriangleSource<3, double>,
                     TriangleSource<4, double>, PointSetSource<2, double>,
                     PointSetSource<3, double>>;
#endif

struct BulkSourceNames {
  template <typename Source>
  static std::string GetName(int) {
    return std::to_string(Source::kDimensions) + "D" + Source::kName;
  }
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_MANY_BULK_POINT_SOURCES_H_

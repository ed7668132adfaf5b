// Builders and bounds of bounds give floats; whoever passes boxes or planes of
// doubles is told so by the compiler. Here: no such call is well-formed.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "halfspace/fit.h"
#include "halfspace/fit_many.h"
#include "halfspace/world.h"

namespace halfspace::testing {
namespace {

template <typename Bound>
concept Merges = requires(const Bound& bound) {
  Merge(bound, bound);
};
template <typename Bound>
concept Inflates = requires(const Bound& bound) {
  Inflate(bound, 1.f);
};
template <typename Bound>
concept InflatesByBox = requires(const Bound& bound) {
  InflateByBox(bound, 1.f);
};
template <typename Bound>
concept Translates = requires(const Bound& bound,
                              const Point<Bound::kDimensions>& by) {
  Translate(bound, by);
};
template <typename Bound>
concept TranslatesVertices = requires(const Bound& bound,
                                      const Point<Bound::kDimensions>& by) {
  TranslateVertices(bound, by);
};
template <typename Bound>
concept Scales = requires(const Bound& bound) {
  Scale(bound, 2.f);
};
template <typename Bound>
concept Sweeps = requires(const Bound& bound,
                          const Point<Bound::kDimensions>& motion) {
  Sweep(bound, motion);
};
template <typename Bound>
concept Circumscribes = requires(const Bound& bound) {
  Circumscribe(bound);
};
template <typename Box>
concept BuildsFromBox = requires(const Box& box) {
  BoundAabb(box);
};

template <int kDims>
void ExpectOnlyFloats() {
  using Floats = Aabb<kDims>;
  using Doubles = Aabb<kDims, double>;
  EXPECT_TRUE(Merges<Floats> && !Merges<Doubles>);
  EXPECT_TRUE(Inflates<Floats> && !Inflates<Doubles>);
  EXPECT_TRUE(InflatesByBox<Floats> && !InflatesByBox<Doubles>);
  EXPECT_TRUE(Translates<Floats> && !Translates<Doubles>);
  EXPECT_TRUE(Scales<Floats> && !Scales<Doubles>);
  EXPECT_TRUE(Sweeps<Floats> && !Sweeps<Doubles>);
  EXPECT_FALSE(TranslatesVertices<Doubles>);
  EXPECT_FALSE(Circumscribes<Doubles>);
  // The one builder of a bound of floats from one of doubles.
  EXPECT_TRUE(BuildsFromBox<Floats> && BuildsFromBox<Doubles>);
}

// Of a program, with what a bound has.
struct Foreign {
  static constexpr int kDimensions = 3;
  std::array<float, 3> min;
  std::array<float, 3> max;
};

TEST(FitDoublesTest, BoundsOfBoundsAreOfFloats) {
  EXPECT_FALSE(Merges<Foreign> || Inflates<Foreign> || InflatesByBox<Foreign>);
  EXPECT_FALSE(Translates<Foreign> || Scales<Foreign> || Sweeps<Foreign>);
  ExpectOnlyFloats<2>();
  ExpectOnlyFloats<3>();
  ExpectOnlyFloats<4>();
}

template <typename Planes>
concept BuildsInBulk = requires(const Planes& planes, const Boxes3& boxes) {
  BoundBoxes(boxes, planes);
}
|| requires(const Planes& planes, const Spheres3& spheres) {
  BoundSpheres(spheres, planes);
}
|| requires(const Planes& planes, const Points3& points,
            std::span<const std::uint32_t> indices) {
  BoundTriangles(points, indices, planes);
}
|| requires(const Planes& planes, const PointsSoa3& points,
            std::span<const std::uint32_t> indices) {
  BoundTriangles(points, indices, planes);
}
|| requires(const Planes& planes, const Points3& points,
            std::span<const std::size_t> ends) {
  BoundPointSets(points, ends, planes);
}
|| requires(const Planes& planes, const PointsSoa3& points,
            std::span<const std::size_t> ends) {
  BoundPointSets(points, ends, planes);
};

TEST(FitDoublesTest, BoundsInBulkAreOfFloats) {
  EXPECT_TRUE((BuildsInBulk<SimplexPlanes3>));
  EXPECT_TRUE((BuildsInBulk<AabbPlanes<3, float>>));
  EXPECT_TRUE((BuildsInBulk<AaboPlanes3>));
  EXPECT_TRUE((BuildsInBulk<DPlanes<3>>));
  EXPECT_FALSE((BuildsInBulk<AabbPlanes<3, double>>));
}

}  // namespace
}  // namespace halfspace::testing

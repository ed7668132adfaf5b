// The sum that needs the error of the sum of errors.
//
// 2^30 + 2^6 rounds to 2^30, as does the sum of that and z = 2^6 - 2^-18. The
// two errors, 2^6 and z, add up to 2^7 - 2^-18, which rounds to 2^7; and
// 2^30 + 2^7 is a float. That the exact sum is less than this shows only in the
// error of the third addition.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "halfspace/fit.h"
#include "halfspace/fit_many.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// The range of D, by one of the bulk builders.
struct Range {
  float min;
  float max;
  bool operator==(const Range&) const = default;
};

template <typename Build>
Range RangeBy(Build build) {
  Range range;
  build(DPlanes3{&range.min, &range.max, 1});
  return range;
}

TEST(FitManyHardSumsTest, ErrorOfTheErrorsCounts) {
  for (float sign : {1.f, -1.f}) {
    Point3 point = {sign * 0x1p30f, sign * 0x1p6f, sign * 0x1.fffffep5f};
    // D = -sum is between these two.
    const Range expected = sign > 0.f ? Range{-0x1.000002p30f, -0x1p30f}
                                      : Range{0x1p30f, 0x1.000002p30f};
    std::sort(point.begin(), point.end());
    do {
      const Aabo3 single = BoundPoint<3>(point);
      EXPECT_EQ((Range{single.min[3], single.max[3]}), expected);
      for (Target target : TargetsUnderTest()) {
        const FitOptions options{.tightest = true, .target = target};
        EXPECT_EQ(RangeBy([&](const DPlanes3& planes) {
                    const std::array<const float*, 3> corner = {
                        &point[0], &point[1], &point[2]};
                    BoundBoxes(Boxes<3>{corner, corner, 1}, planes, options);
                  }),
                  expected)
            << "box, " << target.name();
        EXPECT_EQ(RangeBy([&](const DPlanes3& planes) {
                    const std::array<std::uint32_t, 3> indices{};
                    BoundTriangles(Points3{point.data(), 1}, indices, planes,
                                   options);
                  }),
                  expected)
            << "triangle, " << target.name();
        EXPECT_EQ(
            RangeBy([&](const DPlanes3& planes) {
              const std::array<std::size_t, 1> ends = {1};
              BoundPointSets(Points3{point.data(), 1}, ends, planes, options);
            }),
            expected)
            << "point set, " << target.name();
      }
    } while (std::next_permutation(point.begin(), point.end()));
  }
}

}  // namespace
}  // namespace halfspace::testing

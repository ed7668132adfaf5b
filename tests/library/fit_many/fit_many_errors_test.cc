// What the bulk builders refuse: before anything is written or counted, with a
// text that says what was wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/fit_many.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kCount = 3;
constexpr std::size_t kHuge = std::numeric_limits<std::size_t>::max();

enum class Call { kBoxes, kSpheres, kTriangles, kPointSets };

class FitManyErrorsTest : public ::testing::Test {
 protected:
  using Parts = std::initializer_list<std::string_view>;

  FitManyErrorsTest() {
    for (auto& column : columns_) column.assign(16, 1.f);
    for (auto& plane : planes_) plane.assign(16, kUntouched);
    for (std::size_t k = 0; k < 3; ++k) {
      boxes_.min[k] = columns_[k].data();
      boxes_.max[k] = columns_[k + 3].data();
      spheres_.center[k] = columns_[k].data();
      points_.coords[k] = columns_[k].data();
    }
    boxes_.count = spheres_.count = points_.count = output_.size = kCount;
    spheres_.radius = columns_[3].data();
    for (std::size_t k = 0; k < 4; ++k) {
      output_.min[k] = planes_[k].data();
      output_.max[k] = planes_[k + 4].data();
    }
  }

  // With what the members hold; of points, those of `points`.
  template <typename AnyPoints>
  void Make(Call call, const AnyPoints& points, FitStatus* status) {
    switch (call) {
      case Call::kBoxes:
        BoundBoxes(boxes_, output_, options_, status);
        break;
      case Call::kSpheres:
        BoundSpheres(spheres_, output_, options_, status);
        break;
      case Call::kTriangles:
        BoundTriangles(points, indices_, output_, options_, status);
        break;
      case Call::kPointSets:
        BoundPointSets(points, ends_, output_, options_, status);
        break;
    }
  }

  template <typename AnyPoints>
  void ExpectRefused(Call call, const AnyPoints& points, Parts parts) {
    FitStatus status;
    EXPECT_TRUE(Refuses([&] { Make(call, points, &status); }, parts));
    EXPECT_EQ(status.results, 0u);
    for (const auto& plane : planes_) {
      EXPECT_TRUE(std::all_of(plane.begin(), plane.end(),
                              [](float value) { return value == kUntouched; }));
    }
  }
  void ExpectRefused(Call call, Parts parts) {
    ExpectRefused(call, points_, parts);
  }

  static constexpr float kUntouched = 77.f;

  std::array<std::vector<float>, 6> columns_;
  std::array<std::vector<float>, 8> planes_;
  Boxes3 boxes_;
  Spheres3 spheres_;
  PointsSoa3 points_;
  AaboPlanes3 output_;
  FitOptions options_;
  std::vector<std::uint32_t> list_ = {0, 1, 2, 0, 1, 2, 0, 1, 2};
  std::vector<std::size_t> end_list_ = {1, 2, 3};
  Span<const std::uint32_t> indices_ = list_;
  Span<const std::size_t> ends_ = end_list_;
};

TEST_F(FitManyErrorsTest, NullAndMisalignedPointers) {
  const auto refused = [&](Call call, const float*& pointer,
                           std::string_view argument,
                           std::string_view expected) {
    const float* const before = pointer;
    pointer = nullptr;
    ExpectRefused(call,
                  {argument, ": expected ", expected, "got a null pointer"});
    pointer = Misaligned(before);
    ExpectRefused(call, {argument, ": expected", "aligned to 4", "misaligned"});
    pointer = before;
  };
  refused(Call::kBoxes, boxes_.max[0], "BoundBoxes: boxes.max[0]", "3 boxes");
  refused(Call::kBoxes, boxes_.min[2], "BoundBoxes: boxes.min[2]", "3 boxes");
  refused(Call::kSpheres, spheres_.radius, "BoundSpheres: spheres.radius",
          "3 spheres");
  refused(Call::kSpheres, spheres_.center[2], "BoundSpheres: spheres.center[2]",
          "3 spheres");
  refused(Call::kTriangles, points_.coords[1],
          "BoundTriangles: vertices.coords[1]", "3 vertices");
  refused(Call::kPointSets, points_.coords[1],
          "BoundPointSets: points.coords[1]", "3 points");
  const Points3 none{nullptr, kCount};
  ExpectRefused(Call::kTriangles, none,
                {"vertices.coords: expected 3 vertices", "a null pointer"});
  ExpectRefused(Call::kPointSets, none,
                {"points.coords: expected 3 points", "a null pointer"});
  const Aabb3* const no_boxes = nullptr;
  boxes_ = BoxesOf(Span<const Aabb3>(no_boxes, kCount));
  ExpectRefused(Call::kBoxes, {"BoundBoxes: boxes.min[0]: expected", "a null"});
}

TEST_F(FitManyErrorsTest, OutputsAndIndicesThatAreNoMemory) {
  output_.max[3] = nullptr;
  ExpectRefused(Call::kBoxes, {"BoundBoxes: planes.max[3]", "a null pointer"});
  output_.max[3] = Misaligned(planes_[7].data());
  ExpectRefused(Call::kBoxes, {"BoundBoxes: planes.max[3]", "misaligned"});
  output_.max[3] = planes_[7].data();
  output_.size = 2;
  const std::uint32_t* const indices = list_.data();
  indices_ = {Misaligned(indices), 6};
  ExpectRefused(Call::kTriangles,
                {"BoundTriangles: indices", "aligned to 4", "misaligned"});
  const std::size_t* const ends = end_list_.data();
  ends_ = {Misaligned(ends), 2};
  ExpectRefused(Call::kPointSets,
                {"BoundPointSets: ends", "aligned to 8", "misaligned"});
}

TEST_F(FitManyErrorsTest, SizesThatDiffer) {
  boxes_.count = spheres_.count = kCount - 1;
  ExpectRefused(Call::kBoxes, {"BoundBoxes: boxes.count: expected 3", "got 2"});
  ExpectRefused(Call::kSpheres,
                {"BoundSpheres: spheres.count: expected 3", "got 2"});
  indices_ = {list_.data(), 8};
  ExpectRefused(Call::kTriangles,
                {"BoundTriangles: indices.size(): expected 9", "got 8"});
  ends_ = {end_list_.data(), 2};
  ExpectRefused(Call::kPointSets,
                {"BoundPointSets: ends.size(): expected 3", "got 2"});
}

// Of 32 bits or of 64, whatever a size has here. Of stride and count, the
// larger is to blame.
TEST_F(FitManyErrorsTest, BeyondTheAddressSpace) {
  boxes_.stride = spheres_.stride = kHuge / 4;
  const Points3 strided{columns_[0].data(), kCount, kHuge / 4};
  const std::string given = "got " + std::to_string(kHuge / 4);
  const std::string stride = "stride: expected a stride with which 3 ";
  ExpectRefused(Call::kBoxes, {"BoundBoxes: boxes.", stride, given});
  ExpectRefused(Call::kSpheres, {"BoundSpheres: spheres.", stride, given});
  ExpectRefused(Call::kTriangles, strided,
                {"BoundTriangles: vertices.", stride, given});
  ExpectRefused(Call::kPointSets, strided,
                {"BoundPointSets: points.", stride, given});
  boxes_.count = output_.size = kHuge / 4;
  boxes_.stride = 2;
  ExpectRefused(Call::kBoxes,
                {"BoundBoxes: boxes.count: expected", "stride 2", given});
  boxes_.count = output_.size = kHuge;
  boxes_.stride = 0;
  ExpectRefused(Call::kBoxes,
                {"BoundBoxes", "planes.size: expected", "address space"});
  output_.size = kHuge / 3 + 1;
  ExpectRefused(Call::kTriangles,
                {"BoundTriangles", "planes.size: expected", "address space"});
  output_.size = kCount;
  points_.count = kHuge;
  ExpectRefused(Call::kPointSets, {"BoundPointSets: points.count: expected"});
}

TEST_F(FitManyErrorsTest, OutputsThatOverlap) {
  output_.max[1] = planes_[2].data() + kCount - 1;
  ExpectRefused(Call::kBoxes, {"BoundBoxes", "planes.m", "apart from",
                               "planes.m", "got an overlap"});
  output_.max[1] = columns_[4].data() + kCount - 1;
  ExpectRefused(Call::kBoxes, {"BoundBoxes", "planes.max[1]: expected",
                               "apart from boxes.max[1]", "got an overlap"});
  EXPECT_EQ(columns_[4], std::vector<float>(16, 1.f));
  // Between the values of a column is inside it.
  boxes_.stride = 2;
  output_.max[1] = columns_[4].data() + 4;
  ExpectRefused(Call::kBoxes, {"planes.max[1]", "apart from boxes.max[1]"});
  output_.max[1] = reinterpret_cast<float*>(&list_[6]);
  ExpectRefused(Call::kTriangles,
                {"BoundTriangles", "planes.max[1]", "apart from indices"});
  output_.max[1] = reinterpret_cast<float*>(end_list_.data()) + 5;
  ExpectRefused(Call::kPointSets,
                {"BoundPointSets", "planes.max[1]", "apart from ends"});
}

// Right behind an input, and right before it, is fine.
TEST_F(FitManyErrorsTest, NeighboursAreNoOverlap) {
  output_.min[0] = columns_[0].data() + kCount;
  output_.min[1] = output_.min[0] + kCount;
  EXPECT_NO_THROW(BoundBoxes(boxes_, output_));
  boxes_.min[0] = columns_[0].data() + 3 * kCount;
  EXPECT_NO_THROW(BoundBoxes(boxes_, output_));
}

TEST_F(FitManyErrorsTest, TargetsAndOptions) {
  options_.target = Target::FromHighwayBit(3);  // two bits
  ExpectRefused(Call::kBoxes, {"BoundBoxes", "target"});
  options_ = {.inverted = static_cast<Inverted>(7)};
  ExpectRefused(Call::kBoxes, {"BoundBoxes", "options.inverted", "got 7"});
  boxes_.count = output_.size = 0;
  ExpectRefused(Call::kBoxes, {"BoundBoxes", "options.inverted", "got 7"});
}

// Null pointers are fine where there is nothing.
TEST_F(FitManyErrorsTest, NothingIsNoError) {
  FitStatus status;
  EXPECT_NE(BoundBoxes(Boxes3{}, AaboPlanes3{}, {}, &status), Target());
  EXPECT_NE(BoundSpheres(Spheres3{}, SimplexPlanes3{}, {}, &status), Target());
  EXPECT_NE(BoundTriangles(Points3{}, {}, AabbPlanes3{}, {}, &status),
            Target());
  EXPECT_NE(BoundPointSets(PointsSoa3{}, {}, DPlanes3{}, {}, &status),
            Target());
  EXPECT_EQ(status.results, 0u);
}

// Twice as many bytes: misaligned as no float is, and as long as that.
TEST_F(FitManyErrorsTest, Doubles) {
  alignas(double) std::array<float, 2 * kCount + 2> room{};
  const std::array<double, kCount> ones = {1, 1, 1};
  Boxes<3, double> boxes{.count = kCount};
  boxes.min.fill(ones.data());
  boxes.max.fill(ones.data());
  const auto refused = [&](Parts parts) {
    FitStatus status;
    EXPECT_TRUE(
        Refuses([&] { BoundBoxes(boxes, output_, options_, &status); }, parts));
    EXPECT_EQ(status.results, 0u);
  };
  boxes.max[1] = reinterpret_cast<const double*>(room.data() + 1);
  refused({"BoundBoxes: boxes.max[1]: expected", "aligned to 8 bytes"});
  boxes.max[1] = reinterpret_cast<const double*>(room.data());
  output_.min[2] = room.data() + 2 * kCount - 1;
  refused({"BoundBoxes: planes.min[2]: expected", "boxes.max[1]"});
  output_.min[2] = planes_[2].data();
  boxes.count = kCount + 1;
  refused({"BoundBoxes: boxes.count: expected 3"});
  // A target that is not there is refused, though one is like the other.
  boxes.count = kCount;
  options_.target = Target::FromHighwayBit(std::int64_t{1} << 50);
  refused({"BoundBoxes: ", "target"});
}

}  // namespace
}  // namespace halfspace::testing

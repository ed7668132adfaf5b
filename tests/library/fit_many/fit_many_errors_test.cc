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

class FitManyErrorsTest : public ::testing::Test {
 protected:
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

  template <typename Call>
  void ExpectRefused(Call call, std::initializer_list<std::string_view> parts) {
    FitStatus status;
    EXPECT_TRUE(Refuses([&] { call(&status); }, parts));
    EXPECT_EQ(status.results, 0u);
    for (const auto& plane : planes_) {
      EXPECT_TRUE(std::all_of(plane.begin(), plane.end(),
                              [](float value) { return value == kUntouched; }));
    }
  }

  void ExpectBoxesRefused(std::initializer_list<std::string_view> parts,
                          const FitOptions& options = {}) {
    ExpectRefused(
        [&](FitStatus* status) {
          BoundBoxes(boxes_, output_, options, status);
        },
        parts);
  }

  static float* Misaligned(const float* pointer) {
    return reinterpret_cast<float*>(reinterpret_cast<std::uintptr_t>(pointer) +
                                    1);
  }

  static constexpr float kUntouched = 77.f;

  std::array<std::vector<float>, 6> columns_;
  std::array<std::vector<float>, 8> planes_;
  Boxes3 boxes_;
  Spheres3 spheres_;
  PointsSoa3 points_;
  AaboPlanes3 output_;
  std::vector<std::uint32_t> indices_ = {0, 1, 2, 0, 1, 2, 0, 1, 2};
  std::vector<std::size_t> ends_ = {1, 2, 3};
};

TEST_F(FitManyErrorsTest, NullAndMisalignedPointers) {
  boxes_.max[0] = nullptr;
  ExpectBoxesRefused(
      {"BoundBoxes: boxes.max[0]: expected 3 boxes, got a null"});
  const std::array<Aabb3, kCount> list{};
  const auto expect_list_refused = [&](const Aabb3* boxes,
                                       std::string_view given) {
    ExpectRefused(
        [&](FitStatus* status) {
          BoundBoxes(BoxesOf(Span<const Aabb3>(boxes, kCount)), output_, {},
                     status);
        },
        {"BoundBoxes: boxes.min[0]: expected", given});
  };
  expect_list_refused(nullptr, "got a null");
  expect_list_refused(
      reinterpret_cast<const Aabb3*>(Misaligned(list[0].min.data())),
      "got a misaligned");
  boxes_.max[0] = Misaligned(columns_[3].data());
  ExpectBoxesRefused(
      {"BoundBoxes: boxes.max[0]", "aligned to 4", "misaligned"});
  boxes_.max[0] = columns_[3].data();
  output_.max[3] = nullptr;
  ExpectBoxesRefused({"BoundBoxes", "planes.max[3]", "a null pointer"});
  output_.max[3] = Misaligned(planes_[7].data());
  ExpectBoxesRefused({"BoundBoxes", "planes.max[3]", "misaligned"});
  output_.max[3] = planes_[7].data();
  boxes_.min[2] = nullptr;
  ExpectBoxesRefused({"BoundBoxes: boxes.min[2]: expected", "a null pointer"});

  const auto expect_spheres_refused = [&](std::string_view text) {
    ExpectRefused(
        [&](FitStatus* status) { BoundSpheres(spheres_, output_, {}, status); },
        {text, "a null pointer"});
  };
  spheres_.radius = nullptr;
  expect_spheres_refused("BoundSpheres: spheres.radius: expected 3 spheres");
  spheres_.center[2] = nullptr;
  expect_spheres_refused("BoundSpheres: spheres.center[2]: expected 3 spheres");
}

TEST_F(FitManyErrorsTest, NullPoints) {
  const auto expect_refused = [&](const auto& points, std::string_view coords) {
    const std::string expected = std::string(coords) + ": expected 3 ";
    ExpectRefused(
        [&](FitStatus* status) {
          BoundTriangles(points, indices_, output_, {}, status);
        },
        {"BoundTriangles: vertices." + expected + "vertices",
         "a null pointer"});
    ExpectRefused(
        [&](FitStatus* status) {
          BoundPointSets(points, ends_, output_, {}, status);
        },
        {"BoundPointSets: points." + expected + "points", "a null pointer"});
  };
  points_.coords[1] = nullptr;
  expect_refused(points_, "coords[1]");
  expect_refused(Points3{nullptr, kCount}, "coords");
}

TEST_F(FitManyErrorsTest, MisalignedIndices) {
  const auto* indices = reinterpret_cast<const std::uint32_t*>(
      reinterpret_cast<std::uintptr_t>(indices_.data()) + 1);
  ExpectRefused(
      [&](FitStatus* status) {
        output_.size = 2;
        BoundTriangles(points_, {indices, 6}, output_, {}, status);
      },
      {"BoundTriangles", "indices", "aligned to 4", "misaligned"});
  const auto* ends = reinterpret_cast<const std::size_t*>(
      reinterpret_cast<std::uintptr_t>(ends_.data()) + 4);
  ExpectRefused(
      [&](FitStatus* status) {
        BoundPointSets(points_, {ends, 2}, output_, {}, status);
      },
      {"BoundPointSets", "ends", "aligned to 8", "misaligned"});
}

TEST_F(FitManyErrorsTest, SizesThatDiffer) {
  boxes_.count = spheres_.count = kCount - 1;
  ExpectBoxesRefused({"BoundBoxes", "boxes.count: expected 3", "got 2"});
  ExpectRefused(
      [&](FitStatus* status) { BoundSpheres(spheres_, output_, {}, status); },
      {"BoundSpheres", "spheres.count: expected 3", "got 2"});
  indices_.pop_back();
  ExpectRefused(
      [&](FitStatus* status) {
        BoundTriangles(points_, indices_, output_, {}, status);
      },
      {"BoundTriangles", "indices.size(): expected 9", "got 8"});
  ends_.push_back(3);
  ExpectRefused(
      [&](FitStatus* status) {
        BoundPointSets(points_, ends_, output_, {}, status);
      },
      {"BoundPointSets", "ends.size(): expected 3", "got 4"});
}

// Of 32 bits or of 64, whatever a size has here.
TEST_F(FitManyErrorsTest, SizesBeyondTheAddressSpace) {
  boxes_.count = output_.size = kHuge / 4;
  boxes_.stride = 2;
  ExpectBoxesRefused({"BoundBoxes: boxes.count: expected", "stride 2",
                      "got " + std::to_string(kHuge / 4)});
  boxes_.count = output_.size = kHuge;
  boxes_.stride = 0;
  ExpectBoxesRefused({"BoundBoxes", "planes.size: expected", "address space"});
  output_.size = kHuge / 3 + 1;
  ExpectRefused(
      [&](FitStatus* status) {
        BoundTriangles(points_, indices_, output_, {}, status);
      },
      {"BoundTriangles", "planes.size: expected", "address space"});
  output_.size = kCount;
  points_.count = kHuge;
  ExpectRefused(
      [&](FitStatus* status) {
        BoundPointSets(points_, ends_, output_, {}, status);
      },
      {"BoundPointSets: points.count: expected"});
}

// Of stride and count, the larger is to blame.
TEST_F(FitManyErrorsTest, StridesBeyondTheAddressSpace) {
  boxes_.stride = spheres_.stride = kHuge / 4;
  const std::string expected = "expected a stride with which 3 ";
  const std::string given = "got " + std::to_string(kHuge / 4);
  ExpectBoxesRefused({"BoundBoxes: boxes.stride: " + expected, given});
  ExpectRefused(
      [&](FitStatus* status) { BoundSpheres(spheres_, output_, {}, status); },
      {"BoundSpheres: spheres.stride: " + expected, given});
  const Points3 points{columns_[0].data(), kCount, kHuge / 4};
  ExpectRefused(
      [&](FitStatus* status) {
        BoundTriangles(points, indices_, output_, {}, status);
      },
      {"BoundTriangles: vertices.stride: " + expected, given});
  ExpectRefused(
      [&](FitStatus* status) {
        BoundPointSets(points, ends_, output_, {}, status);
      },
      {"BoundPointSets: points.stride: " + expected, given});
}

TEST_F(FitManyErrorsTest, OutputsThatOverlap) {
  output_.max[1] = planes_[2].data() + kCount - 1;
  ExpectBoxesRefused(
      {"BoundBoxes", "planes.m", "apart from", "planes.m", "got an overlap"});
  output_.max[1] = columns_[4].data() + kCount - 1;
  ExpectBoxesRefused({"BoundBoxes", "planes.max[1]: expected",
                      "apart from boxes.max[1]", "got an overlap"});
  EXPECT_EQ(columns_[4], std::vector<float>(16, 1.f));
  // Between the values of a column is inside it.
  boxes_.stride = 2;
  output_.max[1] = columns_[4].data() + 4;
  ExpectBoxesRefused({"planes.max[1]", "apart from boxes.max[1]"});
  output_.max[1] = reinterpret_cast<float*>(&indices_[6]);
  ExpectRefused(
      [&](FitStatus* status) {
        BoundTriangles(points_, indices_, output_, {}, status);
      },
      {"BoundTriangles", "planes.max[1]", "apart from indices"});
  output_.max[1] = reinterpret_cast<float*>(ends_.data()) + 5;
  ExpectRefused(
      [&](FitStatus* status) {
        BoundPointSets(points_, ends_, output_, {}, status);
      },
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
  const Target nonsense = Target::FromHighwayBit(3);  // two bits
  ExpectBoxesRefused({"BoundBoxes", "target"}, {.target = nonsense});
  ExpectBoxesRefused({"BoundBoxes", "options.inverted", "got 7"},
                     {.inverted = static_cast<Inverted>(7)});
  boxes_.count = output_.size = 0;
  ExpectBoxesRefused({"BoundBoxes", "options.inverted", "got 7"},
                     {.inverted = static_cast<Inverted>(7)});
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
  const auto* doubles = reinterpret_cast<const double*>(room.data());
  Boxes<3, double> boxes{.count = kCount};
  boxes.min.fill(ones.data());
  boxes.max.fill(ones.data());
  const auto expect_refused =
      [&](std::initializer_list<std::string_view> parts) {
        ExpectRefused(
            [&](FitStatus* status) { BoundBoxes(boxes, output_, {}, status); },
            parts);
      };
  boxes.max[1] = reinterpret_cast<const double*>(room.data() + 1);
  expect_refused({"BoundBoxes: boxes.max[1]: expected", "aligned to 8 bytes"});
  boxes.max[1] = doubles;
  output_.min[2] = room.data() + 2 * kCount - 1;
  expect_refused({"BoundBoxes: planes.min[2]: expected", "boxes.max[1]"});
  output_.min[2] = planes_[2].data();
  boxes.count = kCount + 1;
  expect_refused({"BoundBoxes: boxes.count: expected 3"});
  // A target that is not there is refused, though one is like the other.
  boxes.count = kCount;
  ExpectRefused(
      [&](FitStatus* status) {
        BoundBoxes(boxes, output_,
                   {.target = Target::FromHighwayBit(std::int64_t{1} << 50)},
                   status);
      },
      {"BoundBoxes: ", "target"});
}

}  // namespace
}  // namespace halfspace::testing

// What the builders of single shapes and of bounds refuse, and how they say it.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/misaligned.h"

namespace halfspace::testing {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <typename Dims>
class FitErrorsTest : public ::testing::Test {
 protected:
  // call(length) refuses lengths below zero and NaN, and nothing is counted.
  template <typename Call>
  static void ExpectLengthChecked(std::string_view name,
                                  std::string_view argument, Call call) {
    FitStatus status;
    const std::string expected =
        std::string(argument) + ": expected a number that is not negative";
    const auto refuses = [&](float length, std::string_view given) {
      return Refuses([&] { call(length, &status); },
                     {"halfspace: ", name, expected, given});
    };
    EXPECT_TRUE(refuses(-1.f, "got -1"));
    EXPECT_TRUE(refuses(-0x1p-149f, "got -1"));
    EXPECT_TRUE(refuses(-std::numeric_limits<float>::infinity(), "got -inf"));
    EXPECT_TRUE(refuses(kNan, "got nan"));
    EXPECT_EQ(status.results, 0u);
    EXPECT_NO_THROW(call(-0.f, &status));
    EXPECT_EQ(status.results, 1u);
    EXPECT_EQ(status.everything, 0u);
  }

  static Point<Dims::value> Ones() {
    Point<Dims::value> point;
    point.fill(1.f);
    return point;
  }
};
TYPED_TEST_SUITE(FitErrorsTest, AllDims, DimsNames);

TYPED_TEST(FitErrorsTest, NegativeRadii) {
  constexpr int kDims = TypeParam::value;
  const auto center = this->Ones();
  this->ExpectLengthChecked("BoundSphere", "sphere.radius",
                            [&](float radius, FitStatus* status) {
                              BoundSphere<kDims>({center, radius}, status);
                            });
  this->ExpectLengthChecked("BoundSphere", "sphere.radius",
                            [&](float radius, FitStatus* status) {
                              Sphere<kDims, double> sphere{{}, radius};
                              BoundSphere(sphere, status);
                            });
  this->ExpectLengthChecked(
      "BoundCapsule", "capsule.radius", [&](float radius, FitStatus* status) {
        BoundCapsule<kDims>({center, center, radius}, status);
      });
}

TYPED_TEST(FitErrorsTest, NegativeHalfExtents) {
  constexpr int kDims = TypeParam::value;
  for (std::size_t i = 0; i < kDims; ++i) {
    this->ExpectLengthChecked(
        "BoundOrientedBox", "box.half_extents[" + std::to_string(i) + "]",
        [&](float half, FitStatus* status) {
          OrientedBox<kDims> box{this->Ones(), {}, this->Ones()};
          box.half_extents[i] = half;
          BoundOrientedBox(box, status);
        });
  }
}

TYPED_TEST(FitErrorsTest, NegativeReach) {
  constexpr int kDims = TypeParam::value;
  this->ExpectLengthChecked(
      "BoundRay", "ray.max_t", [&](float max_t, FitStatus* status) {
        BoundRay<kDims>({this->Ones(), this->Ones(), max_t}, status);
      });
}

// Of all four types of bounds.
TYPED_TEST(FitErrorsTest, NegativeGrowth) {
  const auto one = BoundPoint<TypeParam::value>(this->Ones());
  const auto check = [&](const auto& bound) {
    this->ExpectLengthChecked("Inflate", "radius",
                              [&](float radius, FitStatus* status) {
                                Inflate(bound, radius, status);
                              });
    this->ExpectLengthChecked("InflateByBox", "margin",
                              [&](float margin, FitStatus* status) {
                                InflateByBox(bound, margin, status);
                              });
  };
  check(one);
  check(one.aabb());
  check(one.up());
  check(one.down());
}

TYPED_TEST(FitErrorsTest, Factors) {
  const auto one = BoundPoint<TypeParam::value>(this->Ones());
  FitStatus status;
  const auto refuses = [&](const auto& bound, float factor,
                           std::string_view expected, std::string_view given) {
    return Refuses([&] { Scale(bound, factor, &status); },
                   {"Scale: factor: ", expected, given});
  };
  EXPECT_TRUE(refuses(one, kNan, "expected a number", "got nan"));
  EXPECT_TRUE(refuses(one.aabb(), kNan, "expected a number", "got nan"));
  for (float factor : {-1.f, -0x1p-149f}) {
    EXPECT_TRUE(refuses(one.up(), factor, "not negative", "got -1"));
    EXPECT_TRUE(refuses(one.down(), factor, "not negative", "got -1"));
  }
  EXPECT_TRUE(refuses(one.up(), kNan, "not negative", "got nan"));
  EXPECT_TRUE(refuses(one.down(), kNan, "not negative", "got nan"));
  EXPECT_EQ(status.results, 0u);
}

TYPED_TEST(FitErrorsTest, InvertedBoxes) {
  constexpr int kDims = TypeParam::value;
  FitStatus status;
  for (std::size_t k = 0; k < kDims; ++k) {
    const std::string axis = "[" + std::to_string(k) + "]";
    Box<kDims, double> box{};
    box.min[k] = 0x1p-1074;
    EXPECT_TRUE(Refuses(
        [&] { BoundAabb(box, &status); },
        {"BoundAabb", "box: expected min" + axis, "max" + axis, "and 0"}));
    Box<kDims> floats{};
    floats.min[k] = 0x1p-149f;
    EXPECT_TRUE(Refuses([&] { BoundAabb(floats, &status); },
                        {"BoundAabb", "box: expected min" + axis}));
    EXPECT_TRUE(Refuses(
        [&] { BoundTransformed(floats, Affine<kDims>{}, &status); },
        {"BoundTransformed", "box: expected min" + axis, "max" + axis}));
  }
  EXPECT_EQ(status.results, 0u);
}

TYPED_TEST(FitErrorsTest, PointsThatCannotBeRead) {
  constexpr int kDims = TypeParam::value;
  FitStatus status;
  const std::vector<double> coords(kDims + 1, 1.0);
  const auto* misaligned = reinterpret_cast<const double*>(
      reinterpret_cast<std::uintptr_t>(coords.data()) + 4);
  EXPECT_TRUE(Refuses(
      [&] {
        BoundPoints(Points<kDims, double>{misaligned, 1}, &status);
      },
      {"BoundPoints", "points.coords: expected", "aligned to 8 bytes"}));
  EXPECT_TRUE(Refuses(
      [&] {
        BoundTransformed(Points<kDims>{nullptr, 2}, Affine<kDims>{}, &status);
      },
      {"BoundTransformed", "points.coords: expected 2 points", "null"}));
  // Any one of the columns.
  for (std::size_t k = 0; k < kDims; ++k) {
    const std::string argument = "points.coords[" + std::to_string(k) + "]";
    PointsSoa<kDims, double> soa{.coords = {}, .count = 1};
    soa.coords.fill(coords.data());
    soa.coords[k] = nullptr;
    EXPECT_TRUE(Refuses([&] { BoundPoints(soa, &status); },
                        {"BoundPoints", argument, "1 points", "null"}));
    soa.coords[k] = misaligned;
    EXPECT_TRUE(Refuses([&] { BoundPoints(soa, &status); },
                        {"BoundPoints", argument, "aligned to 8 bytes"}));
  }
  EXPECT_EQ(status.results, 0u);
}

TYPED_TEST(FitErrorsTest, IndicesThatCannotBeRead) {
  constexpr int kDims = TypeParam::value;
  using Indices = std::span<const std::uint32_t>;
  const auto point = this->Ones();
  const Points<kDims> aos{point.data(), 1};
  PointsSoa<kDims> soa{.coords = {}, .count = 1};
  soa.coords.fill(point.data());
  FitStatus status;
  const auto expect_refused = [&](const std::uint32_t* pointer,
                                  std::string_view expected,
                                  std::string_view given) {
    const Indices indices(pointer, 2);
    EXPECT_TRUE(Refuses([&] { BoundPoints<kDims>(aos, indices, &status); },
                        {"BoundPoints: indices: expected ", expected, given}));
    EXPECT_TRUE(Refuses([&] { BoundPoints<kDims>(soa, indices, &status); },
                        {"BoundPoints: indices: expected ", expected, given}));
  };
  const std::array<std::uint32_t, 3> zeros{};
  expect_refused(nullptr, "2 indices", "a null pointer");
  expect_refused(Misaligned(zeros.data()), "aligned to 4", "misaligned");
  EXPECT_EQ(status.results, 0u);
  EXPECT_EQ(BoundPoints<kDims>(aos, Indices(), &status), Aabo<kDims>::Empty());
}

// Before any is read: the one point there is lies at index 0.
TYPED_TEST(FitErrorsTest, IndicesOutOfRange) {
  constexpr int kDims = TypeParam::value;
  const auto point = this->Ones();
  const Points<kDims> aos{point.data(), 1};
  PointsSoa<kDims> soa{.coords = {}, .count = 1};
  soa.coords.fill(point.data());
  FitStatus status;
  for (std::uint32_t bad : {1u, 0xffffffffu}) {
    const std::array<std::uint32_t, 3> indices = {0, 0, bad};
    const std::string given = "got " + std::to_string(bad);
    EXPECT_TRUE(
        Refuses([&] { BoundPoints<kDims>(aos, indices, &status); },
                {"BoundPoints", "indices[2]: expected less than", "1", given}));
    EXPECT_TRUE(
        Refuses([&] { BoundPoints<kDims>(soa, indices, &status); },
                {"BoundPoints", "indices[2]: expected less than", "1", given}));
  }
  const std::array<std::uint32_t, 1> first = {0};
  EXPECT_TRUE(Refuses(
      [&] {
        BoundPoints<kDims>(Points<kDims>{nullptr, 0}, first, &status);
      },
      {"BoundPoints", "indices[0]: expected less than", "0, got 0"}));
  EXPECT_EQ(status.results, 0u);
}

// Refused before the first is written, or this would crash.
TYPED_TEST(FitErrorsTest, TooManyPieces) {
  constexpr int kDims = TypeParam::value;
  constexpr std::size_t kMany = (std::size_t{1} << 24) + 1;
  alignas(Aabo<kDims>) std::byte room[sizeof(Aabo<kDims>)];
  const std::span<Aabo<kDims>> pieces(reinterpret_cast<Aabo<kDims>*>(room),
                                      kMany);
  FitStatus status;
  EXPECT_TRUE(Refuses(
      [&] {
        BoundSegmentPieces<kDims>({this->Ones(), this->Ones()}, pieces,
                                  &status);
      },
      {"BoundSegmentPieces", "pieces: expected at most 2^24",
       "got " + std::to_string(kMany)}));
  EXPECT_EQ(status.results, 0u);
}

TYPED_TEST(FitErrorsTest, PiecesThatCannotBeWritten) {
  constexpr int kDims = TypeParam::value;
  const Segment<kDims> segment{this->Ones(), this->Ones()};
  FitStatus status;
  const auto bound = [&](Aabo<kDims>* pieces) {
    BoundSegmentPieces(segment, std::span(pieces, 2), &status);
  };
  std::array<Aabo<kDims>, 3> room;
  EXPECT_TRUE(Refuses(
      [&] { bound(nullptr); },
      {"BoundSegmentPieces: pieces: expected room for 2", "a null pointer"}));
  EXPECT_TRUE(Refuses(
      [&] { bound(Misaligned(room.data())); },
      {"BoundSegmentPieces: pieces: expected", "aligned to 4", "misaligned"}));
  BoundSegmentPieces(segment, std::span<Aabo<kDims>>(), &status);
  EXPECT_EQ(status.results, 0u);
}

TEST(FitFrustumErrorsTest, PlanesThatAreNotSix) {
  const std::vector<HalfSpace3> planes(7);
  const HalfSpace3 five[5] = {};
  EXPECT_TRUE(Refuses([&] { BoundFrustum(planes); },
                      {"BoundFrustum: planes: expected 6 planes, got 7"}));
  EXPECT_TRUE(
      Refuses([&] { BoundFrustum(five); }, {"expected 6 planes, got 5"}));
  EXPECT_TRUE(
      Refuses([] { BoundFrustum(Span<const HalfSpace3>()); }, {"got 0"}));
}

TEST(FitFrustumErrorsTest, PlanesThatCannotBeRead) {
  const std::array<HalfSpace3, 7> planes{};
  const auto bound = [](const HalfSpace3* pointer) {
    BoundFrustum(std::span<const HalfSpace3, 6>(pointer, 6));
  };
  EXPECT_TRUE(
      Refuses([&] { bound(nullptr); },
              {"BoundFrustum: planes: expected 6 planes, got a null pointer"}));
  EXPECT_TRUE(Refuses(
      [&] { bound(Misaligned(planes.data())); },
      {"BoundFrustum: planes: expected", "aligned to 4", "misaligned"}));
}

// By one float: the planes' sum is exact.
TYPED_TEST(FitErrorsTest, SimplexWithoutAPoint) {
  constexpr int kDims = TypeParam::value;
  UpSimplex<kDims> up{};
  DownSimplex<kDims> down{};
  for (std::size_t k = 0; k < kDims; ++k) {
    up.min[k] = 1.f;
    down.max[k] = -1.f;
  }
  up.min[kDims] = -float{kDims};
  down.max[kDims] = float{kDims};
  EXPECT_NO_THROW(Circumscribe(up));
  EXPECT_NO_THROW(Circumscribe(down));
  up.min[0] += 0x1p-23f;
  down.max[0] -= 0x1p-23f;
  FitStatus status;
  EXPECT_TRUE(Refuses([&] { Circumscribe(up, &status); },
                      {"Circumscribe", "simplex: expected", "0 or less",
                       "got a simplex that contains no point"}));
  EXPECT_TRUE(Refuses([&] { Circumscribe(down, &status); },
                      {"Circumscribe", "simplex: expected"}));
  EXPECT_EQ(status.results, 0u);
}

}  // namespace
}  // namespace halfspace::testing

// Elements that bulk builders cannot bound: what they become, and how they are
// counted, in every lane on every target.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <vector>

#include "halfspace/fit.h"
#include "halfspace/fit_many.h"
#include "halfspace/world.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kMost = std::numeric_limits<float>::max();
constexpr std::size_t kShapes = 64 + 7;  // a tile and a tail

std::vector<float> BadCoordinates() {
  const float too_large = std::nextafter(0x1p125f, kMost);
  return {kNan,      -kNan,      kInfinity, -kInfinity,
          too_large, -too_large, kMost,     -kMost};
}

template <typename Dims>
class FitManySpecialTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kDim = Dims::value;
  using ABound = Aabo<Dims::value>;

  // build(world's planes, options, status) makes all but shape `bad` good, and
  // that one `expected`; good ones must not be so.
  template <typename Build>
  static void ExpectOne(std::size_t bad, const ABound& expected, Build build,
                        FitOptions options = {}) {
    const bool is_counted = expected == ABound::Everything();
    for (Target target : TargetsUnderTest()) {
      for (bool tightest : {false, true}) {
        options.target = target;
        options.tightest = tightest;
        AaboWorld<Dims::value> world;
        world.Resize(kShapes);
        // What was counted before is kept.
        FitStatus status{.results = 10};
        build(world.planes(), options, &status);
        for (std::size_t i = 0; i < kShapes; ++i) {
          if (i == bad) {
            ASSERT_EQ(world.Get(i), expected) << i << ", " << target.name();
          } else {
            ASSERT_NE(world.Get(i), ABound::Everything()) << i;
            ASSERT_NE(world.Get(i), ABound::Empty()) << i;
          }
        }
        ASSERT_EQ(status.results, 10 + kShapes);
        ASSERT_EQ(status.everything, is_counted ? 1u : 0u) << target.name();
        if (is_counted) {
          ASSERT_EQ(status.first_everything, 10 + bad);
        }
      }
    }
  }

  static Aabb<Dims::value> Unit() {
    Aabb<Dims::value> box;
    box.min.fill(-1.f);
    box.max.fill(1.f);
    return box;
  }

  static void ExpectBox(std::size_t at, const Aabb<Dims::value>& box,
                        const ABound& expected, Inverted inverted) {
    std::vector<Aabb<Dims::value>> boxes(kShapes, Unit());
    boxes[at] = box;
    ExpectOne(
        at, expected,
        [&](const auto& planes, const FitOptions& options, FitStatus* status) {
          BoundBoxes(BoxesOf<Dims::value>(boxes), planes, options, status);
        },
        {.inverted = inverted});
  }

  static void ExpectBadSphere(std::size_t at, std::size_t number, float bad) {
    std::array<std::vector<float>, kDim + 1> columns;
    columns.fill(std::vector<float>(kShapes, 1.f));
    columns[number][at] = bad;
    Spheres<Dims::value> spheres{.radius = columns[kDim].data(),
                                 .count = kShapes};
    for (std::size_t k = 0; k < kDim; ++k) {
      spheres.center[k] = columns[k].data();
    }
    ExpectOne(
        at, ABound::Everything(),
        [&](const auto& planes, const FitOptions& options, FitStatus* status) {
          BoundSpheres(spheres, planes, options, status);
        });
  }
};
TYPED_TEST_SUITE(FitManySpecialTest, AllDims, DimsNames);

TYPED_TEST(FitManySpecialTest, BoxesWithNumbersThatCannotBeBounded) {
  constexpr auto kEverything = Aabo<TypeParam::value>::Everything();
  for (std::size_t at = 0; at < kShapes; at += 5) {
    for (Inverted inverted : {Inverted::kEverything, Inverted::kEmpty}) {
      for (std::size_t k = 0; k < TypeParam::value; ++k) {
        for (float bad : BadCoordinates()) {
          auto box = this->Unit();
          // On the side where it does not turn the box over.
          (bad < 0.f ? box.min : box.max)[k] = bad;
          this->ExpectBox(at, box, kEverything, inverted);
        }
      }
      this->ExpectBox(at, Aabb<TypeParam::value>::Everything(), kEverything,
                      inverted);
    }
  }
}

TYPED_TEST(FitManySpecialTest, InvertedBoxes) {
  using Result = Aabo<TypeParam::value>;
  for (std::size_t at = 0; at < kShapes; ++at) {
    for (std::size_t k = 0; k < TypeParam::value; ++k) {
      for (const auto& [min, max] :
           {std::array{0x1p-149f, 0.f}, std::array{2.f, 1.f},
            std::array{kInfinity, -kInfinity}, std::array{kMost, -kMost}}) {
        auto box = this->Unit();
        box.min[k] = min;
        box.max[k] = max;
        this->ExpectBox(at, box, Result::Everything(), Inverted::kEverything);
        this->ExpectBox(at, box, Result::Empty(), Inverted::kEmpty);
        // A NaN elsewhere is a mistake all the same.
        box.max[(k + 1) % TypeParam::value] = kNan;
        this->ExpectBox(at, box, Result::Everything(), Inverted::kEmpty);
      }
    }
    for (Inverted inverted : {Inverted::kEverything, Inverted::kEmpty}) {
      auto box = Aabb<TypeParam::value>::Empty();
      this->ExpectBox(at, box, Result::Empty(), inverted);
      box.min[0] = kMost;
      this->ExpectBox(at, box, Result::Empty(), inverted);
      box.min.fill(kMost);
      box.max.fill(-kMost);
      this->ExpectBox(at, box, Result::Empty(), inverted);
    }
  }
}

TYPED_TEST(FitManySpecialTest, SpheresThatCannotBeBounded) {
  for (std::size_t at = 0; at < kShapes; ++at) {
    for (std::size_t k = 0; k < TypeParam::value; ++k) {
      for (float bad : BadCoordinates()) this->ExpectBadSphere(at, k, bad);
    }
    for (float bad : {-0x1p-149f, -1.f, kNan, -kInfinity, kInfinity, kMost}) {
      this->ExpectBadSphere(at, TypeParam::value, bad);
    }
  }
}

TYPED_TEST(FitManySpecialTest, RadiusZeroIsBounded) {
  constexpr int kDims = TypeParam::value;
  for (float zero : {0.f, -0.f}) {
    for (Target target : TargetsUnderTest()) {
      const float one = 1.f;
      Spheres<kDims> sphere{.radius = &zero, .count = 1};
      sphere.center.fill(&one);
      AaboWorld<kDims> world;
      world.Resize(1);
      BoundSpheres(sphere, world.planes(),
                   {.tightest = true, .target = target});
      Point<kDims> point;
      point.fill(one);
      EXPECT_EQ(world.Get(0), BoundPoint<kDims>(point));
    }
  }
}

// Good points, but for one that is a corner of one triangle, and belongs to one
// set, alone; and indices that do not exist.
TYPED_TEST(FitManySpecialTest, TrianglesAndSetsThatCannotBeBounded) {
  constexpr int kDims = TypeParam::value;
  constexpr std::size_t kPoints = 3 * kShapes;
  constexpr auto kEverything = Aabo<kDims>::Everything();
  std::vector<float> coords(kPoints * kDims, 1.f);
  const Points<kDims> points{coords.data(), kPoints};
  std::vector<std::uint32_t> indices(kPoints);
  std::vector<std::size_t> ends(kShapes);
  for (std::size_t i = 0; i < kPoints; ++i) {
    indices[i] = static_cast<std::uint32_t>(i);
    ends[i / 3] = i + 1;
  }
  const auto triangles = [&](const auto& planes, const FitOptions& options,
                             FitStatus* status) {
    BoundTriangles(points, indices, planes, options, status);
  };
  const auto sets = [&](const auto& planes, const FitOptions& options,
                        FitStatus* status) {
    BoundPointSets(points, ends, planes, options, status);
  };
  for (std::size_t i = 0; i < kPoints; ++i) {
    for (float bad : BadCoordinates()) {
      float& number = coords[i * kDims + i % kDims];
      number = bad;
      this->ExpectOne(i / 3, kEverything, triangles);
      this->ExpectOne(i / 3, kEverything, sets);
      number = 1.f;
    }
    for (std::uint32_t bad :
         {static_cast<std::uint32_t>(kPoints), std::uint32_t{0xffffffff}}) {
      indices[i] = bad;
      this->ExpectOne(i / 3, kEverything, triangles);
      indices[i] = static_cast<std::uint32_t>(i);
    }
  }
}

// Sets of 3 points, but for set `at`.
TYPED_TEST(FitManySpecialTest, EndsThatAreOutOfOrder) {
  constexpr int kDims = TypeParam::value;
  using Result = Aabo<kDims>;
  const std::vector<float> coords(3 * kShapes * kDims, 1.f);
  const Points<kDims> points{coords.data(), 3 * kShapes};
  for (std::size_t at = 1; at < kShapes; ++at) {
    std::vector<std::size_t> ends(kShapes);
    for (std::size_t i = 0; i < kShapes; ++i) ends[i] = 3 * (i + 1);
    const auto sets = [&](const auto& planes, const FitOptions& options,
                          FitStatus* status) {
      BoundPointSets(points, ends, planes, options, status);
    };
    // Begins where the set before ended, or one earlier.
    ends[at] = ends[at - 1];
    this->ExpectOne(at, Result::Empty(), sets);
    ends[at] = ends[at - 1] - 1;
    this->ExpectOne(at, Result::Everything(), sets);
    if (at == kShapes - 1) {
      for (std::size_t end : {3 * kShapes + 1, ~std::size_t{0}}) {
        ends[at] = end;
        this->ExpectOne(at, Result::Everything(), sets);
      }
    }
  }
}

// Bad shapes of doubles, one of each kind; the last of each is good.
TYPED_TEST(FitManySpecialTest, Doubles) {
  constexpr int kDims = TypeParam::value;
  constexpr double kWideNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kWideMost = std::numeric_limits<double>::max();
  constexpr auto kEverything = Aabo<kDims>::Everything();
  constexpr auto kNothing = Aabo<kDims>::Empty();
  Point<kDims> ones;
  ones.fill(1.f);
  const auto good = BoundPoint<kDims>(ones);
  AaboWorld<kDims> world;
  FitStatus status;
  // The bounds that come, of all shapes built since the last time.
  const auto expect = [&](std::initializer_list<Aabo<kDims>> expected) {
    ASSERT_EQ(world.size(), expected.size());
    std::size_t everything = 0;
    for (std::size_t i = 0; i < world.size(); ++i) {
      const auto& bound = expected.begin()[i];
      EXPECT_EQ(world.Get(i), bound) << i;
      if (everything == 0 && bound == kEverything) {
        EXPECT_EQ(status.first_everything, i);
      }
      everything += bound == kEverything ? 1 : 0;
    }
    EXPECT_EQ(status.results, world.size());
    EXPECT_EQ(status.everything, everything);
    status = {};
  };

  std::vector<Aabb<kDims, double>> boxes(7);
  for (auto& box : boxes) {
    box.min.fill(1.0);
    box.max.fill(1.0);
  }
  boxes[0] = Aabb<kDims, double>::Empty();
  boxes[1].min.fill(kWideMost);
  boxes[1].max.fill(-kWideMost);
  boxes[2].min[1] = kWideNan;
  boxes[3].max[0] = 0.0;
  boxes[4] = boxes[3];
  boxes[4].min[1] = kWideNan;
  boxes[5].max[1] = 0x1.8p125;
  world.Resize(boxes.size());
  const auto columns = BoxesOf<kDims>(boxes);
  BoundBoxes(columns, world.planes(), {}, &status);
  expect({kNothing, kNothing, kEverything, kEverything, kEverything,
          kEverything, good});
  BoundBoxes(columns, world.planes(), {.inverted = Inverted::kEmpty}, &status);
  expect({kNothing, kNothing, kEverything, kNothing, kEverything, kEverything,
          good});

  const std::array<double, 4> radii = {-0x1p-1074, kWideNan, 0x1.8p125, 0.0};
  const std::vector<double> coords(4 * kDims, 1.0);
  Spheres<kDims, double> spheres{.radius = radii.data(), .count = radii.size()};
  spheres.center.fill(coords.data());
  world.Resize(radii.size());
  BoundSpheres(spheres, world.planes(), {}, &status);
  expect({kEverything, kEverything, kEverything, good});

  const Points<kDims, double> points{coords.data(), 4};
  const std::array<std::uint32_t, 9> indices = {0, 1, 4, 0xffffffff, 1,
                                                2, 3, 1, 0};
  world.Resize(3);
  BoundTriangles(points, indices, world.planes(), {}, &status);
  expect({kEverything, kEverything, good});

  const std::array<std::size_t, 5> ends = {0, 3, 2, 4, 5};
  world.Resize(ends.size());
  BoundPointSets(points, ends, world.planes(), {}, &status);
  expect({kNothing, good, kEverything, good, kEverything});
}

// No vertices at all: no triangle has corners.
TYPED_TEST(FitManySpecialTest, TrianglesWithoutVertices) {
  constexpr int kDims = TypeParam::value;
  const std::vector<std::uint32_t> indices(3 * kShapes, 0);
  for (Target target : TargetsUnderTest()) {
    AaboWorld<kDims> world;
    world.Resize(kShapes);
    FitStatus status;
    BoundTriangles(Points<kDims>{}, indices, world.planes(), {.target = target},
                   &status);
    EXPECT_EQ(status.everything, kShapes);
    EXPECT_EQ(status.first_everything, 0u);
    EXPECT_EQ(world.Get(kShapes - 1), Aabo<kDims>::Everything());
  }
}

}  // namespace
}  // namespace halfspace::testing

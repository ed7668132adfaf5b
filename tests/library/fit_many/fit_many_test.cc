// The builders of many bounds give what the builders of one give, of any
// shapes, on every target, from and to any memory.
#include "halfspace/fit_many.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "halfspace/world.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/fit_many/bound_of_one.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

BulkShapes RandomShapes(const Bulk& bulk, PointKind kind, std::size_t count,
                        Random& random) {
  const RandomNumbers numbers(kind, bulk.is_double, random);
  BulkShapes shapes(count);
  for (auto& shape : shapes) {
    if (bulk.kind == Kind::kPoints) {
      // Few points, or, now and then, more than fill some vectors.
      std::size_t points = 1 + random() % 4;
      if (OneIn(16, random)) points += random() % 150;
      shape.resize(points * bulk.dims);
      for (std::size_t i = 0; i < shape.size(); i += bulk.dims) {
        numbers.FillPoint(std::span(shape).subspan(i, bulk.dims));
      }
      continue;
    }
    const Shape random_shape = RandomShape(bulk.single(), kind, random);
    for (std::size_t i = 0; i < bulk.single().roles.size(); ++i) {
      shape.push_back(bulk.single().Number(random_shape, i));
    }
  }
  return shapes;
}

// 2^30 + 2^6 rounds to 2^30, as does the sum of that and z = 2^6 - 2^-18. The
// two errors, 2^6 and z, add up to 2^7 - 2^-18, which rounds to 2^7; and
// 2^30 + 2^7 is a float. That the exact sum is less than this shows only in the
// error of the third addition.
BulkShapes HardShapes(const Bulk& bulk) {
  BulkShapes shapes;
  for (double sign : {1.0, -1.0}) {
    std::vector<double> point(bulk.dims);
    constexpr std::array kHard = {0x1p30, 0x1p6, 0x1.fffffep5};
    for (std::size_t k = 0; k < std::min<std::size_t>(3, bulk.dims); ++k) {
      point[k] = sign * kHard[k];
    }
    std::sort(point.begin(), point.end());
    do {
      std::vector<double> shape = point;
      if (bulk.kind == Kind::kSphere) shape.push_back(0);
      while (shape.size() < bulk.single().roles.size()) {
        shape.insert(shape.end(), point.begin(), point.end());
      }
      shapes.push_back(shape);
    } while (std::next_permutation(point.begin(), point.end()));
  }
  return shapes;
}

class FitManyTest : public ::testing::TestWithParam<Bulk> {
 protected:
  static constexpr std::size_t kTile = 64;

  static std::vector<Planes> Singles(const BulkShapes& shapes) {
    std::vector<Planes> singles;
    for (const auto& shape : shapes)
      singles.push_back(GetParam().Single(shape));
    return singles;
  }

  // On every target and in every layout, the same bits.
  static void ExpectAll(const BulkShapes& shapes, bool is_tightest) {
    const std::vector<Planes> singles = Singles(shapes);
    BulkSource source(GetParam(), shapes);
    std::vector<Planes> first;
    for (BulkLayout layout : kBulkLayouts) {
      Arena arena;
      source.Place(arena, layout);
      const BulkOutput built(GetParam(), shapes.size(), arena);
      for (Target target : TargetsUnderTest()) {
        SCOPED_TRACE(target.name());
        FitStatus status;
        ASSERT_EQ(
            source.Bound(built.output(),
                         {.tightest = is_tightest, .target = target}, &status),
            target);
        ASSERT_EQ(status.results, shapes.size());
        ASSERT_EQ(status.everything, 0u);
        const bool is_first = first.empty();
        for (std::size_t i = 0; i < shapes.size(); ++i) {
          if (is_first) {
            first.push_back(built.Get(i));
            ASSERT_TRUE(IsBoundOfOne(GetParam(), first[i], singles[i],
                                     shapes[i], is_tightest));
          } else {
            ASSERT_TRUE(SameBits(built.Get(i), first[i])) << i;
          }
        }
      }
    }
  }

  // More shapes than all sizes that are tried, and their bounds on one target.
  void SetUpMemory() {
    Random random(73);
    shapes_ = RandomShapes(GetParam(), PointKind::kWideExponents,
                           kTile + 4 * MostLanes() + 4, random);
    BulkSource source(GetParam(), shapes_);
    source.Place(arena_, BulkLayout::kColumns);
    expected_.emplace(GetParam(), shapes_.size(), arena_);
    source.Bound(expected_->output(), {.target = TargetsUnderTest().front()});
  }

  // The first `count` shapes in every layout, with inputs and outputs in
  // make_arena().
  template <typename MakeArena>
  void ExpectSame(std::size_t count, Target target,
                  const MakeArena& make_arena) {
    BulkSource source(GetParam(),
                      {shapes_.begin(),
                       shapes_.begin() + static_cast<std::ptrdiff_t>(count)});
    for (BulkLayout layout : kBulkLayouts) {
      Arena arena = make_arena();
      source.Place(arena, layout);
      const BulkOutput built(GetParam(), count, arena);
      source.Bound(built.output(), {.target = target});
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_TRUE(SameBits(built.Get(i), expected_->Get(i)))
            << "shape " << i << " of " << count << ", layout "
            << static_cast<int>(layout) << ", " << target.name();
      }
      ASSERT_TRUE(arena.Intact()) << count << ", " << target.name();
    }
  }

 private:
  BulkShapes shapes_;
  Arena arena_;
  std::optional<BulkOutput> expected_;
};

TEST_P(FitManyTest, BoundsAreThoseOfOneShape) {
  constexpr std::size_t kShapes = 150;  // more than two tiles and a tail
  for (bool is_tightest : {false, true}) {
    ForEachSample(70, 2, kShapes, [&](PointKind kind, Random& random) {
      ExpectAll(RandomShapes(GetParam(), kind, kShapes, random), is_tightest);
    });
    ExpectAll(HardShapes(GetParam()), is_tightest);
  }
}

// Any planes may be wanted.
TEST_P(FitManyTest, PlanesThatAreNotWantedAreNotWritten) {
  const Bulk& bulk = GetParam();
  Random random(72);
  const BulkShapes shapes =
      RandomShapes(bulk, PointKind::kUniform, kTile + 7, random);
  Arena arena;
  BulkSource source(bulk, shapes);
  source.Place(arena, BulkLayout::kColumns);
  const BulkOutput all(bulk, shapes.size(), arena);
  source.Bound(all.output(), {.target = TargetsUnderTest().front()});
  for (Target target : TargetsUnderTest()) {
    // Simplices, boxes, D, and any others.
    const std::uint32_t d = 1u << bulk.dims;
    const std::uint32_t most = (1u << bulk.planes()) - 1;
    for (std::uint32_t wanted :
         {2 * d - 1, most - (2 * d - 1), most - d - (most + 1) / 2,
          d + (most + 1) / 2, 1u, most - 1, 5u}) {
      const BulkOutput some(bulk, shapes.size(), arena);
      detail::Output output;
      output.size = shapes.size();
      for (std::size_t p = 0; p < bulk.planes(); ++p) {
        if ((wanted >> p & 1) != 0) output.Want(p, some.output().planes[p]);
      }
      source.Bound(output, {.target = target});
      for (std::size_t p = 0; p < bulk.planes(); ++p) {
        if ((wanted >> p & 1) == 0) continue;
        ASSERT_TRUE(std::equal(output.planes[p],
                               output.planes[p] + shapes.size(),
                               all.output().planes[p]))
            << "plane " << p << " of " << wanted << ", " << target.name();
      }
    }
  }
  EXPECT_TRUE(arena.Intact());
}

TEST_P(FitManyTest, EverySizeStrideAndMisalignment) {
  SetUpMemory();
  for (Target target : TargetsUnderTest()) {
    const std::size_t lanes = target.lanes();
    for (std::size_t n = 0; n <= kTile + 4 * lanes + 3; ++n) {
      // Some sizes at all misalignments, the others at one after another.
      const bool is_chosen = n == 5 || n == kTile + lanes + 1;
      for (std::size_t i = 0; i < (is_chosen ? lanes : 1); ++i) {
        ExpectSame(n, target, [&] { return Arena((n + i) % lanes); });
        if (HasFatalFailure()) return;
      }
#if defined(__unix__)
      // All of them at a small size; around whole vectors and tiles beyond.
      if (n > lanes + 1 && n % lanes > 1) continue;
      if (GetParam().dims != 3 && n != 1 && n != kTile + 1) continue;
      for (GuardedSide side : {GuardedSide::kBefore, GuardedSide::kAfter}) {
        ExpectSame(n, target, [&] { return Arena(side); });
        if (HasFatalFailure()) return;
      }
#endif
    }
  }
}

TEST_P(FitManyTest, StrideZeroIsTheSameShape) {
  const Bulk& bulk = GetParam();
  if (bulk.IsOfPoints()) return;
  Random random(74);
  constexpr std::size_t kSize = kTile + 9;
  Arena arena;
  BulkSource source(bulk, RandomShapes(bulk, PointKind::kUniform, 1, random));
  source.Place(arena, BulkLayout::kColumns);
  source.Repeat(kSize);
  const BulkOutput built(bulk, kSize, arena);
  for (Target target : TargetsUnderTest()) {
    source.Bound(built.output(), {.target = target});
    for (std::size_t i = 1; i < kSize; ++i) {
      ASSERT_TRUE(SameBits(built.Get(i), built.Get(0)));
    }
  }
}

// One bad shape among good ones, in every lane: what it becomes, how it is
// counted, and that the others do not change.
class FitManySpecialTest : public FitManyTest {
 protected:
  static constexpr std::size_t kShapes = kTile + 7;  // a tile and a tail

  void SetUp() override {
    const Shape ones = ShapeOfOnes(GetParam().single());
    std::vector<double> shape(
        ones.doubles.begin(),
        ones.doubles.begin() +
            static_cast<std::ptrdiff_t>(GetParam().single().roles.size()));
    shapes_.assign(kShapes, shape);
  }

  void ExpectOne(const BulkSource& source, std::size_t bad,
                 const Planes& expected, FitOptions options = {}) {
    const Builder& single = GetParam().single();
    const bool is_counted = expected == single.Everything();
    const BulkOutput built(GetParam(), kShapes, arena_);
    for (Target target : TargetsUnderTest()) {
      for (bool tightest : {false, true}) {
        options.target = target;
        options.tightest = tightest;
        // What was counted before is kept.
        FitStatus status{.results = 10};
        source.Bound(built.output(), options, &status);
        for (std::size_t i = 0; i < kShapes; ++i) {
          if (i == bad) {
            ASSERT_EQ(built.Get(i), expected) << i << ", " << target.name();
          } else {
            ASSERT_NE(built.Get(i), single.Everything()) << i;
            ASSERT_NE(built.Get(i), single.Empty()) << i;
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

  void ExpectShape(std::size_t at, const std::vector<double>& shape,
                   const Planes& expected, const FitOptions& options = {}) {
    BulkShapes shapes = shapes_;
    shapes[at] = shape;
    BulkSource source(GetParam(), shapes);
    arena_ = Arena();
    source.Place(arena_, BulkLayout::kColumns);
    ExpectOne(source, at, expected, options);
  }

  BulkShapes shapes_;
  Arena arena_;
};

TEST_P(FitManySpecialTest, NumbersAreTreatedAsByTheSingleBuilder) {
  const Bulk& bulk = GetParam();
  const double most = bulk.is_double ? std::numeric_limits<double>::max()
                                     : std::numeric_limits<float>::max();
  const double too_large =
      bulk.is_double ? 0x1.0000000000001p125 : 0x1.000002p125;
  for (std::size_t at = 0; at < kShapes; at += 7) {
    for (std::size_t i = 0; i < shapes_[at].size(); ++i) {
      for (double bad : {kNan, kInfinity, too_large, most, -kNan, -kInfinity,
                         -too_large, -most, 0.0, -0x1p-149}) {
        std::vector<double> shape = shapes_[at];
        shape[i] = bad;
        const Planes single = bulk.Single(shape);
        // Good ones are not tested here.
        if (single != bulk.single().Everything()) continue;
        ExpectShape(at + i % 7 < kShapes ? at + i % 7 : at, shape, single);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST_P(FitManySpecialTest, InvertedBoxes) {
  const Bulk& bulk = GetParam();
  if (bulk.kind != Kind::kBox) return;
  const double most = bulk.is_double ? std::numeric_limits<double>::max()
                                     : std::numeric_limits<float>::max();
  const std::size_t dims = bulk.dims;
  const Planes everything = bulk.single().Everything();
  const Planes empty = bulk.single().Empty();
  const FitOptions to_empty{.inverted = Inverted::kEmpty};
  for (std::size_t at = 0; at < kShapes && !HasFatalFailure(); ++at) {
    const std::size_t k = at % dims;
    for (const auto& [min, max] :
         {std::pair(0x1p-149, 0.0), std::pair(2.0, 1.0),
          std::pair(kInfinity, -kInfinity), std::pair(most, -most)}) {
      std::vector<double> box = shapes_[at];
      box[k] = min;
      box[dims + k] = max;
      ExpectShape(at, box, everything);
      ExpectShape(at, box, empty, to_empty);
      // A NaN elsewhere is a mistake all the same.
      box[dims + (k + 1) % dims] = kNan;
      ExpectShape(at, box, everything, to_empty);
    }
    for (const FitOptions& options : {FitOptions(), to_empty}) {
      std::vector<double> box(dims, kInfinity);
      box.resize(2 * dims, -kInfinity);
      ExpectShape(at, box, empty, options);
      if (!bulk.is_double) {
        box[0] = most;
        ExpectShape(at, box, empty, options);
      }
      std::fill_n(box.begin(), dims, most);
      std::fill(box.begin() + static_cast<std::ptrdiff_t>(dims), box.end(),
                -most);
      ExpectShape(at, box, empty, options);
      for (double& value : box) value = -value;
      ExpectShape(at, box, everything, options);
    }
  }
}

TEST_P(FitManySpecialTest, IndicesAndEndsThatAreOutOfRange) {
  const Bulk& bulk = GetParam();
  if (!bulk.IsOfPoints()) return;
  const Planes everything = bulk.single().Everything();
  const BulkSource good(bulk, shapes_);
  const auto expect = [&](BulkSource& source, std::size_t at,
                          const Planes& expected) {
    // What is read past the end could be bounded.
    arena_ = Arena(0, Arena::kFiniteCanary);
    source.Place(arena_, BulkLayout::kColumns);
    ExpectOne(source, at, expected);
  };
  for (std::size_t i = 0; i < 3 * kShapes && !HasFatalFailure(); ++i) {
    if (bulk.kind != Kind::kTriangle) break;
    for (std::size_t bad : {3 * kShapes, std::size_t{0xffffffff}}) {
      BulkSource source = good;
      source.indices[i] = static_cast<std::uint32_t>(bad);
      expect(source, i / 3, everything);
    }
  }
  for (std::size_t at = 1; at < kShapes && !HasFatalFailure(); ++at) {
    if (bulk.kind == Kind::kTriangle) break;
    // Begins where the set before ended, or one earlier.
    BulkSource source = good;
    source.ends[at] = source.ends[at - 1];
    expect(source, at, bulk.single().Empty());
    source.ends[at] = source.ends[at - 1] - 1;
    expect(source, at, everything);
    if (at + 1 != kShapes) continue;
    for (std::size_t end : {3 * kShapes + 1, ~std::size_t{0}}) {
      source.ends[at] = end;
      expect(source, at, everything);
    }
  }
}

struct BulkName {
  std::string operator()(const ::testing::TestParamInfo<Bulk>& info) const {
    return info.param.name;
  }
};
INSTANTIATE_TEST_SUITE_P(, FitManyTest, ::testing::ValuesIn(Bulks()),
                         BulkName());
INSTANTIATE_TEST_SUITE_P(, FitManySpecialTest, ::testing::ValuesIn(Bulks()),
                         BulkName());

// Builds so large that they are written past the caches, against small ones. In
// 3D an AABO takes 32 bytes: 96 MiB, and a tail.
TEST(FitManyLargeTest, AreTheSameAsSmallOnes) {
#if !defined(__x86_64__)
  GTEST_SKIP() << "only on x86 do large builds take a path of their own";
#endif
  constexpr std::size_t kLarge = 3 * (std::size_t{1} << 20) + 64 + 3;
  constexpr std::size_t kSmall = 4093;  // prime: no two tiles are alike
  for (const Bulk& bulk : Bulks()) {
    // Point sets are written one by one whatever their number.
    if (bulk.dims != 3 || bulk.is_double || bulk.kind == Kind::kPoints) {
      continue;
    }
    SCOPED_TRACE(bulk.name);
    Random random(80);
    const BulkShapes some =
        RandomShapes(bulk, PointKind::kUniform, kSmall, random);
    BulkSource small(bulk, some);
    BulkSource large(bulk, some);
    large.Cycle(kLarge);
    for (BulkLayout layout : {BulkLayout::kColumns, BulkLayout::kPacked}) {
      Arena arena;
      small.Place(arena, layout);
      large.Place(arena, layout);
      const BulkOutput expected(bulk, kSmall, arena);
      small.Bound(expected.output());
      const BulkOutput built(bulk, kLarge, arena);
      for (Target target : TargetsUnderTest()) {
        FitStatus status;
        large.Bound(built.output(), {.target = target}, &status);
        for (std::size_t p = 0; p < bulk.planes(); ++p) {
          float* const plane = built.output().planes[p];
          for (std::size_t i = 0; i < kLarge; i += kSmall) {
            const std::size_t count = std::min(kSmall, kLarge - i);
            ASSERT_TRUE(std::equal(plane + i, plane + i + count,
                                   expected.output().planes[p]))
                << "plane " << p << ", from shape " << i;
          }
          std::fill(plane, plane + kLarge, 0.f);
        }
        ASSERT_TRUE(arena.Intact());
        ASSERT_EQ(status.results, kLarge);
      }
    }
  }
}

// Stores past the caches fault where they are not aligned. One box, over and
// over; the other seven planes alone would be large enough for such stores.
TEST(FitManyLargeTest, OneMisalignedPlane) {
  constexpr std::size_t kBoxes = std::size_t{4} << 20;
  const Bulk bulk{"BoundBoxes3", Kind::kBox, 3, false};
  Arena aligned;
  BulkSource source(bulk, {{1, 2, 3, 4, 5, 6}});
  source.Place(aligned, BulkLayout::kColumns);
  source.Repeat(kBoxes);
  const BulkOutput built(bulk, kBoxes, aligned);
  Arena misaligned(1);
  detail::Output output = built.output();
  output.planes[7] = misaligned.New<float>(kBoxes);
  constexpr std::array<float, 8> kBound = {1, 2, 3, -15, 4, 5, 6, -6};
  for (Target target : TargetsUnderTest()) {
    source.Bound(output, {.tightest = true, .target = target});
    for (std::size_t p = 0; p < kBound.size(); ++p) {
      float* const plane = output.planes[p];
      ASSERT_TRUE(std::all_of(plane, plane + kBoxes, [&](float x) {
        return x == kBound[p];
      })) << target.name();
      std::fill(plane, plane + kBoxes, 0.f);
    }
  }
  EXPECT_TRUE(aligned.Intact());
  EXPECT_TRUE(misaligned.Intact());
}

// The calls with their types, by hand.
TEST(FitManyKnownTest, EveryKindOfSourceAndOfPlanes) {
  const FitOptions options{.tightest = true};
  const std::array<Aabb3, 2> boxes = {
      {{{1, 2, 3}, {4, 5, 6}}, {{-1, 0, 0}, {0, 1, 2}}}};
  AaboWorld3 aabos;
  aabos.Resize(2);
  BoundBoxes(BoxesOf<3>(boxes), aabos.planes(), options);
  EXPECT_EQ(aabos.Get(0), (Aabo3{{1, 2, 3, -15}, {4, 5, 6, -6}}));
  EXPECT_EQ(aabos.Get(1), (Aabo3{{-1, 0, 0, -3}, {0, 1, 2, 1}}));
  // The D axis of boxes that are already a world.
  std::array<float, 2> min;
  std::array<float, 2> max;
  BoundBoxes(BoxesOf(AabbWorld3(boxes)), DPlanes3{min.data(), max.data(), 2},
             options);
  EXPECT_EQ(min, (std::array{-15.f, -3.f}));
  EXPECT_EQ(max, (std::array{-6.f, 1.f}));

  const float coords[] = {0, 0, 0, 1, 0, 0, 0, 2, 0, 4, 2, -1};
  const std::array<std::uint32_t, 6> indices = {0, 1, 2, 3, 0, 0};
  SimplexWorld3 simplices;
  simplices.Resize(2);
  BoundTriangles(Points3{coords, 4}, indices, simplices.planes(), options);
  EXPECT_EQ(simplices.Get(0), (UpSimplex3{{0, 0, 0, -2}}));
  EXPECT_EQ(simplices.Get(1), (UpSimplex3{{0, 0, -1, -5}}));

  // One point, and two.
  const double x[] = {1, 4, 0};
  const double y[] = {2, -5, 0};
  const std::array<std::size_t, 2> ends = {1, 3};
  AabbWorld3 box_world;
  box_world.Resize(2);
  BoundPointSets(PointsSoa<3, double>{{x, y, y}, 3}, ends, box_world.planes(),
                 options);
  EXPECT_EQ(box_world.Get(0), (Aabb3{{1, 2, 2}, {1, 2, 2}}));
  EXPECT_EQ(box_world.Get(1), (Aabb3{{0, -5, -5}, {4, 0, 0}}));

  // Of two calls, each with a sphere of no size, the first one says which is
  // first.
  const float center[] = {0, 0};
  const float radii[] = {1, -1, 1};
  FitStatus status;
  for (const float* radius : {radii, radii + 1}) {
    BoundSpheres(Spheres3{{center, center, center}, radius, 2}, aabos.planes(),
                 {}, &status);
  }
  EXPECT_EQ(status.results, 4u);
  EXPECT_EQ(status.everything, 2u);
  EXPECT_EQ(status.first_everything, 1u);
}

}  // namespace
}  // namespace halfspace::testing

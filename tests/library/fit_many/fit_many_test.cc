// The builders of many bounds give what the builders of one give, of any
// shapes, on every target, from and to any memory; and what they refuse.
#include "halfspace/fit_many.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/world.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/fit_many/bulk_answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

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

  // In every layout, in memory of make_arena(), and in any floating-point mode.
  // In all but the first layout any planes may be wanted: simplices, boxes, D,
  // and any others.
  template <typename MakeArena>
  void ExpectAll(BulkAnswers& answers, const BulkShapes& shapes,
                 const MakeArena& make_arena) {
    BulkSource source(GetParam(), shapes);
    std::uint32_t wanted = 0xFFFFFFFF;
    for (BulkLayout layout : kBulkLayouts) {
      Arena arena = make_arena();
      source.Place(arena, layout);
      const FpMode mode = kFpModes[random_() % 6];
      ASSERT_TRUE(answers.Check(source, arena, wanted, mode))
          << "layout " << static_cast<int>(layout) << ", mode "
          << static_cast<int>(mode);
      wanted = static_cast<std::uint32_t>(random_());
    }
  }

 private:
  Random random_{72};
};

TEST_P(FitManyTest, BoundsAreThoseOfOneShape) {
  constexpr std::size_t kShapes = 150;  // more than two tiles and a tail
  for (Inverted inverted : {Inverted::kEverything, Inverted::kEmpty}) {
    const auto expect_all = [&](const BulkShapes& shapes) {
      BulkAnswers answers(GetParam(), shapes, {.inverted = inverted});
      ExpectAll(answers, shapes, [] { return Arena(); });
    };
    ForEachSample(70, 2, [&](PointKind kind, Random& random) {
      BulkShapes shapes = RandomShapes(GetParam(), kind, kShapes, random);
      expect_all(shapes);
      // Some with anything at all in them.
      for (auto& shape : shapes) {
        if (random() % 4 == 0) SpoilOne(GetParam(), shape, random);
      }
      expect_all(shapes);
    });
    expect_all(HardShapes(GetParam()));
  }
}

TEST_P(FitManyTest, EverySizeStrideAndMisalignment) {
  const std::size_t lanes = MostLanes();
  Random random(73);
  BulkShapes shapes = RandomShapes(GetParam(), PointKind::kWideExponents,
                                   kTile + 4 * lanes + 3, random);
  BulkAnswers answers(GetParam(), shapes);
  ExpectAll(answers, shapes, [] { return Arena(); });
  for (std::size_t n = shapes.size() + 1; n-- > 0;) {
    shapes.resize(n);
    // Some sizes at all misalignments, the others at one after another.
    const bool is_chosen = n == 5 || n == kTile + lanes + 1;
    for (std::size_t i = 0; i < (is_chosen ? lanes : 1); ++i) {
      ExpectAll(answers, shapes, [&] { return Arena((n + i) % lanes); });
      if (HasFatalFailure()) return;
    }
#if defined(__unix__)
    // All of them at a small size; around whole vectors and tiles beyond.
    if (n > lanes + 1 && n % lanes > 1) continue;
    if (GetParam().dims != 3 && n != 1 && n != kTile + 1) continue;
    for (GuardedSide side : {GuardedSide::kBefore, GuardedSide::kAfter}) {
      ExpectAll(answers, shapes, [&] { return Arena(side); });
      if (HasFatalFailure()) return;
    }
#endif
  }
}

// One bad shape among good ones, in every lane: what it becomes, how it is
// counted, and that the others do not change.
TEST_P(FitManyTest, IndicesAndEndsThatAreOutOfRange) {
  constexpr std::size_t kShapes = kTile + 7;  // a tile and a tail
  const Bulk& bulk = GetParam();
  if (!bulk.IsOfPoints()) return;
  const Planes everything = bulk.single().Everything();
  const BulkShapes shapes(kShapes, std::vector<double>(3 * bulk.dims, 1.0));
  const BulkSource good(bulk, shapes);
  const auto expect = [&](BulkSource& source, std::size_t bad,
                          const Planes& expected) {
    BulkAnswers answers(bulk, shapes);
    answers.Set(bad, expected);
    // What is read past the end could be bounded.
    Arena arena(0, Arena::kFiniteCanary);
    source.Place(arena, BulkLayout::kColumns);
    ASSERT_TRUE(answers.Check(source, arena)) << bad;
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

INSTANTIATE_TEST_SUITE_P(, FitManyTest, ::testing::ValuesIn(Bulks()),
                         ::testing::PrintToStringParamName());

// Builds so large that they are written past the caches, against small ones. In
// 3D an AABO takes 32 bytes: 128 MiB, and a tail. Stores past the caches fault
// where they are not aligned, and all planes but one are large enough for them.
TEST(FitManyLargeTest, AreTheSameAsSmallOnes) {
#if !defined(__x86_64__)
  GTEST_SKIP() << "only on x86 do large builds take a path of their own";
#endif
  constexpr std::size_t kLarge = 4 * (std::size_t{1} << 20) + 64 + 3;
  constexpr std::size_t kSmall = 4093;
  std::array<std::vector<float>, 6> columns;
  Random random(80);
  for (auto& column : columns) {
    for (std::size_t i = 0; i < kLarge; ++i) {
      // Boxes between -2^8 and 2^8.
      const float value = 0x1p-8f * static_cast<float>(random() >> 48);
      column.push_back(&column < &columns[3] ? -value : value);
    }
  }
  const auto bound = [&](std::size_t begin, detail::Output output,
                         std::size_t count, Target target, FitStatus* status) {
    Boxes3 boxes{.count = output.size = count};
    for (std::size_t k = 0; k < 3; ++k) {
      boxes.min[k] = &columns[k][begin];
      boxes.max[k] = &columns[k + 3][begin];
    }
    detail::BoundBoxes(detail::SourceOf<detail::kFitBoxes>(boxes), output,
                       {.target = target}, status);
  };
  const Bulk bulk{"", Kind::kBox, 3, false};
  for (bool is_misaligned : {false, true}) {
    Arena arena;
    Arena misaligned(1);
    const BulkOutput small(bulk, kSmall, arena);
    detail::Output output = BulkOutput(bulk, kLarge, arena).output();
    if (is_misaligned) output.planes[7] = misaligned.New<float>(kLarge);
    for (Target target : TargetsUnderTest()) {
      FitStatus status;
      bound(0, output, kLarge, target, &status);
      for (std::size_t i = 0; i < kLarge; i += kSmall) {
        const std::size_t count = std::min(kSmall, kLarge - i);
        bound(i, small.output(), count, target, nullptr);
        for (std::size_t p = 0; p < bulk.planes(); ++p) {
          float* const plane = output.planes[p] + i;
          ASSERT_TRUE(
              std::equal(plane, plane + count, small.output().planes[p]))
              << "plane " << p << ", from shape " << i;
          std::fill(plane, plane + count, 0.f);
        }
      }
      ASSERT_TRUE(arena.Intact() && misaligned.Intact());
      ASSERT_EQ(status.results, kLarge);
    }
  }
}

float Below(float d) { return std::nextafter(d, -detail::kInf<float>); }
float Above(float d) { return std::nextafter(d, detail::kInf<float>); }

// The calls with their types, by hand. D is one float looser than it must be.
TEST(FitManyKnownTest, EveryKindOfSourceAndOfPlanes) {
  const std::array<Aabb3, 2> boxes = {
      {{{1, 2, 3}, {4, 5, 6}}, {{-1, 0, 0}, {0, 1, 2}}}};
  AaboWorld3 aabos;
  aabos.Resize(2);
  BoundBoxes(BoxesOf<3>(boxes), aabos.planes());
  EXPECT_EQ(aabos.Get(0), (Aabo3{{1, 2, 3, Below(-15)}, {4, 5, 6, Above(-6)}}));
  EXPECT_EQ(aabos.Get(1), (Aabo3{{-1, 0, 0, Below(-3)}, {0, 1, 2, Above(1)}}));
  // The D axis of boxes that are already a world.
  std::array<float, 2> min;
  std::array<float, 2> max;
  BoundBoxes(BoxesOf(AabbWorld3(boxes)), DPlanes3{min.data(), max.data(), 2});
  EXPECT_EQ(min, (std::array{Below(-15), Below(-3)}));
  EXPECT_EQ(max, (std::array{Above(-6), Above(1)}));

  const float coords[] = {0, 0, 0, 1, 0, 0, 0, 2, 0, 4, 2, -1};
  const std::array<std::uint32_t, 6> indices = {0, 1, 2, 3, 0, 0};
  SimplexWorld3 simplices;
  simplices.Resize(2);
  BoundTriangles(Points3{coords, 4}, indices, simplices.planes());
  EXPECT_EQ(simplices.Get(0), (UpSimplex3{{0, 0, 0, Below(-2)}}));
  EXPECT_EQ(simplices.Get(1), (UpSimplex3{{0, 0, -1, Below(-5)}}));

  // One point, and two.
  const double x[] = {1, 4, 0};
  const double y[] = {2, -5, 0};
  const std::array<std::size_t, 2> ends = {1, 3};
  AabbWorld3 box_world;
  box_world.Resize(2);
  BoundPointSets(PointsSoa<3, double>{{x, y, y}, 3}, ends, box_world.planes());
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

// What the bulk builders refuse: before anything is written or counted, with a
// text that says what was wrong.

constexpr std::size_t kCount = 3;
constexpr std::size_t kHuge = std::numeric_limits<std::size_t>::max();

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

  void ExpectRefused(const std::function<void()>& call, Parts parts) {
    EXPECT_TRUE(Refuses(call, parts));
    EXPECT_EQ(status_.results, 0u);
    for (const auto& plane : planes_) {
      EXPECT_EQ(plane, std::vector<float>(16, kUntouched));
    }
  }

  // With what the members hold.
  const std::function<void()> boxes_call_ = [this] {
    BoundBoxes(boxes_, output_, options_, &status_);
  };
  const std::function<void()> spheres_call_ = [this] {
    BoundSpheres(spheres_, output_, options_, &status_);
  };
  const std::function<void()> triangles_call_ = [this] {
    BoundTriangles(points_, indices_, output_, options_, &status_);
  };
  const std::function<void()> point_sets_call_ = [this] {
    BoundPointSets(points_, ends_, output_, options_, &status_);
  };

  static constexpr float kUntouched = 77.f;

  std::array<std::vector<float>, 6> columns_;
  std::array<std::vector<float>, 8> planes_;
  Boxes3 boxes_;
  Spheres3 spheres_;
  PointsSoa3 points_;
  AaboPlanes3 output_;
  FitOptions options_;
  FitStatus status_;
  std::vector<std::uint32_t> list_ = {0, 1, 2, 0, 1, 2, 0, 1, 2};
  std::vector<std::size_t> end_list_ = {1, 2, 3};
  Span<const std::uint32_t> indices_ = list_;
  Span<const std::size_t> ends_ = end_list_;
};

TEST_F(FitManyErrorsTest, NullAndMisalignedPointers) {
  const auto refused = [&](const auto& call, const float*& pointer,
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
  refused(boxes_call_, boxes_.max[0], "BoundBoxes: boxes.max[0]", "3 boxes");
  refused(boxes_call_, boxes_.min[2], "BoundBoxes: boxes.min[2]", "3 boxes");
  refused(spheres_call_, spheres_.radius, "BoundSpheres: spheres.radius",
          "3 spheres");
  refused(spheres_call_, spheres_.center[2], "BoundSpheres: spheres.center[2]",
          "3 spheres");
  refused(triangles_call_, points_.coords[1],
          "BoundTriangles: vertices.coords[1]", "3 vertices");
  refused(point_sets_call_, points_.coords[1],
          "BoundPointSets: points.coords[1]", "3 points");
  const Points3 none{nullptr, kCount};
  ExpectRefused(
      [&] { BoundTriangles(none, indices_, output_, options_, &status_); },
      {"vertices.coords: expected 3 vertices", "a null pointer"});
  ExpectRefused(
      [&] { BoundPointSets(none, ends_, output_, options_, &status_); },
      {"points.coords: expected 3 points", "a null pointer"});
  const Aabb3* const no_boxes = nullptr;
  boxes_ = BoxesOf(Span<const Aabb3>(no_boxes, kCount));
  ExpectRefused(boxes_call_, {"BoundBoxes: boxes.min[0]: expected", "a null"});
}

TEST_F(FitManyErrorsTest, OutputsAndIndicesThatAreNoMemory) {
  output_.max[3] = nullptr;
  ExpectRefused(boxes_call_, {"BoundBoxes: planes.max[3]", "a null pointer"});
  output_.max[3] = Misaligned(planes_[7].data());
  ExpectRefused(boxes_call_, {"BoundBoxes: planes.max[3]", "misaligned"});
  output_.max[3] = planes_[7].data();
  output_.size = 2;
  const std::uint32_t* const indices = list_.data();
  indices_ = {Misaligned(indices), 6};
  ExpectRefused(triangles_call_,
                {"BoundTriangles: indices", "aligned to 4", "misaligned"});
  const std::size_t* const ends = end_list_.data();
  ends_ = {Misaligned(ends), 2};
  ExpectRefused(point_sets_call_,
                {"BoundPointSets: ends", "aligned to 8", "misaligned"});
}

TEST_F(FitManyErrorsTest, SizesThatDiffer) {
  boxes_.count = spheres_.count = kCount - 1;
  ExpectRefused(boxes_call_, {"BoundBoxes: boxes.count: expected 3", "got 2"});
  ExpectRefused(spheres_call_,
                {"BoundSpheres: spheres.count: expected 3", "got 2"});
  indices_ = {list_.data(), 8};
  ExpectRefused(triangles_call_,
                {"BoundTriangles: indices.size(): expected 9", "got 8"});
  ends_ = {end_list_.data(), 2};
  ExpectRefused(point_sets_call_,
                {"BoundPointSets: ends.size(): expected 3", "got 2"});
}

// Of 32 bits or of 64, whatever a size has here. Of stride and count, the
// larger is to blame.
TEST_F(FitManyErrorsTest, BeyondTheAddressSpace) {
  boxes_.stride = spheres_.stride = kHuge / 4;
  const Points3 strided{columns_[0].data(), kCount, kHuge / 4};
  const std::string given = "got " + std::to_string(kHuge / 4);
  const std::string stride = "stride: expected a stride with which 3 ";
  ExpectRefused(boxes_call_, {"BoundBoxes: boxes.", stride, given});
  ExpectRefused(spheres_call_, {"BoundSpheres: spheres.", stride, given});
  ExpectRefused(
      [&] { BoundTriangles(strided, indices_, output_, options_, &status_); },
      {"BoundTriangles: vertices.", stride, given});
  ExpectRefused(
      [&] { BoundPointSets(strided, ends_, output_, options_, &status_); },
      {"BoundPointSets: points.", stride, given});
  boxes_.count = output_.size = kHuge / 4;
  boxes_.stride = 2;
  ExpectRefused(boxes_call_,
                {"BoundBoxes: boxes.count: expected", "stride 2", given});
  boxes_.count = output_.size = kHuge;
  boxes_.stride = 0;
  ExpectRefused(boxes_call_,
                {"BoundBoxes", "planes.size: expected", "address space"});
  output_.size = kHuge / 3 + 1;
  ExpectRefused(triangles_call_,
                {"BoundTriangles", "planes.size: expected", "address space"});
  output_.size = kCount;
  points_.count = kHuge;
  ExpectRefused(point_sets_call_, {"BoundPointSets: points.count: expected"});
}

TEST_F(FitManyErrorsTest, OutputsThatOverlap) {
  output_.max[1] = planes_[2].data() + kCount - 1;
  ExpectRefused(boxes_call_, {"BoundBoxes", "planes.m", "apart from",
                              "planes.m", "got an overlap"});
  output_.max[1] = columns_[4].data() + kCount - 1;
  ExpectRefused(boxes_call_, {"BoundBoxes", "planes.max[1]: expected",
                              "apart from boxes.max[1]", "got an overlap"});
  EXPECT_EQ(columns_[4], std::vector<float>(16, 1.f));
  // Between the values of a column is inside it.
  boxes_.stride = 2;
  output_.max[1] = columns_[4].data() + 4;
  ExpectRefused(boxes_call_, {"planes.max[1]", "apart from boxes.max[1]"});
  output_.max[1] = reinterpret_cast<float*>(&list_[6]);
  ExpectRefused(triangles_call_,
                {"BoundTriangles", "planes.max[1]", "apart from indices"});
  output_.max[1] = reinterpret_cast<float*>(end_list_.data()) + 5;
  ExpectRefused(point_sets_call_,
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

TEST_F(FitManyErrorsTest, StrideZeroIsTheSameBox) {
  columns_[0][1] = 0.f;
  boxes_.stride = 0;
  BoundBoxes(boxes_, output_);
  std::vector<float> expected(16, kUntouched);
  std::fill_n(expected.begin(), kCount, 1.f);
  EXPECT_EQ(planes_[0], expected);
}

TEST_F(FitManyErrorsTest, TargetsAndOptions) {
  options_.target = Target::FromHighwayBit(3);  // two bits
  ExpectRefused(boxes_call_, {"BoundBoxes", "target"});
  options_ = {.inverted = static_cast<Inverted>(7)};
  ExpectRefused(boxes_call_, {"BoundBoxes", "options.inverted", "got 7"});
  boxes_.count = output_.size = 0;
  ExpectRefused(boxes_call_, {"BoundBoxes", "options.inverted", "got 7"});
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
    ExpectRefused([&] { BoundBoxes(boxes, output_, options_, &status_); },
                  parts);
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

// BVHs whose answers a reader can check, and what functions of calls may do.
#include <gtest/gtest.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "tests/library/bvh/answers.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

// The first survivors are told before a second leaf is read, and statistics say
// so. One query adds to what another one counted. Also where the codes of all
// objects are the query's and floats tell.
TEST(BvhKnownTest, TellsTheFirstLeafAtOnce) {
  constexpr Aabb3 kOne = {{1, 1, 1}, {1, 1, 1}};
  for (std::size_t size : {64u, 4000u, 20'000u, 10'000u}) {
    const bool are_same = size == 10'000;
    const Aabb3 all = are_same ? kOne : Aabb3::Everything();
    const AabbBvh3 bvh = are_same ? AabbBvh3(std::vector<Aabb3>(size, kOne))
                                  : AabbBvh3(Spread(1.0f).Some(size));
    const std::size_t leaves = (size + 63) / 64;
    for (Target target : TargetsUnderTest()) {
      QueryStatistics read;
      const QueryOptions options = {.target = target, .statistics = &read};
      EXPECT_TRUE(AnySurvivor(bvh, all, options).has_value());
      EXPECT_EQ(read.leaves, 1u);
      ForEachSurvivor(
          bvh, all,
          [](Span<const std::uint32_t> ids) {
            EXPECT_LE(ids.size(), 64u);
            return Visit::kStop;
          },
          options);
      EXPECT_EQ(read.leaves, 2u);
      Ids ids(size);
      EXPECT_EQ(Survivors(bvh, all, ids, options), size);
      EXPECT_EQ(read.leaves, 2 + leaves);
      read = {};
      EXPECT_EQ(Survivors(bvh, Aabb3::Empty(), ids, options), 0u);
      EXPECT_EQ(read.node_blocks + read.leaves, 1u);
    }
  }
}

// What is far from a diagonal segment is rejected, though its bound is not; and
// what is in a corner of a sphere's.
TEST(BvhKnownTest, ShapesRejectWhatTheirBoundsKeep) {
  AabbWorld3 world;
  world.Push({{0, 0, 0}, {1, 1, 1}});
  world.Push({{9, 0, 0}, {10, 1, 1}});
  world.Push({{9, 9, 9}, {10, 10, 10}});
  world.Push({{5.6f, 5.1f, 5.1f}, {6, 6, 5.5f}});
  const AabbBvh3 bvh(world);
  const auto found = [&](const auto& shape) {
    Ids ids(4);
    ids.resize(Survivors(bvh, shape, ids));
    return InOrder(ids);
  };
  EXPECT_EQ(found(Segment3{{0, 0, 0}, {10, 10, 10}}), (Ids{0, 2}));
  EXPECT_EQ(found(Capsule3{{0, 0, 0}, {10, 10, 10}, 0.5f}), (Ids{0, 2, 3}));
  EXPECT_EQ(found(Sphere3{{10, 10, 10}, 4.0f}), (Ids{2}));
  EXPECT_EQ(found(Sphere3{{10, 10, 10}, 9.0f}), (Ids{2, 3}));
  EXPECT_EQ(found(RoundedBox3{{{0, 1.5f, 0}, {10, 1.5f, 10}}, 1}), (Ids{0, 1}));
  const Aabb3 beside = {{10.5f, 1.5f, 1.5f}, {20, 20, 20}};
  EXPECT_EQ(found(RoundedBox3{beside, 0.7f}), Ids{2});
  EXPECT_EQ(found(RoundedBox3{beside, 0.9f}), (Ids{1, 2}));
  const HalfSpace3 half_spaces[] = {{{1, 0, 0}, -6}, {{0, -1, 0}, 6}};
  EXPECT_EQ(found(half_spaces), (Ids{1, 3}));
  EXPECT_EQ(found(Span<const HalfSpace3>(half_spaces)), (Ids{1, 3}));
  const HalfSpace3 huge = {{0x1p124f, 0, 0}, -0x1.8p126f};  // the first one
  EXPECT_EQ(found(std::vector<HalfSpace3>(1, huge)), (Ids{1, 2, 3}));
  EXPECT_EQ(found(std::vector<HalfSpace3>()), (Ids{0, 1, 2, 3}));
  EXPECT_EQ(found(Point3{10, 1, 0.5f}), Ids{1});
  EXPECT_EQ(found(Point3{10, 1.0001f, 0.5f}), Ids{});
  // Turned by 45 degrees about z; its corner (9.9, 5) is beside object 3.
  const float h = 3.5f;
  OrientedBox3 box = {{4.9f, 5, 5}, {{{1, 1, 0}, {-1, 1, 0}, {0, 0, 1}}}, {}};
  box.half_extents = {h, h, 1};
  EXPECT_EQ(found(box), Ids{3});
  box.center = {0, 10, 5};
  EXPECT_EQ(found(box), Ids{});  // though object 3 is in its bound
  box.half_extents = {h, h, kNan};
  EXPECT_EQ(found(box), (Ids{0, 1, 2, 3}));
  // While the radius has a square.
  const Point3 corner = {0x1.4p63f, 0x1.4p63f, 0x1.4p63f};
  const std::vector<Aabb3> bounds = {{corner, corner}, {{}, corner}};
  const AabbBvh3 large(bounds);
  EXPECT_EQ(CountSurvivors(large, Sphere3{{}, 0x1.8p63f}), 1u);
  EXPECT_EQ(CountSurvivors(large, Sphere3{{}, 0x1.2p64f}), 2u);
}

// The function runs in the caller's floating-point mode, and may change it. Its
// exceptions end the call.
TEST(BvhKnownTest, RunsTheFunctionInTheCallersMode) {
  const AabbBvh3 bvh(Spread(4.0f).Some(2000));
  const Ray3 ray = {{-60, -50, -50}, {1, 1, 1}, 100};
  std::vector<float> expected;
  RayCast(bvh, ray, [&](std::uint32_t, float t) { expected.push_back(t); });
  ASSERT_GT(expected.size(), 4u);
  for (int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD}) {
    const RoundingMode rounding(mode);
    std::vector<float> found;
    bool is_callers = true;
    int next = mode;
    RayCast(bvh, ray, [&](std::uint32_t, float t) {
      is_callers = is_callers && std::fegetround() == next;
      found.push_back(t);
      next = found.size() % 2 == 0 ? mode : FE_TOWARDZERO;
      std::fesetround(next);
    });
    EXPECT_TRUE(is_callers);
    EXPECT_EQ(std::fegetround(), next);
    EXPECT_EQ(found, expected);
    std::fesetround(mode);
    std::size_t calls = 0;
    EXPECT_THROW(RayCast(bvh, ray,
                         [&](std::uint32_t, float) {
                           if (++calls == 3) throw calls;
                         }),
                 std::size_t);
    EXPECT_EQ(calls, 3u);
    EXPECT_EQ(std::fegetround(), mode);
  }
}

// A function may return nothing, a bool, a Visit, or a Limit, and take the
// bound or not.
TEST(BvhKnownTest, FunctionsSayWhetherACallGoesOn) {
  const std::vector<Aabb3> boxes(1000, Aabb3{{0, 0, 0}, {1, 1, 1}});
  const AabbBvh3 bvh(boxes);
  const auto expect_stops = [](const auto& call) {
    std::size_t calls = 0;
    call(
        [&](auto...) { return ++calls < 3 ? Visit::kContinue : Visit::kStop; });
    EXPECT_EQ(calls, 3u);
    calls = 0;
    call([&](auto...) { return ++calls < 2; });
    EXPECT_EQ(calls, 2u);
  };
  const Ray3 ray{{0, 0, 0}, {1, 0, 0}, 1};
  expect_stops([&](auto function) {
    ForEachSurvivor(bvh, Aabb3::Everything(), function);
  });
  expect_stops([&](auto function) { ForEachPair(bvh, function); });
  expect_stops([&](auto function) {
    ForEachNearest(bvh, {0, 0, 0}, 1,
                   [&](std::uint32_t id, float) { return function(id); });
  });
  expect_stops([&](auto function) {
    RayCast(bvh, ray, [&](std::uint32_t, float, const Aabb3& bound) {
      EXPECT_EQ(bound, boxes[0]);
      return function(bound);
    });
  });
}

// Sets in worlds of a few leaves, and in one of more blocks than the sets have
// room for: near each other, far apart, and at distances that are powers of
// two.
class BvhSetTest : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Among, BvhSetTest,
                         ::testing::Values(64, 128, 129, 4096, 64 * 1024));

TEST_P(BvhSetTest, HasThePairsOfAllThatTouchTheSet) {
  const bool is_large = GetParam() > 4096;
  const std::vector<Aabb3> world =
      Spread(is_large ? 1.0f : 10.0f).Some(GetParam());
  AabbBvh3 bvh(world, {.quality = BuildQuality::kFast});
  std::vector<IdPair> all(Pairs(bvh, Span<IdPair>()));
  ASSERT_EQ(Pairs(bvh, all), all.size());
  for (bool has_slots : {false, true}) {
    if (has_slots) bvh.Set(0, bvh.Get(0));
    for (std::size_t step : {1u, 64u, 4160u, 8192u, 16384u}) {
      for (std::size_t size : {2u, 5u, 63u, 64u, 200u}) {
        Ids ids;
        for (std::size_t s = 0; s < bvh.ids().size() && ids.size() < size;
             s += step) {
          ids.push_back(bvh.ids()[s]);
        }
        std::vector<bool> is_in(world.size());
        for (std::uint32_t id : ids) is_in[id] = true;
        std::vector<IdPair> expected;
        for (const IdPair& pair : all) {
          if (is_in[pair.a] || is_in[pair.b]) expected.push_back(pair);
        }
        std::vector<IdPair> got(expected.size());
        ASSERT_EQ(PairsOf(bvh, ids, got), got.size()) << step << ' ' << size;
        ASSERT_EQ(InOrder(got, true), InOrder(expected, true));
      }
    }
    // All objects, and, by as many ids, all but two that touch.
    Ids ids(bvh.ids().begin(), bvh.ids().end());
    for (bool is_sorted : {false, true}) {
      if (is_sorted) std::sort(ids.begin(), ids.end());
      std::vector<IdPair> got(all.size());
      ASSERT_EQ(PairsOf(bvh, ids, got), all.size());
      ASSERT_EQ(InOrder(got, true), InOrder(all, true));
      Ids others = ids;
      for (std::uint32_t& id : others) {
        if (id == all[0].a || id == all[0].b) id = all.back().b;
      }
      if (is_sorted) std::sort(others.begin(), others.end());
      ASSERT_EQ(PairsOf(bvh, others, Span<IdPair>()), all.size() - 1);
    }
  }
}

// Results that are flushed to zero, but not what is read: a bound of a block
// may not lose a subnormal that compares see.
#if defined(__SSE2__)
TEST(BvhPairsTest, SubnormalResultsMayBeFlushed) {
  const AabbBvh3 a(std::vector<Aabb3>{{{-1e-40f, 0, 0}, {1, 1, 1}}});
  const AabbBvh3 b(std::vector<Aabb3>{{{-2, 0, 0}, {-0.5e-40f, 1, 1}}});
  const AabbBvh3 c(std::vector<Aabb3>{{{-2, 0, 0}, {-1.7e-40f, 1, 1}}});
  constexpr unsigned kFlushToZero = 0x8000;
  for (Target target : TargetsUnderTest()) {
    const unsigned mode = _mm_getcsr();
    _mm_setcsr(mode | kFlushToZero);
    const std::size_t count = Pairs(a, b, Span<IdPair>(), {.target = target});
    const std::size_t near =
        Pairs(a, c, Span<IdPair>(), {.margin = 0.8e-40f, .target = target});
    _mm_setcsr(mode);
    EXPECT_EQ(count, 1u) << target.name();
    EXPECT_EQ(near, 1u) << target.name();
  }
}
#endif

TEST(BvhPairsTest, ASubnormalMarginIsOneThoughSubnormalsAreFlushed) {
  constexpr float kLeast = std::numeric_limits<float>::min();
  const float next = std::nextafter(kLeast, 1.0f);
  AabbWorld3 world;
  world.Push({{0, 0, 0}, {kLeast, 0, 0}});
  world.Push({{next, 0, 0}, {1, 0, 0}});
  const AabbBvh3 bvh(world);
  const FlushDenormals flush;
  EXPECT_EQ(Pairs(bvh, {}, {.margin = 0x1p-149f}), 1u);
}

// The floats cannot tell 5 from what is next to it, whose square is rounded.
TEST(BvhPairsTest, TheDistanceOfPointsIsExact) {
  const float beyond = std::nextafter(4.0f, 5.0f);
  const auto point = [](float x, float y, float z) {
    return Aabb3{{x, y, z}, {x, y, z}};
  };
  std::vector<Aabb3> points = {point(0, 0, 0), point(3, 4, 0),
                               point(-3, beyond, 0), point(0, -3, -4)};
  for (std::size_t more : {0, 100}) {
    // Far apart from each other, so that a set of few and of many is tested.
    for (std::size_t i = 0; i < more; ++i) {
      points.push_back(point(100 + 10 * static_cast<float>(i), 0, 0));
    }
    const AabbBvh3 bvh(points);
    const AabbBvh3 origin(Span<const Aabb3>(points.data(), 1));
    for (Target target : TargetsUnderTest()) {
      const PairOptions options = {.within = 5, .target = target};
      EXPECT_EQ(Pairs(bvh, {}, options), 2u) << target.name();
      EXPECT_EQ(Pairs(origin, bvh, {}, options), 3u) << target.name();
      EXPECT_EQ(PairsOf(bvh, Ids{1, 2}, {}, options), 1u) << target.name();
    }
  }
}

TEST(BvhPairsTest, ASubnormalDistanceIsOneThoughSubnormalsAreFlushed) {
  constexpr float kLeast = std::numeric_limits<float>::min();
  const AabbBvh3 bvh(
      std::vector<Aabb3>{{{0, 0, 0}, {kLeast, 0, 0}},
                         {{std::nextafter(kLeast, 1.0f), 0, 0}, {1, 0, 0}},
                         {{std::nextafter(1.0f, 2.0f), 0, 0}, {2, 0, 0}}});
  const FlushDenormals flush;
  EXPECT_EQ(Pairs(bvh, {}, {.within = 0x1p-149f}), 1u);
}

// Records with other data between them.
struct Body {
  double mass;
  Aabb<3, double> box;
};
Boxes<3, double> BoxesIn(const std::vector<Body>& bodies) {
  Boxes<3, double> boxes;
  boxes.count = bodies.size();
  boxes.stride = sizeof(Body) / sizeof(double);
  for (std::size_t k = 0; k < 3; ++k) {
    boxes.min[k] = &bodies[0].box.min[k];
    boxes.max[k] = &bodies[0].box.max[k];
  }
  return boxes;
}

TEST(BvhBoxesTest, AreReadInPlace) {
  const auto are_same = [](const AabbBvh3& a, const AabbBvh3& b) {
    return std::ranges::equal(a.Blob(), b.Blob());
  };
  Random random(13);
  std::vector<Body> bodies;
  std::vector<Aabb3> rounded;
  AabbWorld<3, double> world;
  for (std::size_t i = 0; i < 5000; ++i) {
    Aabb<3, double> box;
    for (std::size_t k = 0; k < 3; ++k) {
      box.min[k] = static_cast<double>(random() % 1'000'003) / 7;
      box.max[k] = box.min[k] + 3.3;
    }
    world.Push(box);
    rounded.push_back(RoundOutward(box));
    bodies.push_back({1.0, box});
  }
  const AabbBvh3 expected(rounded);
  EXPECT_TRUE(are_same(AabbBvh3(world), expected));
  EXPECT_TRUE(are_same(AabbBvh3(world.view()), expected));
  AabbBvh3 of_boxes(BoxesIn(bodies));
  EXPECT_TRUE(are_same(of_boxes, expected));
  std::rotate(bodies.begin(), bodies.begin() + 99, bodies.end());
  std::rotate(rounded.begin(), rounded.begin() + 99, rounded.end());
  of_boxes.Refit(BoxesIn(bodies));
  EXPECT_FALSE(are_same(of_boxes, expected));
  AabbBvh3 refitted = expected;
  refitted.Refit(rounded);
  EXPECT_TRUE(are_same(of_boxes, refitted));
  std::vector<Aabb3> in_order;
  for (std::uint32_t id : expected.ids()) in_order.push_back(rounded[id]);
  AabbBvh3 refitted_in_order = expected;
  refitted_in_order.RefitInOrder(in_order);
  EXPECT_TRUE(are_same(refitted_in_order, refitted));
}

TEST(BvhBoxesTest, ChangesByDoublesAreThoseByTheFloatsAround) {
  std::vector<Aabb<3, double>> doubles(300);
  std::vector<Aabb3> floats;
  for (std::size_t i = 0; i < doubles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      doubles[i].min[k] = static_cast<double>(i * (k + 1)) / 7;
      doubles[i].max[k] = doubles[i].min[k] + 0.3;
    }
    floats.push_back(RoundOutward(doubles[i]));
  }
  const auto changed_by = [](const auto& boxes) {
    AabbBvh3 bvh;
    Ids ids(boxes.size());
    bvh.Insert(boxes, ids);
    std::reverse(ids.begin(), ids.end());
    bvh.Set(ids, boxes);
    for (std::uint32_t& id : ids) id += 500;
    bvh.InsertAs(ids, boxes);
    return bvh;
  };
  EXPECT_TRUE(std::ranges::equal(changed_by(doubles).Blob(),
                                 changed_by(floats).Blob()));
}

}  // namespace
}  // namespace halfspace::testing

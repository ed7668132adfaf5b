// BVHs of every kind answer as a list of their objects does: in worlds of every
// scene and size, in both orders, on every target.
#include "tests/library/bvh/answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "tests/library/bvh/history.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

class BvhTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, BvhTest, ::testing::ValuesIn(LayoutsOf(false)),
                         LayoutName());

constexpr BuildQuality kOrders[] = {BuildQuality::kHigh, BuildQuality::kFast};

void ExpectAnswersEverywhere(const Scene& scene, const Layout& layout,
                             std::size_t size) {
  const std::vector<Planes> bounds = ObjectsIn(scene, layout, size, size);
  const Objects objects = ObjectsOf(bounds);
  Random random(size);
  for (BuildQuality quality : kOrders) {
    const auto bvh = MakeBvh(layout, bounds, {.quality = quality});
    HowToAsk how{.targets = TargetsUnderTest(), .is_special = scene.is_special};
    ExpectIsModel(*bvh, objects, how, random);
    how.mask = random() % 2;  // of all or of none
    how.is_special = true;
    ExpectAnswers(*bvh, objects, how, random);
    if (::testing::Test::HasFailure()) {
      FAIL() << scene.name << ", " << size << " objects, quality "
             << static_cast<int>(quality);
    }
  }
}

TEST_P(BvhTest, AnswersInWorldsOfEverySize) {
  std::vector<std::size_t> sizes = {0,   1,   2,   63,   64,   65,
                                    127, 128, 129, 4032, 4096, 4097};
  Random random(7);
  for (std::size_t i = 0; i < Scaled(8); ++i) sizes.push_back(random() % 9000);
  for (std::size_t size : sizes) {
    ExpectAnswersEverywhere(Scenes()[0], GetParam(), size);
    if (HasFailure()) return;
  }
}

// The small ones with all their pairs.
TEST_P(BvhTest, AnswersInWorldsOfEveryScene) {
  for (const Scene& scene : Scenes()) {
    const std::size_t rounds = scene.is_special ? Scaled(8) : 1;
    for (std::size_t round = 0; round < rounds; ++round) {
      ExpectAnswersEverywhere(scene, GetParam(), 330 + round);
      if (HasFailure()) return;
    }
    ExpectAnswersEverywhere(scene, GetParam(), 4500);
    if (HasFailure()) return;
  }
}

// Three levels above the objects.
TEST_P(BvhTest, FindsWhatAScanFindsAmongMany) {
  const auto bounds =
      Spheres(GetParam(), 0.2f).Some(64 * 4096 + Scaled(40'000));
  const Objects objects = ObjectsOf(bounds);
  std::vector<Shape> queries;
  for (float radius : {0.0f, 0.5f, 5.0f, 40.0f}) {
    queries.push_back(Spheres(GetParam(), radius, 2).NextQuery());
  }
  for (BuildQuality quality : kOrders) {
    const auto bvh = MakeBvh(GetParam(), bounds, {.quality = quality});
    ExpectFinds(*bvh, objects, queries, {.targets = TargetsUnderTest()});
    if (HasFailure()) return;
  }
}

// Blocks whose values are at every place of their scale, and queries at each of
// them and one ulp to both sides: a code that decides too much is found. In
// every floating-point mode. More than one block, as one alone is tested by its
// floats.
TEST_P(BvhTest, CodesDecideOnlyWhatTheyProve) {
  const Layout layout = GetParam();
  // With 252.5 the values are at the ends of codes, where rounding tells.
  struct Scale {
    float base;
    float step;
    float last = 63.0f;
  };
  constexpr Scale kScales[] = {{0.0f, 1.0f},
                               {1.0f, 0x1p-23f},
                               {1.0f, 0.1f},
                               {-100.0f, 3.1f},
                               {0.0f, 0x1p-149f},
                               {0x1p-126f, 0x1p-149f},
                               {-0x1p127f, 0x1.f8p121f},
                               {1.0f, 0.0f},
                               {0x1p99f, 0x1p94f},
                               {0.0f, 3.1f, 252.5f},
                               {0.3f, 0.7f, 252.5f},
                               {-40.0f, 0.9f, 252.5f}};
  for (const Scale& scale : kScales) {
    std::vector<float> values;
    for (std::size_t i = 0; i < 64; ++i) {
      values.push_back(scale.base +
                       (i < 63 ? static_cast<float>(i) : scale.last) *
                           scale.step);
    }
    std::vector<Planes> bounds(128);
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      for (std::size_t p = 0; p < layout.plane_count; ++p) {
        bounds[i][p] = values[(i * 37 + p) % 64];
      }
    }
    std::vector<Shape> queries;
    for (std::size_t p = 0; p < layout.plane_count; ++p) {
      for (float value : values) {
        for (float at : {value, std::nextafter(value, kInf),
                         std::nextafter(value, -kInf)}) {
          Planes query = AllPlanes(layout, kInf);
          query[p] = at;
          queries.push_back({Shape::kBound, {query.begin(), query.end()}});
        }
      }
    }
    const auto count = [&](std::size_t q) {
      const std::size_t p = q / (3 * values.size());
      const float at = queries[q].numbers[p];
      std::size_t kept = 0;
      for (const Planes& bound : bounds) {
        kept += IsMin(layout, p) ? bound[p] <= at : bound[p] >= at;
      }
      return kept;
    };
    constexpr FpMode kModes[] = {FpMode::kDefault, FpMode::kFlushes,
                                 FpMode::kUpward, FpMode::kDownward,
                                 FpMode::kToZero};
    std::vector<std::vector<std::size_t>> expected;
    for (FpMode mode : kModes) {
      auto& counts = expected.emplace_back(queries.size());
      RunIn(mode, [&] {
        for (std::size_t q = 0; q < queries.size(); ++q) counts[q] = count(q);
      });
    }
    for (FpMode build_mode :
         {FpMode::kDefault, FpMode::kUpward, FpMode::kDownward}) {
      std::unique_ptr<AnyBvh> bvh;
      RunIn(build_mode, [&] {
        bvh = MakeBvh(layout, bounds);
        bvh->Reserve(4097);  // a smaller world has no codes
      });
      ASSERT_NE(bvh->tree().levels().codes, nullptr);
      for (std::size_t m = 0; m < std::size(kModes); ++m) {
        for (Target target : TargetsUnderTest()) {
          std::vector<std::size_t> counts(queries.size());
          RunIn(kModes[m],
                [&] { bvh->CountEach(queries, counts, {.target = target}); });
          ASSERT_EQ(counts, expected[m]) << "from " << scale.base << " by "
                                         << scale.step << ", " << target.name();
        }
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

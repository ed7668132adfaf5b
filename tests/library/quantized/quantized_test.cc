// Quantized bounds of every kind of world, on every target, schedule and call:
// what floats keep they keep, and refined they give the floats' answers, bit
// for bit. They are worth their memory: how much more than floats they keep.
#include "halfspace/quantized.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "halfspace/reject.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/owners.h"
#include "tests/library/support/quantized_cases.h"
#include "tests/library/support/sizes.h"

namespace halfspace::testing {
namespace {

class QuantizedTest : public ::testing::TestWithParam<QuantizedRow> {
 protected:
  // An input without both answers would test little.
  void TearDown() override {
    EXPECT_GT(survivors_, tests_ / 1000);
    EXPECT_LT(survivors_, tests_);
  }

  void Make(QuantizedInputKind kind, std::size_t size, std::size_t queries) {
    const auto values =
        MakeQuantizedValues(GetParam().layout, kind, size, random_);
    all_ = GetParam().Make(values);
    queries_ =
        MakeQuantizedQueries(GetParam().layout, values, queries, random_);
    EXPECT_TRUE(all_.bounds->Fits());
  }

  void Check(std::size_t queries, const Range& range = {}) {
    const AnyQueries some(queries_.data(), queries);
    const Answers exact = Answers::OfReference(all_.floats(), some, range);
    SCOPED_TRACE(::testing::Message()
                 << exact.objects() << " objects, " << queries
                 << " queries, range " << range.begin << ", " << range.end);
    ASSERT_TRUE(QuantizedAnswersEverywhere(all_.quantized(), all_.refined(),
                                           exact, some, targets_));
    ASSERT_TRUE(AnswersEverywhere(exact, all_.world(), some, targets_));
    tests_ += 64 * exact.rejected().size();
    survivors_ += exact.survivors().size();
  }

  void CheckSizes(const std::vector<std::size_t>& sizes, std::size_t rounds,
                  std::size_t queries) {
    std::size_t turn = 0;
    for (std::size_t size : sizes) {
      for (std::size_t i = 0; i < rounds; ++i) {
        const auto kind =
            kQuantizedInputKinds[turn++ % kQuantizedInputKinds.size()];
        SCOPED_TRACE(NameOf(kind));
        Make(kind, size, queries);
        Check(queries);
        if (HasFatalFailure()) return;
      }
    }
  }

  AnyQuantized all_;
  Random random_{17};

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  std::vector<float> queries_;
  std::size_t tests_ = 0;
  std::size_t survivors_ = 0;
};

// Few objects make few thresholds, so each size is a map of its own.
TEST_P(QuantizedTest, EverySmallSize) {
  CheckSizes(EverySmallSize(), Scaled(2), 1);
  CheckSizes({254, 255, 256, 700}, 4, 5);
}

// Around tiles, and from afar, the largest first.
TEST_P(QuantizedTest, LargeSizes) {
  CheckSizes(SizesAroundTiles(), Scaled(3), 2);
  if (HasFatalFailure()) return;
  std::vector<std::size_t> sizes =
      SizesFromMemory(GetParam().planes() * GetParam().element_bytes);
  std::reverse(sizes.begin(), sizes.end());
  sizes.resize(std::min(Scaled(sizes.size()), sizes.size()));
  CheckSizes(sizes, 1, 4);
}

// Around the queries that share a load (2 or 4), the rows of a tile (16), and
// the queries that are encoded at a time (256).
TEST_P(QuantizedTest, EveryNumberOfQueries) {
  Make(QuantizedInputKind::kAnyValues, 2 * 64 + 37, 600);
  for (std::size_t queries : {0, 1, 2, 3, 4, 5, 9, 16, 17, 256, 257, 600}) {
    Check(queries);
    if (HasFatalFailure()) return;
  }
}

TEST_P(QuantizedTest, Ranges) {
  constexpr std::size_t kSize = 4096 + 3 * 64 + 37;
  Make(QuantizedInputKind::kUniform, kSize, 7);
  constexpr Range kRanges[] = {{0, 0},
                               {0, 64},
                               {64, 64},
                               {63, 192},
                               {4001, 4096},
                               {64, 4096 + 64},
                               {4096 + 192, kSize},
                               {128, ~std::size_t{0}},
                               {8192, ~std::size_t{0}}};
  for (const Range& range : kRanges) {
    for (std::size_t queries : {1u, 7u}) {
      Check(queries, range);
      if (HasFatalFailure()) return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, QuantizedTest, ::testing::ValuesIn(QuantizedRows()),
                         ::testing::PrintToStringParamName());

// Every level of an object against levels of a query, in every plane: all 65
// 536 pairs of one byte, and of two bytes all objects against the queries where
// a sign or a byte changes.
//
// Levels are ranks, so they are known: a map is trained from as many values as
// it has thresholds, and then there is one level below them, and one for each.

class QuantizedPairsTest : public ::testing::TestWithParam<QuantizedRow> {
 protected:
  // The value that has this level in a plane. In a plane of minima the least
  // level is of what reaches no threshold; in one of maxima the greatest is of
  // what passes all.
  static float ValueOf(std::size_t level) {
    return static_cast<float>(level) - 200.f;
  }

  // Objects that reject nothing but in plane p, where object i has a value of
  // level i.
  std::vector<float> ObjectsOf(std::size_t p) const {
    std::vector<float> values((most_ + 1) * planes_);
    for (std::size_t i = 0; i <= most_; ++i) {
      values[i * planes_ + p] = ValueOf(i);
    }
    return values;
  }

  // Trains from all but the one object that no threshold is for, which is then
  // put in its place.
  std::unique_ptr<AnyOwner> QuantizedOf(
      std::size_t p, const std::vector<float>& values) const {
    const std::size_t odd = GetParam().IsMinPlane(p) ? 0 : most_;
    std::vector<float> trained = values;
    const auto at =
        trained.begin() + static_cast<std::ptrdiff_t>(odd * planes_);
    trained.erase(at, at + static_cast<std::ptrdiff_t>(planes_));
    auto quantized = GetParam().make_bounds(trained.data(), most_, {});
    quantized->Push(RecordOf(&values[most_ * planes_], planes_));
    for (std::size_t i = 0; i <= most_; ++i) {
      quantized->Set(i, RecordOf(&values[i * planes_], planes_));
    }
    return quantized;
  }

  // Survivors of a query that has a value for plane p alone.
  std::size_t Survivors(const AnyOwner& quantized, std::size_t p, float value,
                        Target target = {}) const {
    std::array<float, 10> query{};
    query[OpposingValue(GetParam().layout, p)] = value;
    return detail::CountSurvivors(quantized.seen().Asked({query.data(), 1}),
                                  {.target = target});
  }

  // All of one byte; of two bytes other ones from plane to plane, when not all
  // are tried.
  std::vector<std::uint32_t> QueryLevels(std::size_t p) const {
    std::vector<std::uint32_t> levels;
    if (most_ == 255) {
      for (std::uint32_t level = 0; level <= most_; ++level)
        levels.push_back(level);
      return levels;
    }
    constexpr std::array<std::uint32_t, 16> kEdges = {
        0,     1,     127,   128,   255,   256,   257,   0x7f00,
        32766, 32767, 32768, 32769, 65279, 65280, 65534, 65535};
    for (std::size_t i = 0; i < Scaled(kEdges.size()); ++i) {
      levels.push_back(kEdges[(5 * p + i) % kEdges.size()]);
    }
    return levels;
  }

  const std::size_t planes_ = GetParam().planes();
  const std::size_t most_ =
      (std::size_t{1} << (8 * GetParam().element_bytes)) - 1;
};

// What lies between two thresholds has the level that its side of the test
// gives it: of a minimum that of the threshold below, of a maximum that above.
TEST_P(QuantizedPairsTest, AreComparedAsTheirLevelsAre) {
  for (std::size_t p = 0; p < planes_; ++p) {
    const bool is_min = GetParam().IsMinPlane(p);
    const float outward = is_min ? 0.25f : -0.25f;
    auto values = ObjectsOf(p);
    const auto quantized = QuantizedOf(p, values);
    for (const std::uint32_t level : QueryLevels(p)) {
      const float value = ValueOf(level);
      const std::size_t count = is_min ? level + 1 : most_ + 1 - level;
      for (Target target : TargetsUnderTest()) {
        for (float by : {0 * outward, outward, 3 * outward}) {
          ASSERT_EQ(Survivors(*quantized, p, value + by, target), count)
              << target.name() << ", plane " << p << ", level " << level
              << " of the query and " << by;
        }
      }
    }
    constexpr std::size_t kLevel = 100;
    const float value = ValueOf(kLevel);
    values[kLevel * planes_ + p] = value + 3 * outward;
    quantized->Set(kLevel, RecordOf(&values[kLevel * planes_], planes_));
    const std::size_t count = is_min ? kLevel + 1 : most_ + 1 - kLevel;
    EXPECT_EQ(Survivors(*quantized, p, value), count);
    EXPECT_EQ(Survivors(*quantized, p, value - outward), count - 1);
  }
}

// Few numbers among many NaN have a level each.
TEST_P(QuantizedPairsTest, NanTeachesNothing) {
  constexpr std::size_t kNumbers = 100;
  constexpr std::size_t kObjects = 30 * kNumbers;
  for (std::size_t p = 0; p < planes_; ++p) {
    const bool is_min = GetParam().IsMinPlane(p);
    std::vector<float> values(kObjects * planes_);
    for (std::size_t i = 0; i < kObjects; ++i) {
      values[i * planes_ + p] = i % 30 == 0
                                    ? static_cast<float>(i / 30 + 1)
                                    : std::numeric_limits<float>::quiet_NaN();
    }
    const auto quantized = GetParam().make_bounds(values.data(), kObjects, {});
    for (std::size_t n = 0; n <= kNumbers + 1; ++n) {
      const std::size_t rejected = is_min ? kNumbers - std::min(n, kNumbers)
                                          : n - std::min(n, std::size_t{1});
      EXPECT_EQ(Survivors(*quantized, p, static_cast<float>(n)),
                kObjects - rejected)
          << "plane " << p << ", " << n;
    }
  }
}

// A query beyond all objects rejects all of them, however many objects there
// are for a threshold.
TEST_P(QuantizedPairsTest, QueriesBeyondAllRejectAll) {
  for (const std::size_t size : {1u, 2u, 100u, 255u, 256u, 1000u, 60'000u}) {
    for (std::size_t p = 0; p < planes_; ++p) {
      std::vector<float> values(size * planes_);
      for (std::size_t i = 0; i < size; ++i) {
        values[i * planes_ + p] = static_cast<float>(i + 1);
      }
      const auto quantized = GetParam().make_bounds(values.data(), size, {});
      const bool is_min = GetParam().IsMinPlane(p);
      const float last = is_min ? 1.f : static_cast<float>(size);
      EXPECT_GT(Survivors(*quantized, p, last), 0u) << size;
      EXPECT_EQ(Survivors(*quantized, p, is_min ? 0.f : last + 1.f), 0u)
          << size;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, QuantizedPairsTest,
                         ::testing::ValuesIn(QuantizedRows()),
                         ::testing::PrintToStringParamName());

// What calls on quantized bounds refuse: floats that do not refine them, and
// outputs within either. (Owners refuse in world/owner_test.cc.)

template <typename View, typename Element>
void CheckRefined() {
  using Bound = typename View::Bound;
  const World<View> world(std::vector<Bound>(130, Bound::Everything()));
  const QuantizedBounds<View, Element> quantized(world);
  const auto query = View::Query::Everything();
  for (std::size_t size : {0u, 129u, 131u}) {
    View floats = world.view();
    floats.size = size;
    ExpectAllRefuse(AnyWorld(Refined(quantized, floats)), {&query, 1}, {},
                    "world", "as many floats as quantized bounds, 130",
                    std::to_string(size));
  }
  const auto expect_overlap = [&](const auto& any_world, const void* in) {
    const std::span<std::uint64_t> mask(
        static_cast<std::uint64_t*>(const_cast<void*>(in)), 3);
    EXPECT_TRUE(Refuses(
        [&] { RejectMask(any_world, query, mask); },
        {"RejectMask: mask: expected", "apart", "overlap with world."}));
  };
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    View floats = world.view();
    expect_overlap(Refined(quantized, floats), PlaneOf(floats, p) + 64);
    PlaneOf(floats, p) = nullptr;
    const bool is_min = IsMinPlane<View>(p);
    ExpectAllRefuse(AnyWorld(Refined(quantized, floats)), {&query, 1}, {},
                    (is_min ? "world.min[" : "world.max[") +
                        std::to_string(is_min ? p : p - kMinima<View>) + "]",
                    "a plane of 130 floats", "a null pointer");
  }
  expect_overlap(quantized, quantized.view().planes[0]);
}

TEST(QuantizedErrorsTest, FloatsThatDoNotRefineAndOutputsWithin) {
  CheckRefined<SimplexView3, std::uint8_t>();
  CheckRefined<AabbView3, std::uint16_t>();
  CheckRefined<AaboView3, std::uint8_t>();
}

// Fits() says when the objects have left their map, and worlds that grow train.

class QuantizedFitsTest : public ::testing::TestWithParam<OwnerRow> {
 protected:
  using Values = std::vector<float>;  // of one bound after another

  Values RandomValues(std::size_t count,
                      QuantizedInputKind kind = QuantizedInputKind::kUniform) {
    return MakeQuantizedValues(row_.layout, kind, count, random_);
  }

  std::unique_ptr<AnyOwner> WorldOf(const Values& values) const {
    return row_.make(values.data(), values.size() / planes_, {});
  }

  Record At(const Values& values, std::size_t i) const {
    return RecordOf(&values[i * planes_], planes_);
  }

  // The world is pushed to once more; its map fits all the while, as there is
  // enough to train from.
  void PushAll(const Values& values, AnyOwner& world) const {
    for (std::size_t i = 0; i < values.size() / planes_; ++i) {
      world.Push(At(values, i));
      if (world.size() > 64 && world.size() % 32 == 1) {
        ASSERT_TRUE(world.Fits()) << world.size();
      }
    }
    EXPECT_TRUE(world.Fits());
  }

  // The quantized bounds keep hardly more than the floats: 1.013 times as many
  // of one byte, and 1.006 of two.
  void ExpectFewMore(const AnyOwner& world, const Values& values) {
    constexpr std::size_t kQueries = 64;
    const auto queries =
        MakeQuantizedQueries(row_.layout, values, kQueries, random_);
    std::vector<std::size_t> counts(kQueries);
    const auto count = [&](const AnyWorld& bounds) {
      detail::SurvivorCounts(bounds.Asked({queries.data(), kQueries}), counts,
                             {});
      return static_cast<double>(
          std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
    };
    const double exact = count(world.seen());
    EXPECT_GT(exact, 100.0);
    EXPECT_LE(count(world.quantized()), (is_byte_ ? 1.04 : 1.01) * exact);
  }

  const OwnerRow row_ = GetParam();
  const std::size_t planes_ = row_.layout.plane_count;
  const std::size_t axes_ = row_.layout.axes;
  const bool is_byte_ = row_.name.find("Uint8") != std::string::npos;
  Random random_{29};
};

TEST_P(QuantizedFitsTest, FewMoreSurviveThanOfFloats) {
  Values values = RandomValues(50'000);
  ExpectFewMore(*WorldOf(values), values);
  // Outliers take no levels from the others.
  for (std::size_t i = 0; i < values.size(); i += 1000 * planes_) {
    for (std::size_t p = 0; p < planes_; ++p) {
      values[i + p] = i % (2000 * planes_) == 0 ? 1e30f : -1e30f;
    }
  }
  ExpectFewMore(*WorldOf(values), values);
}

// The objects come in order of an axis, and are more than a map is trained
// from: all of them must count, not the first only. Just below the size at
// which every second object is looked at.
TEST_P(QuantizedFitsTest, OrderedObjectsAreToldApartToo) {
  const std::size_t count = 2 * (is_byte_ ? 1 << 16 : 1 << 18) - 1;
  Values values = RandomValues(count);
  std::vector<float> first(count);
  for (std::size_t i = 0; i < count; ++i) first[i] = values[i * planes_];
  std::sort(first.begin(), first.end());
  for (std::size_t i = 0; i < count; ++i) values[i * planes_] = first[i];
  ExpectFewMore(*WorldOf(values), values);
}

// More of the same fits. One plane that shrank is enough, whichever it is; all
// that moved away; and all objects count, not the first of them only.
TEST_P(QuantizedFitsTest, ChangedObjectsFitNoMore) {
  const auto check =
      [&](std::size_t first,
          const std::function<void(float&, std::size_t)>& change) {
        Values values = RandomValues(first == 0 ? 5000 : 2047);
        const auto world = WorldOf(RandomValues(values.size() / planes_));
        for (std::size_t i = 0; i < world->size(); ++i) {
          world->Set(i, At(values, i));
        }
        EXPECT_TRUE(world->Fits());
        for (std::size_t i = first; i < world->size(); ++i) {
          for (std::size_t p = 0; p < planes_; ++p) {
            change(values[i * planes_ + p], p);
          }
          world->Set(i, At(values, i));
        }
        EXPECT_FALSE(world->Fits());
        world->Requantize(*world);
        EXPECT_TRUE(world->Fits());
      };
  for (std::size_t p = 0; p < planes_; ++p) {
    check(0, [p](float& value, std::size_t plane) {
      if (plane == p) value *= 1e-3f;
    });
  }
  check(0, [](float& value, std::size_t) { value += 1000.f; });
  check(1024, [](float& value, std::size_t) { value = 1000.f; });
}

// Worlds that are pushed object by object reject nearly as well as one that is
// made of all at once: grown, with room from the start, or in memory that was
// moved from; and when they are filled afresh, as for each frame.
TEST_P(QuantizedFitsTest, GrowingWorldsTrain) {
  Values values = RandomValues(5000);
  const auto reserved = WorldOf({});
  reserved->Reserve(5000);
  const auto moved_from = WorldOf(values);
  const auto moved_to = moved_from->Move();
  const auto grown = WorldOf({});
  for (AnyOwner* world : {grown.get(), reserved.get(), moved_from.get()}) {
    PushAll(values, *world);
    ExpectFewMore(*world, values);
  }
  EXPECT_EQ(moved_to->size(), 5000u);
  for (float scale : {1e-3f, 1e3f, 0.3f}) {
    SCOPED_TRACE(scale);
    values = RandomValues(1000);
    for (float& value : values) value *= scale;
    grown->Clear();
    PushAll(values, *grown);
    ExpectFewMore(*grown, values);
  }
}

// The last objects that came are then all beyond what the map was trained from.
TEST_P(QuantizedFitsTest, WorldsInSpatialOrderTrain) {
  for (std::size_t p : {std::size_t{0}, planes_ - 1}) {
    const Values values = RandomValues(2000);
    std::vector<std::size_t> order(2000);
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return values[a * planes_ + p] < values[b * planes_ + p];
    });
    for (int i = 0; i < 2; ++i) {
      SCOPED_TRACE(::testing::Message() << p << (i == 0 ? ", up" : ", down"));
      Values sorted;
      for (std::size_t n : order) {
        sorted.insert(sorted.end(), &values[n * planes_],
                      &values[n * planes_] + planes_);
      }
      const auto world = WorldOf({});
      PushAll(sorted, *world);
      ExpectFewMore(*world, sorted);
      std::reverse(order.begin(), order.end());
    }
  }
}

// A period of the objects must not be taken for what all of them are like.
TEST_P(QuantizedFitsTest, GridsInOrderTrain) {
  const auto world = WorldOf({});
  constexpr std::size_t kSide = 32;
  for (std::size_t i = 0; i < kSide * kSide * kSide; ++i) {
    const std::array cell = {i % kSide, i / kSide % kSide, i / kSide / kSide};
    Values values;
    for (std::size_t p = 0; p < planes_; ++p) {
      values.push_back(static_cast<float>(cell[p % 3]));
    }
    world->Push(At(values, 0));
    if (world->size() > 64 && world->size() % 256 == 0) {
      ASSERT_TRUE(world->Fits()) << world->size();
    }
  }
}

std::vector<OwnerRow> QuantizedWorldRows() {
  std::vector<OwnerRow> rows = OwnerRows();
  std::erase_if(
      rows, [](const OwnerRow& row) { return row.type != "QuantizedWorld"; });
  return rows;
}
INSTANTIATE_TEST_SUITE_P(, QuantizedFitsTest,
                         ::testing::ValuesIn(QuantizedWorldRows()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace halfspace::testing

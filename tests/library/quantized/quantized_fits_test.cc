// Quantized bounds are worth their memory: how much more than floats they keep.
// Fits() says when the objects have left their map, and worlds that grow train.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "halfspace/reject.h"
#include "tests/library/support/owners.h"
#include "tests/library/support/quantized_cases.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

class QuantizedFitsTest : public ::testing::TestWithParam<OwnerRow> {
 protected:
  using Values = std::vector<float>;  // of one bound after another

  Values RandomValues(std::size_t count,
                      QuantizedInputKind kind = QuantizedInputKind::kUniform) {
    return MakeQuantizedValues(row_.layout, kind, count, random_);
  }

  // 0 ... 1, in steps of 2^-24.
  float Fraction() {
    return static_cast<float>(numbers_.Below(1 << 24)) * 0x1p-24f;
  }
  // The same on every machine: intervals of up to 20 on every axis, somewhere
  // between 0 and 100.
  Values SeededValues(std::size_t count) {
    Values values;
    for (std::size_t i = 0; i < count * planes_; ++i) {
      const bool is_min = i % planes_ < axes_;
      values.push_back(is_min ? 100.f * Fraction()
                              : values[i - axes_] + 20.f * Fraction());
    }
    return values;
  }

  std::unique_ptr<AnyOwner> WorldOf(const Values& values) const {
    return row_.make(values.data(), values.size() / planes_, {});
  }

  Record At(const Values& values, std::size_t i) const {
    return RecordOf(&values[i * planes_], planes_);
  }

  // Every object from the first on is changed: change(value, plane).
  void ForEachValue(AnyOwner& world, std::size_t first,
                    const std::function<void(float&, std::size_t)>& change) {
    for (std::size_t i = first; i < world.size(); ++i) {
      Record record{};
      world.Get(i, record);
      std::array<float, 10> values{};
      std::memcpy(values.data(), record.data(), planes_ * sizeof(float));
      for (std::size_t p = 0; p < planes_; ++p) change(values[p], p);
      world.Set(i, RecordOf(values.data(), planes_));
    }
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

  static std::size_t Count(const AnyWorld& world, const float* query) {
    return detail::CountSurvivors(world.Asked({query, 1}), {});
  }

  // The quantized bounds keep at most `more` times as many as those of a world
  // that is constructed from all bounds at once.
  void ExpectNearlyAsGood(const AnyOwner& world, const Values& values,
                          double more) {
    const auto made = WorldOf(values);
    std::size_t of_world = 0;
    std::size_t of_made = 0;
    for (int i = 0; i < 50; ++i) {
      const auto query = MakeQuantizedQueries(row_.layout, values, 1, random_);
      of_world += Count(world.quantized(), query.data());
      of_made += Count(made->quantized(), query.data());
    }
    EXPECT_GT(of_made, 0u);
    EXPECT_LT(static_cast<double>(of_world),
              more * static_cast<double>(of_made));
  }

  // Survivors of the quantized bounds, as a multiple of those of the floats, of
  // queries that reject about as many of the objects in each shape.
  void ExpectFewMore(const Values& values) {
    const auto world = WorldOf(values);
    std::size_t exact = 0;
    std::size_t of_quantized = 0;
    for (int i = 0; i < 64; ++i) {
      std::array<float, 10> query{};
      for (std::size_t p = 0; p < axes_; ++p) {
        const float from = 100.f * Fraction();
        query[OpposingValue(row_.layout, p)] = from + 20.f;
        if (row_.layout.has_max) {
          query[OpposingValue(row_.layout, p + axes_)] = from;
        }
      }
      exact += Count(world->seen(), query.data());
      of_quantized += Count(world->quantized(), query.data());
    }
    EXPECT_GT(exact, 100u);
    const double excess =
        static_cast<double>(of_quantized) / static_cast<double>(exact);
    EXPECT_GE(excess, 1.0);
    EXPECT_LE(excess, is_byte_ ? 1.6 : 1.02);
  }

  const OwnerRow row_ = GetParam();
  const std::size_t planes_ = row_.layout.plane_count;
  const std::size_t axes_ = row_.layout.axes;
  const bool is_byte_ = row_.name.find("Uint8") != std::string::npos;
  Random random_{29};
  SeededNumbers numbers_{41};
};

TEST_P(QuantizedFitsTest, FewMoreSurviveThanOfFloats) {
  Values values = SeededValues(50'000);
  ExpectFewMore(values);
  // Outliers take no levels from the others.
  for (std::size_t i = 0; i < values.size(); i += 1000 * planes_) {
    for (std::size_t p = 0; p < planes_; ++p) {
      values[i + p] = i % (2000 * planes_) == 0 ? 1e30f : -1e30f;
    }
  }
  ExpectFewMore(values);
}

// The objects come in order of an axis, and are more than a map is trained
// from: all of them must count, not the first only. Just below the size at
// which every second object is looked at.
TEST_P(QuantizedFitsTest, OrderedObjectsAreToldApartToo) {
  const std::size_t count = 2 * (is_byte_ ? 1 << 16 : 1 << 18) - 1;
  Values values = SeededValues(count);
  std::vector<float> first(count);
  for (std::size_t i = 0; i < count; ++i) first[i] = values[i * planes_];
  std::sort(first.begin(), first.end());
  for (std::size_t i = 0; i < count; ++i) values[i * planes_] = first[i];
  ExpectFewMore(values);
}

// A query beyond all objects rejects all of them, however many objects there
// are for a threshold.
TEST_P(QuantizedFitsTest, QueriesBeyondAllRejectAll) {
  for (const std::size_t size : {1u, 2u, 100u, 255u, 256u, 1000u, 70'000u}) {
    const Values values = SeededValues(size);
    const auto world = WorldOf(values);
    for (std::size_t p = 0; p < planes_; ++p) {
      const bool is_min = p < axes_;
      float extreme = values[p];
      for (std::size_t i = p; i < values.size(); i += planes_) {
        extreme = is_min ? std::min(extreme, values[i])
                         : std::max(extreme, values[i]);
      }
      constexpr float kMost = std::numeric_limits<float>::max();
      std::array<float, 10> query{};
      for (std::size_t k = 0; k < planes_; ++k) {
        query[OpposingValue(row_.layout, k)] = k < axes_ ? kMost : -kMost;
      }
      float& limit = query[OpposingValue(row_.layout, p)];
      limit = extreme;
      EXPECT_GT(Count(world->quantized(), query.data()), 0u) << size;
      limit = extreme + (is_min ? -1.f : 1.f);
      // Only what is among the samples is sure to be a threshold.
      if (size > (1u << 16)) continue;
      EXPECT_EQ(Count(world->quantized(), query.data()), 0u) << size;
    }
  }
}

TEST_P(QuantizedFitsTest, WhatWasJustTrainedFits) {
  for (QuantizedInputKind kind : kQuantizedInputKinds) {
    for (std::size_t size : {0u, 1u, 2u, 63u, 1000u, 5000u}) {
      EXPECT_TRUE(WorldOf(RandomValues(size, kind))->Fits())
          << NameOf(kind) << ", " << size;
    }
  }
  // And more of the same.
  const auto world = WorldOf(RandomValues(5000));
  const Values more = RandomValues(5000);
  for (std::size_t i = 0; i < 5000; ++i) {
    world->Set(random_() % 5000, At(more, i));
  }
  EXPECT_TRUE(world->Fits());
}

// One plane that shrank is enough, whichever it is; all that moved away; and
// all objects count, not the first of them only.
TEST_P(QuantizedFitsTest, ChangedObjectsFitNoMore) {
  const auto check =
      [&](std::size_t first,
          const std::function<void(float&, std::size_t)>& change) {
        const auto world = WorldOf(RandomValues(first == 0 ? 5000 : 2047));
        ForEachValue(*world, first, change);
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
    ExpectNearlyAsGood(*world, values, 1.2);
  }
  EXPECT_EQ(moved_to->size(), 5000u);
  for (float scale : {1e-3f, 1e3f, 0.3f}) {
    SCOPED_TRACE(scale);
    values = RandomValues(1000);
    for (float& value : values) value *= scale;
    grown->Clear();
    PushAll(values, *grown);
    ExpectNearlyAsGood(*grown, values, 1.2);
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
      ExpectNearlyAsGood(*world, sorted, 1.5);
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

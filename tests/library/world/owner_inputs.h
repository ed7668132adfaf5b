// Bounds for the rows of owners.h, the check that an owner has them, and
// histories of owners.
#ifndef HALFSPACE_TESTS_LIBRARY_WORLD_OWNER_INPUTS_H_
#define HALFSPACE_TESTS_LIBRARY_WORLD_OWNER_INPUTS_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/library/support/answers.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/owners.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {

class OwnerInputs {
 public:
  OwnerInputs(const OwnerRow& row, const Random& random)
      : row_(row), random_(random) {}

  // Of a random kind, if none is given: anything at all.
  Records RandomBounds(std::size_t count) {
    return RandomBounds(
        count, kQuantizedInputKinds[random_() % kQuantizedInputKinds.size()]);
  }
  Records RandomBounds(std::size_t count, QuantizedInputKind kind) {
    const std::size_t planes = row_.layout.plane_count;
    const std::vector<float> values =
        MakeQuantizedValues(row_.layout, kind, count, random_);
    Records bounds(count);
    for (std::size_t i = 0; i < count; ++i) {
      const float* const its = &values[i * planes];
      const std::vector<double> wide(its, its + planes);
      bounds[i] = row_.is_double ? RecordOf(wide.data(), planes)
                                 : RecordOf(its, planes);
    }
    return bounds;
  }
  Record RandomBound() { return RandomBounds(1)[0]; }

  // Size, bits, and what view() promises; of quantized bounds, the answers.
  void ExpectHolds(const AnyOwner& owner, const Records& model) {
    ASSERT_EQ(owner.size(), model.size());
    ASSERT_EQ(owner.empty(), model.empty());
    ASSERT_EQ(owner.quantized().size(), model.size());
    for (std::size_t i = 0; i < model.size(); ++i) {
      Record bound{};
      if (owner.Get(i, bound)) {
        ASSERT_EQ(bound, model[i]) << i;
      }
    }
    if (row_.IsQuantized()) {
      ExpectAnswers(owner, model);
    } else if (row_.is_double) {
      ExpectPlanes<double>(owner, model);
    } else {
      ExpectPlanes<float>(owner, model);
    }
  }

  // Random operations, each in any floating-point mode. After each, the owner
  // holds what a list of its bounds does, in any other mode. (A NaN may trap.)
  void FollowModel(std::size_t steps) {
    CountingMemory memory;
    auto owner = row_.make(nullptr, 0, memory.resource());
    Records model;
    for (std::size_t step = 0; step < steps; ++step) {
      const std::uint64_t operation = random_() % 100;
      SCOPED_TRACE(::testing::Message()
                   << row_ << ", step " << step << ", operation " << operation);
      RunIn(kFpModes[random_() % 5], [&] { Change(operation, *owner, model); });
      RunIn(kFpModes[random_() % 5], [&] { ExpectHolds(*owner, model); });
      if (::testing::Test::HasFatalFailure()) return;
    }
  }

 protected:
  const OwnerRow row_;
  Random random_;

 private:
  void Change(std::uint64_t operation, AnyOwner& owner, Records& model) {
    const Record bound = RandomBound();
    const std::size_t at = model.empty() ? 0 : random_() % model.size();
    if (operation < 55 || model.empty()) {
      ASSERT_EQ(owner.Push(bound), model.size());
      model.push_back(bound);
    } else if (operation < 65) {
      owner.Set(at, bound);
      model[at] = bound;
    } else if (operation < 84) {
      owner.EraseBySwap(at);
      model[at] = model.back();
      model.pop_back();
    } else if (operation < 86) {
      const std::size_t before = owner.capacity();
      const std::size_t wanted = random_() % 400;
      owner.Reserve(wanted);
      ASSERT_GE(owner.capacity(), before);
      ASSERT_TRUE(row_.IsQuantized() || owner.capacity() >= wanted);
    } else if (operation < 88) {
      const std::size_t capacity = owner.capacity();
      owner.Clear();
      model.clear();
      ASSERT_EQ(owner.capacity(), capacity);
    } else if (operation < 90) {
      owner.Requantize(*row_.MakeFloats(model));
      ASSERT_TRUE(owner.Fits());
    } else if (operation < 93) {
      model = RandomBounds(random_() % 300);
      owner.Assign(row_.List(model).data(), model.size());
      ASSERT_TRUE(owner.Fits());
    } else if (operation < 96) {
      // Copies are apart.
      auto copy = owner.Copy();
      copy->Set(at, bound);
      copy->EraseBySwap(0);
      ExpectHolds(owner, model);
      copy->AssignCopy(owner);
      owner.Clear();
      ExpectHolds(*copy, model);
      owner.AssignCopy(*copy);
    } else if (operation < 98) {
      owner.AssignCopy(owner);
      ExpectHolds(owner, model);
      owner.AssignMove(owner);
    } else {
      // What was moved from is empty and usable.
      auto taken = owner.Move();
      ExpectHolds(owner, {});
      owner.Push(bound);
      ExpectHolds(owner, {bound});
      owner.AssignMove(*taken);
      ExpectHolds(*taken, {});
    }
  }

  // Alignment, values and padding.
  template <typename T>
  void ExpectPlanes(const AnyOwner& owner, const Records& model) {
    ASSERT_GE(owner.capacity(), owner.size());
    if (model.empty()) return;
    const AnyWorld world = owner.seen();
    const detail::Scan scan = world.Asked({});
    for (std::size_t p = 0; p < row_.layout.plane_count; ++p) {
      const void* plane;
      std::memcpy(
          &plane,
          reinterpret_cast<const std::byte*>(scan.planes) + p * sizeof(plane),
          sizeof(plane));
      ASSERT_EQ(reinterpret_cast<std::uintptr_t>(plane) % 64, 0u) << p;
      const auto* const values = static_cast<const T*>(plane);
      for (std::size_t i = 0; i < model.size(); ++i) {
        ASSERT_EQ(std::memcmp(values + i, &model[i][p * sizeof(T)], sizeof(T)),
                  0)
            << p << ", " << i;
      }
      const T empty = std::numeric_limits<T>::infinity();
      for (std::size_t i = model.size(); i % 64 != 0; ++i) {
        ASSERT_EQ(values[i], p < row_.layout.axes ? empty : -empty)
            << p << ", padding " << i;
      }
    }
  }

  // Refined the floats' answers, and alone no more rejections.
  void ExpectAnswers(const AnyOwner& owner, const Records& model) {
    const auto floats = row_.MakeFloats(model);
    const std::vector<std::byte> list = row_.List(model);
    std::vector<float> values(list.size() / sizeof(float));
    if (!list.empty()) std::memcpy(values.data(), list.data(), list.size());
    for (int i = 0; i < 3; ++i) {
      const auto query = MakeQuantizedQueries(row_.layout, values, 1, random_);
      const AnyQueries asked(query.data(), 1);
      ASSERT_TRUE(QuantizedAnswersEverywhere(
          owner.quantized(), owner.Refined(*floats),
          Answers::OfReference(floats->seen(), asked), asked,
          {&targets_[random_() % targets_.size()], 1}));
    }
  }

  const std::vector<Target> targets_ = TargetsUnderTest();
};

class OwnerTest : public ::testing::TestWithParam<OwnerRow>,
                  public OwnerInputs {
 protected:
  OwnerTest() : OwnerInputs(GetParam(), Random(3)) {}
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_WORLD_OWNER_INPUTS_H_

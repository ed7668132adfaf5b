// The memory of owning worlds and quantized bounds: from the resource that it
// should come from; and what cannot be had, at every allocation in turn, leaves
// them as they were.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <memory_resource>
#include <new>
#include <vector>

#include "halfspace/world.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/limited_memory.h"
#include "tests/library/world/owner_inputs.h"

namespace halfspace::testing {
namespace {

class OwnerMemoryTest : public OwnerTest {
 protected:
  static constexpr std::size_t kObjects = 128;  // no room for one more

  // Calls test(memory, left) for each memory, with the number of allocations
  // that are left of it.
  template <typename Test>
  static void ForEachMemory(Test test) {
    test(MemoryResource(), allocations_left);
    for (Failure failure : {Failure::kThrows, Failure::kReturnsNull}) {
      CountingMemory memory(failure);
      test(memory.resource(), memory.left);
    }
  }

  // Lets change() fail at its first allocation, at its second, ..., and calls
  // check() after each failure. No memory but `left` is used.
  template <typename Change, typename Check>
  static void ExpectStrong(std::size_t& left, Change change, Check check) {
    bool is_done = false;
    std::size_t failures = 0;
    for (; !is_done; ++failures) {
      ASSERT_LT(failures, 100u) << "it uses other memory";
      allocations_left = 0;
      left = failures;
      try {
        change();
        is_done = true;
      } catch (const std::bad_alloc&) {
      }
      left = kNoAllocationLimit;
      allocations_left = kNoAllocationLimit;
      if (!is_done) check();
      if (HasFatalFailure()) return;
    }
    EXPECT_GT(failures, 1u);
  }

  Records bounds_ = RandomBounds(kObjects, QuantizedInputKind::kUniform);
};

TEST_P(OwnerMemoryTest, ChangesThatFailLeaveItAsItWas) {
  const Records more = RandomBounds(1000, QuantizedInputKind::kClustered);
  const std::vector<std::byte> more_list = row_.List(more);
  const auto floats = row_.MakeFloats(bounds_);
  ForEachMemory([&](const MemoryResource& memory, std::size_t& left) {
    auto owner = row_.make(nullptr, 0, memory);
    for (const Record& bound : bounds_) owner->Push(bound);
    const auto check = [&] { ExpectHolds(*owner, bounds_); };
    ExpectStrong(
        left, [&] { owner->Push(bounds_[0]); }, check);
    EXPECT_EQ(owner->size(), kObjects + 1);
    owner->EraseBySwap(kObjects);
    ExpectStrong(
        left, [&] { owner->Assign(more_list.data(), more.size()); }, check);
    ExpectHolds(*owner, more);
  });
}

TEST_P(OwnerMemoryTest, AssignmentThatFailsLeavesBothAsTheyWere) {
  Records longer = bounds_;
  longer.push_back(bounds_[0]);
  ForEachMemory([&](const MemoryResource& memory, std::size_t& left) {
    CountingMemory other;
    const auto from = row_.Make(longer, other.resource());
    for (bool is_move : {false, true}) {
      const auto to = row_.Make(bounds_, memory);
      ExpectStrong(
          left,
          [&] { is_move ? to->AssignMove(*from) : to->AssignCopy(*from); },
          [&] {
            ExpectHolds(*to, bounds_);
            ExpectHolds(*from, longer);
          });
      ExpectHolds(*to, longer);
      EXPECT_TRUE(to->memory() == memory);
    }
    EXPECT_EQ(from->size(), 0u);
    EXPECT_EQ(other.blocks, 0u);
  });
}

TEST_P(OwnerMemoryTest, OwnersUseTheResourceThatMemoryHSays) {
  CountingMemory counting;
  CountingMemory other_counting;
  const MemoryResource memory = counting.resource();
  const MemoryResource other = other_counting.resource();
  const auto expect = [&](const AnyOwner& owner,
                          const MemoryResource& expected) {
    EXPECT_TRUE(owner.memory() == expected);
    ExpectHolds(owner, bounds_);
  };
  const auto expect_empty = [&](const AnyOwner& owner,
                                const MemoryResource& expected) {
    EXPECT_TRUE(owner.empty());
    EXPECT_TRUE(owner.memory() == expected);
  };
  const auto first = row_.Make(bounds_, memory);
  expect(*first, memory);
  expect(*first->Copy(), MemoryResource());
  const auto second = first->Copy(other);
  expect(*second, other);

  const auto taken = first->Move();
  expect(*taken, memory);
  expect_empty(*first, memory);

  first->AssignCopy(*second);
  expect(*first, memory);
  const std::size_t allocations = counting.allocations;
  taken->AssignMove(*first);
  EXPECT_EQ(counting.allocations, allocations);
  expect(*taken, memory);
  EXPECT_TRUE(first->empty());

  first->Swap(*second);
  EXPECT_EQ(counting.allocations, allocations);
  expect(*first, other);
  expect_empty(*second, memory);

  first->StdSwap(*second);
  expect(*second, memory);
  expect_empty(*first, other);
}

TEST_P(OwnerMemoryTest, EverythingComesFromTheResource) {
  CountingMemory counting;
  const std::vector<std::byte> list = row_.List(bounds_);
  const auto floats = row_.MakeFloats(bounds_);
  const auto from = row_.Make(bounds_);
  // One allocation is the test's own.
  allocations_left = 1;
  const auto owner =
      row_.make(list.data(), bounds_.size(), counting.resource());
  allocations_left = kNoAllocationLimit;
  kWithoutMemory([&] {
    // Changes as often as makes all of it grow.
    for (int i = 0; i < 1000; ++i) owner->Push(bounds_[0]);
    owner->Set(1, bounds_[2]);
    owner->EraseBySwap(0);
    owner->Clear();
    owner->Push(bounds_[0]);
    owner->Reserve(300000);  // huge pages, if it were the default
    owner->AssignCopy(*from);
    owner->Requantize(*floats);
    owner->Assign(list.data(), bounds_.size());
    owner->AssignMove(*from);
    EXPECT_TRUE(owner->Fits());
  });
  EXPECT_GT(counting.allocations, 0u);
}

TEST_P(OwnerMemoryTest, ResourcesThatCannotServeAreRefused) {
  CountingMemory counting;
  counting.shift = 8;
  EXPECT_TRUE(Refuses([&] { row_.Make(bounds_, counting.resource()); },
                      {"MemoryResource::allocate", "aligned to 64 bytes"}));
  MemoryResource half = counting.resource();
  half.deallocate = nullptr;
  EXPECT_TRUE(Refuses([&] { row_.Make(bounds_, half); },
                      {"MemoryResource", "allocate and deallocate",
                       "two functions, or none", "one of them"}));
}

INSTANTIATE_TEST_SUITE_P(, OwnerMemoryTest, ::testing::ValuesIn(OwnerRows()),
                         ::testing::PrintToStringParamName());

TEST(MemoryFromTest, TakesAStdResource) {
  std::array<std::byte, 16384> block;
  std::pmr::monotonic_buffer_resource arena(block.data(), block.size(),
                                            std::pmr::null_memory_resource());
  kWithoutMemory([&] {
    AaboWorld3 world(MemoryFrom(arena));
    world.Resize(2);
    EXPECT_EQ(world.Push(Aabo3::Everything()), 2u);
  });
}

}  // namespace
}  // namespace halfspace::testing

// The memory of worlds, quantized bounds and quantized worlds: from the
// resource that it should come from; and what cannot be had, at every
// allocation in turn, leaves them as they were.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <memory_resource>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/world.h"
#include "tests/library/quantized/quantized_answers.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/limited_memory.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedMemoryTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Bound = typename FloatView::Bound;
  using TheBounds = QuantizedBounds<FloatView, typename Case::Element>;
  using TheWorld = QuantizedWorld<FloatView, typename Case::Element>;
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

  // Lets change(subject) fail at its first allocation, at its second, ..., and
  // calls check(subject) after each failure. No memory but `left` is used.
  template <typename Subject, typename Change, typename Check>
  static void ExpectStrong(Subject& subject, std::size_t& left, Change change,
                           Check check) {
    bool is_done = false;
    std::size_t failures = 0;
    for (; !is_done; ++failures) {
      ASSERT_LT(failures, 100u) << "it uses other memory";
      allocations_left = 0;
      left = failures;
      try {
        change(subject);
        is_done = true;
      } catch (const std::bad_alloc&) {
      }
      left = kNoAllocationLimit;
      allocations_left = kNoAllocationLimit;
      if (!is_done) check(subject);
      if (::testing::Test::HasFatalFailure()) return;
    }
    EXPECT_GT(failures, 1u);
  }

  // Calls test(make, check) for a world, quantized bounds and a quantized
  // world: make(memory) makes one of the bounds.
  template <typename Test>
  void ForEachOwner(Test test) {
    const FloatView floats = floats_.view();
    const std::span<const Bound> bounds(bounds_);
    test(
        [=](const MemoryResource& memory) {
          return World<FloatView>(bounds, memory);
        },
        [this](const auto& world) { CheckFloats(world); });
    test(
        [=](const MemoryResource& memory) { return TheBounds(floats, memory); },
        [this](const auto& quantized) { CheckQuantized(quantized); });
    test([=](const MemoryResource& memory) { return TheWorld(bounds, memory); },
         [this](const auto& world) { CheckWorld(world); });
  }

  // The world answers as when it was made.
  void CheckWorld(const TheWorld& world) {
    ASSERT_EQ(world.size(), kObjects);
    ASSERT_EQ(world.quantized().size(), kObjects);
    for (const auto& query : queries_) {
      const Answer exact = ReferenceAnswer(floats_.view(), query);
      ASSERT_TRUE(AnswersEverywhere(exact, world, query, target_));
    }
  }
  void CheckQuantized(const TheBounds& quantized) {
    ASSERT_EQ(quantized.size(), kObjects);
    ASSERT_TRUE(quantized.Fits());
    for (const auto& query : queries_) {
      ASSERT_TRUE(QuantizedAnswersEverywhere(quantized, floats_.view(), query,
                                             target_));
    }
  }

  void CheckFloats(const World<FloatView>& floats) {
    ASSERT_EQ(floats.size(), kObjects);
    for (std::size_t i = 0; i < kObjects; ++i) {
      ASSERT_EQ(floats.Get(i), bounds_[i]) << i;
    }
  }

  Random random_{53};
  std::vector<Bound> bounds_ = MakeQuantizedBounds<FloatView>(
      QuantizedInputKind::kUniform, kObjects, random_);
  World<FloatView> floats_{bounds_};
  std::vector<typename FloatView::Query> queries_ = {
      MakeQuantizedQuery<FloatView>(bounds_, random_),
      MakeQuantizedQuery<FloatView>(bounds_, random_)};
  std::vector<Target> target_ = {TargetsUnderTest().front()};
};

TYPED_TEST_SUITE(QuantizedMemoryTest, FewQuantizedCases, QuantizedCaseNames);

TYPED_TEST(QuantizedMemoryTest, QuantizedWorldStaysAsItWas) {
  this->ForEachMemory([this](const MemoryResource& memory, std::size_t& left) {
    typename TestFixture::TheWorld world(memory);
    for (const auto& bound : this->bounds_) world.Push(bound);
    ASSERT_EQ(world.size(), 128u);
    this->ExpectStrong(
        world, left, [&](auto& changed) { changed.Push(this->bounds_[0]); },
        [&](const auto& same) { this->CheckWorld(same); });
    EXPECT_EQ(world.size(), this->kObjects + 1);
  });
}

TYPED_TEST(QuantizedMemoryTest, QuantizedBoundsStayAsTheyWere) {
  const auto more = MakeQuantizedBounds<typename TypeParam::View>(
      QuantizedInputKind::kClustered, 1000, this->random_);
  const World<typename TypeParam::View> floats(more);
  const auto check = [&](const auto& same) { this->CheckQuantized(same); };
  this->ForEachMemory([&](const MemoryResource& memory, std::size_t& left) {
    typename TestFixture::TheBounds quantized(this->floats_, memory);
    typename TestFixture::TheBounds pushed(quantized, memory);
    this->ExpectStrong(
        pushed, left, [&](auto& changed) { changed.Push(this->bounds_[0]); },
        check);
    EXPECT_EQ(pushed.size(), this->kObjects + 1);
    this->ExpectStrong(
        quantized, left,
        [&](auto& changed) { changed.Requantize(floats.view()); }, check);
    EXPECT_EQ(quantized.size(), 1000u);
  });
}

// A caller's class, whose assignments the compiler writes.
template <typename Member>
struct Holder {
  Member member;
};

// Assignments copy if the resources differ.
template <typename Member>
constexpr bool OnlyAssignmentThrows() {
  using Held = Holder<Member>;
  return !std::is_nothrow_copy_assignable_v<Held> &&
         !std::is_nothrow_move_assignable_v<Held> &&
         std::is_nothrow_move_constructible_v<Held> &&
         std::is_nothrow_swappable_v<Member>;
}

TYPED_TEST(QuantizedMemoryTest, AssignmentThatFailsLeavesBothAsTheyWere) {
  this->ForEachOwner([this](auto make, auto check) {
    using Owner = decltype(make(MemoryResource()));
    static_assert(OnlyAssignmentThrows<Owner>());
    this->ForEachMemory([&](const MemoryResource& memory, std::size_t& left) {
      CountingMemory other;
      Holder<Owner> from{make(other.resource())};
      from.member.Push(this->bounds_[0]);
      const auto assign = [&](auto change) {
        Holder<Owner> to{make(memory)};
        this->ExpectStrong(to, left, change, [&](const auto& same) {
          check(same.member);
          EXPECT_EQ(from.member.size(), this->kObjects + 1);
        });
        EXPECT_EQ(to.member.size(), this->kObjects + 1);
        EXPECT_TRUE(to.member.memory() == memory);
      };
      assign([&](auto& to) { to = from; });
      assign([&](auto& to) { to = std::move(from); });
      EXPECT_EQ(from.member.size(), 0u);
      EXPECT_EQ(other.blocks, 0u);
    });
  });
}

TYPED_TEST(QuantizedMemoryTest, OwnersUseTheResourceThatMemoryHSays) {
  this->ForEachOwner([](auto make, auto check) {
    CountingMemory counting;
    CountingMemory other_counting;
    const MemoryResource memory = counting.resource();
    const MemoryResource other = other_counting.resource();
    const auto expect = [&](const auto& owner, const MemoryResource& expected) {
      EXPECT_TRUE(owner.memory() == expected);
      check(owner);
    };
    auto first = make(memory);
    using Owner = decltype(first);
    expect(first, memory);
    expect(Owner(first), MemoryResource());
    Owner second(first, other);
    expect(second, other);

    Owner taken(std::move(first));
    expect(taken, memory);
    EXPECT_TRUE(first.empty());
    EXPECT_TRUE(first.memory() == memory);

    first = second;
    expect(first, memory);
    const std::size_t allocations = counting.allocations;
    taken = std::move(first);
    EXPECT_EQ(counting.allocations, allocations);
    expect(taken, memory);
    EXPECT_TRUE(first.empty());

    swap(first, second);
    EXPECT_EQ(counting.allocations, allocations);
    expect(first, other);
    EXPECT_TRUE(second.empty());
    EXPECT_TRUE(second.memory() == memory);

    std::swap(first, second);
    expect(second, memory);
    EXPECT_TRUE(first.empty());
    EXPECT_TRUE(first.memory() == other);
  });
}

TYPED_TEST(QuantizedMemoryTest, EverythingComesFromTheResource) {
  using View = typename TypeParam::View;
  using ABounds = typename TestFixture::TheBounds;
  using AWorld = typename TestFixture::TheWorld;
  const std::span<const typename View::Bound> bounds(this->bounds_);
  // Assigns, and changes as often as makes all of it grow.
  const auto use = [&](auto& owner, const auto& from) {
    owner = from;
    for (int i = 0; i < 1000; ++i) owner.Push(bounds[0]);
    owner.Set(1, bounds[2]);
    owner.EraseBySwap(0);
    auto taken = std::move(owner);
    owner = std::move(taken);
    owner.Clear();
    owner.Push(bounds[0]);
    owner.Reserve(300000);  // huge pages, if it were the default
  };
  CountingMemory counting;
  const MemoryResource memory = counting.resource();
  kWithoutMemory([&] {
    World<View> world(memory);
    use(world, this->floats_);
    world.Assign(bounds);
    world.Resize(5000);
    use(world, World<View>(bounds, memory));
  });
  kWithoutMemory([&] {
    ABounds quantized(memory);
    use(quantized, ABounds(this->floats_, memory));
    quantized.Requantize(this->floats_);
    quantized.Requantize(bounds);
    EXPECT_TRUE(quantized.Fits());
    use(quantized, ABounds(this->floats_.view(), memory));
  });
  kWithoutMemory([&] {
    AWorld world(memory);
    use(world, AWorld(this->floats_, memory));
    world.Requantize();
    use(world, AWorld(bounds, memory));
    EXPECT_FALSE(AWorld(this->floats_.view(), memory).empty());
  });
  EXPECT_GT(counting.allocations, 0u);
}

TEST(MemoryFromTest, TakesAStdResource) {
  std::array<std::byte, 16384> block;
  std::pmr::monotonic_buffer_resource arena(block.data(), block.size(),
                                            std::pmr::null_memory_resource());
  kWithoutMemory([&] {
    AaboWorld3 world(MemoryFrom(arena));
    EXPECT_EQ(world.Push(Aabo3::Everything()), 0u);
  });
}

TYPED_TEST(QuantizedMemoryTest, ResourcesThatCannotServeAreRefused) {
  this->ForEachOwner([](auto make, auto) {
    CountingMemory counting;
    counting.shift = 8;
    EXPECT_TRUE(Refuses([&] { make(counting.resource()); },
                        {"MemoryResource::allocate", "aligned to 64 bytes"}));
    MemoryResource half = counting.resource();
    half.deallocate = nullptr;
    EXPECT_TRUE(Refuses([&] { make(half); },
                        {"MemoryResource", "allocate and deallocate",
                         "two functions, or none", "one of them"}));
  });
}

}  // namespace
}  // namespace halfspace::testing

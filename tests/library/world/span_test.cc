// What becomes a Span, and what must not. Callers in C++17 are in
// tests/package/consumer.
#include "halfspace/span.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <initializer_list>
#include <list>
#include <ranges>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "halfspace/bounds.h"
#include "halfspace/fit_many.h"
#include "halfspace/world.h"

namespace halfspace::testing {
namespace {

using Ints = std::vector<int>;

template <typename From, typename T>
constexpr bool kBecomes = std::is_convertible_v<From, Span<T>>;

// Named lists that may be written.
static_assert(kBecomes<int (&)[3], int>);
static_assert(kBecomes<std::array<int, 3>&, int>);
static_assert(kBecomes<Ints&, int>);
static_assert(kBecomes<Ints&, const int>);
static_assert(kBecomes<std::string&, char>);
// Const lists, and temporaries, may only be read.
static_assert(kBecomes<const int (&)[3], const int>);
static_assert(kBecomes<const std::array<int, 3>&, const int>);
static_assert(kBecomes<const Ints&, const int>);
static_assert(kBecomes<Ints, const int>);
static_assert(kBecomes<std::array<int, 3>, const int>);
static_assert(kBecomes<std::initializer_list<int>, const int>);
static_assert(!kBecomes<const int (&)[3], int>);
static_assert(!kBecomes<const std::array<int, 3>&, int>);
static_assert(!kBecomes<std::array<int, 3>, int>);
static_assert(!kBecomes<const Ints&, int>);
static_assert(!kBecomes<Ints, int>);
// Views of what may be written, also if they are const or temporaries.
static_assert(kBecomes<std::span<int>, int>);
static_assert(kBecomes<const std::span<int>&, int>);
static_assert(kBecomes<std::span<int, 3>, const int>);
static_assert(!kBecomes<std::span<const int>, int>);
static_assert(kBecomes<Span<int>, const int>);
static_assert(kBecomes<const Span<int>&, const int>);
static_assert(!kBecomes<Span<const int>, int>);
// Elements of another type, or not one after another.
static_assert(!kBecomes<Ints&, float>);
static_assert(!kBecomes<Ints&, unsigned>);
static_assert(!kBecomes<std::deque<int>&, int>);
static_assert(!kBecomes<std::list<int>&, int>);
static_assert(!kBecomes<int (&)[3][3], int>);
static_assert(!kBecomes<int*, int>);
static_assert(!kBecomes<std::nullptr_t, int>);
static_assert(!kBecomes<AabbWorld3, const Aabb3>);
static_assert(!kBecomes<AabbView3, const Aabb3>);
struct Base {};
struct Derived : Base {
  int more;
};
static_assert(!kBecomes<std::vector<Derived>&, const Base>);

// A list of two numbers, of which the first is 0, is not a null pointer and a
// size.
template <typename T>
concept TakesTwoNumbers = requires {
  Span<T>{0, 1};
};
static_assert(!TakesTwoNumbers<int>);

// Passed in two registers, and back to what C++20 has.
static_assert(std::is_trivially_copyable_v<Span<int>>);
static_assert(std::is_nothrow_constructible_v<Span<int>, Ints&>);
static_assert(std::is_convertible_v<Span<int>&, std::span<int>>);
static_assert(std::is_convertible_v<const Span<int>&, std::span<int>>);
static_assert(std::is_convertible_v<Span<int>, std::span<const int>>);
static_assert(!std::is_convertible_v<Span<const int>, std::span<int>>);
static_assert(std::ranges::contiguous_range<Span<int>>);

constexpr int SumOf(Span<const int> values) {
  int sum = 0;
  for (int value : values) sum += value;
  return sum;
}
constexpr std::array<int, 3> kThree = {1, 2, 3};
static_assert(SumOf(kThree) == 6 && SumOf({}) == 0);
static_assert(SumOf({kThree.data(), 2}) == 3);
static_assert(&Span<const int>(kThree)[1] == &kThree[1] &&
              &Span<const int>(kThree).front() == &kThree[0] &&
              &Span<const int>(kThree).back() == &kThree[2]);
static_assert(Span<const int>().empty() && !Span<const int>(kThree).empty());

TEST(SpanTest, BoxesOfWhateverHasThem) {
  const std::vector<Aabb3> boxes(2, Aabb3{{0, 0, 0}, {1, 1, 1}});
  const Aabb3 array[] = {boxes[0]};
  EXPECT_EQ(BoxesOf(boxes).min[1], boxes[0].min.data() + 1);
  EXPECT_EQ(BoxesOf(std::span(boxes)).count, 2u);
  EXPECT_EQ(BoxesOf(std::span<const Aabb3>(boxes)).count, 2u);
  EXPECT_EQ(BoxesOf(Span<const Aabb3>(boxes)).count, 2u);
  EXPECT_EQ(BoxesOf(array).count, 1u);
  EXPECT_EQ(BoxesOf<3>(boxes).count, 2u);
}

}  // namespace
}  // namespace halfspace::testing

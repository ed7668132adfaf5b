// The duties of a caller that kernels.h asserts. The calls are compiled again
// for this test, without NDEBUG.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "halfspace/kernels.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

constexpr char kMessage[] = "Assertion.*AreValid";

// Arguments of a call, which are valid as long as no test changes them.
struct Arguments {
  std::array<float, 8> values{};
  std::array<const float*, 7> planes;
  std::array<std::uint64_t, 2> words{};
  const float* const* planes_of_call;
  std::size_t n = 1;
  const float* query = values.data();
  std::uint64_t* mask = words.data();

  Arguments() {
    planes.fill(values.data());
    planes_of_call = planes.data();
  }
  void CallOne() const { SurvivorsOfBoxes3(planes_of_call, n, query, mask); }
  void CallSeveral() const {
    SurvivorsOfBoxes3(planes_of_call, n, query, 1, mask);
  }
};

TEST(KernelsAssertionsDeathTest, NullAndMisalignedPointers) {
  for (bool is_null : {false, true}) {
    const auto spoil = [&](auto*& pointer) {
      pointer = is_null ? nullptr : Misaligned(pointer);
    };
    Arguments all[4];
    spoil(all[0].planes_of_call);
    spoil(all[1].planes[5]);
    spoil(all[2].query);
    spoil(all[3].mask);
    for (const Arguments& arguments : all) {
      EXPECT_DEATH(arguments.CallOne(), kMessage);
      EXPECT_DEATH(arguments.CallSeveral(), kMessage);
    }
  }
}

TEST(KernelsAssertionsDeathTest, WhatIsValid) {
  Arguments arguments;
  arguments.planes[6] = nullptr;  // A box has six.
  arguments.CallOne();
  EXPECT_EQ(arguments.words[0], 1u);
  arguments.words[0] = 0;
  arguments.CallSeveral();
  EXPECT_EQ(arguments.words[0], 1u);
  // Without objects any pointer may be null.
  arguments.n = 0;
  arguments.planes_of_call = nullptr;
  arguments.query = nullptr;
  arguments.mask = nullptr;
  arguments.CallOne();
  arguments.CallSeveral();
}

}  // namespace
}  // namespace halfspace::testing

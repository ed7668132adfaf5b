// The duties of a caller that kernels.h asserts. The calls are compiled again
// for this test, without NDEBUG.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "halfspace/kernels.h"

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

// The pointer one byte further.
template <typename T>
T* Misaligned(T* pointer) {
  return reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(pointer) + 1);
}

void ExpectDeath(const Arguments& arguments) {
  EXPECT_DEATH(arguments.CallOne(), kMessage);
  EXPECT_DEATH(arguments.CallSeveral(), kMessage);
}

TEST(KernelsAssertionsDeathTest, NullPointers) {
  Arguments without_planes;
  without_planes.planes_of_call = nullptr;
  ExpectDeath(without_planes);
  Arguments without_last_plane;
  without_last_plane.planes[5] = nullptr;
  ExpectDeath(without_last_plane);
  Arguments without_query;
  without_query.query = nullptr;
  ExpectDeath(without_query);
  Arguments without_mask;
  without_mask.mask = nullptr;
  ExpectDeath(without_mask);
}

TEST(KernelsAssertionsDeathTest, MisalignedPointers) {
  Arguments planes;
  planes.planes_of_call = Misaligned(planes.planes.data());
  ExpectDeath(planes);
  Arguments last_plane;
  last_plane.planes[5] = Misaligned(last_plane.planes[5]);
  ExpectDeath(last_plane);
  Arguments query;
  query.query = Misaligned(query.query);
  ExpectDeath(query);
  Arguments mask;
  mask.mask = Misaligned(mask.mask);
  ExpectDeath(mask);
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

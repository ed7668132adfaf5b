// Many threads make the first call of the process at once. Alone in its
// executable, since there is only one first call.
#include <gtest/gtest.h>

#include <array>
#include <barrier>
#include <cstddef>
#include <thread>
#include <vector>

#include "halfspace/reject.h"
#include "halfspace/world.h"

namespace halfspace::testing {
namespace {

TEST(DispatchRaceTest, AllThreadsGetTheChosenTargetAndTheAnswer) {
  constexpr std::size_t kThreads = 16;
  constexpr std::size_t kObjects = 1000;
  const AaboWorld3 world(std::vector<Aabo3>(kObjects, Aabo3::Everything()));
  std::array<SurvivorCount, kThreads> counted;
  std::barrier start(kThreads);
  {
    std::vector<std::jthread> threads;
    for (SurvivorCount& mine : counted) {
      threads.emplace_back([&world, &start, &mine] {
        start.arrive_and_wait();
        mine = CountSurvivors(world, Aabo3::Everything());
      });
    }
  }
  for (const SurvivorCount& one : counted) {
    EXPECT_EQ(one.count, kObjects);
    EXPECT_EQ(one.target, ChosenTarget());
  }
}

}  // namespace
}  // namespace halfspace::testing

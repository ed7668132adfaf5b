// Many threads make the first call of the process at once. Alone in its
// executable, since there is only one first call.
#include <gtest/gtest.h>

#include <array>
#include <barrier>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

#include "halfspace/kernels.h"
#include "halfspace/reject.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"
#include "tests/library/support/target_that_runs.h"

namespace halfspace::testing {
namespace {

TEST(DispatchRaceTest, AllThreadsGetTheChosenTargetAndTheAnswer) {
  constexpr std::size_t kThreads = 16;
  constexpr std::size_t kObjects = 1000;
  const AaboWorld3 world(std::vector<Aabo3>(kObjects, Aabo3::Everything()));
  struct Answer {
    std::size_t survivors = 0;
    Target ran;
    std::uint64_t mask = 0;
  };
  std::array<Answer, kThreads> answers;
  std::barrier start(kThreads);
  std::vector<std::thread> threads;
  for (Answer& mine : answers) {
    threads.emplace_back([&world, &start, &mine] {
      start.arrive_and_wait();
      mine.ran = TargetThatRuns(world, Aabo3::Everything(), {});
      mine.survivors = CountSurvivors(world, Aabo3::Everything());
      // These calls keep the chosen target by themselves.
      const float values[] = {0, 0, 0, 0};
      const float* const planes[] = {values, values, values, values};
      SurvivorsOfSimplices3(planes, 1, values, &mine.mask);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Answer& one : answers) {
    EXPECT_EQ(one.survivors, kObjects);
    EXPECT_EQ(one.ran, ChosenTarget());
    EXPECT_EQ(one.mask, 1u);
  }
}

}  // namespace
}  // namespace halfspace::testing

// Handlers are exchanged while other threads make calls that are wrong: each is
// told to the handler there is, by the thread that made the call.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

#include "halfspace/error.h"
#include "halfspace/world.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

struct Told {
  int by;
  std::string message;
};
thread_local std::size_t told_here = 0;

template <int kNumber>
[[noreturn]] void Tell(const Error& error) {
  ++told_here;
  throw Told{kNumber, error.what()};
}

TEST(ErrorThreadsTest, EachThreadIsToldOfItsOwn) {
  const std::size_t calls = Scaled(1000);
  std::array<std::size_t, 4> right{};
  std::atomic<std::size_t> running = right.size();
  SetErrorHandler(&Tell<0>);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < right.size(); ++t) {
    threads.emplace_back([&, t] {
      const AabbWorld3 world;
      const std::string end = "got " + std::to_string(t);
      for (std::size_t i = 0; i < calls; ++i) {
        try {
          world.Get(t);
        } catch (const Told& told) {
          right[t] +=
              told.message.ends_with(end) && told.by <= 1 && told_here == i + 1;
        }
      }
      --running;
    });
  }
  while (running != 0) {
    EXPECT_EQ(SetErrorHandler(&Tell<1>), &Tell<0>);
    EXPECT_EQ(SetErrorHandler(&Tell<0>), &Tell<1>);
  }
  for (std::thread& thread : threads) thread.join();
  SetErrorHandler(nullptr);
  for (std::size_t count : right) EXPECT_EQ(count, calls);
}

}  // namespace
}  // namespace halfspace::testing

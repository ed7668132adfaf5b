// The library compiled without exceptions: its files that throw are compiled so
// into this program.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "halfspace/error.h"
#include "halfspace/world.h"

namespace halfspace::testing {
namespace {

constexpr const char kText[] =
    "halfspace: World::Get: index: expected less than the size, 0, got 7";

TEST(WithoutExceptionsDeathTest, TheMessageIsPrinted) {
  EXPECT_EXIT(AabbWorld3().Get(7), ::testing::KilledBySignal(SIGABRT), kText);
}

TEST(WithoutExceptionsDeathTest, OrTold) {
  EXPECT_EXIT(
      {
        SetErrorHandler([](const Error& error) {
          std::fprintf(stderr, "told: %s\n", error.what());
          std::_Exit(3);
        });
        AabbWorld3().Get(7);
      },
      ::testing::ExitedWithCode(3), std::string("told: ") + kText);
}

}  // namespace
}  // namespace halfspace::testing

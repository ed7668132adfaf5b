// The program's own handler of errors. That it is told what would be thrown, of
// every error there is, is checked by Refuses() (expect_invalid.h).
#include <gtest/gtest.h>

#include <cfenv>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "halfspace/error.h"
#include "halfspace/fit.h"
#include "halfspace/world.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

void GetFromNothing() { AabbWorld3().Get(7); }
constexpr const char kText[] =
    "halfspace: World::Get: index: expected less than the size, 0, got 7";

void Return(const char*) {}
void Exit(const char* message) {
  std::fprintf(stderr, "%s\n", message);
  std::_Exit(3);
}

TEST(ErrorHandlerTest, TheOneBeforeIsReturned) {
  EXPECT_EQ(SetErrorHandler(&Return), nullptr);
  EXPECT_EQ(SetErrorHandler(&Exit), &Return);
  EXPECT_EQ(SetErrorHandler(nullptr), &Exit);
  EXPECT_THROW(GetFromNothing(), std::invalid_argument);
  EXPECT_TRUE(Refuses(&GetFromNothing, {kText}));
}

TEST(ErrorHandlerDeathTest, MayEndTheProgram) {
  EXPECT_EXIT(
      {
        SetErrorHandler(&Exit);
        GetFromNothing();
      },
      ::testing::ExitedWithCode(3), kText);
}

TEST(ErrorHandlerDeathTest, IsNotToReturn) {
  EXPECT_EXIT(
      {
        SetErrorHandler(&Return);
        GetFromNothing();
      },
      ::testing::KilledBySignal(SIGABRT), "");
}

struct Thrown {};
bool has_callers_mode;
void Throw(const char*) {
  has_callers_mode = std::fegetround() == FE_UPWARD &&
                     (FlushDenormals::IsOn() || !FlushDenormals::kAvailable);
  throw Thrown();
}

// Builders look at floats in a mode of their own.
TEST(ErrorHandlerTest, HasTheFloatingPointModeOfTheCaller) {
  const RoundingMode upward(FE_UPWARD);
  const FlushDenormals flush;
  has_callers_mode = false;
  SetErrorHandler(&Throw);
  EXPECT_THROW(BoundSphere(Sphere3{{0, 0, 0}, -1}), Thrown);
  SetErrorHandler(nullptr);
  EXPECT_TRUE(has_callers_mode);
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  EXPECT_EQ(FlushDenormals::IsOn(), FlushDenormals::kAvailable);
}

}  // namespace
}  // namespace halfspace::testing

// What libFuzzer calls, in every fuzzer. The failed expectation says what is
// wrong, and the process ends, so that the fuzzer keeps the bytes.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  halfspace::testing::Random random({data, size});
  halfspace::testing::Fuzz(random);
  if (::testing::Test::HasFailure()) std::abort();
  return 0;
}

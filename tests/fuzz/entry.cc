// What libFuzzer calls, in every fuzzer.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/run_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  halfspace::testing::Bytes bytes(data, size);
  halfspace::testing::RunInput(bytes);
  return 0;
}

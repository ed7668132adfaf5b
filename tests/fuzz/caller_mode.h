// The floating-point mode of a caller, which must make no difference.
#ifndef HALFSPACE_TESTS_FUZZ_CALLER_MODE_H_
#define HALFSPACE_TESTS_FUZZ_CALLER_MODE_H_

#include <array>
#include <cfenv>
#include <cstddef>
#include <ostream>

#include "tests/fuzz/bytes.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {

class CallerMode {
 public:
  explicit CallerMode(Bytes& bytes) : mode_(bytes.Below(kNames.size())) {}

  template <typename Call>
  void Run(const Call& call) const {
    if (mode_ == 1) {
      const FlushDenormals flush;
      call();
    } else {
      const RoundingMode rounding(kRoundings[mode_]);
      call();
    }
  }

  friend std::ostream& operator<<(std::ostream& out, const CallerMode& mode) {
    return out << kNames[mode.mode_];
  }

 private:
  static constexpr std::array kNames = {"to nearest", "subnormals flushed",
                                        "upward", "downward", "towards zero"};
  static constexpr int kRoundings[] = {FE_TONEAREST, FE_TONEAREST, FE_UPWARD,
                                       FE_DOWNWARD, FE_TOWARDZERO};

  std::size_t mode_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_CALLER_MODE_H_

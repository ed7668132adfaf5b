// Bounds of shapes and of bounds, by any row of the builders, against exact
// arithmetic.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <ostream>
#include <span>
#include <utility>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/exact_answers.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

const std::vector<Builder>& Rows() {
  static const std::vector<Builder> rows = [] {
    std::vector<Builder> all = Builders({2, 3, 4});
    for (const Builder& change : Changes({2, 3, 4})) all.push_back(change);
    return all;
  }();
  return rows;
}

class FitInput {
 public:
  explicit FitInput(Bytes& bytes)
      : mode_(kFpModes[bytes.Below(5)]),
        builder_(Rows()[bytes.Below(Rows().size())]) {
    if (builder_.kind == Kind::kFrustum) {
      FillFrustum(bytes);
      return;
    }
    for (std::size_t i = 0; i < builder_.roles.size(); ++i)
      FillNumber(i, bytes);
    if (MovesVertices()) {
      for (std::size_t i = 0; i < 3 * builder_.dims; ++i) {
        vertices_.floats[i] = bytes.Float();
      }
    } else if (builder_.kind == Kind::kChange) {
      MakeSpecial(0, bytes);
      if (builder_.change == Change::kMerge) {
        MakeSpecial(builder_.first_argument(), bytes);
      }
    } else if (bytes.Below(4) != 0) {
      MakeValid();
    }
  }

  ::testing::AssertionResult Check() const {
    Shape shape = shape_;
    if (MovesVertices()) SetPlanesOfVertices(builder_, vertices_, shape);
    Outcome outcome;
    RunIn(mode_, [&] { outcome = Try(builder_, shape); });
    auto result = MovesVertices() ? EnclosesMovedVertices(builder_, vertices_,
                                                          shape, outcome)
                                  : IsExact(builder_, shape, outcome);
    return result << "\nthe result: " << Print(outcome.planes);
  }

  friend std::ostream& operator<<(std::ostream& out, const FitInput& input) {
    const auto numbers = [&](const auto& all) {
      return Print(std::span(all).first(input.builder_.roles.size()));
    };
    return out << input.builder_.name << ", floats "
               << numbers(input.shape_.floats) << ", doubles "
               << numbers(input.shape_.doubles) << ", vertices "
               << Print(std::span(input.vertices_.floats)
                            .first(3 * input.builder_.dims))
               << ", in the mode " << static_cast<int>(input.mode_);
  }

 private:
  bool MovesVertices() const {
    return builder_.kind == Kind::kChange &&
           builder_.change == Change::kTranslateVertices;
  }

  void FillNumber(std::size_t i, Bytes& bytes) {
    if (builder_.IsDouble(i)) {
      shape_.doubles[i] = bytes.Double();
    } else {
      shape_.floats[i] = bytes.Float();
    }
  }

  // Products of two of these are as small as the last bits of a double, so that
  // corners come to lie next to a float.
  static double Small(Bytes& bytes) {
    return (static_cast<double>(bytes.Below(8)) - 4) * 0x1p-26;
  }

  // Mostly what closes: the first planes are those of a box, tilted.
  void FillFrustum(Bytes& bytes) {
    const std::size_t tilted = bytes.Below(7);
    const bool is_barely = bytes.Below(2) != 0;
    for (std::size_t i = 0; i < 6; ++i) {
      if (i >= tilted) {
        for (std::size_t n = 0; n < 4; ++n) FillNumber(4 * i + n, bytes);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) shape_.Set(4 * i + k, 0);
      shape_.Set(4 * i + i / 2, i % 2 == 0 ? 1 : -1);
      shape_.Set(4 * i + 3, 1);
      const std::size_t tilt = 4 * i + bytes.Below(3);
      is_barely ? shape_.Set(tilt, Small(bytes)) : FillNumber(tilt, bytes);
      const std::size_t how = bytes.Below(3);
      if (how == 0) FillNumber(4 * i + 3, bytes);
      if (how == 1) shape_.Set(4 * i + 3, Small(bytes));
    }
  }

  // No negative length, and no inverted box.
  void MakeValid() {
    const auto make = [&](auto& numbers) {
      for (std::size_t i = 0; i < builder_.roles.size(); ++i) {
        auto& number = numbers[i];
        if (builder_.roles[i] == Role::kLength) number = std::fabs(number);
        if (builder_.roles[i] != Role::kMinimum) continue;
        auto& maximum = numbers[i + builder_.dims];
        if (number > maximum) std::swap(number, maximum);
      }
    };
    make(shape_.floats);
    make(shape_.doubles);
  }

  // Now and then a bound is Everything(), Empty(), or as engines initialise
  // boxes.
  void MakeSpecial(std::size_t first, Bytes& bytes) {
    const std::size_t how = bytes.Below(8);
    if (how > 2) return;
    constexpr float kMinima[] = {std::numeric_limits<float>::infinity(),
                                 -std::numeric_limits<float>::max(),
                                 std::numeric_limits<float>::max()};
    for (std::size_t i = 0; i < builder_.first_argument(); ++i) {
      const bool is_minimum = builder_.roles[i] == Role::kMinimum;
      shape_.floats[first + i] = is_minimum ? kMinima[how] : -kMinima[how];
    }
  }

  FpMode mode_;
  const Builder& builder_;
  Shape shape_;
  Shape vertices_;
};

}  // namespace

void RunInput(Bytes& bytes) { Run<FitInput>(bytes); }

}  // namespace halfspace::testing

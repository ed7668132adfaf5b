// Bounds of what six planes enclose, against exact corners.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <vector>

#include "halfspace/fit.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/polytope.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"

namespace halfspace::testing {
namespace {

class Frustum {
 public:
  explicit Frustum(Bytes& bytes) : mode_(bytes) {
    // Mostly what closes: the first planes are those of a box, tilted.
    const std::size_t tilted = bytes.Below(7);
    const bool is_barely = bytes.Below(2) != 0;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      HalfSpace3& plane = planes_[i];
      if (i < tilted) {
        plane = {{}, 1};
        plane.normal[i / 2] = i % 2 == 0 ? 1.f : -1.f;
        float& tilt = plane.normal[bytes.Below(3)];
        tilt = is_barely ? Small(bytes) : bytes.Float();
        const std::size_t how = bytes.Below(3);
        if (how == 0) plane.offset = bytes.Float();
        if (how == 1) plane.offset = Small(bytes);
      } else {
        bytes.Fill(plane.normal);
        plane.offset = bytes.Float();
      }
    }
  }

  ::testing::AssertionResult Check() const {
    Aabo3 bound;
    mode_.Run([&] { bound = BoundFrustum(planes_); });
    const bool is_everything = bound == Aabo3::Everything();
    Polytope polytope;
    for (const auto& [normal, offset] : planes_) {
      for (float value : {normal[0], normal[1], normal[2], offset}) {
        if (std::isfinite(value)) continue;
        if (is_everything) return ::testing::AssertionSuccess();
        return ::testing::AssertionFailure() << "bounds what is not finite";
      }
      polytope.Add({normal, offset});
    }
    if (polytope.IsOpen()) {
      if (is_everything) return ::testing::AssertionSuccess();
      return ::testing::AssertionFailure() << "bounds what is open";
    }
    return CheckCorners(polytope, bound)
           << "\nthe bound: min " << Print(bound.min) << ", max "
           << Print(bound.max);
  }

  friend std::ostream& operator<<(std::ostream& out, const Frustum& frustum) {
    out << "the planes";
    for (const auto& [normal, offset] : frustum.planes_) {
      out << ' ' << Print(normal) << " . p + " << Print(std::array{offset})
          << " >= 0,";
    }
    return out << " in the mode " << frustum.mode_;
  }

 private:
  // Products of two of these are as small as the last bits of a double, so that
  // corners come to lie next to a float.
  static float Small(Bytes& bytes) {
    return (static_cast<float>(bytes.Below(8)) - 4) * 0x1p-26f;
  }

  static ::testing::AssertionResult CheckCorners(const Polytope& polytope,
                                                 const Aabo3& bound) {
    const auto corners = polytope.FindCorners();
    if (bound == Aabo3::Everything()) {
      const auto is_far = [](const ExactPoint<3>& corner) {
        return SumOfMagnitudes(corner) > mpq_class(0x1.fp124);
      };
      if (std::any_of(corners.begin(), corners.end(), is_far)) {
        return ::testing::AssertionSuccess();
      }
      return ::testing::AssertionFailure() << "everything";
    }
    if (bound == Aabo3::Empty()) {
      if (corners.empty()) return ::testing::AssertionSuccess();
      return ::testing::AssertionFailure() << "empty";
    }
    ExactShape<3> exact;
    for (const auto& corner : corners) exact.AddPoint(corner);
    exact.Tolerate({.ulps = 1}, {.ulps = 1});
    const auto result = exact.CheckEncloses(bound);
    return result ? exact.CheckTight(bound) : result;
  }

  CallerMode mode_;
  std::array<HalfSpace3, 6> planes_;
};

}  // namespace

void RunInput(Bytes& bytes) { Run<Frustum>(bytes); }

}  // namespace halfspace::testing

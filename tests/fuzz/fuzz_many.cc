// The bulk builders: against exact arithmetic, on every target, into planes of
// any alignment.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <vector>

#include "halfspace/fit_many.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/many_hulls.h"
#include "tests/fuzz/many_shapes.h"
#include "tests/fuzz/print.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// Planes with canaries around the `size` elements of each that count.
template <int kDims>
class GuardedPlanes {
 public:
  static constexpr std::size_t kAxes = kDims + 1;

  GuardedPlanes(std::size_t size, std::size_t offset)
      : size_(size), offset_(kEach + offset) {
    for (auto& plane : planes_) plane.assign(size + offset_ + kEach, kCanary);
  }

  float* min(std::size_t axis) { return planes_[axis].data() + offset_; }
  float* max(std::size_t axis) { return min(kAxes + axis); }
  std::size_t size() const { return size_; }

  std::uint32_t Bits(std::size_t plane, std::size_t i) const {
    return std::bit_cast<std::uint32_t>(planes_[plane][offset_ + i]);
  }

  // Nothing was written but elements of the planes whose bit in `wanted` is 1.
  bool Intact(std::uint32_t wanted) const {
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      const bool is_wanted = (wanted >> p & 1) != 0;
      for (std::size_t i = 0; i < planes_[p].size(); ++i) {
        const bool is_element = i >= offset_ && i < offset_ + size_;
        if (is_wanted && is_element) continue;
        if (planes_[p][i] != kCanary) return false;
      }
    }
    return true;
  }

 private:
  static constexpr float kCanary = -0x1.234568p100f;
  static constexpr std::size_t kEach = 16;  // as many floats as a vector has

  std::size_t size_;
  std::size_t offset_;
  std::array<std::vector<float>, 2 * kAxes> planes_;
};

template <int kDims>
AaboPlanes<kDims> WholeOf(GuardedPlanes<kDims>& planes) {
  AaboPlanes<kDims> whole{.size = planes.size()};
  for (std::size_t k = 0; k <= kDims; ++k) {
    whole.min[k] = planes.min(k);
    whole.max[k] = planes.max(k);
  }
  return whole;
}

template <int kDims>
SimplexPlanes<kDims> SimplexOf(GuardedPlanes<kDims>& planes) {
  return {WholeOf(planes).min, planes.size()};
}

template <int kDims>
AabbPlanes<kDims> AabbOf(GuardedPlanes<kDims>& planes) {
  AabbPlanes<kDims> box{.size = planes.size()};
  for (std::size_t k = 0; k < kDims; ++k) {
    box.min[k] = planes.min(k);
    box.max[k] = planes.max(k);
  }
  return box;
}

template <int kDims>
DPlanes<kDims> DOf(GuardedPlanes<kDims>& planes) {
  return {planes.min(kDims), planes.max(kDims), planes.size()};
}

std::vector<std::size_t> DecodeChoices(Bytes& bytes) {
  std::vector<std::size_t> choices(bytes.Below(150));
  const std::uint32_t pattern = bytes.Word();
  for (std::size_t i = 0; i < choices.size(); ++i) {
    choices[i] = std::rotl(pattern, static_cast<int>(7 * i)) % kMostDistinct;
  }
  return choices;
}

template <template <int> class Source, int kDims>
class Many {
 public:
  explicit Many(Bytes& bytes)
      : mode_(bytes),
        options_{.tightest = bytes.Below(2) != 0,
                 .inverted = bytes.Below(2) != 0 ? Inverted::kEmpty
                                                 : Inverted::kEverything},
        offset_(bytes.Below(16)),
        wanted_(bytes.Below(4)),
        choices_(DecodeChoices(bytes)),
        source_(bytes, choices_) {}

  ::testing::AssertionResult Check() const {
    const std::vector<Target> targets = TargetsUnderTest();
    GuardedPlanes<kDims> expected(choices_.size(), 0);
    FitStatus expected_status;
    FitOptions options = options_;
    options.target = targets.back();
    mode_.Run(
        [&] { source_.Call(WholeOf(expected), options, &expected_status); });
    auto result = CheckExact(expected, expected_status);
    if (!result) return result;
    for (Target target : targets) {
      options.target = target;
      GuardedPlanes<kDims> given(choices_.size(), offset_);
      FitStatus status;
      Target ran;
      std::uint32_t wanted = 0;
      mode_.Run([&] { ran = CallWanted(given, options, wanted, status); });
      if (ran != target) return Wrong(target) << "ran on " << ran.name();
      if (!given.Intact(wanted)) return Wrong(target) << "wrote elsewhere";
      if (!SameStatus(status, expected_status)) {
        return Wrong(target) << "a wrong status";
      }
      for (std::size_t p = 0; p < 2 * (kDims + 1); ++p) {
        if ((wanted >> p & 1) == 0) continue;
        for (std::size_t i = 0; i < choices_.size(); ++i) {
          if (given.Bits(p, i) == expected.Bits(p, i)) continue;
          return Wrong(target)
                 << "plane " << p << ", element " << i << ": expected the bits "
                 << std::hex << expected.Bits(p, i) << ", got "
                 << given.Bits(p, i);
        }
      }
    }
    return ::testing::AssertionSuccess();
  }

  friend std::ostream& operator<<(std::ostream& out, const Many& many) {
    return out << many.source_ << "\nelements " << Print(many.choices_)
               << "\ntightest " << many.options_.tightest << ", inverted "
               << static_cast<int>(many.options_.inverted) << ", offset "
               << many.offset_ << ", planes of kind " << many.wanted_
               << ", in the mode " << many.mode_;
  }

 private:
  static ::testing::AssertionResult Wrong(Target target) {
    return ::testing::AssertionFailure() << "on " << target.name() << ": ";
  }

  static bool SameStatus(const FitStatus& a, const FitStatus& b) {
    return a.results == b.results && a.everything == b.everything &&
           a.first_everything == b.first_everything;
  }

  Target CallWanted(GuardedPlanes<kDims>& planes, const FitOptions& options,
                    std::uint32_t& wanted, FitStatus& status) const {
    const auto call = [&](const auto& some) {
      wanted = detail::OutputOf(some).wanted;
      return source_.Call(some, options, &status);
    };
    if (wanted_ == 0) return call(WholeOf(planes));
    if (wanted_ == 1) return call(SimplexOf(planes));
    if (wanted_ == 2) return call(AabbOf(planes));
    return call(DOf(planes));
  }

  // Each different shape once; its other copies must have the same bits.
  ::testing::AssertionResult CheckExact(GuardedPlanes<kDims>& planes,
                                        const FitStatus& status) const {
    std::array<std::size_t, kMostDistinct> first;
    first.fill(choices_.size());
    FitStatus expected{.results = choices_.size()};
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      Aabo<kDims> bound;
      for (std::size_t k = 0; k <= kDims; ++k) {
        bound.min[k] = planes.min(k)[i];
        bound.max[k] = planes.max(k)[i];
      }
      if (bound == Aabo<kDims>::Everything() && expected.everything++ == 0) {
        expected.first_everything = i;
      }
      std::size_t& earlier = first[choices_[i]];
      if (earlier == choices_.size()) {
        earlier = i;
        ExactShape<kDims> exact;
        source_.Describe(choices_[i], options_, exact);
        auto result = exact.Check(bound);
        if (!result) {
          return result << "\nelement " << i << ": min " << Print(bound.min)
                        << ", max " << Print(bound.max);
        }
      }
      for (std::size_t p = 0; p < 2 * (kDims + 1); ++p) {
        if (planes.Bits(p, i) != planes.Bits(p, earlier)) {
          return ::testing::AssertionFailure()
                 << "elements " << i << " and " << earlier
                 << " are the same shape, and have different bounds";
        }
      }
    }
    if (SameStatus(status, expected)) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "a wrong status";
  }

  CallerMode mode_;
  FitOptions options_;
  std::size_t offset_;
  std::size_t wanted_;
  std::vector<std::size_t> choices_;
  Source<kDims> source_;
};

template <int kDims>
using Inputs =
    ::testing::Types<Many<ManyBoxes, kDims>, Many<ManySpheres, kDims>,
                     Many<ManyTriangles, kDims>, Many<ManyPointSets, kDims>>;

}  // namespace

void RunInput(Bytes& bytes) { RunOneOfAllDims<Inputs>(bytes); }

}  // namespace halfspace::testing

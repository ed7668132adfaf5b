// The preconditions of the calls: who broke which, and nothing written.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/reject.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/misaligned.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kObjects = 130;  // 3 words

template <typename Case>
class RejectErrorsTest : public ::testing::Test {
 protected:
  using View = typename Case::View;
  using Scalar = ScalarOf<View>;

  RejectErrorsTest() {
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      PlaneOf(view_, p) = Plane(p).data();
      OpposingValue<View>(query_, p) = 0;
    }
    view_.size = kObjects;
  }

  // Planes two elements apart from one another, so that an output fits between.
  static constexpr std::size_t kStride = kObjects + 2;
  std::span<Scalar> Plane(std::size_t p) {
    return std::span(block_).subspan(2 + p * kStride, kObjects);
  }

  static std::string PlaneName(std::size_t p) {
    const bool is_min = IsMinPlane<View>(p);
    const std::size_t k = is_min ? p : p - kMinima<View>;
    return std::string("world.") + (is_min ? "min[" : "max[") +
           std::to_string(k) + "]";
  }

  // All five calls refuse, each in its own name, and write nothing.
  void ExpectAllRefuse(const View& view, const Options& options,
                       std::string_view argument, std::string_view expected,
                       std::string_view given) {
    ForEachCall(
        view, query_, options, outputs_, [&](std::string_view name, auto call) {
          EXPECT_TRUE(Refuses(call, {"halfspace: ", name, argument, "expected",
                                     expected, "got", given}));
        });
    EXPECT_TRUE(outputs_.Untouched());
  }

  // Both mask calls refuse `mask`, and the planes are as they were.
  void ExpectMaskRefused(std::span<std::uint64_t> mask,
                         std::string_view expected, std::string_view given) {
    const std::vector<Scalar> before = block_;
    EXPECT_TRUE(
        Refuses([&] { RejectMask(view_, query_, mask); },
                {"RejectMask: mask: expected", expected, "got", given}));
    EXPECT_TRUE(
        Refuses([&] { SurvivorMask(view_, query_, mask); },
                {"SurvivorMask: mask: expected", expected, "got", given}));
    EXPECT_EQ(block_, before);
  }

  void ExpectIndicesRefused(std::span<std::uint32_t> indices,
                            std::string_view expected, std::string_view given) {
    const std::vector<Scalar> before = block_;
    EXPECT_TRUE(
        Refuses([&] { (void)Survivors(view_, query_, indices); },
                {"Survivors: indices: expected", expected, "got", given}));
    EXPECT_EQ(block_, before);
  }

  View view_;
  typename View::Query query_;
  CallOutputs outputs_;
  std::vector<Scalar> block_ = std::vector<Scalar>(2 + kPlanes<View> * kStride);
};

TYPED_TEST_SUITE(RejectErrorsTest, WholeCases, CaseNames);

TYPED_TEST(RejectErrorsTest, NullPlane) {
  constexpr bool kIsDouble = sizeof(typename TestFixture::Scalar) == 8;
  for (std::size_t p = 0; p < kPlanes<typename TypeParam::View>; ++p) {
    auto view = this->view_;
    PlaneOf(view, p) = nullptr;
    this->ExpectAllRefuse(
        view, {}, this->PlaneName(p) + ": ",
        kIsDouble ? "a plane of 130 doubles" : "a plane of 130 floats",
        "a null pointer");
  }
}

TYPED_TEST(RejectErrorsTest, MisalignedPlane) {
  constexpr bool kIsDouble = sizeof(typename TestFixture::Scalar) == 8;
  for (std::size_t p = 0; p < kPlanes<typename TypeParam::View>; ++p) {
    auto view = this->view_;
    PlaneOf(view, p) = Misaligned(PlaneOf(view, p));
    this->ExpectAllRefuse(view, {}, this->PlaneName(p) + ": ",
                          kIsDouble ? "a pointer aligned to 8 bytes"
                                    : "a pointer aligned to 4 bytes",
                          "a misaligned one");
  }
}

TYPED_TEST(RejectErrorsTest, SizeBeyondTheAddressSpace) {
  auto view = this->view_;
  for (std::size_t size : {std::numeric_limits<std::size_t>::max() /
                                   sizeof(typename TestFixture::Scalar) +
                               1,
                           std::numeric_limits<std::size_t>::max()}) {
    view.size = size;
    this->ExpectAllRefuse(view, {}, "world.size: ", "fits the address space",
                          std::to_string(size));
  }
}

TYPED_TEST(RejectErrorsTest, UnknownSchedule) {
  const Options options{.schedule = static_cast<Schedule>(17)};
  auto view = this->view_;
  this->ExpectAllRefuse(view, options,
                        "options.schedule: ", "one of the enumerators", "17");
  view.size = 0;
  this->ExpectAllRefuse(view, options,
                        "options.schedule: ", "one of the enumerators", "17");
}

TYPED_TEST(RejectErrorsTest, ShortMask) {
  std::vector<std::uint64_t> mask(3, 7);
  this->ExpectMaskRefused(std::span(mask).first(2),
                          "at least 3 words for 130 objects", "2");
  this->ExpectMaskRefused({}, "at least 3 words for 130 objects", "0");
  EXPECT_EQ(mask, std::vector<std::uint64_t>(3, 7));
}

TYPED_TEST(RejectErrorsTest, NullOutput) {
  std::uint64_t* no_words = nullptr;
  this->ExpectMaskRefused({no_words, 3}, "room for the output",
                          "a null pointer");
  std::uint32_t* no_indices = nullptr;
  this->ExpectIndicesRefused({no_indices, 1}, "room for the output",
                             "a null pointer");
}

TYPED_TEST(RejectErrorsTest, MisalignedOutput) {
  std::vector<std::uint64_t> mask(5, 7);
  this->ExpectMaskRefused({Misaligned(mask.data()), 3}, "aligned",
                          "a misaligned one");
  EXPECT_EQ(mask, std::vector<std::uint64_t>(5, 7));
  std::vector<std::uint32_t> indices(5, 7);
  this->ExpectIndicesRefused({Misaligned(indices.data()), 3}, "aligned",
                             "a misaligned one");
  EXPECT_EQ(indices, std::vector<std::uint32_t>(5, 7));
}

// By one element, at either end of the plane.
TYPED_TEST(RejectErrorsTest, OutputOverlapsAPlane) {
  for (std::size_t p = 0; p < kPlanes<typename TypeParam::View>; ++p) {
    const auto plane = this->Plane(p);
    const std::string overlap = "an overlap with " + this->PlaneName(p);
    auto* first = reinterpret_cast<std::uint64_t*>(plane.data());
    this->ExpectMaskRefused({first, 3}, "apart from the world's planes",
                            overlap);
    constexpr std::size_t kInWord = 8 / sizeof(typename TestFixture::Scalar);
    auto* last = reinterpret_cast<std::uint64_t*>(&plane[kObjects - kInWord]);
    this->ExpectMaskRefused({last, 3}, "apart from the world's planes",
                            overlap);
    auto* index = reinterpret_cast<std::uint32_t*>(&plane[kObjects - 1]);
    this->ExpectIndicesRefused({index, 1}, "apart from the world's planes",
                               overlap);
    index = reinterpret_cast<std::uint32_t*>(&plane[0]) - 1;
    this->ExpectIndicesRefused({index, 2}, "apart from the world's planes",
                               overlap);
  }
}

// Two elements lie between two planes: an output fits there exactly.
TYPED_TEST(RejectErrorsTest, OutputRightBesideAPlaneIsFine) {
  auto view = this->view_;
  view.size = 64;
  for (std::size_t p = 0; p + 1 < kPlanes<typename TypeParam::View>; ++p) {
    PlaneOf(view, p) = this->Plane(p).data() + (kObjects - 64);
  }
  for (std::size_t p = 0; p + 1 < kPlanes<typename TypeParam::View>; ++p) {
    auto* gap = this->Plane(p).data() + kObjects;
    EXPECT_NO_THROW(RejectMask(view, this->query_,
                               {reinterpret_cast<std::uint64_t*>(gap), 1}));
    EXPECT_EQ(*reinterpret_cast<std::uint64_t*>(gap), 0u);
    EXPECT_EQ(Survivors(view, this->query_,
                        {reinterpret_cast<std::uint32_t*>(gap), 2}),
              64u);
  }
}

// Two objects have no more than two survivors: what else the span has room for
// is never written, and may be a plane.
TYPED_TEST(RejectErrorsTest, RoomForMoreIndicesThanObjectsMayOverlap) {
  auto view = this->view_;
  view.size = 2;
  for (std::size_t p = 0; p + 1 < kPlanes<typename TypeParam::View>; ++p) {
    PlaneOf(view, p) = this->Plane(p).data() + (kObjects - 2);
    PlaneOf(view, p + 1) = this->Plane(p + 1).data();
    auto* gap =
        reinterpret_cast<std::uint32_t*>(this->Plane(p).data() + kObjects);
    EXPECT_EQ(Survivors(view, this->query_, {gap, 8}), 2u);
    EXPECT_EQ(gap[1], 1u);
  }
}

TYPED_TEST(RejectErrorsTest, MoreObjectsThanIndices) {
  auto view = this->view_;
  view.size = (std::size_t{1} << 32) + 1;
  const auto indices = this->outputs_.indices.Reset(5);
  EXPECT_TRUE(
      Refuses([&] { (void)Survivors(view, this->query_, indices); },
              {"Survivors: world.size: expected", "2^32", "got 4294967297"}));
  EXPECT_TRUE(this->outputs_.indices.IntactBut(0));
}

TYPED_TEST(RejectErrorsTest, EmptyWorldNeedsNoPlanesAndNoOutput) {
  const typename TypeParam::View view;
  const auto& query = this->query_;
  EXPECT_NO_THROW(RejectMask(view, query, {}));
  EXPECT_NO_THROW(SurvivorMask(view, query, {}));
  EXPECT_EQ(Survivors(view, query, {}), 0u);
  EXPECT_EQ(CountSurvivors(view, query), 0u);
  EXPECT_FALSE(AnySurvivor(view, query));
  ForEachCall(view, query, {}, this->outputs_,
              [](std::string_view, auto call) { call(); });
  EXPECT_TRUE(this->outputs_.Untouched());
}

}  // namespace
}  // namespace halfspace::testing

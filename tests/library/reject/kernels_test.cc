// Every pair of special values (object, query) in every plane and every lane,
// against a rule that looks only at their bits. And each function of kernels.h,
// and so of c/kernels.h, is that of its bound: the other tests call them by the
// tables of KernelsOf().
#include "halfspace/kernels.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

// The rule itself, by hand.
constexpr float kNan = std::bit_cast<float>(0x7fc00000u);
constexpr float kInfinity = std::bit_cast<float>(0x7f800000u);
static_assert(IsGreater(1.f, 0.f) && !IsGreater(0.f, 1.f));
static_assert(!IsGreater(1.f, 1.f));
static_assert(!IsGreater(0.f, -0.f) && !IsGreater(-0.f, 0.f));
static_assert(IsGreater(-1.f, -2.f) && !IsGreater(-2.f, -1.f));
static_assert(!IsGreater(kNan, 0.f) && !IsGreater(0.f, kNan));
static_assert(!IsGreater(kNan, kNan));
static_assert(IsGreater(kInfinity, 0x1.fffffep127f));
static_assert(IsGreater(-0x1.fffffep127f, -kInfinity));
static_assert(IsGreater(1.0 + 0x1p-52, 1.0) && !IsGreater(1.0, 1.0 + 0x1p-52));
static_assert(!IsGreater(0.0, -0.0) && IsGreater(-1.0, -2.0));
static_assert(!IsGreater(double{kNan}, 0.0) && !IsGreater(0.0, double{kNan}));
static_assert(IsGreater(double{kInfinity}, 0x1.fffffffffffffp1023));

// A word, then a tail with every lane of a vector, then a partial vector.
std::size_t Objects() { return 64 + 2 * MostLanes() - 1; }

// Special values in one plane, object i having value i + shift, and nothing
// that could reject in the other planes.
template <typename T>
class SpecialPlane {
 public:
  SpecialPlane(const FlatCase& kind, std::size_t plane, T query_value)
      : is_min_(kind.IsMinPlane(plane)), query_value_(query_value) {
    for (std::size_t p = 0; p < kind.seen.plane_count; ++p) {
      pointers_[p] = (kind.IsMinPlane(p) ? minima_ : maxima_).data();
    }
    pointers_[plane] = plane_.data();
    query_[kind.Opposing(plane)] = query_value;
    world_.emplace(kind.world(pointers_, Objects()));
  }
  SpecialPlane(const SpecialPlane&) = delete;
  SpecialPlane& operator=(const SpecialPlane&) = delete;

  void Shift(std::size_t shift) {
    for (std::size_t i = 0; i < Objects(); ++i) {
      plane_[i] = kSpecialValues<T>[(i + shift) % kSpecialValues<T>.size()];
    }
  }

  bool Rejects(std::size_t i) const {
    return is_min_ ? IsGreater(plane_[i], query_value_)
                   : IsGreater(query_value_, plane_[i]);
  }

  const AnyWorld& world() const { return *world_; }
  AnyQueries query() const { return {query_.data(), 1}; }

 private:
  bool is_min_;
  T query_value_;
  std::vector<T> plane_ = std::vector<T>(Objects());
  // Which a query of zeros does not reject.
  std::vector<T> minima_ = std::vector<T>(Objects(), T{-1});
  std::vector<T> maxima_ = std::vector<T>(Objects(), T{1});
  PlanePointers pointers_{};
  std::array<T, 10> query_{};
  std::optional<AnyWorld> world_;
};

class SpecialValuesTest : public ::testing::TestWithParam<FlatCase> {
 protected:
  // Calls check(plane) for every plane, query value and rotation of the values.
  // At a smaller scale, every seventh rotation: each value is in each lane at
  // full scale.
  template <typename Check>
  void ForEachPair(Check check) const {
    const std::size_t step = TestScale() < 1 ? 7 : 1;
    GetParam().WithScalar([&]<typename T>(T) {
      for (std::size_t p = 0; p < GetParam().seen.plane_count; ++p) {
        for (const T query_value : kSpecialValues<T>) {
          SpecialPlane<T> plane(GetParam(), p, query_value);
          for (std::size_t shift = 0; shift < kSpecialValues<T>.size();
               shift += step) {
            plane.Shift(shift);
            check(plane);
            if (HasFatalFailure()) return;
          }
        }
      }
    });
  }

  const std::vector<Target> targets_ = TargetsUnderTest();
};

TEST_P(SpecialValuesTest, FollowTheRuleInEveryLane) {
  ForEachPair([&](const auto& plane) {
    const Answers answers(Objects(),
                          [&](std::size_t i) { return plane.Rejects(i); });
    ASSERT_TRUE(
        AnswersEverywhere(answers, plane.world(), plane.query(), targets_));
  });
}

// A process may run with subnormals flushed to zero. That may cost survivors
// that could have been rejected, never the other way round.
TEST_P(SpecialValuesTest, NothingMoreIsRejectedWithSubnormalsFlushed) {
  std::vector<std::uint64_t> mask(MaskWords(Objects()));
  std::size_t kept_more = 0;
  ForEachPair([&](const auto& plane) {
    for (Target target : targets_) {
      for (Schedule schedule : kSchedules) {
        {
          const FlushDenormals flush;
          detail::RejectMask(plane.world().Asked(plane.query()), mask,
                             {.schedule = schedule, .target = target});
        }
        for (std::size_t i = 0; i < Objects(); ++i) {
          const bool rejected = ((mask[i / 64] >> (i % 64)) & 1) != 0;
          if (plane.Rejects(i) && !rejected) ++kept_more;
          if (!plane.Rejects(i)) {
            ASSERT_FALSE(rejected) << target.name() << ", object " << i;
          }
        }
      }
    }
  });
  // Else the mode was not on, and this has tested nothing.
  if (FlushDenormals::kAvailable) {
    EXPECT_GT(kept_more, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(, SpecialValuesTest,
                         ::testing::ValuesIn(WholeFlatCases()),
                         ::testing::PrintToStringParamName());

// The functions of kernels.h by their names.

template <typename T>
void ExpectSame(const typename Kernels<T>::OfBound& by_name,
                const typename Kernels<T>::OfBound& in_table) {
  constexpr std::size_t kObjects = 3 * 64 + 7;
  constexpr std::size_t kQueries = 3;
  constexpr std::size_t kMostPlanes = 10;
  std::mt19937 random(1);
  std::uniform_real_distribution<T> value(0, 1);
  std::vector<T> values(kMostPlanes * kObjects);
  for (T& v : values) v = value(random);
  std::array<const T*, kMostPlanes> planes;
  for (std::size_t p = 0; p < kMostPlanes; ++p) {
    planes[p] = &values[p * kObjects];
  }
  std::vector<T> queries(kQueries * kMostPlanes);
  for (T& v : queries) v = T{0.5} + value(random) / 4;
  using Masks = std::array<std::uint64_t, kQueries*(kObjects / 64 + 1)>;
  const auto masks_of = [&](const auto& functions) {
    Masks masks{};
    functions.several(planes.data(), kObjects, queries.data(), kQueries,
                      masks.data());
    return masks;
  };
  const auto mask_of = [&](const auto& functions) {
    Masks mask{};
    functions.one(planes.data(), kObjects, queries.data(), mask.data());
    return mask;
  };
  EXPECT_EQ(masks_of(by_name), masks_of(in_table));
  EXPECT_EQ(mask_of(by_name), mask_of(in_table));
}

TEST(KernelsByName, OfFloats) {
  const auto& table = KernelsOf<float>();
  ExpectSame<float>({&SurvivorsOfBoxes3, &SurvivorsOfBoxes3}, table.boxes3);
  ExpectSame<float>({&SurvivorsOfSimplices3, &SurvivorsOfSimplices3},
                    table.simplices3);
  ExpectSame<float>({&SurvivorsOfOctahedra3, &SurvivorsOfOctahedra3},
                    table.octahedra3);
#if !defined(HALFSPACE_TEST_ONLY_3D)  // which a library of 3D alone lacks
  ExpectSame<float>({&SurvivorsOfBoxes2, &SurvivorsOfBoxes2}, table.boxes2);
  ExpectSame<float>({&SurvivorsOfBoxes4, &SurvivorsOfBoxes4}, table.boxes4);
  ExpectSame<float>({&SurvivorsOfSimplices2, &SurvivorsOfSimplices2},
                    table.simplices2);
  ExpectSame<float>({&SurvivorsOfSimplices4, &SurvivorsOfSimplices4},
                    table.simplices4);
  ExpectSame<float>({&SurvivorsOfOctahedra2, &SurvivorsOfOctahedra2},
                    table.octahedra2);
  ExpectSame<float>({&SurvivorsOfOctahedra4, &SurvivorsOfOctahedra4},
                    table.octahedra4);
#endif
}
TEST(KernelsByName, OfDoubles) {
  const auto& table = KernelsOf<double>();
  ExpectSame<double>({&SurvivorsOfBoxes3, &SurvivorsOfBoxes3}, table.boxes3);
#if !defined(HALFSPACE_TEST_ONLY_3D)
  ExpectSame<double>({&SurvivorsOfBoxes2, &SurvivorsOfBoxes2}, table.boxes2);
  ExpectSame<double>({&SurvivorsOfBoxes4, &SurvivorsOfBoxes4}, table.boxes4);
#endif
}

}  // namespace
}  // namespace halfspace::testing

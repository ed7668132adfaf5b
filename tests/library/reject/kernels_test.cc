// Every pair of special values (object, query) in every plane and every lane,
// of one query and of several, also with subnormals flushed. And each function
// of kernels.h, and so of c/kernels.h, is that of its bound: the other tests
// call them by the tables of KernelsOf().
#include "halfspace/kernels.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

class SpecialValuesTest : public ::testing::TestWithParam<FlatCase> {};

// One plane has special values, and nothing in the others rejects. A process
// may run with subnormals flushed to zero. That may cost survivors that could
// have been rejected, never the other way round.
TEST_P(SpecialValuesTest, AreComparedInEveryLane) {
  const FlatCase& kind = GetParam();
  const std::vector<Target> targets = TargetsUnderTest();
  // A word, then a tail with every lane of a vector, then a partial vector.
  const std::size_t objects = 64 + 2 * MostLanes() - 1;
  // Each value is in each lane at full scale.
  const std::size_t step = TestScale() < 1 ? 7 : 1;
  std::vector<std::uint64_t> flushed(MaskWords(objects));
  // Some share each load, and the last one is by itself.
  constexpr std::size_t kQueries = 5;
  std::vector<std::uint64_t> rows(kQueries * flushed.size());
  bool is_flushed = false;
  bool kept_more = false;
  kind.WithScalar([&]<typename T>(T) {
    constexpr std::size_t kValues = kSpecialValues<T>.size();
    // Which a query of zeros does not reject.
    const std::vector<T> minima(objects, T{-1});
    const std::vector<T> maxima(objects, T{1});
    std::vector<T> special(objects + kValues);
    for (std::size_t i = 0; i < special.size(); ++i) {
      special[i] = kSpecialValues<T>[i % kValues];
    }
    PlanePointers pointers{};
    for (std::size_t p = 0; p < kind.layout.plane_count; ++p) {
      pointers[p] = (kind.IsMinPlane(p) ? minima : maxima).data();
    }
    for (std::size_t n = 0; n < kind.layout.plane_count * kValues; ++n) {
      const std::size_t p = n / kValues;
      std::array<T, 10 * kQueries> values{};
      for (std::size_t q = 0; q < kQueries; ++q) {
        values[q * kind.query_bytes() / sizeof(T) + kind.Opposing(p)] =
            kSpecialValues<T>[n % kValues];
      }
      const AnyQueries query(values.data(), 1);
      const AnyQueries queries(values.data(), kQueries);
      PlanePointers its_pointers = pointers;
      for (std::size_t shift = 0; shift < kValues; shift += step) {
        its_pointers[p] = &special[shift];
        const AnyWorld world = kind.world(its_pointers, objects);
        const Answers answers = Answers::OfReference(world, query);
        ASSERT_TRUE(AnswersEverywhere(answers, world, query, targets));
        for (Target target : targets) {
          for (Schedule schedule : kSchedules) {
            const Options options{.schedule = schedule, .target = target};
            const auto expect_rows = [&](std::span<const std::uint64_t> row) {
              detail::SurvivorMasks(world.Asked(queries), rows, options, 0);
              for (std::size_t w = 0; w < rows.size(); ++w) {
                ASSERT_EQ(rows[w], row[w % row.size()]) << target.name();
              }
            };
            expect_rows(answers.survived());
            {
              const FlushDenormals flush;
              is_flushed |= FlushDenormals::IsOn();
              detail::SurvivorMask(world.Asked(query), flushed, options);
              expect_rows(flushed);
            }
            if (HasFatalFailure()) return;
            for (std::size_t w = 0; w < flushed.size(); ++w) {
              ASSERT_EQ(answers.survived()[w] & ~flushed[w], 0u)
                  << target.name();
              kept_more |= flushed[w] != answers.survived()[w];
            }
          }
        }
      }
    }
  });
  EXPECT_EQ(kept_more, is_flushed);
}

INSTANTIATE_TEST_SUITE_P(, SpecialValuesTest,
                         ::testing::ValuesIn(AllFlatCases()),
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
  const auto masks_of = [&](const typename Kernels<T>::OfBound& functions) {
    std::array<std::uint64_t, (kQueries + 1) * (kObjects / 64 + 1)> masks{};
    functions.several(planes.data(), kObjects, queries.data(), kQueries,
                      masks.data());
    functions.one(planes.data(), kObjects, queries.data(),
                  &masks[kQueries * (kObjects / 64 + 1)]);
    return masks;
  };
  EXPECT_EQ(masks_of(by_name), masks_of(in_table));
}

TEST(KernelsByName, AreThoseOfTheTables) {
#define HALFSPACE_EXPECT_SAME(T, Name, entry) \
  ExpectSame<T>({&SurvivorsOf##Name, &SurvivorsOf##Name}, KernelsOf<T>().entry)
  HALFSPACE_EXPECT_SAME(float, Boxes3, boxes3);
  HALFSPACE_EXPECT_SAME(float, Simplices3, simplices3);
  HALFSPACE_EXPECT_SAME(float, Octahedra3, octahedra3);
  HALFSPACE_EXPECT_SAME(double, Boxes3, boxes3);
#if !defined(HALFSPACE_TEST_ONLY_3D)  // which a library of 3D alone lacks
  HALFSPACE_EXPECT_SAME(float, Boxes2, boxes2);
  HALFSPACE_EXPECT_SAME(float, Boxes4, boxes4);
  HALFSPACE_EXPECT_SAME(float, Simplices2, simplices2);
  HALFSPACE_EXPECT_SAME(float, Simplices4, simplices4);
  HALFSPACE_EXPECT_SAME(float, Octahedra2, octahedra2);
  HALFSPACE_EXPECT_SAME(float, Octahedra4, octahedra4);
  HALFSPACE_EXPECT_SAME(double, Boxes2, boxes2);
  HALFSPACE_EXPECT_SAME(double, Boxes4, boxes4);
#endif
#undef HALFSPACE_EXPECT_SAME
}

}  // namespace
}  // namespace halfspace::testing

// The functions of kernels-inl.h, of which scans make their words, on every
// target against a plain loop. Tests of the library have the other parts of
// scans: of quantized bounds, streaming and staged.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "kernels/compiled_targets.h"
#include "tests/library/support/environment.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/kernels/scan_test.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "halfspace/kernels-inl.h"

#ifndef HALFSPACE_TESTS_KERNELS_SCAN_TEST_TYPES_
#define HALFSPACE_TESTS_KERNELS_SCAN_TEST_TYPES_

namespace halfspace::testing {

// The word of `count` objects from object i on.
template <typename T>
using WordFunction = std::uint64_t (*)(const T* const* planes, std::size_t i,
                                       std::size_t count, const T* query);

// Planes of which the first `mins` are minima, and who makes words of them.
template <typename T>
struct WordCase {
  std::size_t mins = 0;
  std::size_t planes = 0;
  WordFunction<T> whole = nullptr;  // of 64 objects
  WordFunction<T> tail = nullptr;   // of at most 63
};

inline constexpr std::size_t kMostPlanes = 10;

// Boxes, and of floats simplices and octahedra, in 2, 3 and 4 dimensions.
template <typename T>
using WordCases = std::array<WordCase<T>, std::is_same_v<T, float> ? 9 : 3>;

// Specialised by each target's pass over this file.
template <std::int64_t kTarget, typename T>
inline constexpr WordCases<T> kWordCases{};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_KERNELS_SCAN_TEST_TYPES_

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// Queries have minima, then maxima; here query[p] is what plane p is compared
// with.
#define HALFSPACE_NAMED_CASE(name, kMins, kMaxs)                             \
  template <int kDims, typename T>                                           \
  struct Named##name {                                                       \
    static constexpr size_t kPlanes = (kMins) + (kMaxs);                     \
    struct Query {                                                           \
      explicit Query(const T* of_planes) {                                   \
        for (size_t p = 0; p < kPlanes; ++p) {                               \
          values[(p + (kMaxs)) % kPlanes] = of_planes[p];                    \
        }                                                                    \
      }                                                                      \
      T values[kPlanes];                                                     \
    };                                                                       \
    static uint64_t Of64(const T* const* planes, size_t i, size_t,           \
                         const T* query) {                                   \
      return SurvivorsOf64##name<kDims>(planes, i, Query(query).values);     \
    }                                                                        \
    static uint64_t OfFew(const T* const* planes, size_t i, size_t n,        \
                          const T* query) {                                  \
      return SurvivorsOfFew##name<kDims>(planes, i, n, Query(query).values); \
    }                                                                        \
    static constexpr testing::WordCase<T> Case() {                           \
      return {kMins, kPlanes, &Of64, &OfFew};                                \
    }                                                                        \
  };
HALFSPACE_NAMED_CASE(Boxes, kDims, kDims)
HALFSPACE_NAMED_CASE(Simplices, kDims + 1, 0)
HALFSPACE_NAMED_CASE(Octahedra, kDims + 1, kDims + 1)
#undef HALFSPACE_NAMED_CASE

template <int... kDims>
constexpr testing::WordCases<float> CasesOfFloats() {
  return {NamedBoxes<kDims, float>::Case()...,
          NamedSimplices<kDims, float>::Case()...,
          NamedOctahedra<kDims, float>::Case()...};
}

}  // namespace HWY_NAMESPACE

namespace testing {

template <>
inline constexpr WordCases<float> kWordCases<HWY_TARGET, float> =
    HWY_NAMESPACE::CasesOfFloats<2, 3, 4>();
template <>
inline constexpr WordCases<double> kWordCases<HWY_TARGET, double> = {
    HWY_NAMESPACE::NamedBoxes<2, double>::Case(),
    HWY_NAMESPACE::NamedBoxes<3, double>::Case(),
    HWY_NAMESPACE::NamedBoxes<4, double>::Case()};

}  // namespace testing
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace halfspace::testing {
namespace {

template <typename T>
class ScanWordsTest : public ::testing::Test {
 protected:
  // One word, from an odd object on, and nothing after it.
  static constexpr std::size_t kFirst = 3;
  static constexpr std::size_t kObjects = kFirst + 64;

  // Mostly the same value, so that some objects survive ten planes; and every
  // kind of other one.
  T AnyValue() {
    using Limits = std::numeric_limits<T>;
    switch (random_() % 32) {
      case 0:
        return Limits::quiet_NaN();
      case 1:
        return Limits::infinity();
      case 2:
        return -Limits::infinity();
      case 3:
      case 4:
        return static_cast<T>(static_cast<int>(random_() % 5) - 2);
      default:
        return T{1};
    }
  }

  void Fill() {
    for (std::size_t p = 0; p < kMostPlanes; ++p) {
      planes_[p].resize(kObjects);
      for (T& value : planes_[p]) value = AnyValue();
      pointers_[p] = planes_[p].data();
      query_[p] = AnyValue();
    }
  }

  std::uint64_t Expected(const WordCase<T>& word_case, std::size_t count) {
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < count; ++i) {
      bool rejected = false;
      for (std::size_t p = 0; p < word_case.planes; ++p) {
        const T object = planes_[p][kFirst + i];
        // A NaN rejects nothing.
        rejected |=
            p < word_case.mins ? object > query_[p] : object < query_[p];
      }
      word |= std::uint64_t{!rejected} << i;
    }
    return word;
  }

  std::uint64_t Word(WordFunction<T> function, std::size_t count) {
    return function(pointers_, kFirst, count, query_);
  }

  void Check(const WordCase<T>& word_case) {
    SCOPED_TRACE(std::to_string(word_case.planes) + " planes, " +
                 std::to_string(word_case.mins) + " minima");
    for (int round = 0; round < 50; ++round) {
      Fill();
      ASSERT_EQ(Word(word_case.whole, 64), Expected(word_case, 64));
      for (std::size_t count = 1; count < 64; ++count) {
        ASSERT_EQ(Word(word_case.tail, count), Expected(word_case, count))
            << count << " objects";
      }
    }
  }

 private:
  std::mt19937_64 random_{1};
  std::vector<T> planes_[kMostPlanes];
  const T* pointers_[kMostPlanes];
  T query_[kMostPlanes];
};

struct ElementNames {
  template <typename T>
  static std::string GetName(int) {
    return "Float" + std::to_string(8 * sizeof(T));
  }
};

using Elements = ::testing::Types<float, double>;
TYPED_TEST_SUITE(ScanWordsTest, Elements, ElementNames);

TYPED_TEST(ScanWordsTest, AreThoseOfAPlainLoop) {
  const std::vector<Target> targets = TargetsUnderTest();
  kernels::ForEachCompiledTarget([&](auto target) {
    const Target handle = Target::FromHighwayBit(target());
    if (std::find(targets.begin(), targets.end(), handle) == targets.end()) {
      return;
    }
    SCOPED_TRACE(std::string(handle.name()));
    for (const auto& word_case : kWordCases<target(), TypeParam>) {
      this->Check(word_case);
    }
  });
}

}  // namespace
}  // namespace halfspace::testing
#endif  // HWY_ONCE

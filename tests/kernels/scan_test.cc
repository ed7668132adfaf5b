// The words of a scan on every target, against a plain loop: of every type of
// element, of 1 to 10 planes, and of the functions of kernels-inl.h. Streaming
// and staged scans, which are made of the same parts, are in
// cpu_choices_test.cc.
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
#include "kernels/scan/words-inl.h"

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
  WordFunction<T> wide = nullptr;   // the same, with the longest vectors
  WordFunction<T> tail = nullptr;   // of at most 63
};

inline constexpr std::size_t kMostPlanes = 10;

// Of 1, 2, 5 and 10 planes half, rounded up, are minima. The others are the
// named ones: of floats, and boxes of doubles too.
template <typename T>
using WordCases = std::array<WordCase<T>, 13>;

// Specialised by each target's pass over this file.
template <std::int64_t kTarget, typename T>
inline constexpr WordCases<T> kWordCases{};
template <std::int64_t kTarget>
inline constexpr std::uint64_t (*kNonzeroWords)(const std::uint64_t*,
                                                std::size_t) = nullptr;

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_KERNELS_SCAN_TEST_TYPES_

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

template <size_t kMins, typename T, size_t... kPlane>
struct WordsOfPlanes {
  static uint64_t Whole(const T* const* planes, size_t i, size_t,
                        const T* query) {
    const OneTag<T> d;
    return KeptBits<kMins>(d, LoadAll(), planes, i,
                           hn::Set(d, query[kPlane])...);
  }
  static uint64_t Wide(const T* const* planes, size_t i, size_t,
                       const T* query) {
    const WordTag<T> d;
    return KeptBits<kMins>(d, LoadAll(), planes, i,
                           hn::Set(d, query[kPlane])...);
  }
  static uint64_t Tail(const T* const* planes, size_t i, size_t count,
                       const T* query) {
    const WordTag<T> d;
    return KeptTail<kMins>(d, planes, i, count, hn::Set(d, query[kPlane])...);
  }
};

template <typename T, size_t... kPlane>
constexpr testing::WordCase<T> WordCaseOf(std::index_sequence<kPlane...>) {
  constexpr size_t kPlanes = sizeof...(kPlane);
  using Words = WordsOfPlanes<(kPlanes + 1) / 2, T, kPlane...>;
  return {(kPlanes + 1) / 2, kPlanes, &Words::Whole, &Words::Wide,
          &Words::Tail};
}

// The functions of kernels-inl.h. Their queries have minima, then maxima; here
// query[p] is what plane p is compared with.
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
      return {kMins, kPlanes, &Of64, &Of64, &OfFew};                         \
    }                                                                        \
  };
HALFSPACE_NAMED_CASE(Boxes, kDims, kDims)
HALFSPACE_NAMED_CASE(Simplices, kDims + 1, 0)
HALFSPACE_NAMED_CASE(Octahedra, kDims + 1, kDims + 1)
#undef HALFSPACE_NAMED_CASE

template <typename T>
constexpr testing::WordCases<T> MakeWordCases() {
  testing::WordCases<T> cases = {
      WordCaseOf<T>(std::make_index_sequence<1>()),
      WordCaseOf<T>(std::make_index_sequence<2>()),
      WordCaseOf<T>(std::make_index_sequence<5>()),
      WordCaseOf<T>(std::make_index_sequence<testing::kMostPlanes>())};
  if constexpr (std::is_floating_point_v<T>) {
    cases[4] = NamedBoxes<2, T>::Case();
    cases[5] = NamedBoxes<3, T>::Case();
    cases[6] = NamedBoxes<4, T>::Case();
  }
  if constexpr (std::is_same_v<T, float>) {
    cases[7] = NamedSimplices<2, T>::Case();
    cases[8] = NamedSimplices<3, T>::Case();
    cases[9] = NamedSimplices<4, T>::Case();
    cases[10] = NamedOctahedra<2, T>::Case();
    cases[11] = NamedOctahedra<3, T>::Case();
    cases[12] = NamedOctahedra<4, T>::Case();
  }
  return cases;
}

uint64_t NonzeroWordsOfTest(const uint64_t* words, size_t count) {
  return NonzeroWords(words, count);
}

}  // namespace HWY_NAMESPACE

namespace testing {

template <>
inline constexpr WordCases<float> kWordCases<HWY_TARGET, float> =
    HWY_NAMESPACE::MakeWordCases<float>();
template <>
inline constexpr WordCases<double> kWordCases<HWY_TARGET, double> =
    HWY_NAMESPACE::MakeWordCases<double>();
template <>
inline constexpr WordCases<std::int8_t> kWordCases<HWY_TARGET, std::int8_t> =
    HWY_NAMESPACE::MakeWordCases<std::int8_t>();
template <>
inline constexpr WordCases<std::int16_t> kWordCases<HWY_TARGET, std::int16_t> =
    HWY_NAMESPACE::MakeWordCases<std::int16_t>();
template <>
inline constexpr std::uint64_t (*kNonzeroWords<HWY_TARGET>)(
    const std::uint64_t*, std::size_t) = &HWY_NAMESPACE::NonzeroWordsOfTest;

}  // namespace testing
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace halfspace::testing {
namespace {

// Calls visit(target) for every target under test, as a constant.
template <typename Visit>
void ForEachTargetUnderTest(const Visit& visit) {
  const std::vector<Target> targets = TargetsUnderTest();
  kernels::ForEachCompiledTarget([&](auto target) {
    const Target handle = Target::FromHighwayBit(target());
    if (std::find(targets.begin(), targets.end(), handle) == targets.end()) {
      return;
    }
    SCOPED_TRACE(std::string(handle.name()));
    visit(target);
  });
}

// A NaN rejects nothing. Quantized bounds of minima are stored in reverse.
template <typename T>
bool Rejects(bool is_min, T object, T query) {
  return is_min && std::is_floating_point_v<T> ? object > query
                                               : object < query;
}

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
        return Limits::has_quiet_NaN ? Limits::quiet_NaN() : T{0};
      case 1:
        return Limits::has_infinity ? Limits::infinity() : Limits::max();
      case 2:
        return Limits::has_infinity ? -Limits::infinity() : Limits::min();
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
        rejected |=
            Rejects(p < word_case.mins, planes_[p][kFirst + i], query_[p]);
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
      const std::uint64_t expected = Expected(word_case, 64);
      ASSERT_EQ(Word(word_case.whole, 64), expected);
      ASSERT_EQ(Word(word_case.wide, 64), expected);
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
    return (std::is_floating_point_v<T> ? "Float" : "Int") +
           std::to_string(8 * sizeof(T));
  }
};

using Elements = ::testing::Types<float, double, std::int8_t, std::int16_t>;
TYPED_TEST_SUITE(ScanWordsTest, Elements, ElementNames);

TYPED_TEST(ScanWordsTest, AreThoseOfAPlainLoop) {
  ForEachTargetUnderTest([this](auto target) {
    constexpr const WordCases<TypeParam>& kCases =
        kWordCases<target(), TypeParam>;
    for (const auto& word_case : kCases) {
      if (word_case.planes != 0) this->Check(word_case);
    }
  });
}

TEST(NonzeroWordsTest, AreThoseOfAPlainLoop) {
  ForEachTargetUnderTest([](auto target) {
    std::mt19937_64 random(1);
    for (std::size_t count = 0; count <= 64; ++count) {
      for (int round = 0; round < 20; ++round) {
        // One bit, so that no part of a word is overlooked. What follows the
        // words is not 0, so that it is seen if it is read.
        std::vector<std::uint64_t> words(64 + 16, ~std::uint64_t{0});
        std::uint64_t expected = 0;
        for (std::size_t w = 0; w < count; ++w) {
          words[w] = std::uint64_t{random() % 2} << (random() % 64);
          expected |= std::uint64_t{words[w] != 0} << w;
        }
        ASSERT_EQ(kNonzeroWords<target()>(words.data(), count), expected)
            << count << " words";
      }
    }
  });
}

}  // namespace
}  // namespace halfspace::testing
#endif  // HWY_ONCE

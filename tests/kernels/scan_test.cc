// The functions of kernels-inl.h, of which scans make their words, on every
// target against the reference. Tests of the library have the other parts of
// scans: of quantized bounds, streaming and staged.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <string>
#include <vector>

#include "kernels/compiled_targets.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/inputs.h"
#include "tests/reference/reference.h"

#if defined(__unix__)
#include "tests/library/support/guarded_memory.h"
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/kernels/scan_test.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "halfspace/kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// The word of `n` objects from object i on.
template <int kDims, typename T>
uint64_t WordOf(const AabbView<kDims, T>&, const T* const* planes, size_t i,
                size_t n, const T* query) {
  return n == 64 ? SurvivorsOf64Boxes<kDims>(planes, i, query)
                 : SurvivorsOfFewBoxes<kDims>(planes, i, n, query);
}
template <int kDims>
uint64_t WordOf(const SimplexView<kDims>&, const float* const* planes, size_t i,
                size_t n, const float* query) {
  return n == 64 ? SurvivorsOf64Simplices<kDims>(planes, i, query)
                 : SurvivorsOfFewSimplices<kDims>(planes, i, n, query);
}
template <int kDims>
uint64_t WordOf(const AaboView<kDims>&, const float* const* planes, size_t i,
                size_t n, const float* query) {
  return n == 64 ? SurvivorsOf64Octahedra<kDims>(planes, i, query)
                 : SurvivorsOfFewOctahedra<kDims>(planes, i, n, query);
}

}  // namespace HWY_NAMESPACE

namespace testing {

// Specialised by each target's pass over this file.
template <std::int64_t kTarget>
struct WordsOf;
template <>
struct WordsOf<HWY_TARGET> {
  template <typename View, typename T>
  static uint64_t Word(const T* const* planes, size_t i, size_t n,
                       const T* query) {
    return HWY_NAMESPACE::WordOf(View(), planes, i, n, query);
  }
};

}  // namespace testing
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace halfspace::testing {
namespace {

template <typename View>
class ScanWordsTest : public ::testing::Test {};

using Views = ::testing::Types<SimplexView2, SimplexView3, SimplexView<4>,
                               AabbView2, AabbView3, AabbView<4>, AaboView2,
                               AaboView3, AaboView<4>, AabbView<2, double>,
                               AabbView<3, double>, AabbView<4, double>>;
struct Names {
  template <typename View>
  static std::string GetName(int) {
    return NameOf(View());
  }
};
TYPED_TEST_SUITE(ScanWordsTest, Views, Names);

TYPED_TEST(ScanWordsTest, AreThoseOfTheReference) {
  using View = TypeParam;
  using T = ScalarOf<View>;
  constexpr std::size_t kPlaneCount = kPlanes<View>;
  // From an odd object on, and nothing after the last word.
  constexpr std::size_t kFirst = 3;
  const std::vector<Target> targets = TargetsUnderTest();
#if defined(__unix__)
  std::deque<GuardedMemory> guarded;
  for (std::size_t p = 0; p < kPlaneCount; ++p) guarded.emplace_back(4096);
#endif
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    const InputKind kind =
        round % 2 == 0 ? InputKind::kDense : InputKind::kAdversarial;
    std::vector<T> planes[kPlaneCount];
    const T* pointers[kPlaneCount];
    View view;
    T values[kPlaneCount];
    for (std::size_t p = 0; p < kPlaneCount; ++p) {
      planes[p].resize(kFirst + 64);
      values[OpposingValue(detail::kLayoutOf<typename View::Bound>, p)] =
          FillPlane<T>(kind, IsMinPlane<View>(p), planes[p], random);
      pointers[p] = planes[p].data();
      PlaneOf(view, p) = pointers[p] + kFirst;
    }
    typename View::Query query;
    std::memcpy(&query, values, sizeof(query));
    for (view.size = 1; view.size <= 64; ++view.size) {
      std::uint64_t rejected;
      reference::RejectMask(view, query, &rejected);
      kernels::ForEachCompiledTarget([&](auto target) {
        const Target handle = Target::FromHighwayBit(target());
        if (std::find(targets.begin(), targets.end(), handle) ==
            targets.end()) {
          return;
        }
        const auto word = [&](const T* const* some, std::size_t i) {
          return WordsOf<target()>::template Word<View>(some, i, view.size,
                                                        values);
        };
        ASSERT_EQ(word(pointers, kFirst), ~rejected)
            << handle.name() << ", " << view.size << " objects";
#if defined(__unix__)
        // Nothing before the first object is read, either.
        for (GuardedSide side : {GuardedSide::kBefore, GuardedSide::kAfter}) {
          const T* alone[kPlaneCount];
          for (std::size_t p = 0; p < kPlaneCount; ++p) {
            const auto plane = guarded[p].Get<T>(view.size, side);
            std::copy_n(pointers[p] + kFirst, view.size, plane.begin());
            alone[p] = plane.data();
          }
          ASSERT_EQ(word(alone, 0), ~rejected)
              << handle.name() << ", " << view.size << " objects alone";
        }
#endif
      });
      if (this->HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing
#endif  // HWY_ONCE

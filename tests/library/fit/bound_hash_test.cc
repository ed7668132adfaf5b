// One constant per builder that stands for its bounds of many seeded shapes:
// the same with every compiler and on every machine.
//
// HALFSPACE_TEST_SCALE does not count here. If a bound is meant to change, the
// message of the failed test has the new constant.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ios>
#include <map>
#include <string>

#include "halfspace/fit.h"
#include "tests/library/support/fnv_hash.h"
#include "tests/library/support/seeded_bounds.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

const std::map<std::string, std::uint64_t> kExpected = {
    {"BoundAabb", 0x67ca5ff90215e6e2},
    {"BoundAabb of doubles", 0xe939be9bb1337732},
    {"BoundCapsule", 0x4b747af9113c8c42},
    {"BoundCapsule of doubles", 0x66ba2b9ee6779ae4},
    {"BoundFrustum", 0x6d35254279d03e41},
    {"BoundOrientedBox", 0xaf4a98bb8668c18d},
    {"BoundOrientedBox of doubles", 0x34593f0563d5d6a4},
    {"BoundPoints", 0x3573bddfb9e1af0f},
    {"BoundPoints by indices", 0x1f4d14c05e4a46ab},
    {"BoundPoints of doubles", 0x35643d93018714a1},
    {"BoundRay", 0xd8068d41319c7d99},
    {"BoundRay of doubles", 0x93f1f3196f4f8167},
    {"BoundSegment", 0x1c4465e09a1310b0},
    {"BoundSegmentPieces", 0x3912905216b7232d},
    {"BoundSegmentPieces of doubles", 0xc3a0937605fd8b69},
    {"BoundSphere", 0x01587148ad767104},
    {"BoundSphere of doubles", 0xcfe6ecf10fc7ee09},
    {"BoundTransformed box", 0x531a8c735054c763},
    {"BoundTransformed box of doubles", 0x0cc06882071ab6aa},
    {"BoundTransformed points", 0x0fe231292c1239b1},
    {"BoundTriangle", 0xd37ef5ac65b63eeb},
    {"Circumscribe", 0xf5f809e0d855d5ce},
    {"Inflate", 0x2a262758f8c9c595},
    {"InflateByBox", 0x04b287bdad70ae51},
    {"Merge", 0x98a3e5138385db66},
    {"Scale", 0x7470412c78a0ede9},
    {"Sweep", 0xa71079629c037d0a},
    {"Translate", 0x141cef07215c5202},
    {"TranslateVertices", 0x9bad662ab39369fb},
};

std::uint64_t Expected(const std::string& name) {
  const auto it = kExpected.find(name);
  return it == kExpected.end() ? 0 : it->second;
}

constexpr std::uint64_t kSeed = 11;
constexpr int kBounds = 2000;  // by each builder, in each number of dimensions

template <int kDims, typename Build>
void AddBounds(Build build, FnvHash& hash) {
  SeededNumbers numbers(kSeed);
  int unbounded = 0;
  for (int i = 0; i < kBounds; ++i) {
    const Aabo<kDims> bound = build(numbers);
    unbounded += bound == Aabo<kDims>::Everything();
    for (std::size_t k = 0; k < bound.min.size(); ++k) {
      ASSERT_FALSE(std::isnan(bound.min[k]) || std::isnan(bound.max[k])) << i;
    }
    hash.AddAllFloats(bound.min);
    hash.AddAllFloats(bound.max);
  }
  EXPECT_LT(unbounded, kBounds / 2);
}

template <int kDims>
const SeededBuilder<kDims>& BuilderAt(std::size_t i) {
  constexpr std::size_t kFirst = kSeededBuilders<kDims>.size();
  return i < kFirst ? kSeededBuilders<kDims>[i]
                    : kSeededBuildersOfDoubles<kDims>[i - kFirst];
}

class BoundHashTest : public ::testing::TestWithParam<std::size_t> {};

TEST_P(BoundHashTest, IsTheSameEverywhere) {
  const std::string name = BuilderAt<3>(GetParam()).name;
  FnvHash hash;
  AddBounds<2>(BuilderAt<2>(GetParam()).build, hash);
  AddBounds<3>(BuilderAt<3>(GetParam()).build, hash);
  AddBounds<4>(BuilderAt<4>(GetParam()).build, hash);
  EXPECT_EQ(hash.value(), Expected(name))
      << "the hash of " << name << " is 0x" << std::hex << hash.value();
}

INSTANTIATE_TEST_SUITE_P(
    Builders, BoundHashTest,
    ::testing::Range(std::size_t{0}, kSeededBuilders<3>.size() +
                                         kSeededBuildersOfDoubles<3>.size()));

// Six planes around a point that is surely inside, none of them straight.
Aabo3 FrustumBound(SeededNumbers& numbers) {
  std::array<HalfSpace3, 6> planes;
  for (std::size_t p = 0; p < planes.size(); ++p) {
    for (float& n : planes[p].normal) n = numbers.WithExponent(-6, -3);
    planes[p].normal[p / 2] = p % 2 == 0 ? 1.f : -1.f;
    planes[p].offset = std::fabs(numbers.WithExponent(-4, 3));
  }
  return BoundFrustum(planes);
}

TEST(FrustumHashTest, IsTheSameEverywhere) {
  FnvHash hash;
  AddBounds<3>(&FrustumBound, hash);
  EXPECT_EQ(hash.value(), Expected("BoundFrustum"))
      << "the hash of BoundFrustum is 0x" << std::hex << hash.value();
}

}  // namespace
}  // namespace halfspace::testing

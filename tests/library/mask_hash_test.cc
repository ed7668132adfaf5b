// One seeded world per number of dimensions, and one constant per shape that
// stands for all its answers: the same on every target, schedule, compiler and
// machine. The other tests compare what runs here with what runs here; only a
// constant compares with machines that are elsewhere.
//
// HALFSPACE_TEST_SCALE does not count here. If an answer is meant to change,
// the message of the failed test has the new constant.
#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <ios>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "halfspace/reject.h"
#include "halfspace/world.h"
#include "tests/library/answers.h"
#include "tests/library/cases.h"
#include "tests/library/environment.h"
#include "tests/library/fnv_hash.h"
#include "tests/library/seeded_bounds.h"
#include "tests/library/seeded_numbers.h"

namespace halfspace::testing {
namespace {

const std::map<std::string, std::uint64_t> kExpected = {
    {"Aabb2", 0x9b3b2192a5b90fc5},    {"Aabb3", 0x897a7b9458ffca03},
    {"Aabb4", 0x7020b60384a94482},    {"Aabo2", 0x1dd97fd69039fb35},
    {"Aabo3", 0x7bdd90a6dc6dab43},    {"Aabo4", 0x9b7e0fe77940a811},
    {"Simplex2", 0xae1afe0d6303fc27}, {"Simplex3", 0x245c4e942dd3357d},
    {"Simplex4", 0xd2d20e5e697c0a3f},
};

template <int kDims>
struct Scene {
  // A tile of a staged scan, then words, then a tail.
  static constexpr std::size_t kObjects = 4096 + 3 * 64 + 37;
  static constexpr std::size_t kQueries = 32;

  std::vector<Aabo<kDims>> objects;
  std::vector<Aabo<kDims>> queries;

  Scene() {
    SeededNumbers numbers(kDims);
    while (queries.size() < kQueries) {
      queries.push_back(Next(numbers, queries));
    }
    while (objects.size() < kObjects) {
      objects.push_back(Next(numbers, queries));
    }
  }

 private:
  // Half of them by the builders.
  static Aabo<kDims> Next(SeededNumbers& numbers,
                          std::span<const Aabo<kDims>> others) {
    if (numbers.Below(2) == 0) {
      const auto& builders = kSeededBuilders<kDims>;
      const auto one =
          numbers.Below(static_cast<std::uint32_t>(builders.size()));
      return builders[one].build(numbers);
    }
    Aabo<kDims> bound;
    for (std::size_t k = 0; k < bound.min.size(); ++k) {
      const auto* other = others.empty()
                              ? nullptr
                              : &others[numbers.Below(
                                    static_cast<std::uint32_t>(others.size()))];
      bound.min[k] = Value(numbers, -16.f, other ? other->max[k] : 0.f);
      bound.max[k] = Value(numbers, 16.f, other ? other->min[k] : 0.f);
    }
    return bound;
  }

  // Half of the values seldom reject, so that some objects survive. The others
  // are anything at all, touch an opposing value or are one ulp from it.
  static float Value(SeededNumbers& numbers, float loose, float opposing) {
    const auto bits = std::bit_cast<std::uint32_t>(opposing);
    switch (numbers.Below(10)) {
      case 0:
        return numbers.Special();
      case 1:
        return numbers.Raw();
      case 2:
        return opposing;
      case 3:
        return std::bit_cast<float>(bits + 1);
      case 4:
        return std::bit_cast<float>(bits - 1);
      default:
        return loose;
    }
  }
};

template <typename Bound, int kDims>
Bound PartOf(const Aabo<kDims>& bound) {
  if constexpr (HasMinima<Bound> && HasMaxima<Bound>) {
    if constexpr (Bound::kAxes == kDims) {
      return bound.aabb();
    } else {
      return bound;
    }
  } else if constexpr (HasMinima<Bound>) {
    return bound.up();
  } else {
    return bound.down();
  }
}

template <typename Case>
class MaskHashTest : public ::testing::Test {
 protected:
  using Stored = typename Case::Stored;
  using View = typename Case::View;
  static constexpr int kDims = Stored::Bound::kDimensions;

  MaskHashTest() {
    static const Scene<kDims> scene;
    for (const auto& object : scene.objects) {
      world_.Push(PartOf<typename Stored::Bound>(object));
    }
    for (const auto& query : scene.queries) {
      queries_.push_back(Case::Seen(PartOf<typename Stored::Query>(query)));
    }
  }

  // Of every form of the answers to all queries.
  std::uint64_t HashOf(const Options& options) {
    const View view = Case::Seen(world_.view());
    std::vector<std::uint64_t> mask(MaskWords(view.size));
    std::vector<std::uint32_t> indices(view.size);
    FnvHash hash;
    survivors_ = 0;
    for (const auto& query : queries_) {
      RejectMask(view, query, mask, options);
      hash.AddAll(mask);
      SurvivorMask(view, query, mask, options);
      hash.AddAll(mask);
      const std::size_t listed = Survivors(view, query, indices, options).count;
      hash.AddAll(std::span(indices).first(listed));
      hash.Add(listed);
      hash.Add(CountSurvivors(view, query, options).count);
      hash.Add(AnySurvivor(view, query, options).any ? 1 : 0);
      survivors_ += listed;
    }
    return hash.value();
  }

  std::size_t survivors() const { return survivors_; }

 private:
  World<Stored> world_;
  std::vector<typename View::Query> queries_;
  std::size_t survivors_ = 0;
};

TYPED_TEST_SUITE(MaskHashTest, AllCases, CaseNames);

TYPED_TEST(MaskHashTest, IsTheSameEverywhere) {
  const std::string name = NameOf(Whole<typename TypeParam::View>());
  const std::uint64_t expected = kExpected.at(name);
  for (Target target : TargetsUnderTest()) {
    for (Schedule schedule : kSchedules) {
      const std::uint64_t hash =
          this->HashOf({.schedule = schedule, .target = target});
      EXPECT_EQ(hash, expected)
          << target.name() << ", schedule " << static_cast<int>(schedule)
          << ": the hash of " << name << " is 0x" << std::hex << hash;
    }
  }
  // A world of which all or nothing survives would test little.
  constexpr std::size_t kTested =
      Scene<TestFixture::kDims>::kObjects * Scene<TestFixture::kDims>::kQueries;
  EXPECT_GT(this->survivors(), kTested / 50);
  EXPECT_LT(this->survivors(), kTested / 2);
}

}  // namespace
}  // namespace halfspace::testing

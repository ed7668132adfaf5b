// One seeded world per number of dimensions, of floats and of doubles, and one
// constant per shape that stands for all its answers: the same on every target,
// schedule, compiler and machine. The other tests compare what runs here with
// what runs here; only a constant compares with machines that are elsewhere.
//
// HALFSPACE_TEST_SCALE does not count here. If an answer is meant to change,
// the message of the failed test has the new constant.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ios>
#include <map>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "halfspace/reject.h"
#include "halfspace/reject_many.h"
#include "halfspace/world.h"
#include "tests/library/reject/seeded_scene.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fnv_hash.h"

namespace halfspace::testing {
namespace {

const std::map<std::string, std::uint64_t> kExpected = {
    {"Aabb2", 0x9b3b2192a5b90fc5},       {"Aabb3", 0x897a7b9458ffca03},
    {"Aabb4", 0x7020b60384a94482},       {"Aabo2", 0x1dd97fd69039fb35},
    {"Aabo3", 0x7bdd90a6dc6dab43},       {"Aabo4", 0x9b7e0fe77940a811},
    {"Simplex2", 0xae1afe0d6303fc27},    {"Simplex3", 0x245c4e942dd3357d},
    {"Simplex4", 0xd2d20e5e697c0a3f},    {"Aabb2Double", 0xd620a994e20cd2c8},
    {"Aabb3Double", 0x8665c9a21d612081}, {"Aabb4Double", 0xbde9a4c7a7a9fd48},
};

const std::map<std::string, std::uint64_t> kExpectedForMany = {
    {"Aabb2", 0x9cb1388546c4e779},       {"Aabb3", 0x1d6cd572e794f81d},
    {"Aabb4", 0x37f6290b4be25d40},       {"Aabo2", 0xe2a77dc3399c17d6},
    {"Aabo3", 0xa7dd4d935aa20fac},       {"Aabo4", 0xedb36be664bafdf8},
    {"Simplex2", 0x30ae1fb9676ffc1d},    {"Simplex3", 0x20f4f58e60b0f4d9},
    {"Simplex4", 0x7a1f250ac4ff3ce2},    {"Aabb2Double", 0x4a637392bc5f13e4},
    {"Aabb3Double", 0x0b6a206f6f2e37a2}, {"Aabb4Double", 0x62bfc742c796e8db},
};

template <typename Case>
class MaskHashTest : public ::testing::Test {
 protected:
  using Stored = typename Case::Stored;
  using View = typename Case::View;
  using Scene = SeededScene<Stored::Bound::kDimensions, ScalarOf<Stored>>;

  MaskHashTest() {
    static const Scene scene;
    for (const auto& object : scene.objects) {
      world_.Push(PartOf<typename Stored::Bound>(object));
    }
    for (const auto& query : scene.queries) {
      queries_.push_back(Case::Seen(PartOf<typename Stored::Query>(query)));
    }
  }

  // Of every form of the answers to all queries, one at a time.
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
      const std::size_t listed = Survivors(view, query, indices, options);
      hash.AddAll(std::span(indices).first(listed));
      hash.Add(listed);
      hash.Add(CountSurvivors(view, query, options));
      hash.Add(AnySurvivor(view, query, options).has_value() ? 1 : 0);
      survivors_ += listed;
    }
    return hash.value();
  }

  // The same of the calls for many queries. Pairs count by their query, since
  // the tiles that they come by may change.
  std::uint64_t HashOfMany(const Options& options) {
    const View view = Case::Seen(world_.view());
    std::vector<std::uint64_t> rows(queries_.size() * MaskWords(view.size));
    std::vector<std::size_t> counts(queries_.size());
    FnvHash hash;
    RejectMasks(view, queries_, rows, options);
    hash.AddAll(rows);
    SurvivorMasks(view, queries_, rows, options);
    hash.AddAll(rows);
    SurvivorCounts(view, queries_, counts, options);
    hash.AddAll(counts);
    survivors_ = std::reduce(counts.begin(), counts.end());
    std::vector<std::uint32_t> by_pair(survivors_);
    std::vector<std::uint32_t> objects(survivors_);
    const std::size_t pairs =
        SurvivorPairs(view, queries_, by_pair, objects, options);
    hash.Add(pairs);
    std::vector<std::vector<std::uint32_t>> by_query(queries_.size());
    for (std::size_t j = 0; j < std::min(pairs, survivors_); ++j) {
      by_query.at(by_pair[j]).push_back(objects[j]);
    }
    for (const auto& survivors : by_query) hash.AddAll(survivors);
    return hash.value();
  }

  // A world of which all or nothing survives would test little.
  void ExpectBothAnswers() const {
    constexpr std::size_t kTested = Scene::kObjects * Scene::kQueries;
    EXPECT_GT(survivors_, kTested / 50);
    EXPECT_LT(survivors_, kTested / 2);
  }

 private:
  World<Stored> world_;
  std::vector<typename View::Query> queries_;
  std::size_t survivors_ = 0;
};

TYPED_TEST_SUITE(MaskHashTest, AllCases, CaseNames);

// hash_of(options) is the constant, on every target and schedule.
template <typename HashOf>
void ExpectEverywhere(std::uint64_t expected, const std::string& name,
                      HashOf hash_of) {
  for (Target target : TargetsUnderTest()) {
    for (Schedule schedule : kSchedules) {
      const std::uint64_t hash =
          hash_of(Options{.schedule = schedule, .target = target});
      EXPECT_EQ(hash, expected)
          << target.name() << ", schedule " << static_cast<int>(schedule)
          << ": the hash of " << name << " is 0x" << std::hex << hash;
    }
  }
}

TYPED_TEST(MaskHashTest, IsTheSameEverywhere) {
  const std::string name = NameOf(Whole<typename TypeParam::View>());
  ExpectEverywhere(kExpected.at(name), name, [this](const Options& options) {
    return this->HashOf(options);
  });
  this->ExpectBothAnswers();
}

TYPED_TEST(MaskHashTest, IsTheSameEverywhereForManyQueries) {
  const std::string name = NameOf(Whole<typename TypeParam::View>());
  ExpectEverywhere(
      kExpectedForMany.at(name), name + " for many",
      [this](const Options& options) { return this->HashOfMany(options); });
  this->ExpectBothAnswers();
}

}  // namespace
}  // namespace halfspace::testing

// Competitors give the right answers, each that was built: those of loops over
// all boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "bench/baselines/body_space.h"
#include "bench/baselines/box_tree.h"
#include "bench/worlds/box_set.h"
#include "bench/worlds/random.h"

namespace halfspace::bench {
namespace {

template <int kDims>
struct World {
  std::string name;
  std::vector<Aabb<kDims>> boxes;
  std::vector<Aabb<kDims>> queries;
};

// Boxes whose centres are at most `reach` from `middle`, and whose lengths are
// at most 2 * size.
template <int kDims>
std::vector<Aabb<kDims>> RandomBoxes(std::size_t count, float middle,
                                     float reach, float size, Random& random) {
  std::vector<Aabb<kDims>> boxes(count);
  for (auto& box : boxes) {
    for (std::size_t k = 0; k < kDims; ++k) {
      const float center = middle + reach * random.Signed();
      const float half = std::abs(size * random.Signed());
      box.min[k] = center - half;
      box.max[k] = center + half;
    }
  }
  return boxes;
}

// So few coordinates that many boxes touch, are points, or are the same.
template <int kDims>
std::vector<Aabb<kDims>> IntegerBoxes(std::size_t count, Random& random) {
  std::vector<Aabb<kDims>> boxes(count);
  for (auto& box : boxes) {
    for (std::size_t k = 0; k < kDims; ++k) {
      box.min[k] = static_cast<float>(random.Below(12)) - 4;
      box.max[k] = box.min[k] + static_cast<float>(random.Below(3));
    }
  }
  return boxes;
}

template <int kDims>
std::vector<World<kDims>> Worlds() {
  Random random(1);
  std::vector<World<kDims>> worlds;
  worlds.push_back({"random", RandomBoxes<kDims>(900, 0, 10, 0.7f, random),
                    RandomBoxes<kDims>(60, 0, 11, 3, random)});
  // Far from 0, where floats are coarse.
  worlds.push_back({"far", RandomBoxes<kDims>(500, 5000, 1, 0.01f, random),
                    RandomBoxes<kDims>(60, 5000, 1.2f, 0.1f, random)});
  worlds.push_back({"integers", IntegerBoxes<kDims>(700, random),
                    IntegerBoxes<kDims>(60, random)});
  worlds.push_back({"the same",
                    std::vector(300, IntegerBoxes<kDims>(1, random)[0]),
                    IntegerBoxes<kDims>(60, random)});
  worlds.push_back(
      {"one", IntegerBoxes<kDims>(1, random), IntegerBoxes<kDims>(60, random)});
  worlds.push_back({"none", {}, IntegerBoxes<kDims>(1, random)});
  return worlds;
}

template <int kDims>
bool DoTouch(const Aabb<kDims>& a, const Aabb<kDims>& b) {
  for (std::size_t k = 0; k < kDims; ++k) {
    if (a.max[k] < b.min[k] || b.max[k] < a.min[k]) return false;
  }
  return true;
}

template <typename Query, typename Box>
std::vector<std::uint32_t> AllThatTouch(const Query& query,
                                        const std::vector<Box>& boxes) {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (DoTouch(query, boxes[i])) {
      found.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return found;
}

template <typename Interface>
using Named = std::pair<std::string, std::unique_ptr<Interface>>;

// All that were built.
template <typename Interface>
std::vector<Named<Interface>> Competitors(
    const typename Interface::Input& input) {
  std::vector<Named<Interface>> all;
  for (const auto& each : Registered<Interface>::All()) {
    all.emplace_back(each.name, each.make(input));
  }
  return all;
}

// A scan of our own is always there; what is installed is linked, too.
TEST(CompetitorsTest, AreRegistered) {
  EXPECT_GE(Registered<BodySpace<2>>::All().size(), 1u);
  EXPECT_GE(Registered<BodySpace<3>>::All().size(), 1u);
  for (const auto& tree : Registered<BoxTree<3>>::All()) {
    RecordProperty("tree", tree.name);
  }
}

template <int kDims>
void TestBoxTrees(const std::vector<World<kDims>>& worlds) {
  for (const auto& world : worlds) {
    for (const auto& [name, tree] : Competitors<BoxTree<kDims>>(world.boxes)) {
      SCOPED_TRACE(name + ", " + world.name);
      std::vector<std::uint32_t> found = {99};
      for (const auto& query : world.queries) {
        const auto expected = AllThatTouch(query, world.boxes);
        tree->Find(query, found);
        std::sort(found.begin(), found.end());
        ASSERT_EQ(found, expected);
        if (!tree->CanCount()) continue;
        ASSERT_EQ(tree->Count(query), expected.size());
      }
    }
  }
}

TEST(CompetitorsTest, FindAndCountTheBoxesThatTouchIn2D) {
  TestBoxTrees(Worlds<2>());
}
TEST(CompetitorsTest, FindAndCountTheBoxesThatTouchIn3D) {
  TestBoxTrees(Worlds<3>());
}

// Fewer boxes, but each query finds some.
TEST(CompetitorsTest, FindAndCountTheBoxesThatTouchInSkewedWorlds) {
  std::vector<World<3>> worlds;
  for (const SkewedWorld& skewed : SkewedWorlds()) {
    BoxSet<3> set = skewed.make(1000, 8.0f, 1);
    set.queries.resize(200);
    worlds.push_back({skewed.name, set.boxes, set.queries});
  }
  TestBoxTrees(worlds);
}

// Those of the boxes that touch and of which one has moved.
template <int kDims>
void ExpectPairs(std::vector<IndexPair> found,
                 const std::vector<Aabb<kDims>>& boxes,
                 const std::vector<bool>& is_moved) {
  std::vector<IndexPair> expected;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j) {
      if (!is_moved[i] && !is_moved[j]) continue;
      if (DoTouch(boxes[i], boxes[j])) expected.push_back({i, j});
    }
  }
  for (IndexPair& pair : found) std::sort(pair.begin(), pair.end());
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found, expected);
}

TEST(CompetitorsTest, FindEachPairOnce) {
  for (const auto& world : Worlds<3>()) {
    for (const auto& [name, finder] : Competitors<PairFinder>(world.boxes)) {
      SCOPED_TRACE(name + ", " + world.name);
      std::vector<IndexPair> found = {{99, 99}};
      for (int time = 0; time < 2; ++time) {
        finder->Pairs(found);
        ExpectPairs(found, world.boxes,
                    std::vector<bool>(world.boxes.size(), true));
      }
    }
  }
}

double Distance(const Point<3>& point, const Aabb3& box) {
  double square = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double p = point[k];
    const double away = std::max({box.min[k] - p, p - box.max[k], 0.0});
    square += away * away;
  }
  return std::sqrt(square);
}

// Of boxes that are equally far, or nearly so, any is right.
TEST(CompetitorsTest, FindTheNearest) {
  for (const auto& world : Worlds<3>()) {
    for (const auto& [name, tree] : Competitors<NearestTree>(world.boxes)) {
      SCOPED_TRACE(name + ", " + world.name);
      std::vector<std::uint32_t> found = {99};
      for (const auto& query : world.queries) {
        const Point<3> point = query.min;
        std::vector<double> expected;
        for (const auto& box : world.boxes) {
          expected.push_back(Distance(point, box));
        }
        std::sort(expected.begin(), expected.end());
        for (std::size_t count : {0, 1, 7, 2000}) {
          tree->Nearest(point, count, found);
          ASSERT_EQ(found.size(), std::min(count, world.boxes.size()));
          std::sort(found.begin(), found.end());
          ASSERT_EQ(std::adjacent_find(found.begin(), found.end()),
                    found.end());
          std::vector<double> distances;
          for (std::uint32_t index : found) {
            distances.push_back(Distance(point, world.boxes.at(index)));
          }
          std::sort(distances.begin(), distances.end());
          for (std::size_t i = 0; i < found.size(); ++i) {
            ASSERT_NEAR(distances[i], expected[i], 1e-6 * expected[i]);
          }
        }
      }
    }
  }
}

// Of a few steps, in each of which some bodies go where others were.
template <int kDims>
void TestBodySpace(const World<kDims>& world, BodySpace<kDims>& space) {
  std::vector<Aabb<kDims>> boxes = world.boxes;
  std::vector<std::uint32_t> ids(boxes.size());
  std::iota(ids.begin(), ids.end(), 0u);
  space.Insert(ids, boxes);
  Random random(2);
  std::vector<IndexPair> pairs;
  for (std::size_t one_of : {10, 1, 2}) {
    std::vector<bool> is_moved(boxes.size());
    std::vector<Aabb<kDims>> moved;
    ids.clear();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (random.Below(one_of) != 0) continue;
      is_moved[i] = true;
      ids.push_back(static_cast<std::uint32_t>(i));
      moved.push_back(world.boxes[random.Below(boxes.size())]);
      boxes[i] = moved.back();
    }
    space.Step(ids, moved);
    pairs.clear();
    space.PairsOf(ids, pairs);
    ExpectPairs(pairs, boxes, is_moved);
  }
}

template <int kDims>
void TestBodySpaces() {
  for (const World<kDims>& world : Worlds<kDims>()) {
    if (world.boxes.empty()) continue;
    for (const auto& [name, space] :
         Competitors<BodySpace<kDims>>(world.boxes.size())) {
      // It takes near boxes there for the same.
      if (name == "FCL dynamic tree" && world.name == "far") continue;
      SCOPED_TRACE(name + ", " + world.name);
      TestBodySpace(world, *space);
    }
  }
}

TEST(CompetitorsTest, FollowBodiesThatMoveIn2D) { TestBodySpaces<2>(); }
TEST(CompetitorsTest, FollowBodiesThatMoveIn3D) { TestBodySpaces<3>(); }

}  // namespace
}  // namespace halfspace::bench

// Box2D's b2DynamicTree on halfspace::AabbBroadPhase2, for Box2D 3.2.
//
// Compile this file instead of src/dynamic_tree.c, and link halfspace into
// Box2D. box2d.cmake does that, and builds Box2D's unit tests.
//
// - b2DynamicTree::nodes has one node for each proxy. So Box2D saves and
//   restores a tree as before. The broad phase is made again from the nodes by
//   the first call after that.
// - Query() and QueryAll() call the function in the order of the ids of
//   proxies, after the search. So a world is the same for any number of
//   threads, and after it was restored.
// - Casts come about near to far.
// - A tree may be copied only before it has a proxy.
// - There are no internal nodes: GetHeight() returns the height of a balanced
//   binary tree, GetAreaRatio() returns BroadPhaseStatistics::cost_ratio, and
//   b2TreeStats::nodeVisits is the number of blocks of 64 that a query reads,
//   and 0 for a cast.
#include <box2d/collision.h>
#include <halfspace/broad_phase.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

// Of Box2D's src/core.h.
extern "C" {
void* b2Alloc(size_t size);
void b2Free(void* memory, size_t size);
}

namespace {

using Bodies = halfspace::AabbBroadPhase2;
using Id = std::uint32_t;

halfspace::Point2 PointOf(b2Vec2 v) { return {v.x, v.y}; }
halfspace::Aabb2 BoxOf(b2AABB box) {
  return {PointOf(box.lowerBound), PointOf(box.upperBound)};
}

// 64 category bits in the 32 of a mask. A bit of both inputs is in both
// results, so queries test the 64 bits of what they find again.
std::uint32_t Fold(std::uint64_t bits) {
  return static_cast<std::uint32_t>(bits | bits >> 32);
}
halfspace::BodyMasks MasksOf(std::uint64_t category_bits) {
  return {Fold(category_bits)};
}

bool IsProxy(const b2TreeNode& node) { return node.flags & b2_leafNode; }

// b2DynamicTree::leafIndices is the address of a pointer to the broad phase.
// Box2D frees the array when it restores a tree, and not the broad phase. So
// this list has the broad phase of each tree too.
constexpr int kLeafIndices = 2;
static_assert(sizeof(Bodies*) <= kLeafIndices * sizeof(std::int32_t));
std::mutex trees_mutex;
std::unordered_map<const b2DynamicTree*, std::unique_ptr<Bodies>> trees;

// Returns the broad phase of the tree. Makes it of the nodes if there is none.
Bodies& BodiesOf(const b2DynamicTree* const_tree) {
  auto* tree = const_cast<b2DynamicTree*>(const_tree);
  const std::atomic_ref<std::int32_t*> link(tree->leafIndices);
  if (link.load(std::memory_order_acquire) == nullptr) {
    const std::lock_guard lock(trees_mutex);
    if (link.load(std::memory_order_relaxed) == nullptr) {
      auto bodies = std::make_unique<Bodies>(
          halfspace::BroadPhaseOptions{.moves_are_seen_at_once = true});
      std::vector<Id> ids;
      std::vector<halfspace::Aabb2> boxes;
      std::vector<halfspace::BodyMasks> masks;
      for (int i = 0; i < tree->nodeCapacity; ++i) {
        const b2TreeNode& node = tree->nodes[i];
        if (!IsProxy(node)) continue;
        ids.push_back(static_cast<Id>(i));
        boxes.push_back(BoxOf(node.aabb));
        masks.push_back(MasksOf(node.categoryBits));
      }
      bodies->Insert(ids, boxes, masks);
      Bodies* const address = bodies.get();
      trees[tree] = std::move(bodies);
      tree->rebuildCapacity = kLeafIndices;
      auto* array = static_cast<std::int32_t*>(
          b2Alloc(kLeafIndices * sizeof(std::int32_t)));
      std::memcpy(array, &address, sizeof(address));
      link.store(array, std::memory_order_release);
    }
  }
  Bodies* bodies;
  std::memcpy(&bodies, link.load(std::memory_order_acquire), sizeof(bodies));
  return *bodies;
}

// Free nodes are a list.
void Grow(b2DynamicTree* tree, int capacity) {
  auto* nodes =
      static_cast<b2TreeNode*>(b2Alloc(capacity * sizeof(b2TreeNode)));
  std::memset(nodes, 0, capacity * sizeof(b2TreeNode));
  const int old = tree->nodeCapacity;
  if (old > 0) std::memcpy(nodes, tree->nodes, old * sizeof(b2TreeNode));
  b2Free(tree->nodes, old * sizeof(b2TreeNode));
  for (int i = old; i < capacity; ++i) nodes[i].next = i + 1;
  tree->nodes = nodes;
  tree->freeList = old;
  tree->nodeCapacity = capacity;
}

// Calls the function for the proxies of a query by their ids.
template <typename Wants>
b2TreeStats Query(const b2DynamicTree* tree, b2AABB box, std::uint32_t mask,
                  const Wants& wants, b2TreeQueryCallbackFcn* function,
                  void* context) {
  if (tree->proxyCount == 0) return {};
  // A function may query again.
  thread_local std::vector<Id> memory;
  std::vector<Id> found = std::move(memory);
  found.clear();
  halfspace::QueryStatistics statistics;
  halfspace::QueryOptions options;
  options.mask = mask;
  options.statistics = &statistics;
  ForEachSurvivor(
      BodiesOf(tree), BoxOf(box),
      [&](halfspace::Span<const Id> ids) {
        for (const Id id : ids) {
          if (wants(tree->nodes[id])) found.push_back(id);
        }
      },
      options);
  std::sort(found.begin(), found.end());
  b2TreeStats stats = {};
  stats.nodeVisits =
      static_cast<int>(statistics.node_blocks + statistics.leaves);
  for (const Id id : found) {
    ++stats.leafVisits;
    const int proxy = static_cast<int>(id);
    if (!function(proxy, tree->nodes[id].userData, context)) break;
  }
  memory = std::move(found);
  return stats;
}

// The function of a cast. `input` is Box2D's.
template <typename Input, typename Function>
auto OnHit(const b2DynamicTree* tree, Input& input, std::uint64_t mask_bits,
           Function* function, void* context, b2TreeStats& stats) {
  return [=, &input, &stats](Id id, float) {
    const b2TreeNode& node = tree->nodes[id];
    if ((node.categoryBits & mask_bits) != 0) {
      ++stats.leafVisits;
      const float value =
          function(&input, static_cast<int>(id), node.userData, context);
      if (value == 0) return halfspace::Limit{-1};
      if (0 < value && value < input.maxFraction) input.maxFraction = value;
    }
    return halfspace::Limit{input.maxFraction};
  };
}

halfspace::SearchOptions Search(std::uint64_t mask_bits) {
  halfspace::SearchOptions options;
  options.mask = Fold(mask_bits);
  return options;
}

}  // namespace

b2DynamicTree b2DynamicTree_Create(int proxyCapacity) {
  b2DynamicTree tree;
  std::memset(&tree, 0, sizeof(tree));
  Grow(&tree, std::max(proxyCapacity, 16));
  return tree;
}

void b2DynamicTree_Destroy(b2DynamicTree* tree) {
  {
    const std::lock_guard lock(trees_mutex);
    trees.erase(tree);
  }
  b2Free(tree->leafIndices, tree->rebuildCapacity * sizeof(std::int32_t));
  b2Free(tree->nodes, tree->nodeCapacity * sizeof(b2TreeNode));
  std::memset(tree, 0, sizeof(*tree));
}

int b2DynamicTree_CreateProxy(b2DynamicTree* tree, b2AABB aabb,
                              uint64_t categoryBits, uint64_t userData) {
  Bodies& bodies = BodiesOf(tree);
  if (tree->proxyCount == tree->nodeCapacity) {
    Grow(tree, tree->nodeCapacity + tree->nodeCapacity / 2);
  }
  const int proxy = tree->freeList;
  bodies.Insert(static_cast<Id>(proxy), BoxOf(aabb), MasksOf(categoryBits));
  b2TreeNode& node = tree->nodes[proxy];
  tree->freeList = node.next;
  node.aabb = aabb;
  node.categoryBits = categoryBits;
  node.userData = userData;
  node.next = 0;
  node.flags = b2_allocatedNode | b2_leafNode;
  tree->nodeCount = ++tree->proxyCount;
  return proxy;
}

void b2DynamicTree_DestroyProxy(b2DynamicTree* tree, int proxyId) {
  B2_ASSERT(IsProxy(tree->nodes[proxyId]));
  BodiesOf(tree).Erase(static_cast<Id>(proxyId));
  b2TreeNode& node = tree->nodes[proxyId];
  node.flags = 0;
  node.next = tree->freeList;
  tree->freeList = proxyId;
  tree->nodeCount = --tree->proxyCount;
}

void b2DynamicTree_MoveProxy(b2DynamicTree* tree, int proxyId, b2AABB aabb) {
  B2_ASSERT(IsProxy(tree->nodes[proxyId]));
  BodiesOf(tree).Move(static_cast<Id>(proxyId), BoxOf(aabb));
  tree->nodes[proxyId].aabb = aabb;
}

void b2DynamicTree_EnlargeProxy(b2DynamicTree* tree, int proxyId, b2AABB aabb) {
  b2DynamicTree_MoveProxy(tree, proxyId, aabb);
}

void b2DynamicTree_SetCategoryBits(b2DynamicTree* tree, int proxyId,
                                   uint64_t categoryBits) {
  B2_ASSERT(IsProxy(tree->nodes[proxyId]));
  BodiesOf(tree).SetMasks(static_cast<Id>(proxyId), MasksOf(categoryBits));
  tree->nodes[proxyId].categoryBits = categoryBits;
}

uint64_t b2DynamicTree_GetCategoryBits(b2DynamicTree* tree, int proxyId) {
  return tree->nodes[proxyId].categoryBits;
}

uint64_t b2DynamicTree_GetUserData(const b2DynamicTree* tree, int proxyId) {
  return tree->nodes[proxyId].userData;
}

b2AABB b2DynamicTree_GetAABB(const b2DynamicTree* tree, int proxyId) {
  return tree->nodes[proxyId].aabb;
}

b2TreeStats b2DynamicTree_Query(const b2DynamicTree* tree, b2AABB aabb,
                                uint64_t maskBits,
                                b2TreeQueryCallbackFcn* callback,
                                void* context) {
  const auto wants = [=](const b2TreeNode& node) {
    return (node.categoryBits & maskBits) != 0;
  };
  return Query(tree, aabb, Fold(maskBits), wants, callback, context);
}

b2TreeStats b2DynamicTree_QueryAll(const b2DynamicTree* tree, b2AABB aabb,
                                   b2TreeQueryCallbackFcn* callback,
                                   void* context) {
  const auto wants = [](const b2TreeNode&) { return true; };
  return Query(tree, aabb, 0xffffffff, wants, callback, context);
}

b2TreeStats b2DynamicTree_RayCast(const b2DynamicTree* tree,
                                  const b2RayCastInput* input,
                                  uint64_t maskBits,
                                  b2TreeRayCastCallbackFcn* callback,
                                  void* context) {
  b2TreeStats stats = {};
  if (tree->proxyCount == 0) return stats;
  b2RayCastInput rest = *input;
  const halfspace::Ray2 ray = {PointOf(input->origin),
                               PointOf(input->translation), input->maxFraction};
  RayCast(BodiesOf(tree), ray,
          OnHit(tree, rest, maskBits, callback, context, stats),
          Search(maskBits));
  return stats;
}

b2TreeStats b2DynamicTree_BoxCast(const b2DynamicTree* tree,
                                  const b2BoxCastInput* input,
                                  uint64_t maskBits,
                                  b2TreeBoxCastCallbackFcn* callback,
                                  void* context) {
  b2TreeStats stats = {};
  if (tree->proxyCount == 0) return stats;
  b2BoxCastInput rest = *input;
  BoxCast(BodiesOf(tree), BoxOf(input->box), PointOf(input->translation),
          input->maxFraction,
          OnHit(tree, rest, maskBits, callback, context, stats),
          Search(maskBits));
  return stats;
}

int b2DynamicTree_GetHeight(const b2DynamicTree* tree) {
  if (tree->proxyCount == 0) return 0;
  return std::bit_width(static_cast<unsigned>(tree->proxyCount) - 1);
}

float b2DynamicTree_GetAreaRatio(const b2DynamicTree* tree) {
  if (tree->proxyCount == 0) return 0;
  return static_cast<float>(BodiesOf(tree).Statistics().cost_ratio);
}

b2AABB b2DynamicTree_GetRootBounds(const b2DynamicTree* tree) {
  if (tree->proxyCount == 0) return {};
  const halfspace::Aabb2 all = BodiesOf(tree).Bounds();
  return {{all.min[0], all.min[1]}, {all.max[0], all.max[1]}};
}

int b2DynamicTree_GetProxyCount(const b2DynamicTree* tree) {
  return tree->proxyCount;
}

// Box2D calls it once in each step, for moving bodies.
int b2DynamicTree_Rebuild(b2DynamicTree* tree, bool fullBuild) {
  if (tree->proxyCount == 0) return 0;
  if (!fullBuild) {
    BodiesOf(tree).Update();
    return 0;
  }
  BodiesOf(tree).Rebuild();
  return tree->proxyCount;
}

int b2DynamicTree_GetByteCount(const b2DynamicTree* tree) {
  std::size_t bytes = sizeof(*tree) + tree->nodeCapacity * sizeof(b2TreeNode);
  if (tree->proxyCount > 0) bytes += BodiesOf(tree).Statistics().bytes;
  return static_cast<int>(bytes);
}

void b2DynamicTree_Validate(const b2DynamicTree* tree) {
  if (tree->proxyCount == 0) return;
  B2_VALIDATE(BodiesOf(tree).size() ==
              static_cast<std::size_t>(tree->proxyCount));
  B2_VALIDATE(BodiesOf(tree).Validate());
}

void b2DynamicTree_ValidateNoEnlarged(const b2DynamicTree*) {}

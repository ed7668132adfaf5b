// A tree of an engine's own, with 64 children in a node: its walk is compiled
// for each target by Highway, and tests a node by one inline call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels_inline.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// After foreach_target.h.
#include "halfspace/kernels-inl.h"
#include "hwy/highway.h"

#ifndef EXAMPLE_NODE
#define EXAMPLE_NODE
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

// The boxes of 64 children, plane after plane, and the first child's number.
struct Node {
  float planes[6][64];
  std::size_t first_child;
};
#endif

HWY_BEFORE_NAMESPACE();
namespace example::HWY_NAMESPACE {

// The root's children are nodes, and their children are objects.
std::size_t CountTouched(const Node* nodes, const float* query) {
  const auto survivors_of = [query](const Node& node) HWY_ATTR {
    const float* planes[6];
    for (std::size_t p = 0; p < 6; ++p) planes[p] = node.planes[p];
    return halfspace::HWY_NAMESPACE::SurvivorsOf64Boxes<3>(planes, 0, query);
  };
  std::size_t count = 0;
  for (std::uint64_t left = survivors_of(nodes[0]); left != 0;
       left &= left - 1) {
    const std::size_t child =
        nodes[0].first_child + hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
    count += hwy::PopCount(survivors_of(nodes[child]));
  }
  return count;
}

}  // namespace example::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace example {

HWY_EXPORT(CountTouched);

// Boxes of side 1 in a row, 2 apart, on two levels.
std::vector<Node> MakeTree() {
  std::vector<Node> nodes(65);
  nodes[0].first_child = 1;
  for (std::size_t i = 0; i < 64 * 64; ++i) {
    const float x = 2.0f * static_cast<float>(i);
    const float box[6] = {x, 0, 0, x + 1, 1, 1};
    Node& leaf = nodes[1 + i / 64];
    for (std::size_t p = 0; p < 6; ++p) {
      leaf.planes[p][i % 64] = box[p];
      float& bound = nodes[0].planes[p][i / 64];
      if (i % 64 == 0 || p >= 3) bound = box[p];
    }
  }
  return nodes;
}

std::size_t CountOnBestTarget(const Node* nodes, const float* query) {
  return HWY_DYNAMIC_DISPATCH(CountTouched)(nodes, query);
}

}  // namespace example

int main() {
  const std::vector<Node> nodes = example::MakeTree();
  const float query[] = {100, 0, 0, 200, 1, 1};  // min x y z, max x y z
  const std::size_t touched = example::CountOnBestTarget(nodes.data(), query);
  std::printf("%zu objects could touch the query\n", touched);
  return touched == 51 ? 0 : 1;
}
#endif

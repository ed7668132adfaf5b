// Pairs that touch, and so may never be rejected.
#ifndef HALFSPACE_TESTS_LIBRARY_END_TO_END_KEPT_H_
#define HALFSPACE_TESTS_LIBRARY_END_TO_END_KEPT_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "halfspace/reject.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {

namespace internal {

template <typename AnyWorld>
bool Keeps(const AnyWorld& world, const typename AnyWorld::Query& query,
           std::size_t object, const Options& options) {
  thread_local std::vector<std::uint64_t> mask;
  mask.resize(MaskWords(world.view().size));
  RejectMask(world, query, mask, options);
  return (mask[object / 64] >> (object % 64) & 1) == 0;
}

}  // namespace internal

// Object i is kept by query i, as a simplex, a box and an octahedron, on every
// target.
template <int kDims>
::testing::AssertionResult AllKept(const std::vector<Aabo<kDims>>& objects,
                                   const std::vector<Aabo<kDims>>& queries) {
  const AaboWorld<kDims> world(objects);
  const SimplexView<kDims> simplices = world.view().simplex();
  const AabbView<kDims> boxes = world.view().aabb();
  for (Target target : TargetsUnderTest()) {
    const Options options{.target = target};
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const Aabo<kDims>& query = queries[i];
      const char* format =
          !internal::Keeps(simplices, query.down(), i, options) ? "simplex"
          : !internal::Keeps(boxes, query.aabb(), i, options)   ? "AABB"
          : !internal::Keeps(world, query, i, options)          ? "AABO"
                                                                : nullptr;
      if (format == nullptr) continue;
      return ::testing::AssertionFailure() << "pair " << i << " is rejected as "
                                           << format << " on " << target.name();
    }
  }
  return ::testing::AssertionSuccess();
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_END_TO_END_KEPT_H_

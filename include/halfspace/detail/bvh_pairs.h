// Internal. The calls of bvh_pairs.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_BVH_PAIRS_H_
#define HALFSPACE_DETAIL_BVH_PAIRS_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace {

struct IdPair;
struct PairOptions;

namespace detail {

struct BvhPairKernels;

// As BvhKernelsOf, in object files of their own.
template <std::size_t kAxes>
struct HALFSPACE_API BvhPairKernelsOf {
  static const BvhPairKernels* const kTargets;
};
extern template struct BvhPairKernelsOf<2>;
extern template struct BvhPairKernelsOf<3>;
extern template struct BvhPairKernelsOf<4>;

struct PairSources {
  const BvhPairKernels* kernels;  // of each target
  const BvhTree* a;
  const BvhTree* b;                      // null: the pairs of a
  const Span<const std::uint32_t>* ids;  // null: all
};

// Returns whether to go on.
using PairsFunction = bool (*)(void* context, Span<const IdPair> pairs);

HALFSPACE_API std::size_t BvhPairs(const PairSources& sources,
                                   Span<IdPair> pairs,
                                   const PairOptions& options);
HALFSPACE_API void BvhForEachPair(const PairSources& sources,
                                  PairsFunction function, void* context,
                                  const PairOptions& options);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_BVH_PAIRS_H_

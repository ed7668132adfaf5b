// Internal. The calls of sorted_pairs.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_SORTED_PAIRS_H_
#define HALFSPACE_DETAIL_SORTED_PAIRS_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/sorted.h"
#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace {

struct IdPair;
struct PairOptions;

namespace detail {

struct SortedPairKernels;

// As SortedKernelsOf, in object files of their own.
template <std::size_t kAxes>
struct HALFSPACE_API SortedPairKernelsOf {
  static const SortedPairKernels* const kTargets;
};
extern template struct SortedPairKernelsOf<2>;
extern template struct SortedPairKernelsOf<3>;
extern template struct SortedPairKernelsOf<4>;

struct PairSources {
  const SortedPairKernels* kernels;  // of each target
  const SortedTree* a;
  const SortedTree* b;                   // null: the pairs of a
  const Span<const std::uint32_t>* ids;  // null: all
};

// Returns whether to go on.
using PairsFunction = bool (*)(void* context, Span<const IdPair> pairs);

HALFSPACE_API std::size_t SortedPairs(const PairSources& sources,
                                      Span<IdPair> pairs,
                                      const PairOptions& options);
HALFSPACE_API void SortedForEachPair(const PairSources& sources,
                                     PairsFunction function, void* context,
                                     const PairOptions& options);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_SORTED_PAIRS_H_

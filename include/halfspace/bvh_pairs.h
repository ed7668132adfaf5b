// All overlapping pairs of objects of a BVH (bvh.h): the broad phase.
//
//   std::vector<halfspace::IdPair> pairs(room);
//   const std::size_t count = Pairs(bvh, pairs);
//
// Bounds a and b overlap unless a plane separates them: a.min[k] > b.max[k] or
// b.min[k] > a.max[k] for an axis k. That is the rule of reject.h. So bounds
// that touch overlap, and a NaN separates nothing. An Empty() bound overlaps
// only bounds with NaNs or infinities. Erased objects are in no pair.
//
// BVHs are of boxes or octahedra, in 2 or 3 dimensions. There are no pairs of
// simplices: two simplices of one kind have no planes that face each other.
//
// Pairs() writes to a span and returns the number of pairs. If the span is
// shorter than that, it is filled, and the full number is returned. An empty
// span counts. Elements behind the last pair may be overwritten. ForEachPair()
// calls function(Span<const IdPair>) with 1 to 256 pairs at a time. The
// function returns nothing, or Visit (visit.h): kStop ends the call. Exceptions
// of the function pass through. Equal calls on an unchanged BVH find the
// pairs in the same order.
//
// Errors (error.h), in every call: an output with room or a list of ids is null
// or misaligned; an id is not that of an object in the BVH; the margin or
// `within` is negative or not finite, or both are above 0; `wanted` is not
// empty and has another size than `ids`, or the call has no set; the target is
// not supported.
//
// Floating-point mode: as in bvh.h.
//
// Thread safety: calls on the same BVHs may run at the same time, and can
// share one join (PairOptions::begin). A call uses up to 16 KiB of stack and
// locks nothing. Only PairsOf() and ForEachPairOf() can allocate.
//
// Cost: one query per leaf of 64 objects, and a comparison of the objects of
// leaves that overlap: 12 ns per pair if an object is in 5 pairs, 3 ns if it is
// in 50 (`./bench.sh --details bvh`).
//
// Source: "The Bounding Simplex: A SIMD-Era Rejection Primitive" (its order as
// a hierarchy, which here meets itself).
#ifndef HALFSPACE_BVH_PAIRS_H_
#define HALFSPACE_BVH_PAIRS_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/bvh.h"
#include "halfspace/detail/bvh.h"
#include "halfspace/span.h"
#include "halfspace/target.h"
#include "halfspace/visit.h"

namespace halfspace {

// The ids of two objects. With two BVHs, `a` is from the first.
struct IdPair {
  std::uint32_t a;
  std::uint32_t b;

  friend bool operator==(const IdPair& left, const IdPair& right) {
    return left.a == right.a && left.b == right.b;
  }
  friend bool operator!=(const IdPair& left, const IdPair& right) {
    return !(left == right);
  }
};

// Options of the searches for pairs.
struct PairOptions {
  // Finds only pairs in which the mask of each object has at least one of these
  // bits, not necessarily the same one. All ones finds all objects.
  std::uint32_t mask = 0xFFFFFFFF;
  // Only of PairsOf() and ForEachPairOf(): empty, or one mask for each id.
  // Object ids[i] wants the objects whose mask (Bvh::SetMasks) has at least one
  // bit of wanted[i]. All ones wants all objects. A pair with an object outside
  // the set is found if the object of the set wants the other one. A pair of
  // two objects of the set is found if at least one wants the other; the
  // pair's `a` does. If an id is given twice, it wants what either mask wants.
  Span<const std::uint32_t> wanted = {};
  // Also finds pairs that are at most this far apart on each of X, Y and Z. On
  // D they may be as many times as far apart as there are dimensions. The bound
  // of one of them, grown on all sides, overlaps the other. Values are rounded
  // outward, so a pair can be found that is farther apart by up to 2^-21 of its
  // coordinates and of the margin. Must be finite and not negative.
  float margin = 0;
  // Also finds pairs of boxes whose Euclidean distance is at most this. Boxes
  // with min == max are points. Octahedra are as far apart as their boxes, and
  // no pair if they are more than sqrt(dimensions) times this apart on D. The
  // distance of the stored planes decides: a pair can be found that is farther
  // apart by 2^-48 of it, and on D by 2^-18. Must be finite and not negative,
  // and 0 if there is a margin.
  float within = 0;
  // The first `skip` pairs are not written, and no function is called for them.
  // So a call that had no room for all pairs can be continued. The number that
  // is returned is the full number.
  std::size_t skip = 0;
  // Finds only the pairs of parts begin ... end - 1 of PairParts(). Each pair
  // belongs to one part, so calls with disjoint ranges, on any threads, find
  // each pair once. Parts take unequal times, so use more ranges than threads.
  // An `end` beyond the last part means the last, and there are no pairs if
  // `begin` is not below `end`.
  std::size_t begin = 0;
  std::size_t end = static_cast<std::size_t>(-1);
  Target target = {};  // by default, the chosen one (targets.h)
};

namespace detail {

template <typename View>
const BvhPairKernels* PairKernels() {
  static_assert(HasMax<typename View::Bound>,
                "pairs are of bounds with minima and maxima: two simplices of "
                "one kind have no planes that face each other");
  return BvhPairKernelsOf<View::Bound::kAxes>::kTargets;
}

template <typename View>
PairSources PairsIn(const Bvh<View>& a, const Bvh<View>* b = nullptr,
                    const Span<const std::uint32_t>* ids = nullptr) {
  return {PairKernels<View>(), &CoreOf(a), b == nullptr ? nullptr : &CoreOf(*b),
          ids};
}

template <typename Function>
void CallForPairs(const PairSources& sources, Function& function,
                  const PairOptions& options) {
  Callback call{function};
  BvhForEachPair(sources, &decltype(call)::Run, &call, options);
}

}  // namespace detail

// The number of parts of Pairs(bvh) and of Pairs(bvh, other). Changes of
// the BVH change it.
template <typename View>
std::size_t PairParts(const Bvh<View>& bvh) {
  return (bvh.ids().size() + 63) / 64;
}

// The pairs of objects of one BVH. Each pair is found once. The order is that
// of the tree: `a` has an earlier slot than `b` in ids(), and the pairs are
// sorted by the leaf of `a`, then by the leaf of `b`. A leaf is 64 slots.
// Inside of two leaves the order is unspecified. So the pairs of two searches
// with a small change between them are nearly the same list (pair_events.h).
template <typename View>
[[nodiscard]] std::size_t Pairs(const Bvh<View>& bvh, Span<IdPair> pairs,
                                const PairOptions& options = {}) {
  return detail::BvhPairs(detail::PairsIn(bvh), pairs, options);
}
template <typename View, typename Function>
void ForEachPair(const Bvh<View>& bvh, Function&& function,
                 const PairOptions& options = {}) {
  detail::CallForPairs(detail::PairsIn(bvh), function, options);
}

// The pairs of an object of `a` and an object of `b`.
template <typename View>
[[nodiscard]] std::size_t Pairs(const Bvh<View>& a, const Bvh<View>& b,
                                Span<IdPair> pairs,
                                const PairOptions& options = {}) {
  return detail::BvhPairs(detail::PairsIn(a, &b), pairs, options);
}
template <typename View, typename Function>
void ForEachPair(const Bvh<View>& a, const Bvh<View>& b, Function&& function,
                 const PairOptions& options = {}) {
  detail::CallForPairs(detail::PairsIn(a, &b), function, options);
}

// The pairs of an object of a set, which is IdPair::a, and any other object:
// the pairs that can be new after these objects moved. A pair of two objects of
// the set is found once, and `a` has the earlier slot in ids(). The call does
// not say whether `b` is in the set too. A caller that accepts such a pair in
// one order only, as Jolt does, keeps the place of each object in its list, by
// id, and swaps the two if `b` has an earlier one
// (examples/engines/active_pairs.h). An id may be in the list more than once.
//
// The cost grows with the set and not with the BVH: up to 1.5 times that of a
// Survivors() call for each object of a small set, and less for a large one.
// The exception is a BVH that has never changed by id, in which each call
// searches ids() for the objects, O(n). Reserve(size()) prevents that.
//
// PairsOf() and ForEachPairOf() allocate nothing for up to 63 ids in a BVH
// that has changed by id. Otherwise they can allocate from the BVH's
// MemoryResource (Bvh::memory()), in the calling thread, and free it before
// they return: up to 128 bytes for each id, but not more than a quarter of a
// byte for each object, and 4 bytes for each id with `wanted`. The search needs
// one bit more for each object. With `wanted` the set takes twice the memory.
// The BVH is const, but its resource is used: calls that run at the same
// time, such as those on different parts, need a resource that is thread-safe.
// The default resource is. A failed allocation throws std::bad_alloc before a
// pair is written and before the function is called.
template <typename Tree, typename View = detail::SearchedView<Tree>>
[[nodiscard]] std::size_t PairsOf(const Tree& tree,
                                  Span<const std::uint32_t> ids,
                                  Span<IdPair> pairs,
                                  const PairOptions& options = {}) {
  return detail::CoreOf(tree).PairsOf(detail::PairKernels<View>(), ids, pairs,
                                      options);
}
template <typename Tree, typename Function,
          typename View = detail::SearchedView<Tree>>
void ForEachPairOf(const Tree& tree, Span<const std::uint32_t> ids,
                   Function&& function, const PairOptions& options = {}) {
  detail::Callback call{function};
  detail::CoreOf(tree).ForEachPairOf(detail::PairKernels<View>(), ids,
                                     &decltype(call)::Run, &call, options);
}

// The pairs of an object of a set of `bvh` and an object of `other`.
template <typename View>
[[nodiscard]] std::size_t PairsOf(const Bvh<View>& bvh,
                                  Span<const std::uint32_t> ids,
                                  const Bvh<View>& other, Span<IdPair> pairs,
                                  const PairOptions& options = {}) {
  return detail::BvhPairs(detail::PairsIn(bvh, &other, &ids), pairs, options);
}
template <typename View, typename Function>
void ForEachPairOf(const Bvh<View>& bvh, Span<const std::uint32_t> ids,
                   const Bvh<View>& other, Function&& function,
                   const PairOptions& options = {}) {
  detail::CallForPairs(detail::PairsIn(bvh, &other, &ids), function, options);
}

}  // namespace halfspace

#endif  // HALFSPACE_BVH_PAIRS_H_

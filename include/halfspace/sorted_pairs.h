// All pairs of objects of sorted worlds whose bounds touch or overlap.
//
//   std::vector<halfspace::IdPair> pairs(room);
//   const std::size_t count = Pairs(sorted, pairs);
//
// Bounds a and b overlap unless a plane separates them: a.min[k] > b.max[k] or
// b.min[k] > a.max[k] for an axis k. That is the rule of reject.h, with an
// object for the query. So bounds that touch overlap, a NaN separates nothing,
// and of bounds without NaNs and infinities none overlaps Empty(). Erased
// objects are in no pair.
//
// Worlds are those of sorted.h that have minima and maxima: boxes and
// octahedra, in 2 or 3 dimensions. No two simplices of a kind have planes that
// face each other, so nothing tells them apart.
//
// Every call takes
//   world    a SortedWorld, or two of one type
//   options  categories, parts, and target; the defaults are right
// and gives pairs in no particular order
//   to a span      and returns how many there are. A span that is too short is
//                  no error: it is filled, and the full count is returned; an
//                  empty one counts. Elements after the last pair may be
//                  overwritten.
//   to a function  of Span<const IdPair>, 1 to 256 at a time. A function that
//                  returns a bool ends the call by returning false. Exceptions
//                  of the function pass through.
//
// Errors (error.h): no span or list with room is null or misaligned, ids are
// those of objects in the world, and the target is supported here.
//
// Floating-point mode: as in sorted.h.
//
// Thread safety: calls on the same worlds may run at the same time, and share
// one join by parts (PairOptions). They use up to 32 KiB of stack and lock
// nothing. Only PairsOf() and ForEachPairOf() allocate: see there.
//
// Cost: a query for each 64 objects, and a compare of those that meet the
// bounds of each other's 64: 12 ns a pair where an object is in 5 pairs, 3 ns
// where it is in 50.
//
// Source: "The Bounding Simplex: A SIMD-Era Rejection Primitive" (its order as
// a hierarchy, here met by itself).
#ifndef HALFSPACE_SORTED_PAIRS_H_
#define HALFSPACE_SORTED_PAIRS_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/sorted_pairs.h"
#include "halfspace/sorted.h"
#include "halfspace/span.h"
#include "halfspace/targets.h"

namespace halfspace {

// The ids of two objects; of two worlds, `a` is one of the first.
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

struct PairOptions {
  // Only pairs of objects that each have one of these categories, not
  // necessarily the same; all ones stands for all objects, as in SortedOptions.
  std::uint32_t categories = 0xFFFFFFFF;
  // Only parts begin ... end - 1 of PairParts(). Each pair belongs to one part,
  // so calls on parts that are apart, on any threads, give each pair once.
  // Parts take unequal times: have more ranges than threads.
  std::size_t begin = 0;
  std::size_t end = static_cast<std::size_t>(-1);
  Target target = {};  // by default, the chosen one (targets.h)
};

namespace detail {

template <typename View>
PairSources PairsIn(const SortedWorld<View>& a,
                    const SortedWorld<View>* b = nullptr,
                    const Span<const std::uint32_t>* ids = nullptr) {
  static_assert(HasMax<typename View::Bound>,
                "pairs are of bounds with minima and maxima: two simplices of "
                "one kind have no planes that face each other");
  return {SortedPairKernelsOf<View::Bound::kAxes>::kTargets, &a.tree(),
          b == nullptr ? nullptr : &b->tree(), ids};
}

template <typename Function>
void CallForPairs(const PairSources& sources, Function& function,
                  const PairOptions& options) {
  auto call = [&function](Span<const IdPair> pairs) { return function(pairs); };
  SortedForEachPair(sources, &CallWithSome<IdPair, decltype(call)>, &call,
                    options);
}

}  // namespace detail

// How many parts a join has whose first or only world this is.
template <typename View>
std::size_t PairParts(const SortedWorld<View>& world) {
  return (world.ids().size() + 63) / 64;
}

// The pairs of objects of one world, each once: {i, j} or {j, i}.
template <typename View>
[[nodiscard]] std::size_t Pairs(const SortedWorld<View>& world,
                                Span<IdPair> pairs,
                                const PairOptions& options = {}) {
  return detail::SortedPairs(detail::PairsIn(world), pairs, options);
}
template <typename View, typename Function>
void ForEachPair(const SortedWorld<View>& world, Function&& function,
                 const PairOptions& options = {}) {
  detail::CallForPairs(detail::PairsIn(world), function, options);
}

// The pairs of an object of `a` and one of `b`.
template <typename View>
[[nodiscard]] std::size_t Pairs(const SortedWorld<View>& a,
                                const SortedWorld<View>& b, Span<IdPair> pairs,
                                const PairOptions& options = {}) {
  return detail::SortedPairs(detail::PairsIn(a, &b), pairs, options);
}
template <typename View, typename Function>
void ForEachPair(const SortedWorld<View>& a, const SortedWorld<View>& b,
                 Function&& function, const PairOptions& options = {}) {
  detail::CallForPairs(detail::PairsIn(a, &b), function, options);
}

// The pairs of an object of a set, which is IdPair::a, and any other object:
// the pairs that can be new after these objects moved. A pair of two objects of
// the set is found once. An id may be in the list more than once.
//
// Both calls allocate a bit for each object from the world's MemoryResource
// (SortedWorld::memory()), in the calling thread, and free it before they
// return. The world is const, but its resource is used: calls that run at the
// same time, such as those on different parts, need a resource that is
// thread-safe. The default resource is. A failed allocation throws
// std::bad_alloc before a pair is written and before the function is called.
//
// A world that has never changed by id (SortedWorld::Set) takes two bits for
// each object, and 0.6 ns for each object to find their places.
template <typename View>
[[nodiscard]] std::size_t PairsOf(const SortedWorld<View>& world,
                                  Span<const std::uint32_t> ids,
                                  Span<IdPair> pairs,
                                  const PairOptions& options = {}) {
  return detail::SortedPairs(detail::PairsIn<View>(world, nullptr, &ids), pairs,
                             options);
}
template <typename View, typename Function>
void ForEachPairOf(const SortedWorld<View>& world,
                   Span<const std::uint32_t> ids, Function&& function,
                   const PairOptions& options = {}) {
  detail::CallForPairs(detail::PairsIn<View>(world, nullptr, &ids), function,
                       options);
}

}  // namespace halfspace

#endif  // HALFSPACE_SORTED_PAIRS_H_

// Worlds: stored bounds as a structure of arrays. A view refers to memory of
// the caller. An owning world allocates its memory.
//
//   halfspace::AabbWorld3 world;
//   world.Push({{0, 0, 0}, {1, 1, 1}});
//   world.Push(halfspace::BoundSphere(sphere).aabb());  // fit.h
//   const std::size_t n = halfspace::CountSurvivors(world, query);  // reject.h
//
// A world of n objects has one array of n floats for each plane. A world of
// boxes can have doubles instead.
// Object i is element i of every plane.
//
//   view                planes                               queried by
//   SimplexView<D>      min[0 .. D]                          DownSimplex<D>
//   AabbView<D>         min[0 .. D-1], max[0 .. D-1]         Aabb<D>
//   AaboView<D>         min[0 .. D], max[0 .. D]             Aabo<D>
//
// AabbView<D, double> is a view of doubles. Its queries are boxes of doubles.
// It scans columns of a database in place, because boxes need no rounding. A
// test of doubles takes twice the time, because it reads twice the bytes.
// Simplices and octahedra have a D axis, which has to be rounded outward. Build
// them as floats that enclose the doubles (fit.h, fit_many.h).
//
// Planes may have any values. A plane with a NaN never rejects its object.
//
// Thread safety: as for any container. Any number of threads may read a world
// at the same time. A write needs exclusive access.
#ifndef HALFSPACE_WORLD_H_
#define HALFSPACE_WORLD_H_

#include <array>
#include <cstddef>

#include "halfspace/bounds.h"
#include "halfspace/detail/plane_arrays.h"
#include "halfspace/memory.h"
#include "halfspace/planes.h"
#include "halfspace/span.h"

namespace halfspace {

// A view copies nothing and owns nothing. The planes must outlive every call
// that uses the view, and must not be written during such a call.
//
// Each plane must be aligned for its element type. Planes need not be adjacent,
// padded or aligned further. A call reads elements 0 ... size - 1 of each plane
// and nothing else. A plane may be null only if `size` is 0.
template <int kDims>
struct SimplexView {
  using Bound = UpSimplex<kDims>;
  using Query = DownSimplex<kDims>;
  using Planes = SimplexPlanes<kDims>;

  std::array<const float*, Bound::kAxes> min{};
  std::size_t size = 0;

  const SimplexView& view() const { return *this; }
};

template <int kDims, typename T = float>
struct AabbView {
  using Bound = Aabb<kDims, T>;
  using Query = Aabb<kDims, T>;
  using Planes = AabbPlanes<kDims, T>;

  std::array<const T*, Bound::kAxes> min{};
  std::array<const T*, Bound::kAxes> max{};
  std::size_t size = 0;

  const AabbView& view() const { return *this; }
};

template <int kDims>
struct AaboView {
  using Bound = Aabo<kDims>;
  using Query = Aabo<kDims>;
  using Planes = AaboPlanes<kDims>;

  std::array<const float*, Bound::kAxes> min{};
  std::array<const float*, Bound::kAxes> max{};
  std::size_t size = 0;

  const AaboView& view() const { return *this; }

  // An AABO world is also a simplex world and an AABB world. simplex() and
  // aabb() return views of the same planes, at no cost.
  SimplexView<kDims> simplex() const { return {min, size}; }
  AabbView<kDims> aabb() const {
    AabbView<kDims> box;
    for (std::size_t k = 0; k < kDims; ++k) {
      box.min[k] = min[k];
      box.max[k] = max[k];
    }
    box.size = size;
    return box;
  }
};

using SimplexView2 = SimplexView<2>;
using SimplexView3 = SimplexView<3>;
using AabbView2 = AabbView<2>;
using AabbView3 = AabbView<3>;
using AaboView2 = AaboView<2>;
using AaboView3 = AaboView<3>;

// A world that owns its planes. The names to use are SimplexWorld, AabbWorld
// and AaboWorld below.
//
// Every plane starts on a 64-byte boundary and is padded with Empty() bounds to
// a multiple of 64 objects.
//
// The index of an object is its position. EraseBySwap changes the index of the
// last object. No other call changes an index.
//
// If indices must never change, do not erase. Overwrite the object with
// Set(i, Bound::Empty()), and later reuse index i for a new object with
// Set(i, bound). No finite query finds an Empty() object. It takes as much
// memory and time as any other object, and size() counts it. The caller keeps
// the list of free indices.
//
// Errors (error.h): an index must be less than size(). A size must fit the
// address space. The pointer of a list with elements must not be null or
// misaligned. A failed allocation throws std::bad_alloc. After an error the
// world is unchanged.
//
// Memory: one block, from the heap or from the caller's resource. memory.h says
// which resource copies, moves and swap(a, b) use.
template <typename ViewType>
class World {
 public:
  using View = ViewType;
  using Bound = typename View::Bound;
  using Query = typename View::Query;
  using Planes = typename View::Planes;

  World() : World(MemoryResource()) {}
  explicit World(const MemoryResource& memory)
      : planes_(detail::Planes(Bound::Empty()), memory) {}

  // Creates a world of the given bounds, in order.
  explicit World(Span<const Bound> bounds, const MemoryResource& memory = {})
      : World(memory) {
    Assign(bounds);
  }

  World(const World& other, const MemoryResource& memory)
      : planes_(other.planes_, memory) {}

  friend void swap(World& a, World& b) noexcept { swap(a.planes_, b.planes_); }

  const MemoryResource& memory() const { return planes_.memory(); }
  std::size_t size() const { return planes_.size(); }
  std::size_t capacity() const { return planes_.capacity(); }
  bool empty() const { return size() == 0; }

  // Allocates room for `objects` objects in total. Never shrinks.
  void Reserve(std::size_t objects) { planes_.Reserve(objects); }

  // Appends an object and returns its index. Doubles the capacity if the world
  // is full. Amortized O(1).
  std::size_t Push(const Bound& bound) {
    return planes_.Push(detail::Planes(bound).data());
  }

  // Replaces the bound of object `index`. O(1).
  void Set(std::size_t index, const Bound& bound) {
    planes_.Set(index, detail::Planes(bound).data());
  }

  // Returns the bound of object `index`. O(1).
  Bound Get(std::size_t index) const {
    detail::PlaneValues<Bound> values;
    planes_.Get(index, values.data());
    return detail::BoundOf<Bound>(values);
  }

  // Removes object `index` and moves the last object to its place. O(1).
  void EraseBySwap(std::size_t index) { planes_.EraseBySwap(index); }

  // Changes the number of objects. New objects are Empty().
  void Resize(std::size_t objects) { planes_.Resize(objects); }

  // Removes all objects and keeps the memory. O(size), because it overwrites
  // all objects with padding.
  void Clear() { planes_.Resize(0); }

  // Replaces all objects by the given bounds, in order. The bounds must not be
  // in the memory of this world.
  void Assign(Span<const Bound> bounds) {
    planes_.Assign(detail::RecordsOf(bounds), bounds.size());
  }

  // Returns a view of the current objects. A later Push, EraseBySwap, Resize or
  // Clear does not change the size of the view. The view is valid until the
  // world allocates a larger block, or is assigned to, moved from or destroyed.
  View view() const { return detail::ViewOf<View>(planes_); }

  // Returns the same planes for writing, for example by the builders of
  // fit_many.h. Valid as long as view().
  Planes planes() { return detail::ViewOf<Planes>(planes_); }

 private:
  detail::PlaneArrays<typename Bound::Scalar> planes_;
};

template <int kDims>
using SimplexWorld = World<SimplexView<kDims>>;
template <int kDims, typename T = float>
using AabbWorld = World<AabbView<kDims, T>>;
template <int kDims>
using AaboWorld = World<AaboView<kDims>>;

using SimplexWorld2 = SimplexWorld<2>;
using SimplexWorld3 = SimplexWorld<3>;
using AabbWorld2 = AabbWorld<2>;
using AabbWorld3 = AabbWorld<3>;
using AaboWorld2 = AaboWorld<2>;
using AaboWorld3 = AaboWorld<3>;

}  // namespace halfspace

#endif  // HALFSPACE_WORLD_H_

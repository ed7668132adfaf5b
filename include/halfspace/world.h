// Worlds: stored bounds as a structure of arrays, either as a view of the
// caller's memory or as an owning container.
//
// A world of n objects is one array of n floats, or of n doubles, per plane.
// Object i is element i of every plane.
//
//   view                planes                               queried by
//   SimplexView<D>      min[0 .. D]                          DownSimplex<D>
//   AabbView<D>         min[0 .. D-1], max[0 .. D-1]         Aabb<D>
//   AaboView<D>         min[0 .. D], max[0 .. D]             Aabo<D>
//
// SimplexView<D, double>, AabbView<D, double> and AaboView<D, double> are views
// of doubles and are queried by bounds of doubles: for data that is stored in
// double precision, as in a database. A test of doubles takes twice the time,
// because it reads twice the bytes.
//
// An AABO world is also a simplex world and an AABB world: simplex() and aabb()
// of a view select some of its planes, at no cost.
//
// Views copy nothing. Planes need not be adjacent to each other, nor aligned
// beyond what their elements need, nor padded; calls read elements 0 .. size -
// 1 and nothing else. A view owns nothing: the planes must outlive the calls
// that use it, and must not be written meanwhile. A null plane is allowed only
// when size is 0. Any value is allowed; a plane with a NaN never rejects its
// object.
//
// Thread safety: as for any container. Concurrent reads are fine; a write needs
// exclusive access.
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

template <int kDims, typename T = float>
struct SimplexView {
  using Bound = UpSimplex<kDims, T>;
  using Query = DownSimplex<kDims, T>;
  using Planes = SimplexPlanes<kDims, T>;

  std::array<const T*, Bound::kAxes> min{};
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

template <int kDims, typename T = float>
struct AaboView {
  using Bound = Aabo<kDims, T>;
  using Query = Aabo<kDims, T>;
  using Planes = AaboPlanes<kDims, T>;

  std::array<const T*, Bound::kAxes> min{};
  std::array<const T*, Bound::kAxes> max{};
  std::size_t size = 0;

  const AaboView& view() const { return *this; }

  SimplexView<kDims, T> simplex() const { return {min, size}; }
  AabbView<kDims, T> aabb() const {
    AabbView<kDims, T> box;
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
using SimplexView4 = SimplexView<4>;
using AabbView2 = AabbView<2>;
using AabbView3 = AabbView<3>;
using AabbView4 = AabbView<4>;
using AaboView2 = AaboView<2>;
using AaboView3 = AaboView<3>;
using AaboView4 = AaboView<4>;

// A world that owns its planes. `World` stands for SimplexWorld, AabbWorld or
// AaboWorld below.
//
// Every plane starts on a 64-byte boundary and is padded to a multiple of 64
// objects with Empty() bounds. Indices are positions: EraseBySwap moves the
// last object, nothing else moves one. Growth doubles the capacity and
// invalidates views, as std::vector does with pointers.
//
// Where indices must not move, leave a hole instead of erasing: Set(i,
// Bound::Empty()), which no finite query keeps, and fill it with a later object
// by Set(i, bound). A hole costs what an object costs, in memory and in every
// scan, and size() counts it. The caller keeps the list of free indices.
//
// Errors (error.h): an index is not below size(), no memory can have the size,
// or the pointer of a list of bounds is null or misaligned and the list is not
// empty. A failed allocation throws std::bad_alloc. The world is then as it
// was.
//
// Memory: one block, from the heap or from a resource of the caller's; memory.h
// says which one copies, moves and swap(a, b) use.
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

  // Builds a world of the given bounds, in order.
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

  // Makes room for `objects` objects in all. Never shrinks.
  void Reserve(std::size_t objects) { planes_.Reserve(objects); }

  // Appends and returns the object's index. Amortised O(1).
  std::size_t Push(const Bound& bound) {
    return planes_.Push(detail::Planes(bound));
  }

  void Set(std::size_t index, const Bound& bound) {
    planes_.Set(index, detail::Planes(bound));
  }

  Bound Get(std::size_t index) const {
    detail::PlaneValues<Bound> values;
    planes_.Get(index, values);
    return detail::BoundOf<Bound>(values);
  }

  // Removes object `index`; the last object takes its place. O(1).
  void EraseBySwap(std::size_t index) { planes_.EraseBySwap(index); }

  // Sets the number of objects; new ones are Empty().
  void Resize(std::size_t objects) { planes_.Resize(objects); }

  // Removes all objects and keeps the memory. O(size), because it refills the
  // padding.
  void Clear() { planes_.Clear(); }

  // Replaces the content by the given bounds, in order. They may not be part
  // of this world's memory.
  void Assign(Span<const Bound> bounds) {
    planes_.Assign(detail::RecordsOf(bounds), bounds.size());
  }

  // A view of the current objects. It does not follow a later Push, EraseBySwap
  // or Clear. Valid until the world grows, is assigned to, moved from or
  // destroyed.
  View view() const { return detail::ViewOf<View>(planes_); }

  // The same planes for writing, for example by the builders of fit_many.h.
  Planes planes() { return detail::ViewOf<Planes>(planes_); }

 private:
  detail::PlaneArrays<typename Bound::Scalar> planes_;
};

template <int kDims, typename T = float>
using SimplexWorld = World<SimplexView<kDims, T>>;
template <int kDims, typename T = float>
using AabbWorld = World<AabbView<kDims, T>>;
template <int kDims, typename T = float>
using AaboWorld = World<AaboView<kDims, T>>;

using SimplexWorld2 = SimplexWorld<2>;
using SimplexWorld3 = SimplexWorld<3>;
using SimplexWorld4 = SimplexWorld<4>;
using AabbWorld2 = AabbWorld<2>;
using AabbWorld3 = AabbWorld<3>;
using AabbWorld4 = AabbWorld<4>;
using AaboWorld2 = AaboWorld<2>;
using AaboWorld3 = AaboWorld<3>;
using AaboWorld4 = AaboWorld<4>;

}  // namespace halfspace

#endif  // HALFSPACE_WORLD_H_

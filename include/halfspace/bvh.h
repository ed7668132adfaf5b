// Bvh: a BVH of 64-wide nodes for one query over many objects, which
// may move, come and go.
//
//   halfspace::AabbBvh3 bvh(world);  // an AabbWorld3, its view, or a list
//   halfspace::Aabb3 query = {{0, 0, 0}, {1, 1, 1}};
//   std::vector<std::uint32_t> ids(bvh.size());
//   ids.resize(Survivors(bvh, query, ids));
//   bvh.Insert(BoundSphere(sphere).aabb());  // fit.h
//
// A call returns the same objects as the call of reject.h with the same name.
// An id is the index of the object in the world that it came from. A flat scan
// tests every object. A query of a Bvh visits a node only if the parent
// of the node survived. There are about log64(n) tree levels.
//
// The BVH has no pointers. Objects are sorted so that 64 consecutive ones are
// near each other and form a leaf, 64 consecutive leaves form a node, and so
// on. A block of 64 objects or nodes holds its planes together. Nodes are
// floats. In leaves, objects are also quantized to 16 bits per plane, on one
// map for the whole BVH, so a query is quantized once. The quantized values
// reject an object, prove that it survives, or leave the decision to the
// floats.
//
// Other queries of the same BVH: bvh_shapes.h (points, spheres, segments,
// capsules, oriented boxes, half-spaces), bvh_nearest.h (k nearest, ray casts,
// box casts), bvh_pairs.h (all overlapping pairs: a broad phase). A program
// links only the queries it calls. docs/bvh.md has the layout, the proof that
// no overlap is missed, and measurements.
//
// Bounds are floats in 2 or 3 dimensions: Bvh<SimplexView3>,
// Bvh<AabbView3>, Bvh<AaboView3>, or the same with 2. Each call
// takes a query of the view's Query type. NaN, empty, inverted and infinite
// values mean the same as in reject.h. Boxes of doubles become floats that
// enclose them. For a query of doubles, call RoundOutward (transform.h), and
// for a sphere or another shape of doubles use its bound (fit.h).
//
// Errors (error.h), in every call: an output or a list of more than 0 elements
// is null or misaligned; the target is not supported. Outputs and queries must
// not overlap in memory, which is not checked.
//
// Floating-point mode: as in reject.h, except that queries may raise inexact,
// overflow and underflow. A program that enables floating-point traps must
// disable these three during a query. Building and changing a BVH never trap,
// in any mode.
//
// Thread safety: queries of one BVH may run at the same time. A query uses up
// to 8 KiB of stack, allocates nothing, locks nothing and keeps no state.
//
// Source: "The Bounding Simplex: A SIMD-Era Rejection Primitive" (a sort that
// encodes a hierarchy in array order; the SIMD-batch median layout).
#ifndef HALFSPACE_BVH_H_
#define HALFSPACE_BVH_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

#include "halfspace/detail/bvh.h"
#include "halfspace/memory.h"
#include "halfspace/runner.h"
#include "halfspace/span.h"
#include "halfspace/target.h"
#include "halfspace/visit.h"
#include "halfspace/world.h"

namespace halfspace {

// Build quality. It changes the cost of queries, never their result.
enum class BuildQuality : std::uint8_t {
  // Splits at medians of the widest axis. O(n log n), about as long as the bulk
  // load of an R-tree.
  kHigh,
  // Sorts along a Hilbert curve, and the objects of a cell of the curve that
  // has more than 64 by medians. A third of the time, O(n), unless most objects
  // are in crowded cells. Queries take up to 1.4 times as long as with kHigh if
  // objects are spread evenly, and up to 3 times in uneven scenes (`./bench.sh
  // --details worlds`).
  kFast,
};

// Options of a build and of Rebuild().
struct BuildOptions {
  BuildQuality quality = BuildQuality::kHigh;
  // The extents of a typical query on X, Y and Z, not negative: 0 for points,
  // infinity where queries do not limit an axis. Only their ratios and those to
  // the extents of the objects count. They decide which axis is cut, so queries
  // of another form read more leaves. Give them if the axes have unlike units
  // (degrees and meters, positions and time), if objects are points in a world
  // that is much longer on one axis than on another, or if queries are long on
  // some axes. Without them, queries are taken to be about as large as the
  // objects (docs/choosing.md has measurements). The BVH keeps them: later
  // sorts use them, and Rebuild() unless it gets others. A BVH without objects
  // keeps none.
  std::optional<std::array<float, 3>> query_extents = {};
  // The resource of a new BVH (memory.h). Rebuild() does not read it: a BVH
  // keeps its resource.
  MemoryResource memory = {};
  // Calls the parts of the work, for example on several threads (runner.h). By
  // default the calling thread does all of it.
  Runner run = {};
  Target target = {};  // by default, the chosen one (targets.h)
  // For builds that do not fit into memory: the objects are mapped files, and
  // `memory` maps a file for each block. 0 is off. Otherwise, if objects * (24
  // + sizeof(Bound)) > run_bytes, `quality` is not read: the build sorts runs
  // of `run_bytes` bytes as kFast does, and merges them. The tree is that of
  // kFast, unless a cell of the curve has more objects than a run and than
  // 65 536. Only the current run is read in random order, so the system can
  // evict all other pages. `memory` provides 8 bytes and the bound for each
  // object besides the tree. hs_builder_create_file() (c/halfspace.h) does this
  // with files.
  std::size_t run_bytes = 0;
};

// What queries read of a BVH. A query adds to it.
struct QueryStatistics {
  std::size_t node_blocks = 0;  // blocks of 64 nodes
  std::size_t leaves = 0;       // blocks of 64 objects
};

// Options of queries by bounds and by shapes (bvh_shapes.h).
struct QueryOptions {
  // Finds only objects whose mask (Bvh::SetMasks) has at least one of these
  // bits: all ones finds all objects, and 0 none.
  std::uint32_t mask = 0xFFFFFFFF;
  Target target = {};  // by default, the chosen one (targets.h)
  // If it is not null, the call adds what it reads. Calls that run at the same
  // time need one each.
  QueryStatistics* statistics = nullptr;
};

namespace detail {

template <typename View>
BvhType BvhTypeOf() {
  using Bound = typename View::Bound;
  return {kLayoutOf<Bound>, BvhKernelsOf<Bound::kAxes>::kTargets};
}

template <typename Query, const BvhShapeKind* kKind = nullptr>
struct BvhQueriesOf {
  static BvhQueries Of(const Query& query) { return {&query, 1, kKind}; }
  static BvhQueries OfEach(Span<const Query> queries) {
    return {queries.data(), queries.size(), kKind};
  }
};

// What a call asks a Bvh, by the type of the query. bvh_shapes.h adds shapes.
template <typename View, typename Query, typename = void>
struct BvhAsked : BvhQueriesOf<Query> {
  static_assert(sizeof(Query) == 0,
                "a Bvh takes queries of its own type, View::Query, and shapes "
                "of floats in its dimensions: include bvh_shapes.h. Bound "
                "other shapes first (fit.h)");
};
template <typename View, typename Query>
struct BvhAsked<View, Query,
                std::enable_if_t<std::is_convertible_v<
                    const Query&, const typename View::Query&>>>
    : BvhQueriesOf<typename View::Query> {
  using Own = typename View::Query;
  static_assert(std::is_standard_layout_v<Own> &&
                    sizeof(Own) == kPlaneCount<Own> * sizeof(float),
                "a query is read as a list of its values");
};

template <typename Bound>
Span<const typename Bound::Scalar> ValuesOfAll(Span<const Bound> bounds) {
  return {RecordsOf(bounds), bounds.size() * kPlaneCount<Bound>};
}

}  // namespace detail

// The bounds that a build or a change of a Bvh reads, in the caller's memory.
// It converts from what the caller holds:
//   - the view of the BVH, or an owning world of it (world.h);
//   - a list of bounds: an array, a std::vector or a Span;
//   - for a BVH of boxes also an AabbView, an AabbWorld or a list of Aabb of
//     doubles, or Boxes of floats or doubles (shapes.h), which may be strided.
// Doubles are rounded outward, so no overlap of the exact doubles is missed. A
// double that is a float stays equal. A build and a refit of doubles allocate 4
// more bytes per plane and object, and free them.
// For other shapes of doubles, use Bvh::Fitted() with a builder of fit_many.h.
template <typename View>
class BvhBounds {
 public:
  template <typename From, typename = decltype(detail::BoundsIn<View>(
                               std::declval<const From&>()))>
  // NOLINTNEXTLINE(google-explicit-constructor): lists convert implicitly.
  BvhBounds(const From& from) : columns_(detail::BoundsIn<View>(from)) {}

  std::size_t size() const { return columns_.size; }

 private:
  friend class Bvh<View>;
  detail::Columns columns_;
};

// A sorted copy of a world's bounds. The id of an object is its index in that
// world, what Insert() returned, or the caller's own (InsertAs).
//
// Memory: one block, from the heap or from a resource of the caller's
// (memory.h, which says what copies, moves and swap(a, b) use). Boxes in 3
// dimensions take 41 bytes per slot, 24 of them floats, or 29 with room for up
// to 4096. They take 4.13 more per id below the greatest after the first change
// by id, and 4 more per slot with masks. A build needs 16 more bytes per
// object. Sorting all objects again needs up to 112.
//
// Slots: an object has a slot in the order, and an erased object leaves an
// empty one. There are never more than 2 * size() + 64 slots. Objects move
// together when half of the slots are empty, or, if the block is full, when a
// quarter are. Otherwise a full block grows by half. So two BVHs with the
// same changes can have different orders, if one has more room. Rebuild() frees
// the memory that is not needed.
//
// Changes are seen by every later call. No change may run at the same time as
// another call on the same BVH. Changes run on the chosen target, except
// Rebuild().
//
// Errors (error.h): a plane of a BVH that is not empty is null or misaligned;
// there are 2^31 objects or more; the quality is none of the enumerators; an id
// is not that of an object in the BVH. A failed allocation throws
// std::bad_alloc. The BVH is then as it was, and what ids() and Blob()
// returned stays valid. If `run` throws in a constructor, no BVH is
// created. In Rebuild(), the BVH is unchanged. In Refit(), call Refit() again
// before the next query.
template <typename ViewType>
class Bvh {
 public:
  using View = ViewType;
  using Bound = typename View::Bound;
  // There is no member Query: with one, the calls of reject.h would match.
  static_assert(std::is_same_v<typename Bound::Scalar, float>,
                "BVHs are of floats");
  static_assert(Bound::kDimensions <= 3, "2 or 3 dimensions");

  Bvh() : Bvh(MemoryResource()) {}
  explicit Bvh(const MemoryResource& memory)
      : tree_(detail::BvhTypeOf<View>(), memory) {}

  // Sorts the bounds, and copies them.
  explicit Bvh(const BvhBounds<View>& bounds, const BuildOptions& options = {})
      : Bvh(options.memory) {
    tree_.Build(bounds.columns_, options);
  }

  // Builds a BVH of the `count` bounds that fit(planes) writes, as a builder
  // of fit_many.h does:
  //
  //   AabbBvh3::Fitted(spheres.count, [&](const AabbPlanes3& planes) {
  //     BoundSpheres(spheres, planes);
  //   });
  template <typename Fit>
  static Bvh Fitted(std::size_t count, Fit&& fit,
                    const BuildOptions& options = {}) {
    Bvh(options.memory).tree_.CheckBuild(count, options);
    World<View> bounds(options.memory);
    bounds.Resize(count);
    fit(bounds.planes());
    return Bvh(bounds.view(), options);
  }

  Bvh(const Bvh& other, const MemoryResource& memory)
      : tree_(other.tree_, memory) {}

  friend void swap(Bvh& a, Bvh& b) noexcept { swap(a.tree_, b.tree_); }

  const MemoryResource& memory() const { return tree_.memory(); }
  std::size_t size() const { return tree_.size(); }
  bool empty() const { return size() == 0; }

  // The size of the BVH's block of memory.
  std::size_t bytes() const { return tree_.bytes(); }

  // Whether an object has this id. O(1).
  bool Has(std::uint32_t id) const { return tree_.Has(id); }

  // Returns the bound of an object. O(1). In a BVH that was built, the call
  // searches ids() until the first change by id or Reserve(): O(n).
  Bound Get(std::uint32_t id) const {
    detail::PlaneValues<Bound> values;
    tree_.Get(id, values);
    return detail::BoundOf<Bound>(values);
  }

  // Returns the bound of all objects: on each plane the outermost value, which
  // is infinite if an object has a NaN there. Empty() for an empty BVH. O(1):
  // reads one block.
  Bound Bounds() const {
    detail::PlaneValues<Bound> values;
    tree_.Bounds(values);
    return detail::BoundOf<Bound>(values);
  }

  // Allocates room for `objects` objects in total. Until there are more, or one
  // is erased, insertions do not grow the block; they still allocate memory to
  // sort with, and free it. Never shrinks. Counts as a change by id. Throws if
  // `objects` is 2^31 or more.
  void Reserve(std::size_t objects) { tree_.Reserve(objects); }

  // Changes the bound of an object, and tightens its leaf and the nodes above.
  // The order stays, so leaves grow as objects move: see CostRatio(). About 1
  // us in a BVH of a million objects (docs/bvh.md). The first change by id of
  // a BVH that was built copies it once.
  void Set(std::uint32_t id, const Bound& bound) {
    tree_.Set(id, detail::Planes(bound));
  }

  // Sets several bounds: bounds[i] is that of object ids[i]. If an id is given
  // twice, the last bound wins. `bounds.size()` must be `ids.size()`. Checks
  // all ids before it changes anything. `ids` must not be ids(). Encodes each
  // leaf and each node once, so many objects take less time than with one call
  // per object, and a few take as long (docs/bvh.md). Allocates and frees up to
  // a bit per slot. For all objects, use Refit().
  void Set(Span<const std::uint32_t> ids, const BvhBounds<View>& bounds) {
    tree_.Set(ids, bounds.columns_);
  }

  // Adds an object whose mask is all ones, and returns its id: the least that
  // no object has. The object takes an empty slot in a leaf that it makes grow
  // by a 16th at most, or a new slot at the end.
  //
  // The BVH sorts itself as it grows: the newest objects after every 256 at
  // the end, and all objects when half as many were inserted as the BVH had
  // when it was last sorted. A query of a BVH that was filled by Insert()
  // takes up to 4.3 times as long as after Rebuild() (docs/bvh.md). An
  // insertion takes 1 to 2 us on average, but a single one can take as long as
  // Rebuild(). If there is no memory to sort with, the objects stay unsorted
  // until the next insertion.
  std::uint32_t Insert(const Bound& bound) {
    return tree_.Insert(detail::Planes(bound));
  }

  // Adds several objects and writes their ids: ids[i] is that of bounds[i].
  // `ids.size()` must be at least `bounds.size()`. Up to a 16th of the size()
  // takes empty slots as single insertions do, but in leaves as they were
  // before the call, if they are more than a few. More objects take new slots
  // at the end. They are sorted where the same number of single insertions
  // would sort, but all at once. Grows the block at most once, and allocates
  // and frees up to a bit per slot. If there is no memory to sort with, the
  // objects stay unsorted.
  void Insert(const BvhBounds<View>& bounds, Span<std::uint32_t> ids) {
    tree_.Insert(bounds.columns_, ids);
  }

  // Adds objects under ids that the caller chooses: ids[i] is that of
  // bounds[i]. Otherwise as Insert() of several objects. `bounds.size()` must
  // be `ids.size()`. An id must be below 0xFFFFFFFF. No object may have it, and
  // it must be in `ids` once. Otherwise the call throws and changes nothing.
  //
  // Ids may be any numbers, but arrays by id have the size id_limit(), and the
  // BVH takes 4.13 bytes for each id below the greatest. This memory grows by
  // half at least, so ids may also grow one by one. Ids between those in use
  // are free. Insert() takes the least of them.
  void InsertAs(Span<const std::uint32_t> ids, const BvhBounds<View>& bounds) {
    tree_.InsertAs(ids, bounds.columns_);
  }

  // Removes an object. Costs what Set() costs, and on average a few ns more:
  // when more than half of the slots are empty, the objects move together, in
  // their order. It allocates only if it is the first change by id, or the
  // first change of a blob in place.
  void Erase(std::uint32_t id) { tree_.Erase(id); }

  // Removes several objects. An id that is given twice is removed once. Checks
  // and allocates as Set() of several does. `ids` must not be ids(): to remove
  // all objects, use Clear().
  void Erase(Span<const std::uint32_t> ids) { tree_.Erase(ids); }

  // Removes all objects and keeps the block of memory. A blob in place is
  // released instead. Insert() begins with id 0 again, and the mask of a new
  // object is all ones. Takes a few us per million ids. Never throws.
  void Clear() { tree_.Clear(); }

  // Sets the mask of one object, or of all: masks[i] is that of object i. Masks
  // of erased objects are not read. `masks.size()` must be at least id_limit().
  // An object whose mask was never set has all ones. One with 0 is found only
  // with a QueryOptions::mask of all ones.
  void SetMasks(std::uint32_t id, std::uint32_t mask) {
    tree_.SetMasks(id, mask);
  }
  void SetMasks(Span<const std::uint32_t> masks) { tree_.SetMasks(masks); }

  // The ids in this BVH's order, one per slot; 0xFFFFFFFF in an empty slot.
  // Valid until the BVH changes.
  Span<const std::uint32_t> ids() const { return tree_.ids(); }

  // One more than the greatest id that was in use since the last Rebuild(), or
  // since the BVH was last empty: the size of an array by id. 0 for an empty
  // BVH, also if its last object was erased.
  std::size_t id_limit() const { return tree_.id_limit(); }

  // Gives all objects new bounds, by id: bounds[i] is that of object i. Bounds
  // of erased objects are not read. `bounds.size()` must be at least
  // id_limit(). The order stays as it is. `run` is BuildOptions::run.
  void Refit(const BvhBounds<View>& bounds, const Runner& run = {}) {
    tree_.Refit(bounds.columns_, true, run);
  }

  // Sets the bounds of the objects in `ids`: bounds[i] is the bound of object
  // i. Reads no other bounds. An id may be in the list more than once.
  // Otherwise as Set() of several objects, and faster, because the bounds are
  // read in this BVH's order. `bounds.size()` must be at least id_limit().
  void Refit(Span<const std::uint32_t> ids, const BvhBounds<View>& bounds) {
    tree_.Refit(ids, bounds.columns_);
  }

  // Sets the bounds of all objects, in this BVH's order: bounds[i] is the bound
  // of object ids()[i]. `bounds.size()` must be `ids().size()`. 2 to 4 times as
  // fast as Refit().
  void RefitInOrder(const BvhBounds<View>& bounds, const Runner& run = {}) {
    tree_.Refit(bounds.columns_, false, run);
  }

  // How much the order has decayed: the surface of all leaves (64 slots each),
  // divided by the surface that as many objects had when they were last sorted.
  // 1 is as sorted. With 2, queries visit up to twice as many leaves. If half
  // of the objects are erased, CostRatio() is about 2. It is 1 for up to 64
  // slots. For more it is infinite until more than 64 objects are sorted: in a
  // BVH of fewer than 256 objects that were inserted. O(n / 64).
  double CostRatio() const { return tree_.CostRatio(); }

  // How many leaves a query of these extents reads on average, if it can be
  // anywhere within Bounds(): the sum over the leaves of the products of (leaf
  // + query) / world over X, Y and Z, each at most 1. Infinity is a query that
  // does not limit the axis. A BVH in the right order reads a few leaves more
  // than the results need. Many leaves: give query_extents, and see
  // docs/bvh.md. Throws if an extent is negative or NaN. O(n / 64).
  double ExpectedLeaves(
      const std::array<float, Bound::kDimensions>& extents) const {
    static_assert(detail::HasMax<Bound>, "simplices have no extents");
    return tree_.ExpectedLeaves({extents.data(), extents.size()});
  }

  // Sorts all objects, without empty slots between them, and gives memory
  // back: the block has no more room than the objects need, and 4.13 bytes for
  // each id up to the greatest in use. Ids stay.
  void Rebuild(const BuildOptions& options = {}) { tree_.Rebuild(options); }

  // Sorts the group of 1024 slots whose surface has grown most, together with
  // those that overlap it most and then with those that have grown most, about
  // `objects` objects in total and up to two groups at least. Groups that are
  // more than 8 times as large, or as small, are left out, unless there is room
  // for all. Groups that are sorted together exchange their objects. If there
  // is room for all, all are also sorted if some were inserted since the last
  // time. Returns the number of objects sorted, and 0 if there is no reason to
  // sort. Takes 0.1 to 0.3 us per object. `run` is BuildOptions::run.
  std::size_t RebuildPartial(std::size_t objects, const Runner& run = {}) {
    return tree_.RebuildPartial(objects, run);
  }

  // The BVH as bytes, to store or to map: its block of memory itself. Valid
  // until the BVH changes. A BVH that never had an object has no bytes. The
  // first call after a change computes a checksum, O(n); the others are O(1).
  Span<const std::byte> Blob() const { return tree_.Blob(); }

  // A BVH of what Blob() returned. FromBlob() copies the bytes. InPlace()
  // refers to them: they must be aligned to 64 bytes, as a mapped file is, and
  // stay unchanged while the BVH lives. A change of the BVH copies them
  // first.
  //
  // The format has its own version, which changes less often than the
  // library's (docs/bvh.md). A library reads the format that it writes; another
  // one is an error, which says whether it is older or newer.
  //
  // Both check the header, the size and the unused lanes of the last block of
  // each tree level, and throw (error.h) if the blob is one of another type or
  // byte order, has a format that is not read, or was cut. An altered body can
  // change results, but no query and no change reads or writes outside the blob
  // and the BVH. The first change checks in O(n) that ids and slots belong
  // together, and throws if they do not. Verify() finds every other alteration.
  static Bvh FromBlob(Span<const std::byte> blob,
                      const MemoryResource& memory = {}) {
    Bvh bvh(memory);
    bvh.tree_.Load(blob, false);
    return bvh;
  }
  static Bvh InPlace(Span<const std::byte> blob,
                     const MemoryResource& memory = {}) {
    Bvh bvh(memory);
    bvh.tree_.Load(blob, true);
    return bvh;
  }

  // Returns whether the bytes of a blob are those that Blob() returned, by
  // their checksum. The checksum detects accidental damage. It does not protect
  // against an attacker. True for a BVH that was not loaded from a blob, and
  // for one that changed since. O(n).
  [[nodiscard]] bool Verify() const { return tree_.Verify(); }

 private:
  friend const detail::BvhTree& detail::CoreOf<View>(const Bvh& bvh);

  detail::BvhTree tree_;
};

using SimplexBvh2 = Bvh<SimplexView2>;
using SimplexBvh3 = Bvh<SimplexView3>;
using AabbBvh2 = Bvh<AabbView2>;
using AabbBvh3 = Bvh<AabbView3>;
using AaboBvh2 = Bvh<AaboView2>;
using AaboBvh3 = Bvh<AaboView3>;

// The calls below, and those of bvh_nearest.h, search `tree`: a Bvh, or a
// BroadPhase (broad_phase.h) of the same View.

// Writes the ids of all survivors to `ids`, in no particular order, and returns
// their number. If `ids` is shorter than that, the call fills it and still
// returns the full number. Elements of `ids` behind the last id may be
// overwritten. The first `skip` ids are not written, so that a call whose `ids`
// were too short can be continued. The order of the ids is the same in each
// call with the same arguments, on every target and machine, until the BVH
// changes (docs/api-stability.md).
template <typename Tree, typename View = detail::SearchedView<Tree>,
          typename Query = typename View::Query,
          typename Asked = detail::BvhAsked<View, Query>>
[[nodiscard]] std::size_t Survivors(const Tree& tree, const Query& query,
                                    Span<std::uint32_t> ids,
                                    const QueryOptions& options = {},
                                    std::size_t skip = 0) {
  return detail::CoreOf(tree).Survivors(Asked::Of(query), ids, options, skip);
}

// Returns the number of survivors. A node inside a box or an octahedron is
// counted without a visit, so the cost of a large query grows with its surface
// and not with its volume. A query with a mask visits it, if masks were set.
template <typename Tree, typename View = detail::SearchedView<Tree>,
          typename Query = typename View::Query,
          typename Asked = detail::BvhAsked<View, Query>>
[[nodiscard]] std::size_t CountSurvivors(const Tree& tree, const Query& query,
                                         const QueryOptions& options = {}) {
  return detail::CoreOf(tree).Count(Asked::Of(query), options);
}

// Writes the number of survivors of each query. Queries walk the tree 64 at a
// time, as in SurvivorsOfEach(). `counts.size()` must be at least
// `queries.size()`.
template <typename View>
void CountSurvivorsOfEach(const Bvh<View>& bvh,
                          Span<const typename View::Query> queries,
                          Span<std::size_t> counts,
                          const QueryOptions& options = {}) {
  detail::CoreOf(bvh).CountOfEach(
      detail::BvhAsked<View, typename View::Query>::OfEach(queries), counts,
      options);
}

// Returns the id of a survivor, or nothing if there is none. Reads no leaf
// after the first that has one.
template <typename Tree, typename View = detail::SearchedView<Tree>,
          typename Query = typename View::Query,
          typename Asked = detail::BvhAsked<View, Query>>
[[nodiscard]] std::optional<std::uint32_t> AnySurvivor(
    const Tree& tree, const Query& query, const QueryOptions& options = {}) {
  std::uint32_t id = 0;
  if (!detail::CoreOf(tree).Any(Asked::Of(query), id, options)) {
    return std::nullopt;
  }
  return id;
}

// Calls function(Span<const std::uint32_t> ids) with 1 to 512 survivors at a
// time: first with those of the first leaf that has any, as soon as it was
// read. The function returns void or Visit (visit.h). Exceptions of the
// function pass through. The function must not change the BVH.
template <typename Tree, typename Function,
          typename View = detail::SearchedView<Tree>,
          typename Query = typename View::Query,
          typename Asked = detail::BvhAsked<View, Query>>
void ForEachSurvivor(const Tree& tree, const Query& query, Function&& function,
                     const QueryOptions& options = {}) {
  detail::Callback call{function};
  detail::CoreOf(tree).ForEach(Asked::Of(query), &decltype(call)::Run, &call,
                               options);
}

// Survivors() of several queries. The queries walk the tree together, 64 at a
// time, which hides the latency of memory and the cost of a call. In uniform
// scenes it takes 0.6 to 1 times as long as one call per query, in clusters,
// meshes and scenes with outliers up to 1.25 times (docs/bvh.md). If the tree
// is larger than the cache, sort the queries along a curve: those that are near
// each other then find in the cache what the ones before them read. In trees of
// 10^6 and 4 * 10^6 boxes, queries in such an order take about half of the
// time, here and in CountSurvivorsOfEach() and KNearestOfEach().
//   ids      receives the ids of all queries, one query after another
//   offsets  `offsets.size()` must be at least `queries.size() + 1`. The ids of
//            queries[q] are ids[offsets[q]] ... ids[offsets[q + 1] - 1].
// Returns the number of all ids. If `ids` is shorter than that, it is filled,
// and `offsets` are written as if it were long enough. Elements of `ids` behind
// the last id may be overwritten. `skip` is that of Survivors(), for the ids of
// all queries. `offsets` do not depend on it.
template <typename Tree, typename View = detail::SearchedView<Tree>,
          typename Queries = Span<const typename View::Query>,
          typename Query = std::decay_t<
              decltype(*std::data(std::declval<const Queries&>()))>,
          typename Asked = detail::BvhAsked<View, Query>>
[[nodiscard]] std::size_t SurvivorsOfEach(const Tree& tree,
                                          const Queries& queries,
                                          Span<std::uint32_t> ids,
                                          Span<std::size_t> offsets,
                                          const QueryOptions& options = {},
                                          std::size_t skip = 0) {
  return detail::CoreOf(tree).SurvivorsOfEach(Asked::OfEach(queries), ids,
                                              offsets, options, skip);
}

}  // namespace halfspace

#endif  // HALFSPACE_BVH_H_

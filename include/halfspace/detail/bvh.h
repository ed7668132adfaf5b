// Internal. What a Bvh owns, and the calls of bvh.h, bvh_shapes.h,
// bvh_nearest.h and bvh_pairs.h after the types are gone. Not part of the
// interface. A program links only those that it calls.
#ifndef HALFSPACE_DETAIL_BVH_H_
#define HALFSPACE_DETAIL_BVH_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/export.h"
#include "halfspace/memory.h"
#include "halfspace/runner.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"
#include "halfspace/target.h"
#include "halfspace/world.h"

namespace halfspace {

struct BuildOptions;
struct IdPair;
struct PairOptions;
struct QueryOptions;
struct SearchOptions;

template <typename View>
class Bvh;
template <typename View>
class BroadPhase;

namespace detail {

struct BvhKernels;

// The kernels of BVHs with kAxes axes, of each compiled target, best
// first: an object file of the library for each, as ScanKernelsOf of scan.h.
template <std::size_t kAxes>
struct HALFSPACE_API BvhKernelsOf {
  static const BvhKernels* const kTargets;
};
extern template struct BvhKernelsOf<2>;
extern template struct BvhKernelsOf<3>;
extern template struct BvhKernelsOf<4>;

inline constexpr std::size_t kBlockObjects = 64;

inline constexpr std::uint32_t kNoId = 0xFFFFFFFF;

// A type of Bvh.
struct BvhType : PlaneLayout {
  const BvhKernels* kernels;  // of each target
};

// The bounds that a Bvh reads: its own, and boxes of doubles if it is of boxes.
template <typename View>
Columns BoundsIn(const View& view) {
  return ColumnsOf(view);
}
template <typename View>
Columns BoundsIn(const World<View>& world) {
  return ColumnsOf(world.view());
}
template <typename View>
Columns BoundsIn(Span<const typename View::Bound> list) {
  return ColumnsOf(list);
}

template <typename View>
using IfBoxes = std::enable_if_t<
    std::is_same_v<View, AabbView<View::Bound::kDimensions, float>>>;
template <typename View, typename = IfBoxes<View>>
Columns BoundsIn(const AabbView<View::Bound::kDimensions, double>& view) {
  return ColumnsOf(view);
}
template <typename View, typename = IfBoxes<View>>
Columns BoundsIn(const AabbWorld<View::Bound::kDimensions, double>& world) {
  return ColumnsOf(world.view());
}
template <typename View, typename = IfBoxes<View>>
Columns BoundsIn(Span<const Aabb<View::Bound::kDimensions, double>> list) {
  return ColumnsOf(list);
}
template <typename View, typename Scalar, typename = IfBoxes<View>>
Columns BoundsIn(const Boxes<View::Bound::kDimensions, Scalar>& boxes) {
  return ColumnsOf(boxes);
}

// What calls search for.

struct BvhQueries;
struct BvhShapeQuery;
struct Walk;

// Queries by shapes of one type.
struct BvhShapeKind {
  std::size_t alignment;
  BvhShapeQuery (*at)(const void* shapes, std::size_t i);
  // BvhWalkShapes(), which a program links only if it has shapes.
  void (*walk)(const BvhType& type, const BvhQueries& queries,
               const QueryOptions& options, const char* call, const Walk& walk);
};

// Queries, one after another: bounds, of which each has all minima, then all
// maxima, and of simplices only maxima; or shapes.
struct BvhQueries {
  const void* first;
  std::size_t count;
  const BvhShapeKind* kind = nullptr;  // of shapes
};

// Returns the new limit; a negative one ends the search. `planes` has the
// object's value on plane p at p * kBlockObjects.
using NearFunction = float (*)(void* context, std::uint32_t id, float value,
                               const float* planes);

// Boxes, or points, whose corners are equal. The lower corner of box i is at
// values[i * stride], and the upper one is `upper` values behind it.
struct NearQueries {
  const float* values;
  std::size_t upper;
  std::size_t stride;
  std::size_t count;
};

// A box from `low` to `high`, `radius` larger on each side, or, if it is round,
// a ball, on its way.
struct LineCast {
  const char* call;
  const float* low;
  const float* high;
  const float* direction;
  float max_t;
  float radius;
  bool is_round = false;
};

// Results of queries, and of pairs. Both return whether to go on.
using IdsFunction = bool (*)(void* context, Span<const std::uint32_t> ids);
using PairsFunction = bool (*)(void* context, Span<const IdPair> pairs);

struct BvhPairKernels;
class BroadPhaseCore;
class BvhState;
struct BvhLevels;

// A tree in one block of memory. Its state is in dispatch/bvh/tree.h. The
// objects are in slots 0, 1, ..., some of which may be empty.
class HALFSPACE_API BvhTree {
 public:
  BvhTree(const BvhType& type, const MemoryResource& memory);
  BvhTree(const BvhTree& other, const MemoryResource& memory);
  BvhTree(const BvhTree& other) : BvhTree(other, MemoryResource()) {}
  BvhTree(BvhTree&& other) noexcept;
  // Into the memory that is there, if both have equal room.
  BvhTree& operator=(const BvhTree& other);
  BvhTree& operator=(BvhTree&& other) { return AssignMove(*this, other); }
  ~BvhTree();
  friend void swap(BvhTree& a, BvhTree& b) noexcept { a.Swap(b); }

  const MemoryResource& memory() const;
  std::size_t size() const;
  std::size_t bytes() const;
  std::size_t id_limit() const;
  Span<const std::uint32_t> ids() const;
  // For the library alone.
  const BvhType& type() const;
  const BvhLevels& levels() const;

  // Throws unless so many objects can be built.
  void CheckBuild(std::size_t objects, const BuildOptions& options) const;
  // Replaces the content. The planes may not be its own.
  void Build(const Columns& objects, const BuildOptions& options);

  // Replaces the content by what Blob() gave, in place or as a copy. Only the
  // header is checked: see BvhState::CheckLoaded().
  void Load(Span<const std::byte> blob, bool is_in_place);
  Span<const std::byte> Blob() const;
  bool Verify() const;

  // `values` are those of all minima, then of all maxima.
  bool Has(std::uint32_t id) const;
  // Throws unless all are ids of objects.
  void CheckIds(Span<const std::uint32_t> ids, const char* call) const;
  void Get(std::uint32_t id, Span<float> values) const;
  void GetAt(std::size_t slot, Span<float> values) const;
  void Bounds(Span<float> values) const;
  void Set(std::uint32_t id, Span<const float> values);
  std::uint32_t Insert(Span<const float> values);
  void Erase(std::uint32_t id);
  void Set(Span<const std::uint32_t> ids, const Columns& bounds);
  void Insert(const Columns& bounds, Span<std::uint32_t> ids);
  void InsertAs(Span<const std::uint32_t> ids, const Columns& bounds);
  void Erase(Span<const std::uint32_t> ids);
  void Clear();
  void Reserve(std::size_t objects);

  // Sets the mask of one object, or of all objects by id.
  void SetMasks(std::uint32_t id, std::uint32_t mask);
  void SetMasks(Span<const std::uint32_t> masks);

  // Refits some objects. The bounds are by id.
  void Refit(Span<const std::uint32_t> ids, const Columns& bounds);
  // The bounds of the objects anew, by id or by slot.
  void Refit(const Columns& objects, bool is_by_id, const Runner& run);

  double CostRatio() const;
  // Not of simplices.
  double ExpectedLeaves(Span<const float> extents) const;
  void Rebuild(const BuildOptions& options);
  std::size_t RebuildPartial(std::size_t objects, const Runner& run = {});

  // The queries of bvh.h. One query, several, and several bounds. Any() returns
  // whether there is one, and its id.
  std::size_t Survivors(const BvhQueries& query, Span<std::uint32_t> ids,
                        const QueryOptions& options, std::size_t skip) const;
  std::size_t Count(const BvhQueries& query, const QueryOptions& options) const;
  bool Any(const BvhQueries& query, std::uint32_t& id,
           const QueryOptions& options) const;
  void ForEach(const BvhQueries& query, IdsFunction function, void* context,
               const QueryOptions& options) const;
  std::size_t SurvivorsOfEach(const BvhQueries& queries,
                              Span<std::uint32_t> ids,
                              Span<std::size_t> offsets,
                              const QueryOptions& options,
                              std::size_t skip) const;
  void CountOfEach(const BvhQueries& queries, Span<std::size_t> counts,
                   const QueryOptions& options) const;

  // Those of bvh_nearest.h.
  std::size_t Nearest(const NearQueries& query, float max_distance,
                      Span<std::uint32_t> ids, Span<float> distances,
                      const SearchOptions& options) const;
  void NearestOfEach(const NearQueries& queries, std::size_t k,
                     float max_distance, Span<std::uint32_t> ids,
                     Span<float> distances, const SearchOptions& options) const;
  void ForEachNearest(const NearQueries& query, float max_distance,
                      NearFunction function, void* context,
                      const SearchOptions& options) const;
  void Cast(const LineCast& cast, NearFunction function, void* context,
            const SearchOptions& options) const;

  // Those of bvh_pairs.h that a BroadPhase has, too.
  std::size_t PairsOf(const BvhPairKernels* kernels,
                      Span<const std::uint32_t> ids, Span<IdPair> pairs,
                      const PairOptions& options) const;
  void ForEachPairOf(const BvhPairKernels* kernels,
                     Span<const std::uint32_t> ids, PairsFunction function,
                     void* context, const PairOptions& options) const;

 private:
  friend class BvhState;
  void Swap(BvhTree& other) noexcept;

  alignas(8) std::byte state_[464];
};

// What the calls of bvh.h and its siblings search. Both have the same members.
template <typename View>
const BvhTree& CoreOf(const Bvh<View>& bvh) {
  return bvh.tree_;
}
template <typename View>
const BroadPhaseCore& CoreOf(const BroadPhase<View>& bodies);

// Its view. A type only of a Bvh or a BroadPhase.
template <typename View>
View ViewIn(const Bvh<View>& bvh);
template <typename View>
View ViewIn(const BroadPhase<View>& bodies);
template <typename Tree>
using SearchedView = decltype(ViewIn(std::declval<const Tree&>()));

// The planes of a stored tree, without dimensions if the bytes are none.
HALFSPACE_API PlaneLayout LayoutOfBlob(Span<const std::byte> blob);

// Shapes (bvh_shapes.h).

inline constexpr std::size_t kMostHalfSpaces = 64;

struct BvhShapeQuery {
  enum Kind : std::uint8_t {
    kPoint,
    kSphere,
    kSegment,
    kCapsule,
    kRoundedBox,
    kOrientedBox,
    kHalfSpaces
  };
  Kind kind;
  std::uint8_t dims;
  const float* values;  // of the shape, or of all half-spaces
  std::size_t count;    // of half-spaces
};

// Walks for one shape after another. Throws if one of them is no shape, before
// the first walk. `type` is that of the tree.
HALFSPACE_API void BvhWalkShapes(const BvhType& type, const BvhQueries& queries,
                                 const QueryOptions& options, const char* call,
                                 const Walk& walk);

// Pairs (bvh_pairs.h).

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

HALFSPACE_API std::size_t BvhPairs(const PairSources& sources,
                                   Span<IdPair> pairs,
                                   const PairOptions& options);
HALFSPACE_API void BvhForEachPair(const PairSources& sources,
                                  PairsFunction function, void* context,
                                  const PairOptions& options);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_BVH_H_

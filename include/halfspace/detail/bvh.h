// Internal. What a Bvh owns, and the calls of bvh.h after the types
// are gone. Not part of the interface.
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
struct QueryOptions;

template <typename View>
class Bvh;

namespace detail {

struct BvhKernels;

// The kernels of BVHs with kAxes axes, of each compiled target, best
// first: an object file of the library for each, as KernelsOf of scan.h.
template <std::size_t kAxes>
struct HALFSPACE_API BvhKernelsOf {
  static const BvhKernels* const kTargets;
};
extern template struct BvhKernelsOf<2>;
extern template struct BvhKernelsOf<3>;
extern template struct BvhKernelsOf<4>;

// 64 to the power of this is more than 2^32 objects.
inline constexpr std::size_t kMostLevels = 6;

inline constexpr std::size_t kBlockObjects = 64;

// Level 0 has the objects. Node i of another level encloses block i of the
// level below it: 64 consecutive objects or nodes.
struct BvhLevel {
  std::size_t size = 0;
  // Block after block: of each plane after plane, 64 floats of all minima, then
  // of all maxima.
  float* floats = nullptr;
  std::size_t planes = 0;
  // One bit per object or node: whether it exists. Erased objects and nodes
  // without objects are Empty().
  std::uint64_t* present = nullptr;
  // One bit per node with maxima: whether all of its objects exist and have
  // min <= max on each axis. If such a node is inside a query, all of its
  // objects survive.
  std::uint64_t* regular = nullptr;
  // An object's own masks, and the union of them for a node. Null if none
  // were set.
  std::uint32_t* masks = nullptr;
  // What a query reads of the level is far from the first caches.
  bool is_prefetched = false;

  float* Plane(std::size_t block, std::size_t plane) const {
    return floats + (block * planes + plane) * kBlockObjects;
  }
  float& Value(std::size_t plane, std::size_t i) const {
    return Plane(i / kBlockObjects, plane)[i % kBlockObjects];
  }
};

// How the values of objects become codes (kernels/bvh/block.h). Lane k has the
// minima of axis k, lane kMaxLane + k the negated maxima.
struct alignas(64) CodeMap {
  static constexpr std::size_t kMaxLane = 4;
  static constexpr std::size_t kLanes = 8;
  float base[kLanes];
  float scale[kLanes];
};

// Some slots: about how many blocks queries visit, and their objects.
struct BvhPart {
  double cost;
  std::uint64_t objects;
};

struct BvhLevels {
  std::size_t count = 0;
  std::array<BvhLevel, kMostLevels> level{};
  CodeMap* map = nullptr;
  // Block after block as the floats of level 0. Null with room for up to 4096
  // objects, or if BvhShape::has_codes is false: a query then reads the floats.
  std::int16_t* codes = nullptr;
  std::uint32_t* ids = nullptr;  // of objects, by slot; kNoId of none
  // By id, the slot; of a free id the next that is free. Null until a change.
  std::uint32_t* slots = nullptr;
  BvhPart* built = nullptr;  // 4096 slots each, when they were last sorted
};

inline constexpr std::uint32_t kNoId = 0xFFFFFFFF;

struct BvhShape {
  const BvhKernels* kernels;  // of each target
  std::uint8_t dims;
  std::uint8_t axes;
  bool has_max;
  // A tree without codes is never a blob.
  bool has_codes = true;
};

// What a Bvh of boxes is built of besides its own types.
template <typename View>
inline constexpr bool kIsOfBoxes =
    std::is_same_v<View, AabbView<View::Bound::kDimensions, float>>;
template <typename View>
using IfBoxes = std::enable_if_t<kIsOfBoxes<View>>;
template <typename View>
using DoubleView = AabbView<View::Bound::kDimensions, double>;
struct NoBound {};  // of doubles
template <typename View>
using DoubleBound =
    std::conditional_t<kIsOfBoxes<View>, Aabb<View::Bound::kDimensions, double>,
                       NoBound>;

template <typename View, typename = IfBoxes<View>>
Columns OtherColumns(const DoubleView<View>& view) {
  return ColumnsOf(view);
}
template <typename View, typename = IfBoxes<View>>
Columns OtherColumns(const World<DoubleView<View>>& world) {
  return ColumnsOf(world.view());
}
template <typename View, typename = IfBoxes<View>>
Columns OtherColumns(
    Span<const Aabb<View::Bound::kDimensions, double>> bounds) {
  return ColumnsOf(bounds);
}
template <typename View, typename Scalar, typename = IfBoxes<View>>
Columns OtherColumns(const Boxes<View::Bound::kDimensions, Scalar>& boxes) {
  return ColumnsOf(boxes);
}

// Types if Objects can be one of these, and if Bound is a box of doubles.
template <typename View, typename Objects>
using IfOther =
    decltype(OtherColumns<View>(std::declval<const Objects&>()).size);
template <typename View, typename Bound>
using IfDoubleBound =
    std::enable_if_t<std::is_same_v<Bound, DoubleBound<View>>>;

struct BvhHeader;
struct BvhRoom;
struct SlotRange;

// A tree in one block of memory: a header, then the parts of all levels
// (dispatch/bvh/layout.h). The objects are in slots 0, 1, ... of level 0,
// some of which may be empty.
class HALFSPACE_API BvhTree {
 public:
  BvhTree(const BvhShape& shape, const MemoryResource& memory);
  BvhTree(const BvhTree& other, const MemoryResource& memory);
  BvhTree(const BvhTree& other) : BvhTree(other, MemoryResource()) {}
  BvhTree(BvhTree&& other) noexcept;
  BvhTree& operator=(const BvhTree& other) { return AssignCopy(*this, other); }
  BvhTree& operator=(BvhTree&& other) { return AssignMove(*this, other); }
  ~BvhTree();
  friend void swap(BvhTree& a, BvhTree& b) noexcept { a.Swap(b); }

  const MemoryResource& memory() const { return memory_; }
  const BvhShape& shape() const { return shape_; }
  const BvhLevels& levels() const { return levels_; }
  std::size_t size() const;
  std::size_t bytes() const { return bytes_; }
  std::size_t id_limit() const;
  Span<const std::uint32_t> ids() const {
    return {levels_.ids, levels_.level[0].size};
  }

  // Throws unless so many objects can be built.
  void CheckBuild(std::size_t objects, const BuildOptions& options) const;
  // Replaces the content. The planes may not be its own.
  void Build(const Columns& objects, const BuildOptions& options);

  // Replaces the content by what Blob() gave, in place or as a copy. Only the
  // header is checked: see CheckLoaded().
  void Load(Span<const std::byte> blob, bool is_in_place);
  Span<const std::byte> Blob() const;
  bool Verify() const;

  // `values` are those of all minima, then of all maxima.
  bool Has(std::uint32_t id) const;
  // Throws unless all are ids of objects.
  void CheckIds(Span<const std::uint32_t> ids, const char* call) const;
  void Get(std::uint32_t id, Span<float> values) const;
  void Bounds(Span<float> values) const;
  void Set(std::uint32_t id, Span<const float> values);
  std::uint32_t Insert(Span<const float> values);
  void Erase(std::uint32_t id);
  void Set(Span<const std::uint32_t> ids, const Columns& bounds);
  void Insert(const Columns& bounds, Span<std::uint32_t> ids);
  // Of floats, under ids that no object has, and that may be any numbers. No
  // call may choose ids in the same tree. A tree that has objects and no room
  // grows by an eighth, as it copies more often.
  void InsertAs(Span<const std::uint32_t> ids, const Columns& bounds);
  void Erase(Span<const std::uint32_t> ids);
  void Clear();
  void Reserve(std::size_t objects);

  // Of one object; of all objects by id.
  void SetMasks(std::uint32_t id, std::uint32_t mask);
  void SetMasks(Span<const std::uint32_t> masks);

  // The bounds of the objects anew, by id or by slot.
  void Refit(const Columns& objects, bool is_by_id, const Runner& run);

  double CostRatio() const;
  void Rebuild(const BuildOptions& options);
  std::size_t RebuildPartial(std::size_t objects);

 private:
  void Swap(BvhTree& other) noexcept;
  void Free();
  BvhHeader& header() const;
  BvhRoom Room() const;
  void Allocate(const BvhRoom& room);
  void BuildIn(const BvhRoom& room, const Columns& objects,
               const BuildOptions& options);
  // Does the work of InsertAs() if the tree is empty.
  void BuildAs(Span<const std::uint32_t> ids, const Columns& bounds);
  // Throws if ids and slots do not belong together, as in an altered blob:
  // changes would write anywhere.
  void CheckLoaded(const char* call);
  // What a blob with other ids has, or null if the ids are right.
  const char* FindWrongIds() const;
  // The same as CheckLoaded(), and throws if no target can be chosen.
  void CheckChange(const char* call);
  // Before a change: memory of its own with this room at least. Throws before
  // anything has changed, and is the last thing in a change that may throw.
  void Prepare(const char* call, BvhRoom room);
  void Reallocate(const char* call, const BvhRoom& room);
  void CheckId(std::uint32_t id, const char* call) const;
  std::size_t PrepareObject(std::uint32_t id, bool has_masks, const char* call);
  std::size_t slots() const { return levels_.level[0].size; }
  BvhRoom RoomFor(std::size_t more, const char* call) const;
  std::size_t FirstDue(std::size_t added) const;
  bool SortDue(std::size_t added, const BvhRoom& room, const char* call);
  std::size_t FindSlot(const float* values) const;
  std::uint32_t TakeId();
  void Put(std::size_t slot, std::uint32_t id, const float* values);
  void EncodeAppended(std::size_t begin, const char* call);
  void Remove(std::uint32_t id);
  bool HasManyGaps() const;
  void AppendSlot();
  void EncodePath(std::size_t slot);
  void Touch(std::size_t slot, std::uint64_t* touched);
  void EncodeTouched(std::uint64_t* touched);
  // Sorts the objects of some slots into the first of these, after Prepare().
  // Ranges ascend and begin at blocks. Returns the number of objects.
  std::size_t Resort(const char* call, Span<const SlotRange> ranges,
                     const BvhRoom& room);
  void CloseGaps();

  BvhShape shape_;
  MemoryResource memory_;
  std::byte* block_ = nullptr;
  std::size_t bytes_ = 0;
  bool is_owned_ = true;    // and not that of a blob in place
  bool is_checked_ = true;  // ids and slots belong together
  bool is_as_loaded_ = false;
  BvhLevels levels_;
};

template <typename View>
const BvhTree& TreeOf(const Bvh<View>& world) {
  return world.tree_;
}

// Returns whether to go on.
using IdsFunction = bool (*)(void* context, Span<const std::uint32_t> ids);

struct BvhQueries;
struct BvhShapeQuery;
struct Walk;

// Queries by shapes of one type.
struct BvhShapeKind {
  std::size_t alignment;
  BvhShapeQuery (*at)(const void* shapes, std::size_t i);
  // BvhWalkShapes(), which a program links only if it has shapes.
  void (*walk)(const BvhShape& world, const BvhQueries& queries,
               const QueryOptions& options, const char* call, const Walk& walk);
};

// Queries, one after another: bounds, of which each has all minima, then all
// maxima, and of simplices only maxima; or shapes.
struct BvhQueries {
  const void* first;
  std::size_t count;
  const BvhShapeKind* kind = nullptr;  // of shapes
};

// One query.
HALFSPACE_API std::size_t BvhSurvivors(const BvhTree& tree,
                                       const BvhQueries& query,
                                       Span<std::uint32_t> ids,
                                       const QueryOptions& options,
                                       std::size_t skip);
HALFSPACE_API std::size_t BvhCount(const BvhTree& tree, const BvhQueries& query,
                                   const QueryOptions& options);
// Returns whether there is one, and its id.
HALFSPACE_API bool BvhAny(const BvhTree& tree, const BvhQueries& query,
                          std::uint32_t& id, const QueryOptions& options);
HALFSPACE_API void BvhForEach(const BvhTree& tree, const BvhQueries& query,
                              IdsFunction function, void* context,
                              const QueryOptions& options);

// Several.
HALFSPACE_API std::size_t BvhSurvivorsOfEach(
    const BvhTree& tree, const BvhQueries& queries, Span<std::uint32_t> ids,
    Span<std::size_t> offsets, const QueryOptions& options, std::size_t skip);
// Of bounds.
HALFSPACE_API void BvhCountOfEach(const BvhTree& tree,
                                  const BvhQueries& queries,
                                  Span<std::size_t> counts,
                                  const QueryOptions& options);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_BVH_H_

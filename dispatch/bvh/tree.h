// The state of a tree, and the steps of its changes.
#ifndef HALFSPACE_DISPATCH_BVH_TREE_H_
#define HALFSPACE_DISPATCH_BVH_TREE_H_

#include <cstddef>
#include <cstdint>
#include <new>

#include "dispatch/bvh/axes.h"
#include "dispatch/bvh/layout.h"
#include "dispatch/bvh/used_ids.h"
#include "halfspace/bvh.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"

namespace halfspace::detail {

// A tree in one block of memory, which has a header and then the arrays of all
// levels (layout.h). The objects are in slots 0, 1, ... of level 0. Slots can
// be empty.
class BvhState {
 public:
  BvhState(const BvhType& type, const MemoryResource& memory)
      : type_(type), memory_(memory) {}
  BvhState(const BvhState& other, const MemoryResource& memory);
  BvhState(const BvhState&) = delete;
  BvhState& operator=(const BvhState&) = delete;
  ~BvhState() { Free(); }

  static BvhState& Of(BvhTree& tree) {
    return *std::launder(reinterpret_cast<BvhState*>(tree.state_));
  }
  static const BvhState& Of(const BvhTree& tree) {
    return *std::launder(reinterpret_cast<const BvhState*>(tree.state_));
  }

  const BvhType& type() const { return type_; }
  const MemoryResource& memory() const { return memory_; }
  const BvhLevels& levels() const { return levels_; }
  std::size_t slots() const { return levels_.level[0].size; }
  std::size_t size() const { return block_ == nullptr ? 0 : header().size; }
  bool Has(std::uint32_t id) const;
  double CostRatio() const;

  // For the broad phase, which writes the floats of slots itself. It calls
  // PrepareRefit() first. After the writes it calls EncodePath() for each of a
  // few slots, or EncodeTouched() with a bit for each slot that changed.
  // `changed` has WordsOfChanges() words, which are 0 after the words of the
  // slots. The tree must have changed by id before. No call allocates.
  void PrepareRefit() { Prepare("Bvh::Refit", {}); }
  // Called after a change by a caller that sorts by itself: objects that were
  // inserted until now do not count towards a sort of all.
  void ResetInsertions() { header().inserted = 0; }
  // Becomes a copy, in its own memory if both have equal room. If it throws,
  // nothing has changed.
  void CopyFrom(const BvhState& other);
  // As Rebuild(), in the memory of the tree, whose pages are there.
  void SortAll(const char* call, BuildQuality quality, const Runner& run);
  void EncodePath(std::size_t slot, bool is_new_block = false);
  void EncodeTouched(std::uint64_t* changed);
  static std::size_t WordsOfChanges(std::size_t slots);
  // Up to so many changes take less time one by one.
  static std::size_t FewChanges(std::size_t slots) {
    return 4 + slots / (std::size_t{1} << 14);
  }
  // Uses the levels of another owner. The tree must have no memory of its own.
  void Borrow(const BvhLevels& levels) { levels_ = levels; }

 private:
  friend class BvhTree;

  void Swap(BvhState& other) noexcept;
  void Free();
  BvhHeader& header() const { return *reinterpret_cast<BvhHeader*>(block_); }
  // Only if `levels_.slots` is not null.
  UsedIds Used() const { return {levels_.used, header().id_room}; }
  BvhRoom Room() const;
  void Allocate(const BvhRoom& room);
  void CheckBuild(std::size_t objects, const BuildOptions& options) const;
  // `kept` are the weights of the options of an earlier build, if they were
  // given.
  void BuildIn(const BvhRoom& room, const Columns& objects,
               const BuildOptions& options, const AxisWeights& kept);
  // Builds in parts that fit into memory (runs.cc).
  std::size_t RunObjects(const BuildOptions& options) const;
  bool IsSortedInRuns(std::size_t objects, const BuildOptions& options) const;
  void BuildInRuns(const BvhRoom& room, const Columns& objects,
                   const AxisWeights& weights,
                   const BvhKernels::OfPlanes& kernels,
                   const BuildOptions& options);
  void SortSlots(std::size_t begin, std::size_t end, const AxisWeights& weights,
                 const BvhKernels::OfPlanes& kernels, const Runner& run);
  // Throws if ids and slots contradict each other, as in an altered blob:
  // changes would write outside of the memory.
  void CheckLoaded(const char* call);
  // What the ids should be, for a message, or null if they are right.
  const char* FindWrongIds() const;
  // As CheckLoaded(). Throws also if no target can be chosen.
  void CheckChange(const char* call);
  // Makes the tree own its memory, with at least this room. Called before a
  // change: it is the last step that can throw, and if it throws, nothing has
  // changed.
  void Prepare(const char* call, BvhRoom room);
  void Reallocate(const char* call, const BvhRoom& room);
  void CheckId(std::uint32_t id, const char* call) const;
  std::size_t PrepareObject(std::uint32_t id, bool has_masks, const char* call);
  BvhRoom RoomFor(std::size_t more, const char* call) const;
  std::size_t FirstDue(std::size_t added) const;
  void SortDue(std::size_t added, const char* call);
  std::size_t FindSlot(const float* values) const;
  // Throws unless all ids are free and each is in the list once.
  void CheckNewIds(Span<const std::uint32_t> ids, const char* call) const;
  void Put(std::size_t slot, std::uint32_t id, const float* values);
  // Adds objects under the ids that id_of(i) returns.
  template <typename IdOf>
  void Append(const Columns& bounds, const BvhRoom& room, const IdOf& id_of,
              const char* call);
  void Remove(std::uint32_t id, std::uint64_t* changed);
  bool HasManyGaps() const;
  void AppendSlot();
  void Write(std::size_t slot, const float* values, std::uint64_t* changed);
  // Sorts the objects of some slots into the first of these slots, after
  // Prepare(). Ranges ascend and begin at blocks. Returns the number of
  // objects.
  std::size_t Resort(const char* call, Span<const SlotRange> ranges,
                     BuildQuality quality, const Runner& run);
  void CloseGaps();

  BvhType type_;
  MemoryResource memory_;
  std::byte* block_ = nullptr;
  std::size_t bytes_ = 0;
  bool is_owned_ = true;    // false for the block of a blob in place
  bool is_checked_ = true;  // ids and slots belong together
  bool is_as_loaded_ = false;
  BvhLevels levels_;
};

inline const BvhType& BvhTree::type() const {
  return BvhState::Of(*this).type();
}
inline const BvhLevels& BvhTree::levels() const {
  return BvhState::Of(*this).levels();
}

// Whether no query can find an object: the tree is empty, or no mask is wanted.
inline bool FindsNothing(const BvhTree& tree, std::uint32_t mask) {
  return tree.levels().level[0].size == 0 || mask == 0;
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_TREE_H_

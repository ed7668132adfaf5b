// The memory of a BVH, how it is built, and how objects are read.
#include "dispatch/bvh/tree.h"

#include <algorithm>
#include <limits>
#include <new>
#include <string>
#include <tuple>
#include <utility>

#include "dispatch/bvh/order.h"
#include "dispatch/bvh/scratch.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/number_checks.h"
#include "halfspace/bvh.h"

namespace halfspace::detail {

static_assert(sizeof(BvhState) <= sizeof(BvhTree));
static_assert(alignof(BvhState) <= alignof(BvhTree));

BvhTree::BvhTree(const BvhType& type, const MemoryResource& memory) {
  new (state_) BvhState(type, memory);
}

BvhTree::BvhTree(const BvhTree& other, const MemoryResource& memory) {
  new (state_) BvhState(BvhState::Of(other), memory);
}

BvhTree::BvhTree(BvhTree&& other) noexcept
    : BvhTree(other.type(), other.memory()) {
  Swap(other);
}

BvhTree& BvhTree::operator=(const BvhTree& other) {
  if (this != &other) BvhState::Of(*this).CopyFrom(BvhState::Of(other));
  return *this;
}

BvhTree::~BvhTree() { BvhState::Of(*this).~BvhState(); }

void BvhTree::Swap(BvhTree& other) noexcept {
  BvhState::Of(*this).Swap(BvhState::Of(other));
}

const MemoryResource& BvhTree::memory() const {
  return BvhState::Of(*this).memory();
}

std::size_t BvhTree::size() const { return BvhState::Of(*this).size(); }

std::size_t BvhTree::bytes() const { return BvhState::Of(*this).bytes_; }

std::size_t BvhTree::id_limit() const {
  const BvhState& tree = BvhState::Of(*this);
  return tree.block_ == nullptr ? 0 : tree.header().ids;
}

Span<const std::uint32_t> BvhTree::ids() const {
  const BvhState& tree = BvhState::Of(*this);
  return {tree.levels_.ids, tree.slots()};
}

BvhState::BvhState(const BvhState& other, const MemoryResource& memory)
    : BvhState(other.type_, memory) {
  CopyFrom(other);
}

void BvhState::CopyFrom(const BvhState& other) {
  if (other.block_ == nullptr) return Free();
  if (!is_owned_ || bytes_ != other.bytes_ || Room() != other.Room()) {
    Allocate(other.Room());
  }
  CopyButChecksum(block_, other.block_, bytes_);
  header().checksum = Checksum(other.header()).load();
  SetSlots(levels_, header().slots);
  is_checked_ = other.is_checked_;
  is_as_loaded_ = other.is_as_loaded_;
}

void BvhState::Swap(BvhState& other) noexcept {
  std::swap(type_, other.type_);
  std::swap(memory_, other.memory_);
  std::swap(block_, other.block_);
  std::swap(bytes_, other.bytes_);
  std::swap(is_owned_, other.is_owned_);
  std::swap(is_checked_, other.is_checked_);
  std::swap(is_as_loaded_, other.is_as_loaded_);
  std::swap(levels_, other.levels_);
}

void BvhState::Free() {
  if (block_ != nullptr && is_owned_) FreeBlock(memory_, block_, bytes_);
  block_ = nullptr;
  bytes_ = 0;
  is_owned_ = true;
  is_checked_ = true;
  is_as_loaded_ = false;
  levels_ = {};
}

BvhRoom BvhState::Room() const {
  if (block_ == nullptr) return {};
  return {header().capacity, header().id_room, header().has_masks != 0};
}

void BvhState::Allocate(const BvhRoom& room) {
  BvhLevels levels;
  const std::size_t bytes = Place(type_, room, nullptr, false, levels);
  auto* const block = static_cast<std::byte*>(AllocateBlock(memory_, bytes));
  Free();
  block_ = block;
  bytes_ = bytes;
  Place(type_, room, block_, true, levels_);
  BvhHeader& header = this->header();
  header = {};
  std::copy(std::begin(kBvhMagic), std::end(kBvhMagic), header.magic);
  header.version = kBvhVersion;
  header.dims = type_.dims;
  header.axes = type_.axes;
  header.has_max = type_.has_max;
  header.has_masks = room.has_masks;
  header.bytes = bytes;
  header.capacity = static_cast<std::uint32_t>(room.slots);
  header.id_room = static_cast<std::uint32_t>(room.ids);
  header.weights = AxisWeights::kNone;
  for (float& base : levels_.map->base) base = 0;
  for (float& scale : levels_.map->scale) scale = 1;
}

void BvhTree::Build(const Columns& objects, const BuildOptions& options) {
  BvhState& tree = BvhState::Of(*this);
  tree.CheckBuild(objects.size, options);
  if (objects.size == 0) return tree.Free();
  CheckColumns(tree.type_, objects, "Bvh");
  const Rounded floats(tree.type_, tree.memory_, objects, objects.size, nullptr,
                       options.run);
  tree.BuildIn({objects.size, 0, false}, floats.columns(), options, {});
}

void BvhTree::CheckBuild(std::size_t objects,
                         const BuildOptions& options) const {
  BvhState::Of(*this).CheckBuild(objects, options);
}

void BvhState::CheckBuild(std::size_t objects,
                          const BuildOptions& options) const {
  constexpr const char* kCall = "Bvh";
  std::ignore = KernelsFor(type_, options.target, kCall);
  dispatch::CheckObjectCount(kCall, "world", objects);
  const BuildQuality quality = options.quality;
  if (quality != BuildQuality::kHigh && quality != BuildQuality::kFast) {
    dispatch::ThrowInvalid(kCall, "quality", "an enumerator of BuildQuality",
                           std::to_string(static_cast<int>(quality)));
  }
  if (!options.query_extents) return;
  for (std::size_t k = 0; k < type_.dims; ++k) {
    dispatch::CheckLength(kCall, "query_extents", (*options.query_extents)[k]);
  }
}

void BvhState::BuildIn(const BvhRoom& room, const Columns& objects,
                       const BuildOptions& options, const AxisWeights& kept) {
  constexpr const char* kCall = "Bvh";
  CheckBuild(objects.size, options);
  const BvhKernels::OfPlanes& kernels =
      KernelsFor(type_, options.target, kCall);
  if (objects.size == 0) return Free();
  const AxisWeights weights =
      kept.is_given && !options.query_extents
          ? kept
          : WeightsOf(type_, objects, kernels, options.query_extents);
  if (IsSortedInRuns(objects.size, options)) {
    BuildInRuns(room, objects, weights, kernels, options);
  } else {
    const Scratch scratch(memory_, objects.size * kOrderScratch);
    Allocate(room);
    if (options.quality == BuildQuality::kFast) {
      OrderByCurve(type_, objects, weights, kernels, scratch.data(),
                   levels_.ids, options.run);
    } else {
      OrderByMedians(objects, weights, kernels, scratch.data(), levels_.ids,
                     options.run);
    }
    Truncate(type_, levels_, objects.size);
    FillPresent(levels_.level[0], objects.size);
    FillSlots(type_, levels_, objects, levels_.ids, kernels, options.run);
  }
  BvhHeader& header = this->header();
  header.slots = header.size = header.ids = header.sorted =
      static_cast<std::uint32_t>(objects.size);
  header.weights = weights.Pack();
  dispatch::InDefaultFpMode([&] {
    for (std::size_t group = 0; group < GroupsOf(objects.size); ++group) {
      levels_.built[group] = AsIs(type_, levels_, GroupAt(levels_, group));
    }
  });
}

bool BvhState::Has(std::uint32_t id) const {
  if (block_ == nullptr || id >= header().ids) return false;
  if (levels_.slots == nullptr) return true;
  return IsIn(levels_, header().slots, id);
}

bool BvhTree::Has(std::uint32_t id) const {
  return BvhState::Of(*this).Has(id);
}

void BvhState::CheckId(std::uint32_t id, const char* call) const {
  if (Has(id)) return;
  dispatch::ThrowInvalid(call, "id", "the id of an object", std::to_string(id));
}

void BvhTree::Get(std::uint32_t id, Span<float> values) const {
  const BvhState& tree = BvhState::Of(*this);
  constexpr const char* kCall = "Bvh::Get";
  tree.CheckId(id, kCall);
  const std::uint32_t* const ids = tree.levels_.ids;
  const std::size_t slot =
      tree.levels_.slots != nullptr
          ? tree.levels_.slots[id]
          : static_cast<std::size_t>(std::find(ids, ids + tree.slots(), id) -
                                     ids);
  if (slot == tree.slots()) {  // in an altered blob
    dispatch::ThrowInvalid(kCall, "id", "an element of ids()",
                           std::to_string(id));
  }
  GetAt(slot, values);
}

void BvhTree::GetAt(std::size_t slot, Span<float> values) const {
  for (std::size_t p = 0; p < values.size(); ++p) {
    values[p] = levels().level[0].Value(p, slot);
  }
}

void BvhTree::Bounds(Span<float> values) const {
  const BvhState& tree = BvhState::Of(*this);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const BvhLevels& levels = tree.levels_;
  const BvhLevel* const top =
      tree.block_ == nullptr ? nullptr : &levels.level[levels.count - 1];
  for (std::size_t p = 0; p < values.size(); ++p) {
    const float sign = p < tree.type_.axes ? 1.0f : -1.0f;
    float least = kInf;
    for (std::size_t i = 0; top != nullptr && i < top->size; ++i) {
      const float v = sign * top->Value(p, i);
      least = v == v ? std::min(least, v) : -kInf;
    }
    values[p] = sign * least;
  }
}

}  // namespace halfspace::detail

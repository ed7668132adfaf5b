// What a BVH owns: its memory, and how it is built.
#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

#include "dispatch/bvh/layout.h"
#include "dispatch/bvh/order.h"
#include "dispatch/bvh/rounded.h"
#include "dispatch/bvh/scratch.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/exact/default_fp_mode.h"
#include "halfspace/bvh.h"

namespace halfspace::detail {

BvhTree::BvhTree(const BvhShape& shape, const MemoryResource& memory)
    : shape_(shape), memory_(memory) {}

BvhTree::BvhTree(const BvhTree& other, const MemoryResource& memory)
    : BvhTree(other.shape_, memory) {
  if (other.block_ == nullptr) return;
  Allocate(other.Room());
  CopyButChecksum(block_, other.block_, bytes_);
  header().checksum = Checksum(other.header()).load();
  SetSlots(levels_, header().slots);
  is_checked_ = other.is_checked_;
  is_as_loaded_ = other.is_as_loaded_;
}

BvhTree::BvhTree(BvhTree&& other) noexcept
    : BvhTree(other.shape_, other.memory_) {
  Swap(other);
}

BvhTree::~BvhTree() { Free(); }

void BvhTree::Swap(BvhTree& other) noexcept {
  std::swap(shape_, other.shape_);
  std::swap(memory_, other.memory_);
  std::swap(block_, other.block_);
  std::swap(bytes_, other.bytes_);
  std::swap(is_owned_, other.is_owned_);
  std::swap(is_checked_, other.is_checked_);
  std::swap(is_as_loaded_, other.is_as_loaded_);
  std::swap(levels_, other.levels_);
}

void BvhTree::Free() {
  if (block_ != nullptr && is_owned_) FreeBlock(memory_, block_, bytes_);
  block_ = nullptr;
  bytes_ = 0;
  is_owned_ = true;
  is_checked_ = true;
  is_as_loaded_ = false;
  levels_ = {};
}

BvhHeader& BvhTree::header() const {
  return *reinterpret_cast<BvhHeader*>(block_);
}

BvhRoom BvhTree::Room() const {
  if (block_ == nullptr) return {};
  return {header().capacity, header().id_room, header().has_masks != 0};
}

std::size_t BvhTree::size() const {
  return block_ == nullptr ? 0 : header().size;
}

std::size_t BvhTree::id_limit() const {
  return block_ == nullptr ? 0 : header().ids;
}

void BvhTree::Allocate(const BvhRoom& room) {
  BvhLevels levels;
  const std::size_t bytes = Place(shape_, room, nullptr, false, levels);
  auto* const block = static_cast<std::byte*>(AllocateBlock(memory_, bytes));
  Free();
  block_ = block;
  bytes_ = bytes;
  Place(shape_, room, block_, true, levels_);
  BvhHeader& header = this->header();
  header = {};
  std::copy(std::begin(kBvhMagic), std::end(kBvhMagic), header.magic);
  header.version = kBvhVersion;
  header.dims = shape_.dims;
  header.axes = shape_.axes;
  header.has_max = shape_.has_max;
  header.has_masks = room.has_masks;
  header.bytes = bytes;
  header.capacity = static_cast<std::uint32_t>(room.slots);
  header.id_room = static_cast<std::uint32_t>(room.ids);
  header.free_id = kNoId;
  for (float& base : levels_.map->base) base = 0;
  for (float& scale : levels_.map->scale) scale = 1;
}

void BvhTree::Build(const Columns& objects, const BuildOptions& options) {
  CheckBuild(objects.size, options);
  if (objects.size == 0) return Free();
  CheckColumns(shape_, objects, "Bvh");
  const Rounded floats(shape_, memory_, objects, objects.size, nullptr,
                       options.run);
  BuildIn({objects.size, 0, false}, floats.columns(), options);
}

void BvhTree::CheckBuild(std::size_t objects,
                         const BuildOptions& options) const {
  constexpr const char* kCall = "Bvh";
  std::ignore = KernelsFor(shape_, options.target, kCall);
  if (objects >= kMostObjects) {
    dispatch::ThrowInvalid(kCall, "world", "fewer than 2^31 objects in all",
                           std::to_string(objects));
  }
  const BuildQuality quality = options.quality;
  if (quality != BuildQuality::kHigh && quality != BuildQuality::kFast) {
    dispatch::ThrowInvalid(kCall, "quality", "an enumerator of BuildQuality",
                           std::to_string(static_cast<int>(quality)));
  }
}

void BvhTree::BuildIn(const BvhRoom& room, const Columns& objects,
                      const BuildOptions& options) {
  constexpr const char* kCall = "Bvh";
  CheckBuild(objects.size, options);
  const BvhKernels::OfPlanes& kernels =
      KernelsFor(shape_, options.target, kCall);
  if (objects.size == 0) return Free();
  const Scratch scratch(memory_, objects.size * dispatch::kOrderScratch);
  Allocate(room);
  const auto put_in_order = options.quality == BuildQuality::kFast
                                ? dispatch::OrderByCurve
                                : dispatch::OrderByMedians;
  put_in_order(objects, kernels, scratch.data(), levels_.ids, options.run);
  Truncate(shape_, levels_, objects.size);
  BvhHeader& header = this->header();
  header.slots = header.size = header.ids = header.sorted =
      static_cast<std::uint32_t>(objects.size);
  FillPresent(levels_.level[0], objects.size);
  FillSlots(shape_, levels_, objects, levels_.ids, kernels, options.run);
  dispatch::InDefaultFpMode([&] {
    for (std::size_t part = 0; part < PartsOf(objects.size); ++part) {
      levels_.built[part] = AsIs(shape_, levels_, PartAt(levels_, part));
    }
  });
}

}  // namespace halfspace::detail

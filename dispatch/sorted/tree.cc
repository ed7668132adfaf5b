// What a sorted world owns: its memory, and how it is built.
#include <algorithm>
#include <string>
#include <utility>

#include "dispatch/sorted/layout.h"
#include "dispatch/sorted/scratch.h"
#include "halfspace/sorted.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/memory_checks.h"
#include "kernels/sorted/order.h"

namespace halfspace::detail {

SortedTree::SortedTree(const SortedShape& shape, const MemoryResource& memory)
    : shape_(shape), memory_(memory) {}

SortedTree::SortedTree(const SortedTree& other, const MemoryResource& memory)
    : SortedTree(other.shape_, memory) {
  if (other.block_ == nullptr) return;
  Allocate(other.Room());
  CopyButChecksum(block_, other.block_, bytes_);
  header().checksum = Checksum(other.header()).load();
  SetSlots(levels_, header().slots);
  is_checked_ = other.is_checked_;
  is_as_loaded_ = other.is_as_loaded_;
}

SortedTree::SortedTree(SortedTree&& other) noexcept
    : SortedTree(other.shape_, other.memory_) {
  Swap(other);
}

SortedTree::~SortedTree() { Free(); }

void SortedTree::Swap(SortedTree& other) noexcept {
  std::swap(shape_, other.shape_);
  std::swap(memory_, other.memory_);
  std::swap(block_, other.block_);
  std::swap(bytes_, other.bytes_);
  std::swap(is_owned_, other.is_owned_);
  std::swap(is_checked_, other.is_checked_);
  std::swap(is_as_loaded_, other.is_as_loaded_);
  std::swap(levels_, other.levels_);
}

void SortedTree::Free() {
  if (block_ != nullptr && is_owned_) FreeBlock(memory_, block_, bytes_);
  block_ = nullptr;
  bytes_ = 0;
  is_owned_ = true;
  is_checked_ = true;
  is_as_loaded_ = false;
  levels_ = {};
}

SortedHeader& SortedTree::header() const {
  return *reinterpret_cast<SortedHeader*>(block_);
}

SortedRoom SortedTree::Room() const {
  if (block_ == nullptr) return {};
  return {header().capacity, header().id_room, header().has_categories != 0};
}

std::size_t SortedTree::size() const {
  return block_ == nullptr ? 0 : header().size;
}

std::size_t SortedTree::id_limit() const {
  return block_ == nullptr ? 0 : header().ids;
}

void SortedTree::Allocate(const SortedRoom& room) {
  SortedLevels levels;
  const std::size_t bytes = Place(shape_, room, nullptr, false, levels);
  auto* const block = static_cast<std::byte*>(AllocateBlock(memory_, bytes));
  Free();
  block_ = block;
  bytes_ = bytes;
  Place(shape_, room, block_, true, levels_);
  SortedHeader& header = this->header();
  header = {};
  std::copy(std::begin(kSortedMagic), std::end(kSortedMagic), header.magic);
  header.version = kSortedVersion;
  header.dims = shape_.dims;
  header.axes = shape_.axes;
  header.has_max = shape_.has_max;
  header.has_categories = room.has_categories;
  header.bytes = bytes;
  header.capacity = static_cast<std::uint32_t>(room.slots);
  header.id_room = static_cast<std::uint32_t>(room.ids);
  header.free_id = kNoId;
}

void SortedTree::Build(const FloatColumns& objects, Order order, Target target,
                       const PartRunner& run) {
  BuildIn({objects.size, 0, false}, objects, order, target, run);
}

void SortedTree::BuildIn(const SortedRoom& room, const FloatColumns& objects,
                         Order order, Target target, const PartRunner& run) {
  constexpr const char* kCall = "SortedWorld";
  const SortedKernels::OfPlanes& kernels = KernelsFor(shape_, target, kCall);
  if (objects.size >= kMostObjects) {
    kernels::ThrowInvalid(kCall, "world", "less than 2^31 objects",
                          std::to_string(objects.size));
  }
  if (order != Order::kTight && order != Order::kFast) {
    kernels::ThrowInvalid(kCall, "order", "an enumerator of Order",
                          std::to_string(static_cast<int>(order)));
  }
  if (objects.size == 0) return Free();
  CheckColumns(shape_, objects, kCall);
  const Scratch scratch(memory_, objects.size * kernels::kOrderScratch);
  Allocate(room);
  const auto put_in_order =
      order == Order::kFast ? kernels::OrderByCurve : kernels::OrderByMedians;
  put_in_order(objects, kernels, scratch.data(), levels_.ids, run);
  Truncate(shape_, levels_, objects.size);
  SortedHeader& header = this->header();
  header.slots = header.size = header.ids = header.sorted =
      static_cast<std::uint32_t>(objects.size);
  FillPresent(levels_.level[0], objects.size);
  FillSlots(shape_, levels_, objects, levels_.ids, kernels, run);
  kernels::InDefaultFpMode([&] {
    for (std::size_t part = 0; part < PartsOf(objects.size); ++part) {
      levels_.built[part] = AsIs(shape_, levels_, PartAt(levels_, part));
    }
  });
}

}  // namespace halfspace::detail

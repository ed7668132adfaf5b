// What a sorted world owns: its memory, the build, and its blob.
#include <algorithm>
#include <cstring>
#include <limits>
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
namespace {

[[noreturn]] void ThrowCorrupt(bool is_in_place, const char* expected,
                               const std::string& given) {
  kernels::ThrowInvalid(
      is_in_place ? "SortedWorld::InPlace" : "SortedWorld::FromBlob", "blob",
      expected, given);
}

// The last block of a level has lanes without an object, which no query may
// keep: their children would be beyond the level below.
bool IsClosed(const SortedShape& shape, const SortedLevel& level) {
  const std::size_t count = level.size % kBlockObjects;
  if (count == 0) return true;
  const std::size_t last = level.size / kBlockObjects;
  if (level.present[last] >> count != 0) return false;
  const auto* codes = reinterpret_cast<const std::int8_t*>(
      level.blocks + last * BlockBytes(PlanesOf(shape)) + sizeof(BlockScale));
  for (std::size_t p = 0; p < PlanesOf(shape); ++p) {
    for (std::size_t i = count; i < kBlockObjects; ++i) {
      if (codes[p * kBlockObjects + i] != kNoCode - kCodeBias) return false;
    }
  }
  return true;
}

}  // namespace

SortedTree::SortedTree(const SortedShape& shape, const MemoryResource& memory)
    : shape_(shape), memory_(memory) {}

SortedTree::SortedTree(const SortedTree& other, const MemoryResource& memory)
    : SortedTree(other.shape_, memory) {
  if (other.block_ == nullptr) return;
  const SortedHeader& from = other.header();
  Allocate(from.capacity, {from.has_slots != 0, from.has_categories != 0});
  std::memcpy(block_, other.block_, bytes_);
  SetSlots(levels_, from.slots);
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
  std::swap(levels_, other.levels_);
}

void SortedTree::Free() {
  if (block_ != nullptr && is_owned_) FreeBlock(memory_, block_, bytes_);
  block_ = nullptr;
  bytes_ = 0;
  is_owned_ = true;
  levels_ = {};
}

SortedHeader& SortedTree::header() const {
  return *reinterpret_cast<SortedHeader*>(block_);
}

std::size_t SortedTree::size() const {
  return block_ == nullptr ? 0 : header().size;
}

void SortedTree::Allocate(std::size_t capacity, const SortedExtras& extras) {
  SortedLevels levels;
  const std::size_t bytes =
      Place(shape_, capacity, extras, nullptr, false, levels);
  auto* const block = static_cast<std::byte*>(AllocateBlock(memory_, bytes));
  Free();
  block_ = block;
  bytes_ = bytes;
  Place(shape_, capacity, extras, block_, true, levels_);
  SortedHeader& header = this->header();
  header = {};
  std::copy(std::begin(kSortedMagic), std::end(kSortedMagic), header.magic);
  header.version = kSortedVersion;
  header.byte_order = kSortedByteOrder;
  header.bytes = bytes;
  header.capacity = capacity;
  header.free_id = kNoId;
  header.axes = shape_.axes;
  header.has_max = shape_.has_max;
  header.has_slots = extras.has_slots;
  header.has_categories = extras.has_categories;
}

void SortedTree::Build(const FloatColumns& objects, Order order, Target target,
                       const PartRunner& run) {
  constexpr const char* kCall = "SortedWorld";
  const SortedKernels::OfPlanes& kernels = KernelsOf(shape_, target, kCall);
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
  Allocate(objects.size, {});
  const auto put_in_order =
      order == Order::kFast ? kernels::OrderByCurve : kernels::OrderByMedians;
  put_in_order(objects, kernels, scratch.data(), levels_.ids, run);
  SetSlots(levels_, objects.size);
  header().slots = header().size = header().ids = objects.size;
  for (std::size_t l = 0; l < levels_.count; ++l) {
    const std::size_t size = levels_.level[l].size;
    std::fill_n(levels_.level[l].present, BlocksOf(size), ~std::uint64_t{0});
    if (levels_.level[l].regular != nullptr) {
      std::fill_n(levels_.level[l].regular, BlocksOf(size), 0);
    }
    if (size % kBlockObjects != 0) ClearSlots(shape_, levels_, l, size);
  }
  FillSlots(shape_, levels_, objects, levels_.ids, kernels, run);
  kernels::InDefaultFpMode([&] {
    for (std::size_t part = 0; part < PartsOf(objects.size); ++part) {
      levels_.built[part] = CostOf(shape_, levels_, part);
    }
  });
}

void SortedTree::Load(Span<const std::byte> blob, bool is_in_place) {
  if (blob.empty()) return Free();
  kernels::CheckPointer(
      is_in_place ? "SortedWorld::InPlace" : "SortedWorld::FromBlob",
      blob.data(), is_in_place ? alignof(SortedHeader) : 1,
      [] { return "blob"; }, [] { return "a blob"; });
  SortedHeader header;
  if (blob.size() < sizeof(header)) {
    ThrowCorrupt(is_in_place, "a header of 64 bytes",
                 std::to_string(blob.size()));
  }
  std::memcpy(&header, blob.data(), sizeof(header));
  if (!std::equal(std::begin(kSortedMagic), std::end(kSortedMagic),
                  header.magic)) {
    ThrowCorrupt(is_in_place, "what SortedWorld::Blob() gave",
                 "another beginning");
  }
  if (header.version != kSortedVersion ||
      header.byte_order != kSortedByteOrder) {
    ThrowCorrupt(is_in_place, "the version and the byte order of this library",
                 "version " + std::to_string(header.version));
  }
  if (header.axes != shape_.axes || (header.has_max != 0) != shape_.has_max) {
    ThrowCorrupt(is_in_place, "bounds of this world's kind",
                 std::to_string(header.axes) + " axes with " +
                     (header.has_max != 0 ? "" : "no ") + "maxima");
  }
  const SortedExtras extras = {header.has_slots != 0,
                               header.has_categories != 0};
  SortedLevels levels;
  if (header.capacity >= kMostObjects || header.slots > header.capacity ||
      header.size > header.slots || header.slots == 0 ||
      header.ids > header.capacity ||
      (header.free_id != kNoId && header.free_id >= header.ids) ||
      Place(shape_, header.capacity, extras, nullptr, false, levels) !=
          header.bytes ||
      header.bytes != blob.size()) {
    ThrowCorrupt(is_in_place, "the bytes that its header tells",
                 std::to_string(blob.size()));
  }
  SortedTree loaded(shape_, memory_);
  if (is_in_place) {
    // Not written before it has been copied: see MakeOwn().
    loaded.block_ = const_cast<std::byte*>(blob.data());
    loaded.bytes_ = blob.size();
    loaded.is_owned_ = false;
    Place(shape_, header.capacity, extras, loaded.block_, false,
          loaded.levels_);
  } else {
    loaded.Allocate(header.capacity, extras);
    std::memcpy(loaded.block_, blob.data(), blob.size());
  }
  SetSlots(loaded.levels_, header.slots);
  for (std::size_t l = 0; l < loaded.levels_.count; ++l) {
    if (!IsClosed(shape_, loaded.levels_.level[l])) {
      ThrowCorrupt(is_in_place, "no objects beyond the last",
                   "some on level " + std::to_string(l));
    }
  }
  Swap(loaded);
}

}  // namespace halfspace::detail

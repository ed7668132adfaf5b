// What a sorted world owns: its memory, the build, and its blob.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
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

constexpr std::size_t kLine = sizeof(SortedHeader);

[[noreturn]] void ThrowCorrupt(bool is_in_place, const std::string& expected,
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

// Another thread may be in Blob(), which writes the checksum.
void CopyButChecksum(void* to, const std::byte* from, std::size_t bytes) {
  constexpr std::size_t kBefore = offsetof(SortedHeader, checksum);
  constexpr std::size_t kAfter = kBefore + sizeof(std::uint64_t);
  std::memcpy(to, from, kBefore);
  std::memcpy(static_cast<std::byte*>(to) + kAfter, from + kAfter,
              bytes - kAfter);
}

// Of all bytes but the checksum's own. A change of one byte always changes it:
// each step can be undone.
std::uint64_t ChecksumOf(Span<const std::byte> blob) {
  constexpr std::size_t kLanes = kLine / sizeof(std::uint64_t);
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15;
  const auto mix = [](std::uint64_t sum, std::uint64_t word) {
    sum = (sum ^ word) * kOdd;
    return sum ^ sum >> 32;
  };
  std::array<std::uint64_t, kLanes> sums{};
  const auto add = [&](const void* line) {
    std::array<std::uint64_t, kLanes> words;
    std::memcpy(&words, line, kLine);
    for (std::size_t i = 0; i < kLanes; ++i) sums[i] = mix(sums[i], words[i]);
  };
  SortedHeader header{};
  CopyButChecksum(&header, blob.data(), kLine);
  add(&header);
  for (std::size_t i = kLine; i < blob.size(); i += kLine) {
    add(blob.data() + i);
  }
  std::uint64_t all = 0;
  for (std::uint64_t sum : sums) all = mix(all, sum);
  return all == 0 ? 1 : all;
}

std::atomic_ref<std::uint64_t> Checksum(SortedHeader& header) {
  return std::atomic_ref<std::uint64_t>(header.checksum);
}

}  // namespace

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
    ThrowCorrupt(is_in_place, "what SortedWorld::Blob() returned",
                 "another beginning");
  }
  if (header.version != kSortedVersion) {
    ThrowCorrupt(is_in_place,
                 "format " + std::to_string(kSortedVersion) +
                     " in this machine's byte order",
                 "format " + std::to_string(header.version));
  }
  const auto type = [](std::size_t dims, std::size_t axes, bool has_max) {
    return std::to_string(dims) + " dimensions, " + std::to_string(axes) +
           " axes " + (has_max ? "with" : "without") + " maxima";
  };
  if (header.dims != shape_.dims || header.axes != shape_.axes ||
      header.has_max != (shape_.has_max ? 1 : 0)) {
    ThrowCorrupt(is_in_place,
                 "bounds of " + type(shape_.dims, shape_.axes, shape_.has_max),
                 type(header.dims, header.axes, header.has_max != 0));
  }
  const SortedRoom room = {header.capacity, header.id_room,
                           header.has_categories != 0};
  const bool are_ids_right =
      room.ids == 0
          ? header.ids == header.slots && header.size == header.slots &&
                header.free_id == kNoId
          : room.ids >= room.slots && header.ids <= room.ids &&
                (header.free_id == kNoId || header.free_id < header.ids);
  SortedLevels levels;
  if (room.slots == 0 || room.slots >= kMostObjects ||
      header.slots > room.slots || header.size > header.slots ||
      header.ids < header.size || !are_ids_right || header.has_categories > 1 ||
      header.checksum == 0 ||
      Place(shape_, room, nullptr, false, levels) != header.bytes ||
      header.bytes != blob.size()) {
    ThrowCorrupt(is_in_place, "the bytes that its header describes",
                 std::to_string(blob.size()));
  }
  SortedTree loaded(shape_, memory_);
  if (is_in_place) {
    // Not written before it has been copied: see Prepare().
    loaded.block_ = const_cast<std::byte*>(blob.data());
    loaded.bytes_ = blob.size();
    loaded.is_owned_ = false;
    Place(shape_, room, loaded.block_, false, loaded.levels_);
  } else {
    loaded.Allocate(room);
    std::memcpy(loaded.block_, blob.data(), blob.size());
  }
  loaded.is_checked_ = false;
  loaded.is_as_loaded_ = true;
  SetSlots(loaded.levels_, header.slots);
  for (std::size_t l = 0; l < loaded.levels_.count; ++l) {
    if (!IsClosed(shape_, loaded.levels_.level[l])) {
      ThrowCorrupt(is_in_place, "no objects beyond the last",
                   "some on level " + std::to_string(l));
    }
  }
  Swap(loaded);
}

// Calls may run at the same time, so the checksum is written once after a
// change, and not again.
Span<const std::byte> SortedTree::Blob() const {
  if (block_ == nullptr) return {};
  if (Checksum(header()).load() == 0) {
    std::uint64_t none = 0;
    Checksum(header()).compare_exchange_strong(none,
                                               ChecksumOf({block_, bytes_}));
  }
  return {block_, bytes_};
}

bool SortedTree::Verify() const {
  if (!is_as_loaded_) return true;
  return header().checksum == ChecksumOf({block_, bytes_});
}

void SortedTree::CheckLoaded(const char* call) {
  if (is_checked_) return;
  const SortedHeader& header = this->header();
  const auto check = [&](bool is_right, const char* expected) {
    if (is_right) return;
    kernels::ThrowInvalid(call, "blob", expected, "a blob that was altered");
  };
  // A bit for each id, where no slots tell that it is there once.
  const std::size_t words = header.id_room > 0 ? 0 : BlocksOf(header.ids);
  const Scratch scratch(memory_, words * sizeof(std::uint64_t));
  auto* const seen = reinterpret_cast<std::uint64_t*>(scratch.data());
  std::fill_n(seen, words, 0);
  std::size_t size = 0;
  for (std::size_t s = 0; s < header.slots; ++s) {
    if (!IsPresent(levels_, s)) continue;
    ++size;
    const std::uint32_t id = levels_.ids[s];
    check(id < header.ids, "ids below their number");
    if (header.id_room > 0) {
      check(levels_.slots[id] == s, "each id once");
    } else {
      const std::uint64_t bit = std::uint64_t{1} << id % 64;
      check((seen[id / 64] & bit) == 0, "each id once");
      seen[id / 64] |= bit;
    }
  }
  check(size == header.size, "as many objects as its header says");
  std::size_t free = header.ids - size;
  for (std::uint32_t id = header.free_id; id != kNoId; --free) {
    check(free > 0 && id < header.ids && !Has(id), "free ids in a list");
    id = levels_.slots[id];
  }
  check(free == 0, "all free ids in a list");
  is_checked_ = true;
}

}  // namespace halfspace::detail

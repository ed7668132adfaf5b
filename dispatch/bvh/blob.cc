// The blob of a BVH.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <string>

#include "dispatch/bvh/scratch.h"
#include "dispatch/bvh/tree.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "halfspace/bvh.h"

namespace halfspace::detail {
namespace {

constexpr std::size_t kHeaderBytes = sizeof(BvhHeader);

[[noreturn]] void ThrowCorrupt(bool is_in_place, const std::string& expected,
                               const std::string& given) {
  dispatch::ThrowInvalid(is_in_place ? "Bvh::InPlace" : "Bvh::FromBlob", "blob",
                         expected, given);
}

void CheckVersion(bool is_in_place, std::uint32_t version) {
  if (version == kBvhVersion) return;
  std::string given = "format " + std::to_string(version);
  if (version >> 24 != 0) {
    given = "a blob in the other byte order; build the world again here";
  } else if (version > kBvhVersion) {
    given += ", which is newer; use a newer version of halfspace";
  } else {
    given += ", which is older; build the world again";
  }
  ThrowCorrupt(is_in_place, "format " + std::to_string(kBvhVersion), given);
}

// Whether no lane of the last block that is beyond the level is marked as
// present. A query that kept it would read beyond the level below.
bool IsClosed(const BvhLevel& level) {
  const std::size_t count = level.size % kBlockObjects;
  return count == 0 || level.present[level.size / kBlockObjects] >> count == 0;
}

// The checksum of all bytes except its own. A change of one byte always changes
// it, because each step is reversible.
std::uint64_t ChecksumOf(Span<const std::byte> blob) {
  constexpr std::size_t kLanes = kHeaderBytes / sizeof(std::uint64_t);
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15;
  const auto mix = [](std::uint64_t sum, std::uint64_t word) {
    sum = (sum ^ word) * kOdd;
    return sum ^ sum >> 32;
  };
  std::array<std::uint64_t, kLanes> sums{};
  const auto add = [&](const void* line) {
    std::array<std::uint64_t, kLanes> words;
    std::memcpy(&words, line, kHeaderBytes);
    for (std::size_t i = 0; i < kLanes; ++i) sums[i] = mix(sums[i], words[i]);
  };
  BvhHeader header{};
  CopyButChecksum(&header, blob.data(), kHeaderBytes);
  add(&header);
  for (std::size_t i = kHeaderBytes; i < blob.size(); i += kHeaderBytes) {
    add(blob.data() + i);
  }
  std::uint64_t all = 0;
  for (std::uint64_t sum : sums) all = mix(all, sum);
  return all == 0 ? 1 : all;
}

}  // namespace

void BvhTree::Load(Span<const std::byte> blob, bool is_in_place) {
  BvhState& tree = BvhState::Of(*this);
  if (blob.empty()) return tree.Free();
  dispatch::CheckPointer(
      is_in_place ? "Bvh::InPlace" : "Bvh::FromBlob", blob.data(),
      is_in_place ? alignof(BvhHeader) : 1, [] { return "blob"; },
      [] { return "a blob"; });
  BvhHeader header;
  if (blob.size() < sizeof(header)) {
    ThrowCorrupt(is_in_place, "a header of 64 bytes",
                 std::to_string(blob.size()));
  }
  std::memcpy(&header, blob.data(), sizeof(header));
  if (!std::equal(std::begin(kBvhMagic), std::end(kBvhMagic), header.magic)) {
    ThrowCorrupt(is_in_place, "the bytes of a stored BVH", "another beginning");
  }
  CheckVersion(is_in_place, header.version);
  const BvhType& own = tree.type_;
  const auto type = [](std::size_t dims, std::size_t axes, bool has_max) {
    return std::to_string(dims) + " dimensions, " + std::to_string(axes) +
           " axes " + (has_max ? "with" : "without") + " maxima";
  };
  if (header.dims != own.dims || header.axes != own.axes ||
      header.has_max != (own.has_max ? 1 : 0)) {
    ThrowCorrupt(is_in_place,
                 "bounds of " + type(own.dims, own.axes, own.has_max),
                 type(header.dims, header.axes, header.has_max != 0));
  }
  const BvhRoom room = {header.capacity, header.id_room, header.has_masks != 0};
  const bool are_ids_right =
      room.ids == 0 ? header.ids == header.slots && header.size == header.slots
                    : room.ids >= room.slots && header.ids <= room.ids;
  const bool is_room_right = room.slots > 0 && room.slots < kMostObjects;
  BvhLevels levels;
  const std::size_t bytes =
      is_room_right ? Place(own, room, nullptr, false, levels) : 0;
  if (!is_room_right || header.slots > room.slots ||
      header.size > header.slots || header.ids < header.size ||
      !are_ids_right || header.has_masks > 1 || header.checksum == 0 ||
      header.bytes != bytes || header.bytes != blob.size()) {
    ThrowCorrupt(is_in_place,
                 std::to_string(header.bytes) + " bytes, as its header says",
                 std::to_string(blob.size()) +
                     " bytes or an altered header; store the BVH again");
  }
  BvhState loaded(own, tree.memory_);
  if (is_in_place) {
    // Not written before it has been copied: see BvhState::Prepare().
    loaded.block_ = const_cast<std::byte*>(blob.data());
    loaded.is_owned_ = false;
  } else {
    loaded.block_ = static_cast<std::byte*>(AllocateBlock(tree.memory_, bytes));
    std::memcpy(loaded.block_, blob.data(), bytes);
  }
  loaded.bytes_ = bytes;
  Place(own, room, loaded.block_, false, loaded.levels_);
  loaded.is_checked_ = false;
  loaded.is_as_loaded_ = true;
  SetSlots(loaded.levels_, header.slots);
  for (std::size_t l = 0; l < loaded.levels_.count; ++l) {
    if (!IsClosed(loaded.levels_.level[l])) {
      loaded.Free();
      ThrowCorrupt(
          is_in_place, "the bytes of a stored BVH",
          "altered bytes in the unused lanes of level " + std::to_string(l));
    }
  }
  tree.Swap(loaded);
}

PlaneLayout LayoutOfBlob(Span<const std::byte> blob) {
  BvhHeader header;
  if (blob.size() < sizeof(header)) return {};
  std::memcpy(&header, blob.data(), sizeof(header));
  if (!std::equal(std::begin(kBvhMagic), std::end(kBvhMagic), header.magic)) {
    return {};
  }
  return {header.dims, header.axes, header.has_max != 0};
}

// Several calls may run at the same time, so the checksum is written only once
// after a change.
Span<const std::byte> BvhTree::Blob() const {
  const BvhState& tree = BvhState::Of(*this);
  if (tree.block_ == nullptr) return {};
  if (Checksum(tree.header()).load() == 0) {
    std::uint64_t none = 0;
    Checksum(tree.header())
        .compare_exchange_strong(none, ChecksumOf({tree.block_, tree.bytes_}));
  }
  return {tree.block_, tree.bytes_};
}

bool BvhTree::Verify() const {
  const BvhState& tree = BvhState::Of(*this);
  if (!tree.is_as_loaded_) return true;
  return tree.header().checksum == ChecksumOf({tree.block_, tree.bytes_});
}

void BvhState::CheckLoaded(const char* call) {
  if (is_checked_) return;
  if (const char* const expected = FindWrongIds(); expected != nullptr) {
    dispatch::ThrowInvalid(call, "blob", expected, "a blob that was altered");
  }
  is_checked_ = true;
}

const char* BvhState::FindWrongIds() const {
  const BvhHeader& header = this->header();
  // A bit for each id, if there are no slots by id that show that each id is
  // used once.
  const std::size_t words = header.id_room > 0 ? 0 : BlocksOf(header.ids);
  const Scratch scratch(memory_, words * sizeof(std::uint64_t));
  auto* const seen = reinterpret_cast<std::uint64_t*>(scratch.data());
  std::fill_n(seen, words, 0);
  std::size_t size = 0;
  for (std::size_t s = 0; s < header.slots; ++s) {
    const std::uint32_t id = levels_.ids[s];
    if (!IsPresent(levels_, s)) {
      // With its slot by id, it would count as the id of an object.
      if (id != kNoId) return "no ids in empty slots";
      continue;
    }
    ++size;
    if (id >= header.ids) return "ids below their number";
    constexpr const char* kOnce = "each id once";
    if (header.id_room > 0) {
      if (levels_.slots[id] != s || !Used().Has(id)) return kOnce;
    } else {
      const std::uint64_t bit = std::uint64_t{1} << id % 64;
      if ((seen[id / 64] & bit) != 0) return kOnce;
      seen[id / 64] |= bit;
    }
  }
  if (size != header.size) return "as many objects as its header says";
  return header.id_room == 0 || Used().IsRight(size)
             ? nullptr
             : "the ids of its objects as a set";
}

}  // namespace halfspace::detail

// The bytes of a BVH as an older library wrote them.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_OLD_FORMAT_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_OLD_FORMAT_H_

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "halfspace/halfspace.h"

namespace halfspace::testing {

// Format 4 has no set of the ids in use, and one cost for 4096 places, which
// are the last parts of a blob. The checksum stays that of `blob`.
inline std::vector<std::byte> AsFormat4(Span<const std::byte> blob) {
  struct Part {
    double cost = 0;
    std::uint64_t objects = 0;
  };
  const auto in_lines = [](std::size_t bytes) {
    return (bytes + 63) / 64 * 64;
  };
  const auto parts_of = [](std::size_t places, std::size_t of_part) {
    return (places + of_part - 1) / of_part;
  };
  std::uint32_t room[2];  // for places and for ids
  std::memcpy(room, blob.data() + 32, sizeof(room));
  std::size_t words = 0;
  for (std::size_t ids = room[1]; ids > 0;) {
    const std::size_t level = (ids + 63) / 64;
    words += level;
    ids = level == 1 ? 0 : level;
  }
  const std::size_t parts = parts_of(room[0], 1024);
  const std::byte* const costs =
      blob.data() + blob.size() - in_lines(parts * sizeof(Part));
  std::vector<std::byte> bytes(blob.data(),
                               costs - in_lines(words * sizeof(words)));
  for (std::size_t old = 0; old < parts_of(room[0], 4096); ++old) {
    Part sum;
    for (std::size_t i = 4 * old; i < parts && i < 4 * old + 4; ++i) {
      Part part;
      std::memcpy(&part, costs + i * sizeof(part), sizeof(part));
      sum.cost += part.cost;
      sum.objects += part.objects;
    }
    const auto* const begin = reinterpret_cast<const std::byte*>(&sum);
    bytes.insert(bytes.end(), begin, begin + sizeof(sum));
  }
  bytes.resize(in_lines(bytes.size()));
  const std::uint32_t version = 4;
  std::memcpy(&bytes[8], &version, sizeof(version));
  const std::uint64_t size = bytes.size();
  std::memcpy(&bytes[16], &size, sizeof(size));
  return bytes;
}

// Format 3 has codes behind the floats of the objects. Here they are 0.
inline std::vector<std::byte> AsFormat3(const detail::PlaneLayout& layout,
                                        Span<const std::byte> blob) {
  std::vector<std::byte> bytes = AsFormat4(blob);
  std::uint32_t room = 0;
  std::memcpy(&room, &bytes[32], sizeof(room));
  const std::size_t values = (room + 63) / 64 * 64 * layout.plane_count;
  bytes.insert(bytes.begin() + 128 + values * sizeof(float),
               values * sizeof(std::int16_t), std::byte{0});
  const std::uint32_t version = 3;
  std::memcpy(&bytes[8], &version, sizeof(version));
  const std::uint64_t size = bytes.size();
  std::memcpy(&bytes[16], &size, sizeof(size));
  return bytes;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_OLD_FORMAT_H_

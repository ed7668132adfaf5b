// Bytes that another machine wrote: the same as this machine's, or refused
// because the other machine has the other byte order.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

using Bytes = std::vector<std::byte>;

// The octahedra of bvh/blob_test.cc, whose file x86 has written.
AaboBvh3 Octahedra() {
  AaboBvh3 bvh;
  bvh.Reserve(100);
  for (std::uint32_t id = 0; id < 100; ++id) {
    Aabo3 bound;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const auto at = [&](std::uint32_t p) {
        return static_cast<float>((id * 37 + p % 4 * 29) % 101) - 50;
      };
      bound.min[k] = at(k);
      bound.max[k] = at(k + 4) + static_cast<float>(id % 7);
    }
    bvh.Insert(bound);
  }
  for (std::uint32_t id = 3; id < 100; id += 7) bvh.Erase(id);
  for (std::uint32_t id = 0; id < 100; ++id) {
    if (id % 7 == 3) continue;
    bvh.SetMasks(id, id % 5 == 0 ? 1u << id % 8 : 0xFFFFFFFF);
  }
  return bvh;
}

TEST(BlobHashTest, ABvhIsThatOfOtherMachinesOrRefused) {
  std::ifstream file(HALFSPACE_TEST_DATA "/octahedra.5.bvh", std::ios::binary);
  Bytes theirs;
  for (char c; file.get(c);) theirs.push_back(static_cast<std::byte>(c));
  ASSERT_FALSE(theirs.empty());
  const AaboBvh3 bvh = Octahedra();
  const auto ours = bvh.Blob();
  ASSERT_EQ(ours.size(), theirs.size());
  const auto read = AaboBvh3::FromBlob(ours);
  EXPECT_TRUE(read.Verify());
  EXPECT_EQ(read.size(), bvh.size());
  if constexpr (std::endian::native == std::endian::little) {
    EXPECT_TRUE(std::equal(ours.begin(), ours.end(), theirs.begin()));
  } else {
    EXPECT_REFUSED((AaboBvh3::FromBlob(theirs)), "FromBlob", "format 5",
                   "the other byte order");
  }
}

TEST(BlobHashTest, ABroadPhaseOfTheOtherByteOrderIsRefused) {
  AabbBroadPhase3 bodies;
  bodies.Insert(7, BoundSphere(Sphere3{{1, 2, 3}, 4}).aabb());
  Bytes saved;
  bodies.Save([&](Span<const std::byte> piece) {
    saved.insert(saved.end(), piece.begin(), piece.end());
  });
  AabbBroadPhase3 loaded;
  loaded.Load(saved);
  EXPECT_TRUE(loaded.Has(7));
  // After the size and the magic.
  std::reverse(saved.begin() + 16, saved.begin() + 20);
  EXPECT_REFUSED((loaded.Load(saved)), "BroadPhase::Load", "byte order",
                 "the other byte order");
}

}  // namespace
}  // namespace halfspace::testing

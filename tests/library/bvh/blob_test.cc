// A blob has what its BVH has and nothing else. One of another type is refused,
// and an altered one is refused or harmless. history_test.cc goes on with
// blobs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/altered.h"
#include "tests/library/bvh/answers.h"
#include "tests/library/bvh/old_format.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/guarded_memory.h"

namespace halfspace::testing {
namespace {

class BvhBlobTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, BvhBlobTest, ::testing::ValuesIn(LayoutsOf(false)),
                         LayoutName());

std::vector<std::byte> BytesOf(const AnyBvh& bvh) {
  const auto blob = bvh.tree().Blob();
  return {blob.begin(), blob.end()};
}

// A blob may leave the process, so nothing of what its memory held before does.
TEST_P(BvhBlobTest, ABlobHasNothingElseInIt) {
  struct Filled {
    int byte;
    void* allocate(std::size_t bytes, std::size_t alignment) const {
      void* block = ::operator new (bytes, std::align_val_t{alignment});
      std::memset(block, byte, bytes);
      return block;
    }
    void deallocate(void* block, std::size_t, std::size_t alignment) const {
      ::operator delete (block, std::align_val_t{alignment});
    }
  };
  Filled zeros{0};
  Filled ones{255};
  Spheres spheres(GetParam(), 2);
  const std::vector<Planes> bounds = spheres.Some(4500);
  const auto a = MakeBvh(GetParam(), bounds, {.memory = MemoryFrom(zeros)});
  const auto b = MakeBvh(GetParam(), bounds, {.memory = MemoryFrom(ones)});
  for (int step = 0; step < 4; ++step) {
    EXPECT_EQ(BytesOf(*a), BytesOf(*b)) << step;
    for (AnyBvh* changed : {a.get(), b.get()}) {
      if (step == 0) changed->EraseOne(17);
      if (step == 1) changed->SetMask(5, 4);
      for (std::size_t i = 0; step == 2 && i < 100; ++i) {
        changed->InsertOne({{bounds[i]}, {}});
      }
    }
  }
}

TEST_P(BvhBlobTest, OfAnotherTypeIsRefused) {
  const auto bvh = MakeBvh(GetParam(), Spheres(GetParam(), 1).Some(100));
  for (const Layout& other : LayoutsOf(false)) {
    if (other == GetParam()) continue;
    const auto of_other = MakeBvh(other, std::vector<Planes>());
    for (bool is_in_place : {false, true}) {
      EXPECT_REFUSED((of_other->Loaded(bvh->tree().Blob(), is_in_place, {})),
                     is_in_place ? "InPlace" : "FromBlob", "blob", "dimensions",
                     "axes");
    }
  }
}

// The blob stays what it was made of: a change that is refused is none, and
// after one there is another blob.
TEST_P(BvhBlobTest, VerifyLooksAtTheBytesThatWereLoaded) {
  const auto bvh = MakeBvh(GetParam(), Spheres(GetParam(), 1).Some(200));
  bvh->EraseOne(3);
  const AlignedCopy blob(bvh->tree().Blob());
  std::byte& last = blob.bytes().back();
  last ^= std::byte{1};
  const auto altered = bvh->Loaded(blob.bytes(), false, {});
  EXPECT_EQ(altered->RebuildPartial(0), 0u);
  EXPECT_THROW(altered->EraseOne(3), std::invalid_argument);
  EXPECT_FALSE(altered->tree().Verify());
  EXPECT_FALSE(altered->Copy()->tree().Verify());
  last ^= std::byte{1};
  const auto changed = bvh->Loaded(blob.bytes(), true, {});
  EXPECT_TRUE(changed->tree().Verify() && changed->Copy()->tree().Verify());
  changed->EraseOne(4);
  EXPECT_TRUE(changed->tree().Verify());
  EXPECT_TRUE(bvh->Loaded(changed->tree().Blob(), false, {})->tree().Verify());
  EXPECT_NE(BytesOf(*changed), BytesOf(*bvh));
}

// Blocks between pages that fault, and the last of each touches one.
struct GuardedBlocks {
  std::map<void*, std::unique_ptr<GuardedMemory>> blocks;

  void* allocate(std::size_t bytes, std::size_t) {
    auto memory = std::make_unique<GuardedMemory>(bytes);
    void* const block =
        memory->Get<std::byte>(bytes, GuardedSide::kAfter).data();
    blocks[block] = std::move(memory);
    return block;
  }
  void deallocate(void* block, std::size_t, std::size_t) {
    blocks.erase(block);
  }
};

// Any byte of what a blob says of itself, and any number of them: the blob is
// refused, or no query and no change reads or writes anything else.
TEST_P(BvhBlobTest, ACorruptOneIsRefusedOrHarmless) {
  const Layout layout = GetParam();
  Spheres spheres(layout, 2);
  const BoundList objects{spheres.Some(700), {}};
  const Planes everything = EverythingOf(layout);
  const auto fresh = MakeBvh(layout, objects);
  const auto bvh = fresh->Copy();
  for (std::uint32_t id = 0; id < 60; ++id) bvh->EraseOne(id);
  for (int i = 0; i < 80; ++i) bvh->InsertOne({{EmptyOf(layout)}, {}});
  bvh->EraseOne(5);
  const auto with_masks = bvh->Copy();
  with_masks->SetMask(6, 2);
  const auto with_own_ids = bvh->Copy();
  with_own_ids->InsertAs(Ids{730, 2000, 6000},
                         {std::vector<Planes>(3, everything), {}});
  std::vector<std::vector<std::byte>> blobs;
  for (const AnyBvh* world :
       {fresh.get(), bvh.get(), with_masks.get(), with_own_ids.get()}) {
    const auto blob = world->tree().Blob();
    blobs.push_back(BytesOf(*world));
    for (const auto& old : {AsFormat4(blob), AsFormat3(layout, blob)}) {
      EXPECT_EQ(bvh->Loaded(old, false, {})->size(), world->size());
      blobs.push_back(old);
    }
  }
  Random random(1);
  std::size_t refused = 0;
  std::size_t changed = 0;
  GuardedBlocks guarded;
  for (std::size_t round = 0, rounds = std::max<std::size_t>(Scaled(1000), 100);
       round < rounds; ++round) {
    const std::vector<std::byte>& blob = blobs[random() % blobs.size()];
    const GuardedMemory memory(blob.size());
    const auto altered =
        memory.Get<std::byte>(blob.size(), GuardedSide::kAfter);
    std::copy(blob.begin(), blob.end(), altered.begin());
    // Numbers of the header, any bytes of it, any bytes.
    for (std::size_t c = 1 + random() % (round % 2 == 0 ? 2 : 40); c-- > 0;) {
      if (round % 4 == 0) {
        const auto value = static_cast<std::uint32_t>(random() % 1100);
        std::memcpy(&altered[32 + random() % 8 * 4], &value, sizeof(value));
      } else {
        const std::size_t most = round % 4 == 1 ? 64 : altered.size();
        altered[random() % most] = static_cast<std::byte>(random());
      }
    }
    for (std::size_t first = 0; first <= kAlteredChanges; ++first) {
      try {
        const auto world =
            bvh->Loaded(altered, random() % 2 == 0, MemoryFrom(guarded));
        if (first == kAlteredChanges) {
          AskAltered(*world, random);
          continue;
        }
        for (std::size_t step = 0; step < 4; ++step) {
          ChangeAltered(*world, step == 0 ? first : random() % kAlteredChanges,
                        step % 2 == 0 ? everything : Planes{}, random);
          ++changed;
        }
      } catch (const std::invalid_argument&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 0u);
  EXPECT_GT(changed, 0u);
  for (const auto& blob : blobs) {
    for (std::size_t size : {1u, 63u, 64u, 1000u}) {
      EXPECT_REFUSED((bvh->Loaded({blob.data(), size}, false, {})), "FromBlob",
                     "blob");
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

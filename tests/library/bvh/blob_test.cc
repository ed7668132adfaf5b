// A blob is the BVH that it was made of, or is refused, or is
// harmless.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <random>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/model.h"
#include "tests/library/bvh/old_format.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/guarded_memory.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class BvhBlobTest : public ::testing::Test {};
TYPED_TEST_SUITE(BvhBlobTest, FewBvhCases, CaseNames);

TYPED_TEST(BvhBlobTest, ABlobIsTheWorld) {
  using View = typename TypeParam::View;
  for (std::size_t size : {0u, 1u, 64u, 5000u}) {
    Spread<View> spread(2.0f);
    const World<View> world = spread.Objects(size);
    Model<View> model;
    for (std::uint32_t i = 0; i < size; ++i) model.objects[i] = {world.Get(i)};
    Bvh<View> bvh(world);
    if (size == 5000) {
      bvh.Erase(17);
      model.objects.erase(17);
      bvh.SetMasks(5, 4);
      model.objects[5].masks = 4;
    }
    const AlignedCopy blob(bvh.Blob());
    const AlignedCopy untouched(bvh.Blob());
    Bvh<View> copy = Bvh<View>::FromBlob(blob.bytes());
    Bvh<View> in_place = Bvh<View>::InPlace(blob.bytes());
    const auto queries = SomeQueries<View>(size);
    for (Target target : TargetsUnderTest()) {
      ExpectIsModel<View>(copy, model, queries, target, 4);
      ExpectIsModel<View>(in_place, model, queries, target);
    }
    // A change leaves the bytes alone.
    const auto bound = spread.NextObject();
    const std::uint32_t id = in_place.Insert(bound);
    EXPECT_EQ(id, size == 5000 ? 17 : size);
    model.objects[id] = {bound};
    ExpectIsModel<View>(in_place, model, queries, ChosenTarget());
    EXPECT_TRUE(std::equal(blob.bytes().begin(), blob.bytes().end(),
                           untouched.bytes().begin()));
    EXPECT_EQ(copy.Insert(bound), id);
    ExpectIsModel<View>(copy, model, queries, ChosenTarget());
  }
}

// A blob may leave the process, so nothing of what its memory held before does.
TYPED_TEST(BvhBlobTest, ABlobHasNothingElseInIt) {
  using View = typename TypeParam::View;
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
  Spread<View> spread(2.0f);
  const World<View> world = spread.Objects(4500);
  Bvh<View> a(world, {.memory = MemoryFrom(zeros)});
  Bvh<View> b(world, {.memory = MemoryFrom(ones)});
  for (int step = 0; step < 4; ++step) {
    const auto of_a = a.Blob();
    EXPECT_TRUE(std::equal(of_a.begin(), of_a.end(), b.Blob().begin())) << step;
    for (Bvh<View>* changed : {&a, &b}) {
      if (step == 0) changed->Erase(17);
      if (step == 1) changed->SetMasks(5, 4);
      if (step == 2) {
        for (std::uint32_t i = 0; i < 100; ++i) changed->Insert(world.Get(i));
      }
    }
  }
}

// Calls fn(View) for each kind of world.
template <typename Call>
void ForEachKind(const Call& call) {
  call(SimplexView3());
  call(AabbView3());
  call(AaboView3());
#if !defined(HALFSPACE_TEST_ONLY_3D)
  call(SimplexView2());
  call(AabbView2());
  call(AaboView2());
#endif
}

TYPED_TEST(BvhBlobTest, OfAnotherTypeIsRefused) {
  using View = typename TypeParam::View;
  const Bvh<View> bvh(Spread<View>(1.0f).Objects(100));
  ForEachKind([&](auto other) {
    using Other = decltype(other);
    if constexpr (!std::is_same_v<Other, View>) {
      EXPECT_TRUE(Refuses([&] { Bvh<Other>::FromBlob(bvh.Blob()); },
                          {"FromBlob", "blob", "dimensions", "axes"}));
      EXPECT_TRUE(Refuses([&] { Bvh<Other>::InPlace(bvh.Blob()); },
                          {"InPlace", "blob", "dimensions", "axes"}));
    }
  });
}

// A change of any one bit is seen, at once or by Verify().
TYPED_TEST(BvhBlobTest, VerifyFindsWhatWasAltered) {
  using View = typename TypeParam::View;
  using Bvh = Bvh<View>;
  Bvh bvh(Spread<View>(1.0f).Objects(200));
  EXPECT_TRUE(bvh.Verify());
  bvh.Erase(3);
  const AlignedCopy blob(bvh.Blob());
  EXPECT_TRUE(Bvh::FromBlob(blob.bytes()).Verify());
  EXPECT_TRUE(Bvh(Bvh::InPlace(blob.bytes())).Verify());
  Random random(1);
  for (std::size_t at = 0; at < blob.bytes().size();
       at += at < 64 ? 1 : 1 + random() % 64) {
    const std::byte was = blob.bytes()[at];
    blob.bytes()[at] ^= std::byte{1} << random() % 8;
    try {
      EXPECT_FALSE(Bvh::InPlace(blob.bytes()).Verify()) << at;
      EXPECT_FALSE(Bvh(Bvh::FromBlob(blob.bytes())).Verify()) << at;
    } catch (const std::invalid_argument&) {
      EXPECT_LT(at, blob.bytes().size());
    }
    blob.bytes()[at] = was;
  }
  // A change that is refused is none.
  blob.bytes()[blob.bytes().size() - 1] ^= std::byte{1};
  Bvh altered = Bvh::FromBlob(blob.bytes());
  EXPECT_EQ(altered.RebuildPartial(0), 0u);
  EXPECT_THROW(altered.Erase(3), std::invalid_argument);
  EXPECT_FALSE(altered.Verify());
  blob.bytes()[blob.bytes().size() - 1] ^= std::byte{1};
  // After a change there is another blob.
  Bvh changed = Bvh::InPlace(blob.bytes());
  changed.Erase(4);
  EXPECT_TRUE(changed.Verify());
  EXPECT_TRUE(Bvh::FromBlob(changed.Blob()).Verify());
  EXPECT_FALSE(std::equal(blob.bytes().begin(), blob.bytes().end(),
                          changed.Blob().begin()));
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
TYPED_TEST(BvhBlobTest, ACorruptOneIsRefusedOrHarmless) {
  using View = typename TypeParam::View;
  using Bvh = Bvh<View>;
  using Bound = typename View::Bound;
  const World<View> objects = Spread<View>(2.0f).Objects(700);
  const std::vector<Aabb<Bound::kDimensions, double>> of_doubles(700);
  const std::vector<std::uint32_t> masks(700, 3);
  const Bvh fresh(objects);
  Bvh bvh(fresh);
  for (std::uint32_t id = 0; id < 60; ++id) bvh.Erase(id);
  for (int i = 0; i < 80; ++i) bvh.Insert(Bound::Empty());
  bvh.Erase(5);
  Bvh with_masks(bvh);
  with_masks.SetMasks(6, 2);
  Bvh with_own_ids(bvh);
  with_own_ids.InsertAs(Ids{730, 2000, 6000}, std::vector<Bound>(3));
  const Bvh* const worlds[] = {&fresh, &bvh, &with_masks, &with_own_ids};
  std::vector<std::vector<std::byte>> blobs;
  for (const Bvh* world : worlds) {
    blobs.emplace_back(world->Blob().begin(), world->Blob().end());
    blobs.push_back(AsFormat4(world->Blob()));
    EXPECT_EQ(Bvh::FromBlob(blobs.back()).size(), world->size());
    blobs.push_back(AsFormat3<View>(world->Blob()));
    EXPECT_EQ(Bvh::FromBlob(blobs.back()).size(), world->size());
  }
  const auto queries = SomeQueries<View>(1);
  Random random(1);
  std::size_t refused = 0;
  std::size_t changed = 0;
  GuardedBlocks guarded;
  Ids free_ids(70);
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
    const auto load = [&] {
      return random() % 2 == 0 ? Bvh::InPlace(altered, MemoryFrom(guarded))
                               : Bvh::FromBlob(altered, MemoryFrom(guarded));
    };
    try {
      const Bvh world = load();
      (void)world.Verify();
      Ids ids(10);
      for (const auto& query : queries) {
        (void)Survivors(world, query, ids, {.mask = 3});
        (void)CountSurvivors(world, query);
      }
      std::array<std::uint32_t, 3> near{};
      (void)KNearest(world, {}, near, {});
      (void)CountSurvivors(world, Sphere<Bound::kDimensions>{{}, 9.0f});
      (void)CountSurvivors(world, Segment<Bound::kDimensions>{{}, {}});
      if constexpr (HasMaxima<View>) {
        (void)Pairs(world, {});
        (void)PairsOf(world, Span<const std::uint32_t>(near), {});
        (void)PairsOf(world, Span<const std::uint32_t>(near), world, {},
                      {.wanted = near});
      }
    } catch (const std::invalid_argument&) {
      ++refused;
    }
    for (std::size_t first = 0; first < 11; ++first) {
      try {
        Bvh world = load();
        for (std::size_t step = 0; step < 4; ++step) {
          const auto id = static_cast<std::uint32_t>(random() % 720);
          switch (step == 0 ? first : random() % 11) {
            case 0:
              world.Refit(objects);
              break;
            case 1:
              world.SetMasks(id, 1);
              break;
            case 2:
              world.SetMasks(masks);
              break;
            case 3:
              world.RebuildPartial(1000);
              break;
            case 4:
              world.Rebuild();
              break;
            case 5:
              world.Set(id, Bound::Everything());
              break;
            case 6:
              for (std::uint32_t i = 0; i < 720; ++i) {
                if (world.Has(i)) world.Erase(i);
              }
              break;
            case 7:
              world.RefitInOrder(World<View>(
                  std::vector<Bound>(world.ids().size(), Bound::Empty())));
              break;
            case 8:
              if constexpr (std::is_same_v<Bound, Aabb<Bound::kDimensions>>) {
                world.Refit(of_doubles);
              }
              break;
            case 9:
              for (std::size_t i = 0; i < free_ids.size(); ++i) {
                free_ids[i] = static_cast<std::uint32_t>(id + i * 97);
              }
              std::erase_if(free_ids,
                            [&](std::uint32_t i) { return world.Has(i); });
              world.InsertAs(free_ids, std::vector<Bound>(free_ids.size()));
              free_ids.resize(70);
              break;
            default:
              for (int i = 0; i < 300; ++i) world.Insert(Bound::Everything());
          }
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
      EXPECT_TRUE(Refuses(
          [&] {
            Bvh::FromBlob({blob.data(), size});
          },
          {"FromBlob", "blob"}));
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

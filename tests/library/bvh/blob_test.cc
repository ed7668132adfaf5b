// A blob has what its BVH has and nothing else. An altered one is refused or
// harmless. Histories go on with blobs. The files in data/ are blobs of the
// format; a file is never changed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <new>
#include <ostream>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/altered.h"
#include "tests/library/bvh/answers.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/guarded_memory.h"

namespace halfspace::testing {
namespace {

class BvhBlobTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, BvhBlobTest, ::testing::ValuesIn(LayoutsOf(false)),
                         LayoutName());

std::vector<std::byte> BytesOf(const AnyBvh& bvh) {
  const auto blob = bvh.Blob();
  return {blob.begin(), blob.end()};
}

// A blob may leave the process, so nothing of what its memory held before does.
TEST_P(BvhBlobTest, ABlobHasNothingElseInIt) {
  CountingMemory zeros;
  CountingMemory ones;
  ones.fill = 255;
  Spheres spheres(GetParam(), 2);
  const std::vector<Planes> bounds = spheres.Some(4500);
  const auto a = MakeBvh(GetParam(), bounds, {.memory = zeros.resource()});
  const auto b = MakeBvh(GetParam(), bounds, {.memory = ones.resource()});
  for (int step = 0; step < 4; ++step) {
    EXPECT_EQ(BytesOf(*a), BytesOf(*b)) << step;
    for (AnyBvh* changed : {a.get(), b.get()}) {
      if (step == 0) changed->Erase(17);
      if (step == 1) changed->SetMasks(5, 4);
      for (std::size_t i = 0; step == 2 && i < 100; ++i) {
        changed->Insert(bounds[i]);
      }
    }
  }
}

constexpr std::uint32_t kFormat = 5;

// Where a header has its version and its checksum.
constexpr std::size_t kVersionAt = 8;
constexpr std::size_t kChecksumAt = 24;

template <typename T>
T ReadAt(Span<const std::byte> blob, std::size_t at) {
  T value;
  std::memcpy(&value, blob.data() + at, sizeof(value));
  return value;
}
std::uint32_t FormatOf(Span<const std::byte> blob) {
  return ReadAt<std::uint32_t>(blob, kVersionAt);
}
template <typename T>
void WriteAt(std::span<std::byte> blob, std::size_t at, T value) {
  std::memcpy(blob.data() + at, &value, sizeof(value));
}

// A formula in integers, so that all machines make the same objects.
Planes Object(const Layout& layout, std::uint32_t id) {
  Planes planes{};
  for (std::uint32_t p = 0; p < layout.plane_count; ++p) {
    const std::uint32_t k = p % layout.axes;
    planes[p] = static_cast<float>((id * 37 + k * 29) % 101) - 50;
    if (!IsMin(layout, p)) planes[p] += static_cast<float>(id % 7);
  }
  return planes;
}
bool IsErased(std::uint32_t id) { return id % 7 == 3; }
std::uint32_t MasksOf(std::uint32_t id) {
  return id % 5 == 0 ? 1u << id % 8 : 0xFFFFFFFF;
}

// A file of data/.
struct Stored {
  const char* name;
  Layout layout;
  std::uint32_t objects;
  bool is_erased;
  bool has_masks;
};
void PrintTo(const Stored& stored, std::ostream* out) { *out << stored.name; }
constexpr Stored kStored[] = {
    // Built, without slots by id, erased objects and masks.
    {"boxes", Layout(3, 3, true), 100, false, false},
    // With all of these.
    {"octahedra", Layout(3, 4, true), 100, true, true},
    // One block, which has no codes in any format.
    {"simplices", Layout(3, 4, false), 40, true, false},
};

std::unique_ptr<AnyBvh> Make(const Stored& stored) {
  std::vector<Planes> bounds;
  for (std::uint32_t id = 0; id < stored.objects; ++id) {
    bounds.push_back(Object(stored.layout, id));
  }
  if (!stored.is_erased) return MakeBvh(stored.layout, bounds);
  // Objects in the order of their ids, which no sort has changed.
  auto bvh = MakeBvh(stored.layout, std::vector<Planes>());
  bvh->Reserve(stored.objects);
  for (const Planes& bound : bounds) bvh->Insert(bound);
  for (std::uint32_t id = 0; id < stored.objects; ++id) {
    if (IsErased(id)) bvh->Erase(id);
  }
  for (std::uint32_t id = 0; stored.has_masks && id < stored.objects; ++id) {
    if (!IsErased(id)) bvh->SetMasks(id, MasksOf(id));
  }
  return bvh;
}

Objects ModelOf(const Stored& stored) {
  Objects model;
  for (std::uint32_t id = 0; id < stored.objects; ++id) {
    if (stored.is_erased && IsErased(id)) continue;
    model[id] = {Object(stored.layout, id)};
    if (stored.has_masks) model[id].masks = MasksOf(id);
  }
  return model;
}

std::vector<std::byte> FileOf(const Stored& stored) {
  const std::string path = std::string(HALFSPACE_TEST_DATA "/") + stored.name +
                           "." + std::to_string(kFormat) + ".bvh";
  std::ifstream file(path, std::ios::binary);
  std::vector<std::byte> bytes;
  for (char c; file.get(c);) bytes.push_back(static_cast<std::byte>(c));
  EXPECT_FALSE(bytes.empty()) << path;
  return bytes;
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
  const BoundList objects = spheres.Some(700);
  const Planes everything = EverythingOf(layout);
  const auto fresh = MakeBvh(layout, objects);
  const auto bvh = fresh->Copy();
  for (std::uint32_t id = 0; id < 60; ++id) bvh->Erase(id);
  for (int i = 0; i < 80; ++i) bvh->Insert(EmptyOf(layout));
  bvh->Erase(5);
  const auto with_masks = bvh->Copy();
  with_masks->SetMasks(6, 2);
  const auto with_own_ids = bvh->Copy();
  with_own_ids->InsertAs(Ids{730, 2000, 6000},
                         BoundList(std::vector<Planes>(3, everything)));
  const auto with_codes = bvh->Copy();
  with_codes->Reserve(4097);
  std::vector<std::vector<std::byte>> blobs;
  for (const AnyBvh* world : {fresh.get(), bvh.get(), with_masks.get(),
                              with_own_ids.get(), with_codes.get()}) {
    blobs.push_back(BytesOf(*world));
  }
  for (const Stored& stored : kStored) {
    if (stored.layout == layout) blobs.push_back(FileOf(stored));
  }
  Random random(1);
  std::size_t refused = 0;
  GuardedBlocks guarded;
  const std::size_t rounds = std::max<std::size_t>(Scaled(1000), 100);
  for (std::size_t round = 0; round < rounds; ++round) {
    const std::vector<std::byte>& blob = blobs[random() % blobs.size()];
    const GuardedMemory memory(blob.size());
    const auto altered =
        memory.Get<std::byte>(blob.size(), GuardedSide::kAfter);
    std::copy(blob.begin(), blob.end(), altered.begin());
    // Numbers of the header, any bytes of it, any bytes, and parts.
    for (std::size_t c = 1 + random() % (round % 2 == 0 ? 2 : 40); c-- > 0;) {
      if (round % 8 > 5) {
        AlterPart(layout, altered, random);
      } else if (round % 4 == 0) {
        const auto value = static_cast<std::uint32_t>(random() % 1100);
        std::memcpy(&altered[32 + random() % 8 * 4], &value, sizeof(value));
      } else {
        const std::size_t most = round % 4 == 1 ? 64 : altered.size();
        altered[random() % most] = static_cast<std::byte>(random());
      }
    }
    refused += UseAltered(layout, altered, MemoryFrom(guarded), random);
  }
  EXPECT_GT(refused, 0u);
  EXPECT_LT(refused, rounds * (kAlteredChanges + 1));
}

// Has() would find an object there, and Erase() would count one too few. Then
// insertions would find room behind the end of the memory.
TEST_P(BvhBlobTest, AnIdInAnEmptySlotIsSeen) {
  const auto bvh = MakeBvh(GetParam(), Spheres(GetParam(), 2).Some(100));
  bvh->Erase(7);
  const AlignedCopy blob(bvh->Blob());
  const auto in_place = LoadBvh(GetParam(), blob.bytes(), true);
  const detail::BvhLevels& levels = in_place->levels();
  std::uint32_t slot = 0;
  while (levels.ids[slot] != detail::kNoId) ++slot;
  levels.ids[slot] = 7;
  levels.slots[7] = slot;
  EXPECT_REFUSED(in_place->Erase(7), "Erase", "blob", "empty slots", "altered");
}

// The bytes of a world are those that its format has had from its beginning.
void ExpectIsOfFormat(const Stored& stored, const AnyBvh& bvh) {
  const AlignedCopy file(FileOf(stored));
  const auto blob = bvh.Blob();
  if (std::ranges::equal(blob, file.bytes())) return;
  const std::string today = ::testing::TempDir() + stored.name + ".bvh";
  std::ofstream(today, std::ios::binary)
      .write(reinterpret_cast<const char*>(blob.data()),
             static_cast<std::streamsize>(blob.size()));
  ADD_FAILURE() << "The bytes of a stored BVH have changed, so they are a new "
                   "format. Raise kBvhVersion in dispatch/bvh/layout.h and "
                   "kFormat here, and add "
                << today << " to tests/library/bvh/data.";
}

// Compares a world with its model, changes both, and compares again.
void ExpectIsModelAfterChanges(AnyBvh& world, Objects model) {
  const Layout& layout = world.layout;
  Random random(1);
  const auto expect = [&] {
    const std::vector<Target> targets = TargetsUnderTest();
    ExpectIsModel(world, model, {.targets = targets}, random);
    ExpectAnswers(world, model, {.targets = targets, .mask = 4}, random);
  };
  EXPECT_TRUE(world.Verify());
  expect();
  const auto set = [&](std::uint32_t id, std::uint32_t object) {
    world.Set(id, Object(layout, object));
    model[id].bound = Object(layout, object);
  };
  set(0, 50);
  EXPECT_EQ(FormatOf(world.Blob()), kFormat);
  for (std::uint32_t i = 1000; i < 1100; ++i) {
    const Planes bound = Object(layout, i);
    model[world.Insert(bound)] = {bound};
  }
  for (std::uint32_t id = 0; id < 100; id += 9) {
    if (model.contains(id)) set(id, id + 1);
  }
  world.Erase(1);
  model.erase(1);
  world.SetMasks(2, 3);
  model[2].masks = 3;
  for (bool is_rebuilt : {false, true}) {
    if (is_rebuilt) world.Rebuild({});
    expect();
    EXPECT_EQ(FormatOf(world.Blob()), kFormat);
    EXPECT_TRUE(LoadBvh(layout, world.Blob(), false)->Verify());
  }
}

class BvhFormatTest : public ::testing::TestWithParam<Stored> {};
INSTANTIATE_TEST_SUITE_P(Of, BvhFormatTest, ::testing::ValuesIn(kStored),
                         [](const auto& one) {
                           return std::string(one.param.name);
                         });

TEST_P(BvhFormatTest, AFileIsRead) {
  const Stored& stored = GetParam();
  const AlignedCopy file(FileOf(stored));
  ASSERT_EQ(FormatOf(file.bytes()), kFormat);
  const AlignedCopy untouched(file.bytes());
  const auto copy = LoadBvh(stored.layout, file.bytes(), false);
  const auto in_place = LoadBvh(stored.layout, file.bytes(), true);
  EXPECT_EQ(in_place->Blob().data(), file.bytes().data());
  EXPECT_TRUE(LoadBvh(stored.layout, in_place->Blob(), true)->Verify());
  const auto cleared = copy->Copy();
  cleared->Clear();
  EXPECT_EQ(FormatOf(cleared->Blob()), kFormat);
  ExpectIsModelAfterChanges(*copy, ModelOf(stored));
  ExpectIsModelAfterChanges(*in_place, ModelOf(stored));
  EXPECT_TRUE(std::ranges::equal(file.bytes(), untouched.bytes()));
}

TEST_P(BvhFormatTest, TodaysBytesAreOfTheFormat) {
  const Stored& stored = GetParam();
  if (stored.is_erased) ExpectIsOfFormat(stored, *Make(stored));
  // The order of a build may change without a new format, so it is the file's.
  const AlignedCopy file(FileOf(stored));
  const auto refitted = LoadBvh(stored.layout, file.bytes(), false);
  BoundList in_order;
  for (std::uint32_t id : refitted->ids()) {
    in_order.floats.push_back(id < stored.objects ? Object(stored.layout, id)
                                                  : EmptyOf(stored.layout));
  }
  refitted->Refit(in_order, false, {});
  ExpectIsOfFormat(stored, *refitted);
  EXPECT_EQ(Make(stored)->Blob().size(), file.bytes().size());
}

TEST_P(BvhFormatTest, AnAlteredFileIsSeen) {
  const Layout& layout = GetParam().layout;
  Random random(1);
  const AlignedCopy file(FileOf(GetParam()));
  const auto bytes = file.bytes();
  for (std::size_t at = 0; at < bytes.size();
       at += at < 64 ? 1 : 1 + random() % 32) {
    const std::byte was = bytes[at];
    bytes[at] ^= std::byte{1} << random() % 8;
    try {
      for (bool is_in_place : {true, false}) {
        const auto bvh = LoadBvh(layout, bytes, is_in_place);
        // The blob stays what it was made of: this change is refused.
        EXPECT_THROW(bvh->Erase(0xFFFFFFFE), std::invalid_argument);
        EXPECT_FALSE(bvh->Verify()) << at;
        EXPECT_FALSE(bvh->Copy()->Verify()) << at;
      }
    } catch (const std::invalid_argument&) {
      // Refused.
    }
    bytes[at] = was;
  }
  for (std::size_t less : {std::size_t{1}, std::size_t{64}, bytes.size() - 64,
                           bytes.size() - 63, bytes.size() - 1}) {
    const auto cut = bytes.first(bytes.size() - less);
    EXPECT_REFUSED((LoadBvh(layout, cut, true)), "InPlace", "blob");
    EXPECT_REFUSED((LoadBvh(layout, cut, false)), "FromBlob", "blob");
  }
}

TEST_P(BvhFormatTest, OtherFormatsAreRefused) {
  struct Other {
    std::uint32_t version;
    std::string given;
  };
  const std::string expected = "format " + std::to_string(kFormat);
  for (const Other& other :
       {Other{0, "format 0, which is older"},
        Other{kFormat - 1, "format 4, which is older"},
        Other{kFormat + 1, "format 6, which is newer"},
        Other{0x00FFFFFF, "format 16777215, which is newer"},
        Other{kFormat << 24, "the other byte order"}}) {
    const AlignedCopy file(FileOf(GetParam()));
    WriteAt(file.bytes(), kVersionAt, other.version);
    for (bool is_in_place : {false, true}) {
      EXPECT_REFUSED((LoadBvh(GetParam().layout, file.bytes(), is_in_place)),
                     is_in_place ? "InPlace" : "FromBlob", "blob", expected,
                     other.given);
    }
  }
}

// With room for more than 4096 objects there are codes. A file would be large,
// so its checksum stands for it, as the first library of the format computed
// it.
TEST(BvhFormatCodesTest, BytesAreOfTheFormat) {
  constexpr Layout kLayout(3, 3, true);
  const auto bvh = MakeBvh(kLayout, std::vector<Planes>());
  bvh->Reserve(4097);
  Objects model;
  for (std::uint32_t id = 0; id < 100; ++id) {
    bvh->Insert(Object(kLayout, id));
    model[id] = {Object(kLayout, id)};
  }
  const AlignedCopy blob(bvh->Blob());
  EXPECT_EQ(ReadAt<std::uint64_t>(blob.bytes(), kChecksumAt),
            0xE90CDA633B527BB5)
      << "The bytes of a stored BVH have changed, so they are a new format. "
         "Raise kBvhVersion and kFormat, and change this checksum.";
  ExpectIsModelAfterChanges(*LoadBvh(kLayout, blob.bytes(), false), model);
  ExpectIsModelAfterChanges(*LoadBvh(kLayout, blob.bytes(), true), model);
}

}  // namespace
}  // namespace halfspace::testing

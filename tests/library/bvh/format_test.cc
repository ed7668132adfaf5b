// Stored BVHs of every format that can be read: the files in data/. A file is
// never changed. A new format adds files.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <ostream>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/answers.h"
#include "tests/library/bvh/old_format.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

constexpr std::uint32_t kOldest = 3;
constexpr std::uint32_t kNewest = 5;

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
Planes Object(const Layout& layout, std::uint32_t i, std::uint32_t size,
              bool is_query = false) {
  Planes planes{};
  for (std::uint32_t p = 0; p < layout.plane_count; ++p) {
    const std::uint32_t k = p % layout.axes;
    planes[p] = static_cast<float>((i * 37 + k * 29) % 101) - 50;
    if (IsMin(layout, p) == is_query) planes[p] += static_cast<float>(size);
  }
  return planes;
}
BoundList OneObject(const Layout& layout, std::uint32_t id) {
  return {{Object(layout, id, id % 7)}, {}};
}
bool IsErased(std::uint32_t id) { return id % 7 == 3; }
std::uint32_t MasksOf(std::uint32_t id) {
  return id % 5 == 0 ? 1u << id % 8 : 0xFFFFFFFF;
}

// A file of data/ for each format.
struct Stored {
  const char* name;
  Layout layout;
  std::uint32_t first_of_layout;  // the first format with today's layout
  std::uint32_t objects;
  bool is_erased;
  bool has_masks;
};
void PrintTo(const Stored& stored, std::ostream* out) { *out << stored.name; }
constexpr Stored kStored[] = {
    // Built, without slots by id, erased objects and masks.
    {"boxes", Layout(3, 3, true), 4, 100, false, false},
    // With all of these.
    {"octahedra", Layout(3, 4, true), 5, 100, true, true},
    // One block, which has no codes in any format.
    {"simplices", Layout(3, 4, false), 5, 40, true, false},
};

std::unique_ptr<AnyBvh> Make(const Stored& stored) {
  std::vector<Planes> bounds;
  for (std::uint32_t id = 0; id < stored.objects; ++id) {
    bounds.push_back(OneObject(stored.layout, id).floats[0]);
  }
  if (!stored.is_erased) return MakeBvh(stored.layout, bounds);
  // Objects in the order of their ids, which no sort has changed.
  auto bvh = MakeBvh(stored.layout, std::vector<Planes>());
  bvh->Reserve(stored.objects);
  for (const Planes& bound : bounds) bvh->InsertOne({{bound}, {}});
  for (std::uint32_t id = 0; id < stored.objects; ++id) {
    if (IsErased(id)) bvh->EraseOne(id);
  }
  for (std::uint32_t id = 0; stored.has_masks && id < stored.objects; ++id) {
    if (!IsErased(id)) bvh->SetMask(id, MasksOf(id));
  }
  return bvh;
}

Objects ModelOf(const Stored& stored) {
  Objects model;
  for (std::uint32_t id = 0; id < stored.objects; ++id) {
    if (stored.is_erased && IsErased(id)) continue;
    model[id] = {OneObject(stored.layout, id).floats[0]};
    if (stored.has_masks) model[id].masks = MasksOf(id);
  }
  return model;
}

std::unique_ptr<AnyBvh> Loaded(const Layout& layout, Span<const std::byte> blob,
                               bool is_in_place) {
  return MakeBvh(layout, std::vector<Planes>())->Loaded(blob, is_in_place, {});
}

AlignedCopy File(const Stored& stored, std::uint32_t format) {
  const std::string path = std::string(HALFSPACE_TEST_DATA "/") + stored.name +
                           "." + std::to_string(format) + ".bvh";
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_FALSE(bytes.empty()) << path;
  return AlignedCopy(
      {reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()});
}

// The bytes of a world are those that its format has had from its beginning.
void ExpectIsNewest(const Stored& stored, const AnyBvh& bvh) {
  const AlignedCopy file = File(stored, kNewest);
  const auto blob = bvh.tree().Blob();
  if (std::ranges::equal(blob, file.bytes())) return;
  const std::string today = ::testing::TempDir() + stored.name + ".bvh";
  std::ofstream(today, std::ios::binary)
      .write(reinterpret_cast<const char*>(blob.data()),
             static_cast<std::streamsize>(blob.size()));
  ADD_FAILURE() << "The bytes of a stored BVH have changed, so they are a new "
                   "format. Raise kBvhVersion in dispatch/bvh/layout.h and "
                   "kNewest here, let blob.cc read format "
                << kNewest << ", and add " << today
                << " to tests/library/bvh/data as a file of the new format. "
                   "The old files stay.";
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
  EXPECT_TRUE(world.tree().Verify());
  expect();
  const auto set = [&](std::uint32_t id, std::uint32_t object) {
    world.SetOne(id, OneObject(layout, object));
    model[id].bound = OneObject(layout, object).floats[0];
  };
  set(0, 50);
  EXPECT_EQ(FormatOf(world.tree().Blob()), kNewest);
  for (std::uint32_t i = 1000; i < 1100; ++i) {
    const BoundList bound = OneObject(layout, i);
    model[world.InsertOne(bound)] = {bound.floats[0]};
  }
  for (std::uint32_t id = 0; id < 100; id += 9) {
    if (model.contains(id)) set(id, id + 1);
  }
  world.EraseOne(1);
  model.erase(1);
  world.SetMask(2, 3);
  model[2].masks = 3;
  for (bool is_rebuilt : {false, true}) {
    if (is_rebuilt) world.Rebuild({});
    expect();
    EXPECT_EQ(FormatOf(world.tree().Blob()), kNewest);
    EXPECT_TRUE(Loaded(layout, world.tree().Blob(), false)->tree().Verify());
  }
}

class BvhFormatTest : public ::testing::TestWithParam<Stored> {};
INSTANTIATE_TEST_SUITE_P(Of, BvhFormatTest, ::testing::ValuesIn(kStored),
                         [](const auto& one) {
                           return std::string(one.param.name);
                         });

// Some builds of format 3 stored no codes for up to 4096 objects, as format 4.
TEST_P(BvhFormatTest, EveryFormatIsRead) {
  const Stored& stored = GetParam();
  for (std::uint32_t format = kOldest; format <= kNewest + 1; ++format) {
    SCOPED_TRACE(format);
    const bool is_mixed = format > kNewest;
    const AlignedCopy file = File(stored, is_mixed ? 4 : format);
    ASSERT_EQ(FormatOf(file.bytes()), is_mixed ? 4 : format);
    if (is_mixed) WriteAt(file.bytes(), kVersionAt, std::uint32_t{3});
    const AlignedCopy untouched(file.bytes());
    const auto copy = Loaded(stored.layout, file.bytes(), false);
    const auto in_place = Loaded(stored.layout, file.bytes(), true);
    const bool has_todays_layout =
        (is_mixed ? 4 : format) >= stored.first_of_layout;
    EXPECT_EQ(in_place->tree().Blob().data() == file.bytes().data(),
              has_todays_layout);
    if (is_mixed) {
      Random random(2);
      ExpectIsModel(*in_place, ModelOf(stored), {}, random);
      continue;
    }
    EXPECT_EQ(FormatOf(copy->tree().Blob()),
              has_todays_layout ? format : kNewest);
    EXPECT_TRUE(
        Loaded(stored.layout, in_place->tree().Blob(), true)->tree().Verify());
    const auto cleared = copy->Copy();
    cleared->Clear();
    EXPECT_EQ(FormatOf(cleared->tree().Blob()), kNewest);
    ExpectIsModelAfterChanges(*copy, ModelOf(stored));
    ExpectIsModelAfterChanges(*in_place, ModelOf(stored));
    EXPECT_TRUE(std::ranges::equal(file.bytes(), untouched.bytes()));
  }
}

TEST_P(BvhFormatTest, TodaysBytesAreTheNewestFormat) {
  const Stored& stored = GetParam();
  if (stored.is_erased) ExpectIsNewest(stored, *Make(stored));
  // The order of a build may change without a new format, so it is the file's.
  const AlignedCopy file = File(stored, kNewest);
  const auto refitted = Loaded(stored.layout, file.bytes(), false);
  BoundList in_order;
  for (std::uint32_t id : refitted->tree().ids()) {
    in_order.floats.push_back(id < stored.objects
                                  ? OneObject(stored.layout, id).floats[0]
                                  : EmptyOf(stored.layout));
  }
  refitted->RefitInOrder(in_order, {});
  ExpectIsNewest(stored, *refitted);
  EXPECT_EQ(Make(stored)->tree().Blob().size(), file.bytes().size());
}

TEST_P(BvhFormatTest, AnAlteredFileIsSeen) {
  const Layout& layout = GetParam().layout;
  Random random(1);
  for (std::uint32_t format = kOldest; format <= kNewest; ++format) {
    SCOPED_TRACE(format);
    const AlignedCopy file = File(GetParam(), format);
    const auto bytes = file.bytes();
    for (std::size_t at = 0; at < bytes.size();
         at += at < 64 ? 1 : 1 + random() % 32) {
      const std::byte was = bytes[at];
      bytes[at] ^= std::byte{1} << random() % 8;
      try {
        for (bool is_in_place : {true, false}) {
          const auto bvh = Loaded(layout, bytes, is_in_place);
          EXPECT_FALSE(bvh->tree().Verify()) << at;
          EXPECT_FALSE(bvh->Copy()->tree().Verify()) << at;
        }
      } catch (const std::invalid_argument&) {
        // Refused.
      }
      bytes[at] = was;
    }
    for (std::size_t less : {std::size_t{1}, std::size_t{64}, bytes.size() - 64,
                             bytes.size() - 63, bytes.size() - 1}) {
      const auto cut = bytes.first(bytes.size() - less);
      EXPECT_REFUSED((Loaded(layout, cut, true)), "InPlace", "blob");
      EXPECT_REFUSED((Loaded(layout, cut, false)), "FromBlob", "blob");
    }
  }
}

TEST_P(BvhFormatTest, OtherFormatsAreRefused) {
  struct Other {
    std::uint32_t version;
    std::string given;
  };
  const std::string expected = "a format from " + std::to_string(kOldest) +
                               " to " + std::to_string(kNewest);
  for (const Other& other :
       {Other{0, "format 0, which is older"},
        Other{kOldest - 1, "format 2, which is older"},
        Other{kNewest + 1, "format 6, which is newer"},
        Other{0x00FFFFFF, "format 16777215, which is newer"},
        Other{kNewest << 24, "the other byte order"}}) {
    const AlignedCopy file = File(GetParam(), kNewest);
    WriteAt(file.bytes(), kVersionAt, other.version);
    for (bool is_in_place : {false, true}) {
      EXPECT_REFUSED((Loaded(GetParam().layout, file.bytes(), is_in_place)),
                     is_in_place ? "InPlace" : "FromBlob", "blob", expected,
                     other.given);
    }
  }
}

// With room for more than 4096 objects there are codes, in all formats. A file
// would be large, so its checksum stands for it, as the first library of each
// format computed it.
TEST(BvhFormatCodesTest, EveryFormatIsRead) {
  constexpr Layout kLayout(3, 3, true);
  constexpr std::uint64_t kChecksums[] = {
      0x3B706554BCC557E5, 0x04D738325CE7C6FA, 0xE90CDA633B527BB5};
  const auto bvh = MakeBvh(kLayout, std::vector<Planes>());
  bvh->Reserve(4097);
  Objects model;
  for (std::uint32_t id = 0; id < 100; ++id) {
    bvh->InsertOne(OneObject(kLayout, id));
    model[id] = {OneObject(kLayout, id).floats[0]};
  }
  const auto newest = bvh->tree().Blob();
  EXPECT_EQ(ReadAt<std::uint64_t>(newest, kChecksumAt),
            kChecksums[kNewest - kOldest])
      << "The bytes of a stored BVH have changed, so they are a new format. "
         "Raise kBvhVersion and kNewest, and add this checksum: see "
         "ExpectIsNewest().";
  const std::vector<std::byte> format4 = AsFormat4(newest);
  for (std::uint32_t format = kOldest; format <= kNewest; ++format) {
    SCOPED_TRACE(format);
    const bool is_newest = format == kNewest;
    const AlignedCopy blob(is_newest ? newest : format4);
    WriteAt(blob.bytes(), kVersionAt, format);
    WriteAt(blob.bytes(), kChecksumAt, kChecksums[format - kOldest]);
    const auto copy = Loaded(kLayout, blob.bytes(), false);
    const auto in_place = Loaded(kLayout, blob.bytes(), true);
    EXPECT_EQ(in_place->tree().Blob().data() == blob.bytes().data(), is_newest);
    ExpectIsModelAfterChanges(*copy, model);
    ExpectIsModelAfterChanges(*in_place, model);
  }
}

// A group of 4096 slots had one cost in format 4.
TEST(BvhFormatCostsTest, CostsOfFormat4AreDivided) {
  for (std::size_t size : {std::size_t{3000}, std::size_t{9000}}) {
    SCOPED_TRACE(size);
    Spread<AabbView3> spread(0.2f);
    AabbBvh3 bvh(spread.Objects(size));
    const AabbBvh3 sorted = AabbBvh3::FromBlob(AsFormat4(bvh.Blob()));
    EXPECT_NEAR(sorted.CostRatio(), 1.0, 1e-12);
    bvh.Refit(spread.Objects(size).view());
    const double ratio = bvh.CostRatio();
    EXPECT_GT(ratio, 2.0);
    AabbBvh3 moved =
        AabbBvh3::InPlace(AlignedCopy(AsFormat4(bvh.Blob())).bytes());
    EXPECT_NEAR(moved.CostRatio(), ratio, 1e-6 * ratio);
    EXPECT_EQ(moved.RebuildPartial(size + 1023), size);
    EXPECT_LT(moved.CostRatio(), 1.2);
  }
}

}  // namespace
}  // namespace halfspace::testing

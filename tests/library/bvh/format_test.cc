// Stored BVHs of every format that can be read: the files in data/. A file is
// never changed. A new format adds files.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/bvh/model.h"
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
Aabo3 Octahedron(std::uint32_t i, std::uint32_t size) {
  Aabo3 bound{};
  for (std::uint32_t k = 0; k < Aabo3::kAxes; ++k) {
    bound.min[k] = static_cast<float>((i * 37 + k * 29) % 101) - 50;
    bound.max[k] = bound.min[k] + static_cast<float>(size);
  }
  return bound;
}
template <typename View>
typename View::Bound Object(std::uint32_t id) {
  return ObjectOf<View>(Octahedron(id, id % 7));
}
bool IsErased(std::uint32_t id) { return id % 7 == 3; }
std::uint32_t MasksOf(std::uint32_t id) {
  return id % 5 == 0 ? 1u << id % 8 : 0xFFFFFFFF;
}

template <typename View>
std::vector<typename View::Query> Queries() {
  std::vector<typename View::Query> queries = {View::Query::Everything()};
  for (std::uint32_t q = 0; q < 20; ++q) {
    queries.push_back(QueryOf<View>(Octahedron(q * 7, 20 + q * 3)));
  }
  return queries;
}

// Objects in the order of their ids, which no sort has changed.
template <typename View>
Bvh<View> Inserted(std::uint32_t objects, std::uint32_t room) {
  Bvh<View> bvh;
  bvh.Reserve(room);
  for (std::uint32_t id = 0; id < objects; ++id) bvh.Insert(Object<View>(id));
  return bvh;
}
template <typename View>
Bvh<View> InsertedAndErased(std::uint32_t objects) {
  Bvh<View> bvh = Inserted<View>(objects, objects);
  for (std::uint32_t id = 0; id < objects; ++id) {
    if (IsErased(id)) bvh.Erase(id);
  }
  return bvh;
}

// Without places by id, erased objects and masks.
struct BuiltBoxes {
  using View = AabbView3;
  static constexpr const char* kName = "boxes";
  static constexpr std::uint32_t kFirstOfLayout = 4;
  static constexpr std::uint32_t kObjects = 100;
  static constexpr bool kIsErased = false;
  static constexpr bool kHasMasks = false;
  static Bvh<View> Make() {
    World<View> world;
    for (std::uint32_t id = 0; id < kObjects; ++id) {
      world.Push(Object<View>(id));
    }
    return Bvh<View>(world);
  }
};
// With all of these.
struct ChangedOctahedra {
  using View = AaboView3;
  static constexpr const char* kName = "octahedra";
  static constexpr std::uint32_t kFirstOfLayout = 5;
  static constexpr std::uint32_t kObjects = 100;
  static constexpr bool kIsErased = true;
  static constexpr bool kHasMasks = true;
  static Bvh<View> Make() {
    auto bvh = InsertedAndErased<View>(kObjects);
    for (std::uint32_t id = 0; id < kObjects; ++id) {
      if (bvh.Has(id)) bvh.SetMasks(id, MasksOf(id));
    }
    return bvh;
  }
};
// One block, which has no codes in any format.
struct FewSimplices {
  using View = SimplexView3;
  static constexpr const char* kName = "simplices";
  static constexpr std::uint32_t kFirstOfLayout = 5;
  static constexpr std::uint32_t kObjects = 40;
  static constexpr bool kIsErased = true;
  static constexpr bool kHasMasks = false;
  static Bvh<View> Make() { return InsertedAndErased<View>(kObjects); }
};

template <typename Case>
Model<typename Case::View> ModelOf() {
  Model<typename Case::View> model;
  for (std::uint32_t id = 0; id < Case::kObjects; ++id) {
    if (Case::kIsErased && IsErased(id)) continue;
    model.objects[id] = {Object<typename Case::View>(id)};
    if (Case::kHasMasks) model.objects[id].masks = MasksOf(id);
  }
  return model;
}

template <typename Case>
AlignedCopy File(std::uint32_t format) {
  const std::string path = std::string(HALFSPACE_TEST_DATA "/") + Case::kName +
                           "." + std::to_string(format) + ".bvh";
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_FALSE(bytes.empty()) << path;
  return AlignedCopy(
      {reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()});
}

// The bytes of a world are those that its format has had from its beginning.
template <typename Case>
void ExpectIsNewest(const Bvh<typename Case::View>& bvh) {
  const AlignedCopy file = File<Case>(kNewest);
  const auto blob = bvh.Blob();
  if (std::equal(blob.begin(), blob.end(), file.bytes().begin(),
                 file.bytes().end())) {
    return;
  }
  const std::string today = ::testing::TempDir() + Case::kName + ".bvh";
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

template <typename Case>
class BvhFormatTest : public ::testing::Test {};
using StoredCases =
    ::testing::Types<BuiltBoxes, ChangedOctahedra, FewSimplices>;
TYPED_TEST_SUITE(BvhFormatTest, StoredCases);

// Compares a world with its model, changes both, and compares again.
template <typename View>
void ExpectIsModelAfterChanges(Bvh<View>& world, Model<View> model) {
  const auto queries = Queries<View>();
  EXPECT_TRUE(world.Verify());
  for (Target target : TargetsUnderTest()) {
    ExpectIsModel<View>(world, model, queries, target);
    ExpectIsModel<View>(world, model, queries, target, 4);
  }
  world.Set(0, Object<View>(50));
  model.objects[0].bound = Object<View>(50);
  EXPECT_EQ(FormatOf(world.Blob()), kNewest);
  for (std::uint32_t i = 1000; i < 1100; ++i) {
    const auto bound = Object<View>(i);
    model.objects[world.Insert(bound)] = {bound};
  }
  for (std::uint32_t id = 0; id < 100; id += 9) {
    if (!world.Has(id)) continue;
    world.Set(id, Object<View>(id + 1));
    model.objects[id].bound = Object<View>(id + 1);
  }
  world.Erase(1);
  model.objects.erase(1);
  world.SetMasks(2, 3);
  model.objects[2].masks = 3;
  for (bool is_rebuilt : {false, true}) {
    if (is_rebuilt) world.Rebuild();
    ExpectIsModel<View>(world, model, queries, ChosenTarget());
    ExpectIsModel<View>(world, model, queries, ChosenTarget(), 4);
    EXPECT_EQ(FormatOf(world.Blob()), kNewest);
    EXPECT_TRUE(Bvh<View>::FromBlob(world.Blob()).Verify());
  }
}

TYPED_TEST(BvhFormatTest, EveryFormatIsRead) {
  using View = typename TypeParam::View;
  for (std::uint32_t format = kOldest; format <= kNewest; ++format) {
    SCOPED_TRACE(format);
    const AlignedCopy file = File<TypeParam>(format);
    ASSERT_EQ(FormatOf(file.bytes()), format);
    const AlignedCopy untouched(file.bytes());
    Bvh<View> copy = Bvh<View>::FromBlob(file.bytes());
    Bvh<View> in_place = Bvh<View>::InPlace(file.bytes());
    const bool has_todays_layout = format >= TypeParam::kFirstOfLayout;
    EXPECT_EQ(in_place.Blob().data() == file.bytes().data(), has_todays_layout);
    EXPECT_EQ(FormatOf(copy.Blob()), has_todays_layout ? format : kNewest);
    EXPECT_TRUE(Bvh<View>::InPlace(in_place.Blob()).Verify());
    Bvh<View> cleared(copy);
    cleared.Clear();
    EXPECT_EQ(FormatOf(cleared.Blob()), kNewest);
    ExpectIsModelAfterChanges<View>(copy, ModelOf<TypeParam>());
    ExpectIsModelAfterChanges<View>(in_place, ModelOf<TypeParam>());
    EXPECT_TRUE(std::equal(file.bytes().begin(), file.bytes().end(),
                           untouched.bytes().begin()));
  }
}

// Some builds of format 3 stored no codes for up to 4096 objects, as format 4.
TYPED_TEST(BvhFormatTest, Format3WithoutCodesIsRead) {
  using View = typename TypeParam::View;
  const AlignedCopy file = File<TypeParam>(4);
  WriteAt(file.bytes(), kVersionAt, std::uint32_t{3});
  const Bvh<View> world = Bvh<View>::InPlace(file.bytes());
  EXPECT_EQ(world.Blob().data() == file.bytes().data(),
            TypeParam::kFirstOfLayout <= 4);
  ExpectIsModel<View>(world, ModelOf<TypeParam>(), Queries<View>(),
                      ChosenTarget());
}

TYPED_TEST(BvhFormatTest, TodaysBytesAreTheNewestFormat) {
  using View = typename TypeParam::View;
  if (TypeParam::kIsErased) ExpectIsNewest<TypeParam>(TypeParam::Make());
  // The order of a build may change without a new format, so it is the file's.
  const AlignedCopy file = File<TypeParam>(kNewest);
  Bvh<View> refitted = Bvh<View>::FromBlob(file.bytes());
  World<View> in_order;
  for (std::uint32_t id : refitted.ids()) {
    in_order.Push(id < TypeParam::kObjects ? Object<View>(id)
                                           : View::Bound::Empty());
  }
  refitted.RefitInOrder(in_order);
  ExpectIsNewest<TypeParam>(refitted);
  EXPECT_EQ(TypeParam::Make().Blob().size(), file.bytes().size());
}

TYPED_TEST(BvhFormatTest, AnAlteredFileIsSeen) {
  using Bvh = Bvh<typename TypeParam::View>;
  Random random(1);
  for (std::uint32_t format = kOldest; format <= kNewest; ++format) {
    SCOPED_TRACE(format);
    const AlignedCopy file = File<TypeParam>(format);
    const auto bytes = file.bytes();
    for (std::size_t at = 0; at < bytes.size();
         at += at < 64 ? 1 : 1 + random() % 32) {
      const std::byte was = bytes[at];
      bytes[at] ^= std::byte{1} << random() % 8;
      try {
        EXPECT_FALSE(Bvh::InPlace(bytes).Verify()) << at;
        EXPECT_FALSE(Bvh::FromBlob(bytes).Verify()) << at;
        EXPECT_FALSE(Bvh(Bvh::InPlace(bytes)).Verify()) << at;
      } catch (const std::invalid_argument&) {
        // Refused.
      }
      bytes[at] = was;
    }
    for (std::size_t less : {std::size_t{1}, std::size_t{64}, bytes.size() - 64,
                             bytes.size() - 63, bytes.size() - 1}) {
      const auto cut = bytes.first(bytes.size() - less);
      EXPECT_TRUE(Refuses([&] { Bvh::InPlace(cut); }, {"InPlace", "blob"}));
      EXPECT_TRUE(Refuses([&] { Bvh::FromBlob(cut); }, {"FromBlob", "blob"}));
    }
  }
}

TYPED_TEST(BvhFormatTest, OtherFormatsAreRefused) {
  using Bvh = Bvh<typename TypeParam::View>;
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
    const AlignedCopy file = File<TypeParam>(kNewest);
    WriteAt(file.bytes(), kVersionAt, other.version);
    EXPECT_TRUE(Refuses([&] { Bvh::FromBlob(file.bytes()); },
                        {"FromBlob", "blob", expected, other.given}));
    EXPECT_TRUE(Refuses([&] { Bvh::InPlace(file.bytes()); },
                        {"InPlace", "blob", expected, other.given}));
  }
}

// With room for more than 4096 objects there are codes, in all formats. A file
// would be large, so its checksum stands for it, as the first library of each
// format computed it.
TEST(BvhFormatCodesTest, EveryFormatIsRead) {
  using View = AabbView3;
  constexpr std::uint64_t kChecksums[] = {
      0x3B706554BCC557E5, 0x04D738325CE7C6FA, 0xE90CDA633B527BB5};
  Bvh<View> bvh = Inserted<View>(100, 4097);
  Model<View> model;
  for (std::uint32_t id = 0; id < 100; ++id) {
    model.objects[id] = {Object<View>(id)};
  }
  EXPECT_EQ(ReadAt<std::uint64_t>(bvh.Blob(), kChecksumAt),
            kChecksums[kNewest - kOldest])
      << "The bytes of a stored BVH have changed, so they are a new format. "
         "Raise kBvhVersion and kNewest, and add this checksum: see "
         "ExpectIsNewest().";
  const std::vector<std::byte> format4 = AsFormat4(bvh.Blob());
  for (std::uint32_t format = kOldest; format <= kNewest; ++format) {
    SCOPED_TRACE(format);
    const bool is_newest = format == kNewest;
    const AlignedCopy blob(is_newest ? bvh.Blob() : format4);
    WriteAt(blob.bytes(), kVersionAt, format);
    WriteAt(blob.bytes(), kChecksumAt, kChecksums[format - kOldest]);
    Bvh<View> copy = Bvh<View>::FromBlob(blob.bytes());
    Bvh<View> in_place = Bvh<View>::InPlace(blob.bytes());
    EXPECT_EQ(in_place.Blob().data() == blob.bytes().data(), is_newest);
    ExpectIsModelAfterChanges<View>(copy, model);
    ExpectIsModelAfterChanges<View>(in_place, model);
  }
}

// A group of 4096 places had one cost in format 4.
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

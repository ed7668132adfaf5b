// More objects than 32 bits count: planes of up to 32 GiB of addresses, and
// rows of as many, backed again and again by the same memory.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject_many.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// Room for `count` elements, at first all `value`: mappings of one chunk, in a
// row. What is written to one of them is in all of them; but what is written to
// the last one stays there, and keeps that page apart from then on.
template <typename T>
class Repeated {
 public:
  Repeated(T value, std::size_t count) {
    const std::size_t chunks = (count + kChunk - 1) / kChunk;
    size_ = chunks * kBytes;
    const int file = memfd_create("halfspace-huge-world", 0);
    const std::vector<T> chunk(kChunk, value);
    ok_ = file >= 0 &&
          write(file, chunk.data(), kBytes) == static_cast<ssize_t>(kBytes);
    void* all = mmap(nullptr, size_, PROT_NONE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    ok_ = ok_ && all != MAP_FAILED;
    begin_ = static_cast<std::byte*>(all);
    for (std::size_t c = 0; ok_ && c < chunks; ++c) {
      const int kind = c + 1 == chunks ? MAP_PRIVATE : MAP_SHARED;
      ok_ = mmap(begin_ + c * kBytes, kBytes, PROT_READ | PROT_WRITE,
                 kind | MAP_FIXED, file, 0) != MAP_FAILED;
    }
    if (file >= 0) close(file);
  }
  Repeated(const Repeated&) = delete;
  Repeated& operator=(const Repeated&) = delete;
  ~Repeated() {
    if (begin_ != nullptr && begin_ != MAP_FAILED) munmap(begin_, size_);
  }

  bool ok() const { return ok_; }
  T* data() const { return reinterpret_cast<T*>(begin_); }

 private:
  static constexpr std::size_t kBytes = std::size_t{1} << 26;
  static constexpr std::size_t kChunk = kBytes / sizeof(T);

  std::size_t size_;
  std::byte* begin_ = nullptr;
  bool ok_ = false;
};

constexpr std::size_t kTwoTo32 = std::size_t{1} << 32;

class HugeWorldTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestScale() < 1.0) GTEST_SKIP() << "takes seconds at full scale only";
  }
};

// Only counts need all of the objects, and kernels see a chunk at a time. So
// the planes are of bytes, which are a quarter of the pages of floats: the time
// goes into these.
TEST_F(HugeWorldTest, CountsBeyond32Bits) {
  constexpr std::size_t kObjects = kTwoTo32 + 70;
  const QuantizedBounds<SimplexView2> one(
      SimplexWorld2(std::vector<UpSimplex2>{{{1.f, 1.f, 1.f}}}));
  auto world = one.view();
  const Repeated<std::int8_t> plane(*world.planes[0], kObjects);
  ASSERT_TRUE(plane.ok());
  world.planes.fill(plane.data());
  world.size = kObjects;
  const DownSimplex2 queries[] = {{{1.f, 1.f, 1.f}}, {{1.f, 0.f, 1.f}}};
  EXPECT_EQ(CountSurvivors(world, queries[0]), kObjects);
  std::size_t counts[2];
  SurvivorCounts(world, queries, counts);
  EXPECT_EQ(counts[0], kObjects);
  EXPECT_EQ(counts[1], 0u);
}

// Ranges cost nothing for what is outside: here worlds may have more.
class HugeRangeTest : public HugeWorldTest {
 protected:
  // Rows of so many words that 33 of them have more than 2^32, and that begin
  // at other places of the memory that all of them share.
  static constexpr std::size_t kObjects = 2 * kTwoTo32 + 5 * 64 + 6;
  static constexpr std::size_t kQueries = 33;
  // Two words past 2^32 objects from the start, or at the end, or some around
  // 2^32.
  static constexpr Range kMiddle = {kTwoTo32 + 64, kTwoTo32 + 3 * 64};
  static constexpr Range kEnd = {2 * kTwoTo32 + 4 * 64, kObjects};
  static constexpr Range kAround = {kTwoTo32 - 64 * 64, kTwoTo32 + 3 * 64};

  void SetUp() override {
    HugeWorldTest::SetUp();
    if (IsSkipped()) return;
    plane_.emplace(1.f, kObjects);
    ASSERT_TRUE(plane_->ok());
    // The first is in every chunk, also in that of the middle; the others, in
    // a whole word and in the tail, are not.
    plane_->data()[64 + 69] = 0.f;
    plane_->data()[kEnd.begin + 3] = 0.f;
    plane_->data()[kObjects - 1] = 0.f;
  }

  SimplexView2 World(std::size_t size = kObjects) const {
    return {{plane_->data(), plane_->data(), plane_->data()}, size};
  }

  const DownSimplex2 query_{{0.f, 0.f, 0.f}};
  const std::vector<DownSimplex2> queries_ =
      std::vector<DownSimplex2>(kQueries, query_);

 private:
  std::optional<Repeated<float>> plane_;
};

TEST_F(HugeRangeTest, Masks) {
  std::vector<std::uint64_t> mask(3, 7);
  SurvivorMask(World(), query_, mask, {.range = kMiddle});
  EXPECT_EQ(mask, (std::vector<std::uint64_t>{0, 1u << 5, 7}));
  RejectMask(World(), query_, mask, {.range = kEnd});
  EXPECT_EQ(mask, (std::vector<std::uint64_t>{~(std::uint64_t{1} << 3),
                                              ~(std::uint64_t{1} << 5), 7}));
}

TEST_F(HugeRangeTest, LastIndexOf32Bits) {
  std::vector<std::uint32_t> indices(2, 7);
  EXPECT_EQ(Survivors(World(kTwoTo32), {{1.f, 1.f, 1.f}}, indices,
                      {.range = {kTwoTo32 - 1 - 63, kTwoTo32}}, 62),
            64u);
  EXPECT_EQ(indices[0], std::numeric_limits<std::uint32_t>::max() - 1);
  EXPECT_EQ(indices[1], std::numeric_limits<std::uint32_t>::max());
}

TEST_F(HugeRangeTest, CountsAndFlag) {
  EXPECT_EQ(CountSurvivors(World(), query_, {.range = kMiddle}), 1u);
  EXPECT_EQ(CountSurvivors(World(), query_, {.range = kEnd}), 2u);
  EXPECT_EQ(CountSurvivors(World(), query_, {.range = kAround}), 1u);
  EXPECT_TRUE(AnySurvivor(World(), query_, {.range = kMiddle}));
  EXPECT_TRUE(AnySurvivor(World(), query_, {.range = kEnd}));
  EXPECT_FALSE(AnySurvivor(World(), query_,
                           {.range = {kTwoTo32 + 192, kTwoTo32 + 4096 * 64}}));
  std::vector<std::size_t> counts(kQueries, 7);
  SurvivorCounts(World(), queries_, counts, {.range = kEnd});
  EXPECT_EQ(counts, std::vector<std::size_t>(kQueries, 2));
}

TEST_F(HugeRangeTest, RowsOfMoreThan32BitsOfWords) {
  const std::size_t words = MaskWords(kObjects);
  ASSERT_GT(words * (kQueries - 1), kTwoTo32);
  const Repeated<std::uint64_t> rows(7, words * kQueries);
  ASSERT_TRUE(rows.ok());
  const std::size_t first = kEnd.begin / 64;
  SurvivorMasks(World(), queries_,
                {rows.data() + first, words * kQueries - first},
                {.range = kEnd}, words);
  for (std::size_t q = 0; q < kQueries; ++q) {
    const std::uint64_t* end = rows.data() + (q + 1) * words;
    EXPECT_EQ(end[-3], 7u) << q;
    EXPECT_EQ(end[-2], 1u << 3) << q;
    EXPECT_EQ(end[-1], 1u << 5) << q;
    if (q + 1 == kQueries) break;
    EXPECT_EQ(end[0], 7u) << q;
  }
}

}  // namespace
}  // namespace halfspace::testing

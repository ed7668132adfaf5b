// More objects than 32 bits count: planes of 16 GiB of addresses, and a mask of
// half of one, backed again and again by the same memory.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "halfspace/reject.h"
#include "tests/library/environment.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kTwoTo32 = std::size_t{1} << 32;

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
  static constexpr std::size_t kBytes = std::size_t{1} << 22;
  static constexpr std::size_t kChunk = kBytes / sizeof(T);

  std::size_t size_;
  std::byte* begin_ = nullptr;
  bool ok_ = false;
};

class HugeWorldTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestScale() < 1.0) GTEST_SKIP() << "takes seconds at full scale only";
  }

  static SimplexView2 World(const Repeated<float>& plane, std::size_t size) {
    return {{plane.data(), plane.data(), plane.data()}, size};
  }
};

TEST_F(HugeWorldTest, CountsBeyond32Bits) {
  constexpr std::size_t kObjects = kTwoTo32 + 70;
  const Repeated<float> plane(1.f, kObjects);
  ASSERT_TRUE(plane.ok());
  EXPECT_EQ(CountSurvivors(World(plane, kObjects), {{1.f, 1.f, 1.f}}).count,
            kObjects);
}

// Object 2^32 + 69, the only survivor, is bit 5 of the last word.
TEST_F(HugeWorldTest, MaskBeyond32Bits) {
  constexpr std::size_t kObjects = kTwoTo32 + 70;
  const Repeated<float> plane(1.f, kObjects);
  ASSERT_TRUE(plane.ok());
  plane.data()[kObjects - 1] = 0.f;
  constexpr std::size_t kWords = MaskWords(kObjects);
  const Repeated<std::uint64_t> mask(7, kWords);
  ASSERT_TRUE(mask.ok());
  mask.data()[kWords] = 7;
  SurvivorMask(World(plane, kObjects), {{0.f, 0.f, 0.f}},
               {mask.data(), kWords});
  EXPECT_EQ(mask.data()[0], 0u);
  EXPECT_EQ(mask.data()[kWords - 2], 0u);
  EXPECT_EQ(mask.data()[kWords - 1], 1u << 5);
  EXPECT_EQ(mask.data()[kWords], 7u);
}

TEST_F(HugeWorldTest, LastIndexOf32Bits) {
  const Repeated<float> plane(1.f, kTwoTo32);
  ASSERT_TRUE(plane.ok());
  plane.data()[kTwoTo32 - 1] = 0.f;
  std::vector<std::uint32_t> indices(2, 7);
  EXPECT_EQ(Survivors(World(plane, kTwoTo32), {{0.f, 0.f, 0.f}}, indices).count,
            1u);
  EXPECT_EQ(indices[0], std::numeric_limits<std::uint32_t>::max());
  EXPECT_EQ(indices[1], 7u);
}

}  // namespace
}  // namespace halfspace::testing

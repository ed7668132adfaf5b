// More objects than 32 bits count: planes of 16 GiB of addresses, backed again
// and again by the same memory.
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
constexpr std::size_t kChunk = std::size_t{1} << 20;  // floats

// `chunks` mappings of one chunk of floats that are all `value`, in a row. The
// last one is private: writes stay there.
class RepeatedPlane {
 public:
  RepeatedPlane(float value, std::size_t chunks) : size_(chunks * kBytes) {
    const int file = memfd_create("halfspace-huge-world", 0);
    const std::vector<float> chunk(kChunk, value);
    ok_ = file >= 0 &&
          write(file, chunk.data(), kBytes) == static_cast<ssize_t>(kBytes);
    void* all = mmap(nullptr, size_, PROT_NONE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    ok_ = ok_ && all != MAP_FAILED;
    begin_ = static_cast<std::byte*>(all);
    for (std::size_t c = 0; ok_ && c < chunks; ++c) {
      const bool last = c + 1 == chunks;
      ok_ = mmap(begin_ + c * kBytes, kBytes,
                 last ? PROT_READ | PROT_WRITE : PROT_READ,
                 (last ? MAP_PRIVATE : MAP_SHARED) | MAP_FIXED, file,
                 0) != MAP_FAILED;
    }
    if (file >= 0) close(file);
  }
  RepeatedPlane(const RepeatedPlane&) = delete;
  RepeatedPlane& operator=(const RepeatedPlane&) = delete;
  ~RepeatedPlane() {
    if (begin_ != nullptr && begin_ != MAP_FAILED) munmap(begin_, size_);
  }

  bool ok() const { return ok_; }
  float* data() const { return reinterpret_cast<float*>(begin_); }

 private:
  static constexpr std::size_t kBytes = kChunk * sizeof(float);

  std::size_t size_;
  std::byte* begin_ = nullptr;
  bool ok_ = false;
};

class HugeWorldTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestScale() < 1.0) GTEST_SKIP() << "takes seconds at full scale only";
  }
};

TEST_F(HugeWorldTest, CountsBeyond32Bits) {
  const RepeatedPlane plane(1.f, kTwoTo32 / kChunk + 1);
  ASSERT_TRUE(plane.ok());
  SimplexView2 world{{plane.data(), plane.data(), plane.data()}, kTwoTo32 + 70};
  EXPECT_EQ(CountSurvivors(world, {{1.f, 1.f, 1.f}}).count, kTwoTo32 + 70);
}

TEST_F(HugeWorldTest, LastIndexOf32Bits) {
  const RepeatedPlane plane(1.f, kTwoTo32 / kChunk);
  ASSERT_TRUE(plane.ok());
  plane.data()[kTwoTo32 - 1] = 0.f;
  const SimplexView2 world{{plane.data(), plane.data(), plane.data()},
                           kTwoTo32};
  std::vector<std::uint32_t> indices(2, 7);
  EXPECT_EQ(Survivors(world, {{0.f, 0.f, 0.f}}, indices).count, 1u);
  EXPECT_EQ(indices[0], std::numeric_limits<std::uint32_t>::max());
  EXPECT_EQ(indices[1], 7u);
}

}  // namespace
}  // namespace halfspace::testing

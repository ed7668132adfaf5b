// The ceiling of the scans: it must read every byte of every plane.
#include "bench/baselines/plane_reader.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "bench/base/aligned_vector.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

// More than two pages, so that the last turn is a short one.
constexpr std::size_t kBytes = 2 * 8192 + 3 * kReadBytes;

class Planes {
 public:
  explicit Planes(std::size_t count)
      : planes_(count, AlignedVector<unsigned char>(kBytes, 0)) {}

  unsigned char& at(std::size_t plane, std::size_t byte) {
    return planes_[plane][byte];
  }
  std::size_t count() const { return planes_.size(); }

  std::uint32_t Read(ReadWay way, Target target) const {
    BytePlanes list;
    for (const auto& plane : planes_) list.push_back(plane.data());
    return PlaneReaderFor(target)(way, list.data(), list.size(), kBytes);
  }

 private:
  std::vector<AlignedVector<unsigned char>> planes_;
};

template <typename F>
void ForEveryWay(const F& f) {
  for (Target target : SupportedTargets()) {
    for (ReadWay way : kReadWays) {
      SCOPED_TRACE(std::string(target.name()) + ", " + NameOf(way));
      f(way, target);
    }
  }
}

TEST(PlaneReaderTest, EveryByteCounts) {
  for (std::size_t count : {4u, 6u, 8u}) {
    Planes planes(count);
    ForEveryWay([&](ReadWay way, Target target) {
      EXPECT_EQ(planes.Read(way, target), 0u);
      if (way == ReadWay::kWmemchr) return;
      for (std::size_t p = 0; p < count; ++p) {
        // A byte of each chunk, another one each time.
        for (std::size_t i = p; i < kBytes; i += kReadBytes - 1) {
          planes.at(p, i) = 1;
          EXPECT_NE(planes.Read(way, target), 0u) << p << ", " << i;
          planes.at(p, i) = 0;
        }
      }
    });
  }
}

TEST(PlaneReaderTest, TheLibraryFindsEveryAbsentValue) {
  Planes planes(6);
  const Target target = SupportedTargets().front();
  for (std::size_t p = 0; p < planes.count(); ++p) {
    for (std::size_t i : {std::size_t{0}, kBytes / 2, kBytes - 4}) {
      std::memcpy(&planes.at(p, i), &kAbsent, sizeof(kAbsent));
    }
  }
  EXPECT_EQ(planes.Read(ReadWay::kWmemchr, target), 3u * planes.count());
}

TEST(PlaneReaderTest, OtherNumbersOfPlanesAreAnError) {
  EXPECT_THROW(Planes(5).Read(ReadWay::kByWord, SupportedTargets().front()),
               std::logic_error);
}

}  // namespace
}  // namespace halfspace::bench

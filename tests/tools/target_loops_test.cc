// The ceilings: each must move every byte.
#include "bench/inner/target_loops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "bench/base/aligned_vector.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

TEST(TargetLoopsTest, ReadsEveryByte) {
  constexpr std::size_t kFloats = 40 * kReadBytes / sizeof(float);
  for (std::size_t count : {4u, 6u, 8u}) {
    std::vector<AlignedVector<float>> planes(count,
                                             AlignedVector<float>(kFloats, 0));
    std::vector<const float*> list;
    for (const auto& plane : planes) list.push_back(plane.data());
    for (Target target : SupportedTargets()) {
      for (bool by_plane : {false, true}) {
        SCOPED_TRACE(std::string(target.name()) + (by_plane ? ", plane" : ""));
        const auto read = [&] {
          return LoopsFor(target).read(by_plane, list.data(), count,
                                       kFloats * sizeof(float));
        };
        EXPECT_EQ(read(), 0u);
        for (std::size_t p = 0; p < count; ++p) {
          // A float of each chunk, another one each time.
          for (std::size_t i = p; i < kFloats; i += kReadBytes / 4 - 1) {
            planes[p][i] = 1;
            EXPECT_NE(read(), 0u) << p << ", " << i;
            planes[p][i] = 0;
          }
        }
      }
    }
  }
}

constexpr std::size_t kObjects = 9 * kCopyObjects;
constexpr unsigned char kUntouched = 0xFF;

// What is written, and 256 bytes after each of the planes.
std::vector<AlignedVector<unsigned char>> Copied(bool streamed, Target target,
                                                 CopyJob job) {
  std::vector<AlignedVector<unsigned char>> written(
      2, AlignedVector<unsigned char>(4 * kObjects + 256, kUntouched));
  for (auto& plane : written) job.writes.push_back({plane.data(), 4});
  LoopsFor(target).copy(streamed, job);
  return written;
}

TEST(TargetLoopsTest, CopiesEveryByte) {
  // Triangles: three indices and half of three coordinates.
  AlignedVector<unsigned char> indices(12 * kObjects, 0);
  AlignedVector<unsigned char> coordinates(6 * kObjects, 0);
  const CopyJob job{kObjects, {{indices.data(), 12}, {coordinates.data(), 6}}};
  for (Target target : SupportedTargets()) {
    for (bool streamed : {false, true}) {
      SCOPED_TRACE(target.name());
      for (const auto& plane : Copied(streamed, target, job)) {
        for (std::size_t i = 0; i < plane.size(); ++i) {
          ASSERT_EQ(plane[i], i < 4 * kObjects ? 0 : kUntouched) << i;
        }
      }
      for (auto* stream : {&indices, &coordinates}) {
        for (std::size_t i = 0; i < stream->size(); i += kReadBytes - 1) {
          (*stream)[i] = 1;
          // Seen by the last objects at the latest.
          const auto written = Copied(streamed, target, job);
          EXPECT_TRUE(std::any_of(written[1].begin() + 4 * kObjects - 64,
                                  written[1].begin() + 4 * kObjects,
                                  [](unsigned char byte) { return byte == 1; }))
              << i;
          (*stream)[i] = 0;
        }
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::bench

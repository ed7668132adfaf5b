// The ceilings: each must move every byte. The paper's schedules: each must
// give the right mask.
#include "bench/inner/target_loops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/aligned_vector.h"
#include "bench/worlds/scene.h"
#include "bench/worlds/working_set.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

// Halves that differ in length.
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
    return LoopsFor(target).read(way, list.data(), list.size(), kBytes);
  }

 private:
  std::vector<AlignedVector<unsigned char>> planes_;
};

template <typename Ways, typename F>
void ForEvery(const Ways& ways, const F& f) {
  for (Target target : SupportedTargets()) {
    for (auto way : ways) {
      SCOPED_TRACE(std::string(target.name()) + ", " + NameOf(way));
      f(way, target);
    }
  }
}

TEST(PlaneReaderTest, EveryByteCounts) {
  for (std::size_t count : {4u, 6u, 8u}) {
    Planes planes(count);
    ForEvery(kReadWays, [&](ReadWay way, Target target) {
      EXPECT_EQ(planes.Read(way, target), 0u);
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

// A part of 1024 objects, and a shorter one.
constexpr std::size_t kObjects = 1024 + 3 * kCopyObjects;
constexpr unsigned char kUntouched = 0xFF;

// What is written, and 256 bytes after each of the planes.
std::vector<AlignedVector<unsigned char>> Copied(CopyWay way, Target target,
                                                 CopyJob job) {
  std::vector<AlignedVector<unsigned char>> written(
      2, AlignedVector<unsigned char>(4 * kObjects + 256, kUntouched));
  for (auto& plane : written) job.writes.push_back({plane.data(), 4});
  LoopsFor(target).copy(way, job);
  return written;
}

TEST(StreamCopierTest, ReadsAndWritesEveryByte) {
  // Triangles: three indices and half of three coordinates.
  AlignedVector<unsigned char> indices(12 * kObjects, 0);
  AlignedVector<unsigned char> coordinates(6 * kObjects, 0);
  CopyJob job;
  job.objects = kObjects;
  job.reads = {{indices.data(), 12}, {coordinates.data(), 6}};
  ForEvery(kCopyWays, [&](CopyWay way, Target target) {
    for (const auto& plane : Copied(way, target, job)) {
      for (std::size_t i = 0; i < plane.size(); ++i) {
        ASSERT_EQ(plane[i], i < 4 * kObjects ? 0 : kUntouched) << i;
      }
    }
    for (auto* stream : {&indices, &coordinates}) {
      for (std::size_t i = 0; i < stream->size(); i += kReadBytes - 1) {
        (*stream)[i] = 1;
        // Seen by the last objects at the latest.
        const auto written = Copied(way, target, job);
        EXPECT_TRUE(std::any_of(written[1].begin() + 4 * kObjects - 64,
                                written[1].begin() + 4 * kObjects,
                                [](unsigned char byte) { return byte == 1; }))
            << i;
        (*stream)[i] = 0;
      }
    }
  });
}

// Large objects, so that groups survive every stage.
TEST(StagedScanTest, EveryWayAgreesWithTheReference) {
  const std::size_t objects = 2 * kWidestGate + 64;
  const Workload scene = SceneOfSize(0.1, objects, /*seed=*/5);
  WorkingSet set(scene, {"test", objects, "", 0});
  ForEvery(kStageWays, [&](StageWay way, Target target) {
    for (ShapeKind shape : kShapes) {
      for (std::size_t planes : {1u, 2u}) {
        const auto scan = [=,
                           staged = LoopsFor(target).scan_staged](auto... of) {
          staged(shape, way, planes, of...);
        };
        EXPECT_EQ(set.LoopCase("", shape, scan).check(), "")
            << NameOf(shape) << ", " << planes;
      }
    }
  });
}

TEST(StreamCopierTest, CountsTheBytesOfAJob) {
  const std::vector<std::uint32_t> indices(3 * kObjects);
  std::vector<float> plane(kObjects);
  CopyJob job;
  job.objects = kObjects;
  job.Read(indices.data(), indices.size());
  job.Write(plane.data(), plane.size());
  EXPECT_EQ(job.bytes(), 16 * kObjects);
}

// Each width of each target, against the library's scalar code.
TEST(WidthLoopsTest, EveryWidthRejectsTheSame) {
  // More than a tile of 4096, and a word more.
  constexpr std::size_t kSceneObjects = 4096 + 64;
  for (double share : {0.01, 0.3}) {
    const Workload scene = SceneOfSize(share, kSceneObjects, /*seed=*/3, 16);
    WorkingSet set(scene, {"L2", kSceneObjects, "", 0});
    std::set<std::size_t> lanes;
    for (Target target : SupportedTargets()) {
      for (const WidthLoops& loops : LoopsFor(target).widths) {
        if (loops.lanes == 0) continue;
        EXPECT_LE(loops.lanes, target.lanes());
        lanes.insert(loops.lanes);
        for (const auto& [shape, scan] :
             {std::pair(ShapeKind::kSimplex, loops.simplex_flat),
              std::pair(ShapeKind::kSimplex, loops.simplex_staged),
              std::pair(ShapeKind::kAabb, loops.box_flat),
              std::pair(ShapeKind::kAabb, loops.box_staged)}) {
          EXPECT_EQ(set.LoopCase("", shape, scan).check(), "")
              << target.name() << ", " << loops.lanes << ' ' << NameOf(shape);
        }
      }
      // The loops of the library are compiled for one of the widths.
      const std::size_t own = LoopsFor(target).one_query_lanes();
      EXPECT_LE(own, target.lanes());
    }
    EXPECT_TRUE(lanes.contains(1));
  }
}

}  // namespace
}  // namespace halfspace::bench

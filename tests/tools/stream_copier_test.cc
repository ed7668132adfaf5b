// The ceiling of the bulk builders: it must move every byte, once.
#include "bench/baselines/stream_copier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "bench/base/aligned_vector.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kObjects = 2 * kMemcpyObjects;
constexpr float kUntouched = -1.0f;
constexpr std::size_t kBehind = 64;  // floats that must stay untouched

// Streams with so many floats for each object; no value is there twice.
class CopyTest {
 public:
  CopyTest(const std::vector<double>& reads, std::size_t planes) {
    float next = 1.0f;
    for (double per_object : reads) {
      reads_.emplace_back(static_cast<std::size_t>(per_object * kObjects));
      for (float& value : reads_.back()) value = next++;
      job_.Read(reads_.back().data(), reads_.back().size());
    }
    for (std::size_t p = 0; p < planes; ++p) {
      writes_.emplace_back(kObjects + kBehind, kUntouched);
      job_.Write(writes_.back().data(), kObjects);
    }
  }

  // The streams' memory is named by the job.
  CopyTest(const CopyTest&) = delete;
  CopyTest& operator=(const CopyTest&) = delete;

  const CopyJob& job() const { return job_; }
  AlignedVector<float>& read(std::size_t stream) { return reads_[stream]; }

  void Run(CopyWay way, Target target) {
    for (AlignedVector<float>& plane : writes_) {
      std::fill(plane.begin(), plane.end(), kUntouched);
    }
    CopyStreams(way, job_, kObjects, target);
    for (const AlignedVector<float>& plane : writes_) {
      for (std::size_t i = kObjects; i < plane.size(); ++i) {
        ASSERT_EQ(plane[i], kUntouched) << "written past the end";
      }
    }
  }

  std::vector<float> Written() const {
    std::vector<float> values;
    for (const AlignedVector<float>& plane : writes_) {
      values.insert(values.end(), plane.begin(), plane.begin() + kObjects);
    }
    return values;
  }

  std::vector<float> ToRead() const {
    std::vector<float> values;
    for (const AlignedVector<float>& stream : reads_) {
      values.insert(values.end(), stream.begin(), stream.end());
    }
    return values;
  }

 private:
  std::vector<AlignedVector<float>> reads_;
  std::vector<AlignedVector<float>> writes_;
  CopyJob job_;
};

template <typename F>
void ForEveryWay(const CopyJob& job, const F& f) {
  for (Target target : SupportedTargets()) {
    for (CopyWay way : kCopyWays) {
      if (!CanCopy(way, job)) continue;
      SCOPED_TRACE(std::string(target.name()) + ", " + NameOf(way));
      f(way, target);
    }
  }
}

TEST(StreamCopierTest, CopiesAsManyPlanes) {
  CopyTest copy({1, 1, 1}, 3);
  ForEveryWay(copy.job(), [&](CopyWay way, Target target) {
    copy.Run(way, target);
    EXPECT_EQ(copy.Written(), copy.ToRead());
  });
}

TEST(StreamCopierTest, WritesMoreThanItReadsWithoutMissingAny) {
  // Boxes, records and triangles, to octahedra.
  for (const std::vector<double>& reads :
       {std::vector<double>{1, 1, 1, 1, 1, 1}, {6}, {3, 1.5}}) {
    CopyTest copy(reads, 8);
    const std::vector<float> to_read = copy.ToRead();
    const std::set<float> expected(to_read.begin(), to_read.end());
    ForEveryWay(copy.job(), [&](CopyWay way, Target target) {
      copy.Run(way, target);
      const std::vector<float> written = copy.Written();
      EXPECT_EQ(std::set<float>(written.begin(), written.end()), expected);
    });
  }
}

TEST(StreamCopierTest, JoinsWhatIsReadBeyondWhatIsWritten) {
  struct Moved {
    std::vector<double> reads;
    std::size_t planes;
  };
  // Boxes to D, and point sets to octahedra.
  for (const auto& [reads, planes] :
       {Moved{{1, 1, 1, 1, 1, 1}, 2}, Moved{{50, 50, 50, 2}, 8}}) {
    CopyTest copy(reads, planes);
    for (std::size_t stream = 0; stream < reads.size(); ++stream) {
      AlignedVector<float>& values = copy.read(stream);
      std::fill(values.begin(), values.end(), 0.0f);
    }
    for (std::size_t stream = 0; stream < reads.size(); ++stream) {
      AlignedVector<float>& values = copy.read(stream);
      for (std::size_t at :
           {std::size_t{0}, values.size() / 3 + 7, values.size() - 1}) {
        values[at] = 1.0f;
        ForEveryWay(copy.job(), [&](CopyWay way, Target target) {
          copy.Run(way, target);
          const std::vector<float> written = copy.Written();
          EXPECT_EQ(std::count(written.begin(), written.end(), 1.0f), 1)
              << stream << ", " << at;
          EXPECT_EQ(std::count(written.begin(), written.end(), 0.0f),
                    static_cast<std::ptrdiff_t>(written.size() - 1));
        });
        values[at] = 0.0f;
      }
    }
  }
}

TEST(StreamCopierTest, MemcpyCannotDropBytes) {
  EXPECT_FALSE(CanCopy(CopyWay::kMemcpy, CopyTest({1, 1, 1}, 2).job()));
  EXPECT_TRUE(CanCopy(CopyWay::kMemcpy, CopyTest({1, 1}, 2).job()));
  EXPECT_TRUE(CanCopy(CopyWay::kByPlane, CopyTest({1, 1, 1}, 2).job()));
}

}  // namespace
}  // namespace halfspace::bench

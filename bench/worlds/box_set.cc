#include "bench/worlds/box_set.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/worlds/random.h"

namespace halfspace::bench {
namespace {

constexpr float kHalfCube = 50.0f;

// Nearly normal, with mean 0 and deviation 1; no more than 2 * sqrt(3) away.
float NearlyNormal(Random& random) {
  const float sum =
      random.Signed() + random.Signed() + random.Signed() + random.Signed();
  return sum * 0.8660254f;  // the variance of the sum is 4/3
}

template <int kDims>
Aabb<kDims> UniformBox(float side, Random& random) {
  Aabb<kDims> box;
  for (std::size_t k = 0; k < kDims; ++k) {
    const float center = kHalfCube * random.Signed();
    box.min[k] = center - side / 2;
    box.max[k] = center + side / 2;
  }
  return box;
}

class Clusters {
 public:
  explicit Clusters(Random& random) : random_(random) {
    float sum = 0;
    for (std::size_t i = 0; i < kClusters; ++i) {
      sum += std::exp(NearlyNormal(random_));
      ends_.push_back(sum);
      centers_.push_back(UniformBox<3>(0, random_));
    }
  }

  Aabb3 Next() {
    const float place = ends_.back() * (random_.Signed() + 1) / 2;
    const auto end = std::upper_bound(ends_.begin(), ends_.end() - 1, place);
    const Aabb3& of =
        centers_[static_cast<std::size_t>(std::distance(ends_.begin(), end))];
    Aabb3 box;
    for (std::size_t k = 0; k < 3; ++k) {
      const float center = of.min[k] + kDeviation * NearlyNormal(random_);
      const float side =
          kMedianSide * std::exp(kDeviationOfLog * NearlyNormal(random_));
      box.min[k] = center - side / 2;
      box.max[k] = center + side / 2;
    }
    return box;
  }

 private:
  static constexpr std::size_t kClusters = 50;
  static constexpr float kDeviation = 3.0f;
  static constexpr float kMedianSide = 0.4f;
  static constexpr float kDeviationOfLog = 0.5f;

  Random& random_;
  std::vector<float> ends_;  // each as far from the one before as it is large
  std::vector<Aabb3> centers_;
};

template <int kDims, typename Next>
BoxSet<kDims> Make(std::string name, std::size_t count, const Next& next) {
  BoxSet<kDims> set{std::move(name), {}, {}};
  set.boxes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) set.boxes.push_back(next());
  for (std::size_t i = 0; i < kTimedQueries; ++i) {
    set.queries.push_back(next());
  }
  return set;
}

}  // namespace

template <int kDims>
BoxSet<kDims> MakeUniformBoxes(std::string name, std::size_t count, float side,
                               std::uint64_t seed) {
  Random random(seed);
  return Make<kDims>(std::move(name), count,
                     [&] { return UniformBox<kDims>(side, random); });
}
template BoxSet<2> MakeUniformBoxes<2>(std::string, std::size_t, float,
                                       std::uint64_t);
template BoxSet<3> MakeUniformBoxes<3>(std::string, std::size_t, float,
                                       std::uint64_t);

BoxSet<3> MakeClusters(std::string name, std::size_t count,
                       std::uint64_t seed) {
  Random random(seed);
  Clusters clusters(random);
  return Make<3>(std::move(name), count, [&] { return clusters.Next(); });
}

BoxSet<3> BoxesOf(std::string name, const Workload& workload) {
  BoxSet<3> set{std::move(name), {}, {}};
  set.boxes.reserve(workload.objects.size());
  for (std::size_t i = 0; i < workload.objects.size(); ++i) {
    set.boxes.push_back(workload.objects.Get(i).aabb());
  }
  const std::vector<Aabo3>& queries = workload.timed_queries;
  for (std::size_t i = 0; i < kTimedQueries; ++i) {
    set.queries.push_back(queries[i % queries.size()].aabb());
  }
  return set;
}

}  // namespace halfspace::bench

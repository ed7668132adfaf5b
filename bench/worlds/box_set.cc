#include "bench/worlds/box_set.h"

#include <algorithm>
#include <cmath>

#include "bench/worlds/random.h"

namespace halfspace::bench {
namespace {

constexpr float kHalfWorld = 50.0f;

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
    const float center = kHalfWorld * random.Signed();
    box.min[k] = center - side / 2;
    box.max[k] = center + side / 2;
  }
  return box;
}

// next() makes one box after the other.
template <int kDims = 3, typename Next>
BoxSet<kDims> Make(std::size_t count, const Next& next) {
  BoxSet<kDims> set;
  set.boxes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) set.boxes.push_back(next());
  for (std::size_t i = 0; i < kTimedQueries; ++i) {
    set.queries.push_back(next());
  }
  return set;
}

// Uniform boxes, of which the first `few` are skewed by skew(i, box).
template <typename Skew>
BoxSet<3> MakeWithFew(std::size_t count, float side, std::uint64_t seed,
                      std::size_t few, Skew skew) {
  BoxSet<3> set = MakeUniformBoxes<3>("", count, side, seed);
  for (std::size_t i = 0; i < std::min(few, count); ++i) skew(i, set.boxes[i]);
  return set;
}

template <int kExponent>
BoxSet<3> MakeOutliers(std::size_t count, float side, std::uint64_t seed) {
  return MakeWithFew(count, side, seed, 10, [](std::size_t, Aabb3& box) {
    const float factor = std::pow(10.0f, static_cast<float>(kExponent));
    for (float& x : box.min) x *= factor;
    for (float& x : box.max) x *= factor;
  });
}

BoxSet<3> MakeClusters(std::size_t count, float /*side*/, std::uint64_t seed) {
  constexpr std::size_t kClusters = 50;
  constexpr float kDeviation = 3.0f;
  constexpr float kMedianSide = 0.4f;
  constexpr float kDeviationOfLog = 0.5f;
  Random random(seed);
  float sum = 0;
  std::vector<float> ends;  // each as far from the one before as it is large
  std::vector<Aabb3> centers;
  for (std::size_t i = 0; i < kClusters; ++i) {
    sum += std::exp(NearlyNormal(random));
    ends.push_back(sum);
    centers.push_back(UniformBox<3>(0, random));
  }
  return Make(count, [&] {
    const float place = ends.back() * (random.Signed() + 1) / 2;
    const auto end = std::upper_bound(ends.begin(), ends.end() - 1, place);
    const Aabb3& of = centers[static_cast<std::size_t>(end - ends.begin())];
    Aabb3 box;
    for (std::size_t k = 0; k < 3; ++k) {
      const float center = of.min[k] + kDeviation * NearlyNormal(random);
      const float side =
          kMedianSide * std::exp(kDeviationOfLog * NearlyNormal(random));
      box.min[k] = center - side / 2;
      box.max[k] = center + side / 2;
    }
    return box;
  });
}

BoxSet<3> MakeTeapotInStadium(std::size_t count, float side,
                              std::uint64_t seed) {
  constexpr std::size_t kTeapots = 20;
  constexpr float kScale = 1e-3f;
  // A teapot has 0.9 / 20 of the boxes, which are as much larger in it.
  const float side_in_teapot = side * std::cbrt(kTeapots / 0.9f);
  Random random(seed);
  std::vector<Aabb3> centers;
  for (std::size_t i = 0; i < kTeapots; ++i) {
    centers.push_back(UniformBox<3>(0, random));
  }
  return Make(count, [&] {
    if (random.Below(10) == 0) return UniformBox<3>(side, random);
    const Aabb3& center = centers[random.Below(kTeapots)];
    Aabb3 box = UniformBox<3>(side_in_teapot, random);
    for (std::size_t k = 0; k < 3; ++k) {
      box.min[k] = center.min[k] + kScale * box.min[k];
      box.max[k] = center.min[k] + kScale * box.max[k];
    }
    return box;
  });
}

BoxSet<3> MakeGroundPlanes(std::size_t count, float side, std::uint64_t seed) {
  return MakeWithFew(count, side, seed, 5, [](std::size_t i, Aabb3& box) {
    const float z = 20.0f * static_cast<float>(i) - 40.0f;
    box = {{-kHalfWorld, -kHalfWorld, z}, {kHalfWorld, kHalfWorld, z + 0.1f}};
  });
}

// The largest boxes are cubes of five times the side, which gives as many
// survivors: for sides s and t that are log-uniform over many decades below 5,
// the mean of (s + t)^3 is 8.
BoxSet<3> MakeSixDecades(std::size_t count, float side, std::uint64_t seed) {
  Random random(seed);
  return Make(count, [&] {
    const float decades = 3.0f * (random.Signed() - 1.0f);
    return UniformBox<3>(5.0f * side * std::pow(10.0f, decades), random);
  });
}

BoxSet<3> MakeOnePlane(std::size_t count, float side, std::uint64_t seed) {
  // In the unit of the world, its square is the cube of the uniform side.
  const float side_on_plane = side * std::sqrt(side / kHalfWorld);
  Random random(seed);
  return Make(count, [&] {
    Aabb3 box = UniformBox<3>(side_on_plane, random);
    box.min[2] = 0.0f;
    box.max[2] = side_on_plane;
    return box;
  });
}

BoxSet<3> MakeLongObject(std::size_t count, float side, std::uint64_t seed) {
  return MakeWithFew(count, side, seed, 1, [](std::size_t, Aabb3& box) {
    box.min[0] = -1e4f * kHalfWorld;
    box.max[0] = 1e4f * kHalfWorld;
  });
}

constexpr SkewedWorld kSkewedWorlds[] = {
    {"clusters", MakeClusters},
    {"10 outliers at 10^4", MakeOutliers<4>},
    {"teapot in a stadium", MakeTeapotInStadium},
    {"10 outliers at 10^7", MakeOutliers<7>},
    {"5 ground planes", MakeGroundPlanes},
    {"six decades of sizes", MakeSixDecades},
    {"all on one plane", MakeOnePlane},
    {"one long object", MakeLongObject}};

}  // namespace

std::span<const SkewedWorld> SkewedWorlds() { return kSkewedWorlds; }

template <int kDims>
BoxSet<kDims> MakeUniformBoxes(const std::string& name, std::size_t count,
                               float side, std::uint64_t seed) {
  Random random(seed);
  BoxSet<kDims> set =
      Make<kDims>(count, [&] { return UniformBox<kDims>(side, random); });
  set.name = name;
  return set;
}
template BoxSet<2> MakeUniformBoxes<2>(const std::string&, std::size_t, float,
                                       std::uint64_t);
template BoxSet<3> MakeUniformBoxes<3>(const std::string&, std::size_t, float,
                                       std::uint64_t);

}  // namespace halfspace::bench

#include "bench/paper/volume_set.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <string_view>
#include <utility>

#include "bench/paper/bounding_sphere.h"
#include "bench/paper/loops.h"
#include "bench/worlds/working_set.h"
#include "halfspace/fit.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

// The scalar loop is slow: in large worlds it answers one query.
constexpr std::size_t kCheckedPairs = std::size_t{1} << 20;

Schedule ScheduleOf(std::string_view name) {
  if (name == "flat") return Schedule::kFlat;
  return name == "staged" ? Schedule::kStaged : Schedule::kStagedByAxis;
}

bool IsWithinReach(const Sphere<3>& a, const Sphere<3>& b, double factor) {
  double square = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = double{a.center[k]} - double{b.center[k]};
    square += along * along;
  }
  const double reach = factor * (double{a.radius} + double{b.radius});
  // As a float such a square is infinite, and rejects nothing.
  constexpr double kMost = std::numeric_limits<float>::max();
  if (factor > 1.0 && reach * reach > kMost) return true;
  return square <= reach * reach;
}

}  // namespace

VolumeBounds BoundVolumes(std::span<const float> points) {
  VolumeBounds bounds;
  const std::size_t count = points.size() / 3;
  bounds.aabo = BoundPoints(Points3{points.data(), count});
  const Aabo2 hexagon =
      BoundPoints(Points2{points.data(), count, /*stride=*/3});
  bounds.prism = {
      {hexagon.min[0], hexagon.min[1], hexagon.min[2], bounds.aabo.min[2]},
      {hexagon.max[0], hexagon.max[1], hexagon.max[2], bounds.aabo.max[2]}};
  bounds.sphere = Inflated(SphereAround(points));
  return bounds;
}

VolumeSet::VolumeSet(const NextPoints& next, std::size_t size,
                     std::size_t queries)
    : mask_(MaskWords(size)) {
  for (std::size_t i = 0; i < size; ++i) {
    if (i < kDifferentVolumes) objects_.push_back(BoundVolumes(next()));
    const VolumeBounds& object = objects_[i % kDifferentVolumes];
    const auto& [center, radius] = object.sphere;
    aabos_.Push(object.aabo);
    spheres_.Push({{center[0], center[1], center[2], radius}});
    hexagons_.Push({{object.prism.min[2], object.prism.max[2], 0.0f}});
  }
  for (std::size_t q = 0; q < queries; ++q) {
    queries_.push_back(BoundVolumes(next()));
  }
  const AaboView3 view = aabos_.view();
  const SimplexView2 hexagons = hexagons_.view();
  prisms_ = {{view.min[0], view.min[1], hexagons.min[0], view.min[2]},
             {view.max[0], view.max[1], hexagons.min[1], view.max[2]},
             size};
  sphere_planes_ = spheres_.view().min;
}

template <typename F>
void VolumeSet::With(Volume volume, const VolumeBounds& query, F f) const {
  const AaboView3 view = aabos_.view();
  switch (volume) {
    case Volume::kSimplex:
      return f(view.simplex(), query.aabo.down());
    case Volume::kAabb:
      return f(view.aabb(), query.aabo.aabb());
    case Volume::kAabo:
      return f(view, query.aabo);
    case Volume::kPrism:
      return f(prisms_, query.prism);
    case Volume::kHalfPrism:
      return f(prisms_.simplex(), query.prism.down());
    case Volume::kSphere:
      break;
  }
}

void VolumeSet::Scan(const VolumeTest& test, const VolumeBounds& query,
                     Target target) {
  if (test.volume == Volume::kSphere) {
    const auto& [center, radius] = query.sphere;
    const float values[] = {center[0], center[1], center[2], radius};
    return PaperLoopsFor(target).spheres(sphere_planes_.data(), values, size(),
                                         mask_.data());
  }
  With(test.volume, query, [&](const auto& view, const auto& bound) {
    SurvivorMask(view, bound, mask_,
                 {.schedule = ScheduleOf(test.schedule), .target = target});
  });
}

std::string VolumeSet::Check(const VolumeTest& test, Target target) {
  const std::size_t queries =
      std::clamp<std::size_t>(kCheckedPairs / size(), 1, queries_.size());
  std::vector<std::uint64_t> rejected(mask_.size());
  for (std::size_t q = 0; q < queries; ++q) {
    const VolumeBounds& query = queries_[q];
    std::fill(mask_.begin(), mask_.end(), 0x5555555555555555);
    Scan(test, query, target);
    With(test.volume, query, [&](const auto& view, const auto& bound) {
      reference::RejectMask(view, bound, rejected.data());
    });
    for (std::size_t i = 0; i < size(); ++i) {
      const bool is_kept = (mask_[i / 64] >> (i % 64) & 1) != 0;
      const bool is_right =
          test.volume != Volume::kSphere
              ? is_kept != ((rejected[i / 64] >> (i % 64) & 1) != 0)
              // The kernels round; 2^-20 is more (bounding_sphere.h).
              : is_kept == IsWithinReach(objects_[i % kDifferentVolumes].sphere,
                                         query.sphere,
                                         is_kept ? 1 + 0x1p-20 : 1 - 0x1p-20);
      if (!is_right) {
        return "query " + std::to_string(q) + ", object " + std::to_string(i) +
               ": the mask is not the scalar loop's";
      }
    }
  }
  return {};
}

Case VolumeSet::MakeCase(std::string name, const VolumeTest& test,
                         Target target) {
  const std::size_t per_run =
      std::clamp<std::size_t>(kObjectsPerRun / size(), 1, queries_.size());
  Case c;
  c.name = std::move(name);
  c.items = static_cast<double>(size() * per_run);
  c.check = [this, test, target] { return Check(test, target); };
  c.run = [this, test, target, per_run, next = std::size_t{0}]() mutable {
    for (std::size_t i = 0; i < per_run; ++i) {
      Scan(test, queries_[next], target);
      next = next + 1 == queries_.size() ? 0 : next + 1;
    }
  };
  return c;
}

std::size_t VolumeSet::Survivors(Volume volume, std::size_t queries) {
  const auto* test = std::find_if(
      kVolumeTests.begin(), kVolumeTests.end(),
      [volume](const VolumeTest& any) { return any.volume == volume; });
  std::size_t count = 0;
  for (std::size_t q = 0; q < std::min(queries, queries_.size()); ++q) {
    Scan(*test, queries_[q], ChosenTarget());
    for (std::uint64_t word : mask_) {
      count += static_cast<std::size_t>(std::popcount(word));
    }
  }
  return count;
}

}  // namespace halfspace::bench

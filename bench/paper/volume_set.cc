#include "bench/paper/volume_set.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "bench/paper/loops.h"
#include "bench/worlds/working_set.h"
#include "halfspace/fit.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

// The scalar loop is slow: in large worlds it answers one query.
constexpr std::size_t kCheckedPairs = std::size_t{1} << 20;

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

void VolumeSet::Scan(Volume volume, const VolumeBounds& query,
                     const Options& options) {
  if (volume == Volume::kSphere) {
    const auto& [center, radius] = query.sphere;
    const float values[] = {center[0], center[1], center[2], radius};
    return PaperLoopsFor(options.target)
        .spheres(spheres_.view().min.data(), values, size(), mask_.data());
  }
  With(volume, query, [&](const auto& view, const auto& bound) {
    SurvivorMask(view, bound, mask_, options);
  });
}

bool VolumeSet::IsRight(Volume volume, const VolumeBounds& query) const {
  std::vector<std::uint64_t> rejected(mask_.size());
  With(volume, query, [&](const auto& view, const auto& bound) {
    reference::RejectMask(view, bound, rejected.data());
  });
  for (std::size_t i = 0; i < size(); ++i) {
    const bool is_kept = (mask_[i / 64] >> (i % 64) & 1) != 0;
    const bool is_right =
        volume != Volume::kSphere
            ? is_kept != ((rejected[i / 64] >> (i % 64) & 1) != 0)
            // The kernels round; 2^-20 is more (Inflated()).
            : is_kept == IsWithinReach(objects_[i % kDifferentVolumes].sphere,
                                       query.sphere,
                                       is_kept ? 1 + 0x1p-20 : 1 - 0x1p-20);
    if (!is_right) return false;
  }
  return true;
}

Case VolumeSet::MakeCase(Volume volume, const Options& options) {
  const auto scan = [this, volume, options](std::size_t q) {
    Scan(volume, queries_[q], options);
  };
  Case c = CaseOfQueries(queries_.size(), size(), scan);
  c.items *= static_cast<double>(size());
  c.check = CheckOf(
      std::clamp<std::size_t>(kCheckedPairs / size(), 1, queries_.size()),
      "the mask is not the scalar loop's", [this, volume, scan](std::size_t q) {
        std::fill(mask_.begin(), mask_.end(), 0x5555555555555555);
        scan(q);
        return IsRight(volume, queries_[q]);
      });
  return c;
}

std::size_t VolumeSet::Survivors(Volume volume, std::size_t queries) {
  std::size_t count = 0;
  for (std::size_t q = 0; q < std::min(queries, queries_.size()); ++q) {
    Scan(volume, queries_[q], {.target = ChosenTarget()});
    count += CountBits(mask_);
  }
  return count;
}

}  // namespace halfspace::bench

#include "bench/worlds/volume_set.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <string_view>
#include <utility>

#include "bench/inner/target_loops.h"
#include "bench/worlds/bounding_sphere.h"
#include "bench/worlds/working_set.h"
#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

// The scalar loop is slow: in large worlds it answers one query.
constexpr std::size_t kCheckedPairs = std::size_t{1} << 20;

Schedule ScheduleOf(std::string_view name) {
  if (name == "flat") return Schedule::kFlat;
  return name == "staged" ? Schedule::kStaged : Schedule::kStagedByAxis;
}

// Whether no plane of `axes` axes separates them.
bool Overlaps(const Aabo3& a, const Aabo3& b, std::size_t axes) {
  for (std::size_t k = 0; k < axes; ++k) {
    if (a.min[k] > b.max[k] || a.max[k] < b.min[k]) return false;
  }
  return true;
}

// Whether no minimum of the object separates them.
bool OverlapsBelow(const Aabo3& object, const Aabo3& query) {
  for (std::size_t k = 0; k < Aabo3::kAxes; ++k) {
    if (object.min[k] > query.max[k]) return false;
  }
  return true;
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
  bounds.of_box = BoundAabb(bounds.aabo.aabb());
  const Aabo2 hexagon =
      BoundPoints(Points2{points.data(), count, /*stride=*/3});
  bounds.prism = {
      {hexagon.min[0], hexagon.min[1], hexagon.min[2], bounds.aabo.min[2]},
      {hexagon.max[0], hexagon.max[1], hexagon.max[2], bounds.aabo.max[2]}};
  bounds.sphere = Inflated(SphereAround(points));
  return bounds;
}

VolumeObjects::VolumeObjects(const PointSource& source, std::size_t query_count)
    : name(source.name) {
  objects.reserve(source.objects);
  for (std::size_t i = 0; i < source.objects; ++i) {
    objects.push_back(BoundVolumes(source.next_object()));
  }
  queries.reserve(query_count);
  for (std::size_t i = 0; i < query_count; ++i) {
    queries.push_back(BoundVolumes(source.next_query()));
  }
}

VolumeSet::VolumeSet(const VolumeObjects& from, std::size_t size)
    : from_(from), mask_(MaskWords(size)) {
  aabos_.Reserve(size);
  spheres_.Reserve(size);
  others_.Reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    const VolumeBounds& object = from.objects[i % from.objects.size()];
    const Sphere<3>& sphere = object.sphere;
    aabos_.Push(object.aabo);
    spheres_.Push({{sphere.center[0], sphere.center[1], sphere.center[2],
                    sphere.radius}});
    others_.Push(
        {{object.prism.min[2], object.prism.max[2], object.of_box.min[3]}});
  }
  const AaboView3 view = aabos_.view();
  const SimplexView2 others = others_.view();
  prisms_ = {{view.min[0], view.min[1], others.min[0], view.min[2]},
             {view.max[0], view.max[1], others.min[1], view.max[2]},
             size};
  seven_planes_ = {view.min[0], view.min[1], view.min[2], others.min[2],
                   view.max[0], view.max[1], view.max[2]};
  sphere_planes_ = spheres_.view().min;
}

void VolumeSet::Scan(const VolumeTest& test, const VolumeBounds& query,
                     Target target) {
  const Options options = {.schedule = ScheduleOf(test.schedule),
                           .target = target};
  const AaboView3 view = aabos_.view();
  switch (test.volume) {
    case Volume::kSimplex:
      return SurvivorMask(view.simplex(), query.aabo.down(), mask_, options);
    case Volume::kAabb:
      return SurvivorMask(view.aabb(), query.aabo.aabb(), mask_, options);
    case Volume::kAabo:
      return SurvivorMask(view, query.aabo, mask_, options);
    case Volume::kPrism:
      return SurvivorMask(prisms_, query.prism, mask_, options);
    case Volume::kHalfPrism:
      return SurvivorMask(prisms_.simplex(), query.prism.down(), mask_,
                          options);
    case Volume::kSevenSided: {
      const auto& [min, max] = query.of_box;
      const float values[] = {max[0], max[1], max[2], max[3],
                              min[0], min[1], min[2]};
      return LoopsFor(target).scan_seven_sided(seven_planes_.data(), values,
                                               size(), mask_.data());
    }
    case Volume::kSphere: {
      const auto& [center, radius] = query.sphere;
      const float values[] = {center[0], center[1], center[2], radius};
      const TargetLoops loops = LoopsFor(target);
      return (options.schedule == Schedule::kFlat ? loops.scan_spheres
                                                  : loops.scan_spheres_by_axis)(
          sphere_planes_.data(), values, size(), mask_.data());
    }
  }
}

bool VolumeSet::Keeps(Volume volume, const VolumeBounds& query, std::size_t i,
                      Reach reach) const {
  const VolumeBounds& object = from_.objects[i % from_.objects.size()];
  constexpr std::size_t kBoxAxes = 3;
  switch (volume) {
    case Volume::kSimplex:
      return OverlapsBelow(object.aabo, query.aabo);
    case Volume::kHalfPrism:
      return OverlapsBelow(object.prism, query.prism);
    case Volume::kAabb:
    case Volume::kSevenSided:
      return Overlaps(object.aabo, query.aabo, kBoxAxes);
    case Volume::kAabo:
      return Overlaps(object.aabo, query.aabo, Aabo3::kAxes);
    case Volume::kPrism:
      return Overlaps(object.prism, query.prism, Aabo3::kAxes);
    case Volume::kSphere:
      break;
  }
  // 2^-20 is more than the rounding of both sides (bounding_sphere.h).
  return IsWithinReach(object.sphere, query.sphere,
                       reach == Reach::kNearer ? 1 - 0x1p-20 : 1 + 0x1p-20);
}

std::string VolumeSet::Check(const VolumeTest& test, Target target,
                             std::size_t queries) {
  for (std::size_t q = 0; q < std::min(queries, from_.queries.size()); ++q) {
    const VolumeBounds& query = from_.queries[q];
    std::fill(mask_.begin(), mask_.end(), 0x5555555555555555);
    Scan(test, query, target);
    for (std::size_t i = 0; i < size(); ++i) {
      const bool is_kept = (mask_[i / 64] >> (i % 64) & 1) != 0;
      if (Keeps(test.volume, query, i,
                is_kept ? Reach::kFarther : Reach::kNearer) != is_kept) {
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
      std::clamp<std::size_t>(kObjectsPerRun / size(), 1, from_.queries.size());
  Case c;
  c.name = std::move(name);
  c.items = static_cast<double>(size() * per_run);
  c.check = [this, test, target] {
    return Check(test, target,
                 std::max<std::size_t>(1, kCheckedPairs / size()));
  };
  c.run = [this, test, target, per_run, next = std::size_t{0}]() mutable {
    for (std::size_t i = 0; i < per_run; ++i) {
      Scan(test, from_.queries[next], target);
      next = next + 1 == from_.queries.size() ? 0 : next + 1;
    }
  };
  return c;
}

std::size_t VolumeSet::Survivors(Volume volume, std::size_t queries) {
  const auto* test = std::find_if(
      kVolumeTests.begin(), kVolumeTests.end(),
      [volume](const VolumeTest& any) { return any.volume == volume; });
  std::size_t count = 0;
  for (std::size_t q = 0; q < std::min(queries, from_.queries.size()); ++q) {
    Scan(*test, from_.queries[q], ChosenTarget());
    for (std::uint64_t word : mask_) {
      count += static_cast<std::size_t>(std::popcount(word));
    }
  }
  return count;
}

}  // namespace halfspace::bench

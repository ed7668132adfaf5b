// The same objects in every bounding volume that is compared: those of the
// library, and others at the same layout.
#ifndef HALFSPACE_BENCH_WORLDS_VOLUME_SET_H_
#define HALFSPACE_BENCH_WORLDS_VOLUME_SET_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/measure.h"
#include "bench/worlds/point_source.h"
#include "halfspace/bounds.h"
#include "halfspace/reject.h"
#include "halfspace/shapes.h"
#include "halfspace/world.h"

namespace halfspace::bench {

enum class Volume : std::size_t {
  kSimplex,
  kAabb,
  kAabo,
  kSevenSided,  // the box and the D of its own up simplex
  kPrism,       // a hexagon of X, Y and -(X + Y), along Z
  kHalfPrism,   // the minima of a prism, which enclose no volume
  kSphere,
};
inline constexpr std::size_t kVolumes = 7;

constexpr const char* NameOf(Volume volume) {
  constexpr const char* kNames[] = {
      "simplex",           "aabb",  "aabo", "7-sided box", "hexagon prism",
      "half of the prism", "sphere"};
  return kNames[static_cast<std::size_t>(volume)];
}

constexpr std::size_t PlanesOf(Volume volume) {
  constexpr std::size_t kCounts[] = {4, 6, 8, 7, 8, 4, 4};
  return kCounts[static_cast<std::size_t>(volume)];
}

// A volume and the order of its test. By axis, an octahedron is a k-DOP of
// pairs of planes; a sphere is tested along X first.
struct VolumeTest {
  Volume volume;
  const char* schedule;
};
inline constexpr std::array<VolumeTest, 13> kVolumeTests = {
    {{Volume::kSimplex, "flat"},
     {Volume::kAabb, "flat"},
     {Volume::kAabb, "staged"},
     {Volume::kAabo, "flat"},
     {Volume::kAabo, "staged"},
     {Volume::kAabo, "by-axis"},
     {Volume::kSevenSided, "staged"},
     {Volume::kPrism, "flat"},
     {Volume::kPrism, "staged"},
     {Volume::kPrism, "by-axis"},
     {Volume::kHalfPrism, "flat"},
     {Volume::kSphere, "flat"},
     {Volume::kSphere, "by-axis"}}};

// All volumes around the same points.
struct VolumeBounds {
  Aabo3 aabo;
  Aabo3 of_box;      // the octahedron around the aabo's box
  Aabo3 prism;       // its axes are X, Y, -(X + Y) and Z
  Sphere<3> sphere;  // inflated
};
VolumeBounds BoundVolumes(std::span<const float> points);

// Objects and queries of a source.
struct VolumeObjects {
  VolumeObjects(const PointSource& source, std::size_t query_count);

  std::string name;
  std::vector<VolumeBounds> objects;
  std::vector<VolumeBounds> queries;
};

class VolumeSet {
 public:
  // `size` objects, a multiple of 64: the given ones, again and again.
  VolumeSet(const VolumeObjects& from, std::size_t size);

  std::size_t size() const { return aabos_.size(); }
  const std::vector<std::uint64_t>& mask() const { return mask_; }

  // Writes the survivor mask.
  void Scan(const VolumeTest& test, const VolumeBounds& query, Target target);

  // Whether object i survives, longhand. Of spheres, which the kernels round:
  // whether it must (kNearer), or may (kFarther).
  enum class Reach { kNearer, kFarther };
  bool Keeps(Volume volume, const VolumeBounds& query, std::size_t i,
             Reach reach) const;

  // Empty if the first `queries` queries have the right masks, else what is
  // wrong.
  std::string Check(const VolumeTest& test, Target target, std::size_t queries);

  // Scans for one query after the other; checked, and timed per object.
  Case MakeCase(std::string name, const VolumeTest& test, Target target);

  // Of the first `queries` queries.
  std::size_t Survivors(Volume volume, std::size_t queries);

 private:
  const VolumeObjects& from_;
  AaboWorld3 aabos_;
  AaboView3 prisms_;  // X, Y and Z are planes of the octahedra
  // Worlds, for the alignment of their planes.
  SimplexWorld3 spheres_;  // x, y, z, radius
  SimplexWorld2 others_;   // -(X + Y): minima, maxima; D of the boxes: minima
  std::array<const float*, 4> sphere_planes_{};
  std::array<const float*, 7> seven_planes_{};
  std::vector<std::uint64_t> mask_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_VOLUME_SET_H_

// Every bounding volume of the same objects: those of the library, and others
// in the same layout.
#ifndef HALFSPACE_BENCH_PAPER_VOLUME_SET_H_
#define HALFSPACE_BENCH_PAPER_VOLUME_SET_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/base/shape.h"
#include "bench/baselines/bounding_sphere.h"
#include "bench/measure/measure.h"
#include "bench/paper/points.h"
#include "halfspace/bounds.h"
#include "halfspace/reject.h"
#include "halfspace/shapes.h"
#include "halfspace/world.h"

namespace halfspace::bench {

enum class Volume : std::size_t {
  kSimplex,
  kAabb,
  kAabo,
  kPrism,      // a hexagon of X, Y and -(X + Y), along Z
  kHalfPrism,  // the minima of a prism, which enclose no volume
  kSphere,
};
inline constexpr std::size_t kVolumes = 6;

constexpr const char* NameOf(Volume volume) {
  constexpr const char* kNames[] = {
      "simplex",           "aabb",  "aabo", "hexagon prism",
      "half of the prism", "sphere"};
  return kNames[static_cast<std::size_t>(volume)];
}

constexpr std::size_t PlanesOf(Volume volume) {
  constexpr std::size_t kCounts[] = {4, 6, 8, 8, 4, 4};
  return kCounts[static_cast<std::size_t>(volume)];
}

// By axis, an octahedron is a k-DOP of pairs of planes.
constexpr std::span<const NamedSchedule> SchedulesOf(Volume volume) {
  constexpr std::size_t kCounts[] = {1, 2, 3, 3, 1, 1};
  return std::span(kSchedules).first(kCounts[static_cast<std::size_t>(volume)]);
}

// All volumes around the same points.
struct VolumeBounds {
  Aabo3 aabo;
  Aabo3 prism;       // its axes are X, Y, -(X + Y) and Z
  Sphere<3> sphere;  // inflated
};
VolumeBounds BoundVolumes(std::span<const float> points);

// So many different objects at most, which are bounded in a fraction of a
// second.
inline constexpr std::size_t kDifferentVolumes = std::size_t{1} << 17;

class VolumeSet {
 public:
  // `size` objects, a multiple of 64, and queries, all made by `next`. Of more
  // than kDifferentVolumes objects the first ones come again and again.
  VolumeSet(const NextPoints& next, std::size_t size, std::size_t queries);

  std::size_t size() const { return aabos_.size(); }

  // Scans for one query after the other; checked, and timed per object.
  Case MakeCase(Volume volume, const Options& options);

  // The survivors of the first `queries` queries.
  std::size_t Survivors(Volume volume, std::size_t queries);

 private:
  // Writes the survivor mask.
  void Scan(Volume volume, const VolumeBounds& query, const Options& options);
  // Calls f(view, query) with the objects' bounds, unless they are spheres.
  template <typename F>
  void With(Volume volume, const VolumeBounds& query, F f) const;
  // Whether a scalar loop gives the same mask.
  bool IsRight(Volume volume, const VolumeBounds& query) const;

  std::vector<VolumeBounds> objects_;
  std::vector<VolumeBounds> queries_;
  AaboWorld3 aabos_;
  AaboView3 prisms_;  // X, Y and Z are planes of the octahedra
  // Worlds, for the alignment of their planes.
  SimplexWorld3 spheres_;   // x, y, z, radius
  SimplexWorld2 hexagons_;  // -(X + Y): minima, maxima, and zeros
  std::vector<std::uint64_t> mask_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_VOLUME_SET_H_

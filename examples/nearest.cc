// Which spheres are nearest to a place, which one does a ray hit first, which
// bound does a moving box touch first, and which are in a turned box?
// Searches and casts go from near to far and stop when no nearer object is
// left.
#include <halfspace/halfspace.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <vector>

namespace {

// Spheres on a grid, whose centers are a little off it.
std::vector<halfspace::Sphere3> MakeSpheres() {
  std::vector<halfspace::Sphere3> spheres;
  for (int i = 0; i < 50 * 50 * 50; ++i) {
    const auto x = static_cast<float>(i % 50);
    const auto y = static_cast<float>(i / 50 % 50);
    const auto z = static_cast<float>(i / 2500);
    spheres.push_back(
        {{x + 0.1f * std::sin(y), y, z + 0.1f * std::cos(x)}, 0.3f});
  }
  return spheres;
}

// Where the ray meets the sphere, or infinity.
float Hit(const halfspace::Ray3& ray, const halfspace::Sphere3& sphere) {
  float along = 0;
  float square = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const float to_center = sphere.center[k] - ray.origin[k];
    along += to_center * ray.direction[k];
    square += to_center * to_center;
  }
  const float inside = sphere.radius * sphere.radius - square + along * along;
  return inside < 0 ? std::numeric_limits<float>::infinity()
                    : along - std::sqrt(inside);
}

}  // namespace

int main() {
  const std::vector<halfspace::Sphere3> spheres = MakeSpheres();
  const auto world = halfspace::AabbBvh3::Fitted(
      spheres.size(), [&](const halfspace::AabbPlanes3& planes) {
        halfspace::Spheres3 list;
        for (std::size_t k = 0; k < 3; ++k) {
          list.center[k] = &spheres[0].center[k];
        }
        list.radius = &spheres[0].radius;
        list.count = spheres.size();
        list.stride = 4;
        halfspace::BoundSpheres(list, planes);
      });

  // The eight bounds nearest to a point.
  std::array<std::uint32_t, 8> ids;
  std::array<float, 8> distances;
  const std::size_t found =
      KNearest(world, {20.4f, 30.4f, 10.4f}, ids, distances);
  for (std::size_t i = 0; i < found; ++i) {
    std::printf("sphere %u is %.3f away\n", ids[i],
                static_cast<double>(distances[i]));
  }

  // The first sphere along a ray: no bound behind it is asked for.
  const float d = std::sqrt(1.0f / 3.0f);
  const halfspace::Ray3 ray = {{-1.0f, 4.2f, 8.1f}, {d, d, d}, 100.0f};
  float closest = ray.max_t;
  std::uint32_t hit = 0;
  int tests = 0;
  RayCast(world, ray, [&](std::uint32_t id, float /*enters*/) {
    ++tests;
    if (const float t = Hit(ray, spheres[id]); t < closest) {
      closest = t;
      hit = id;
    }
    return halfspace::Limit{closest};
  });
  std::printf("the ray meets sphere %u at %.3f, after %d tests\n", hit,
              static_cast<double>(closest), tests);

  // How far a box can move along x until it touches a bound.
  const halfspace::Aabb3 box = {{-3, 4.1f, 8.1f}, {-2, 4.4f, 8.4f}};
  float free = 100.0f;
  BoxCast(world, box, {1, 0, 0}, free, [&](std::uint32_t /*id*/, float t) {
    free = std::min(free, t);
    return halfspace::Limit{free};
  });
  std::printf("the box can move by %.3f\n", static_cast<double>(free));

  // A selection box that is turned by 45 degrees about z, 4 ids at a time.
  const halfspace::OrientedBox3 turned = {
      {10, 10, 10}, {{{1, 1, 0}, {-1, 1, 0}, {0, 0, 1}}}, {1, 1, 0.5f}};
  std::array<std::uint32_t, 4> some;
  std::size_t skip = 0;
  std::size_t selected = 0;
  do {
    selected = Survivors(world, turned, some, {}, skip);
    for (std::size_t i = skip; i < std::min(skip + some.size(), selected);
         ++i) {
      std::printf("sphere %u may be selected\n", some[i - skip]);
    }
    skip += some.size();
  } while (skip < selected);

  // The same by a test of each sphere.
  float expected = ray.max_t;
  for (const halfspace::Sphere3& sphere : spheres) {
    expected = std::min(expected, Hit(ray, sphere));
  }
  return found == 8 && std::is_sorted(distances.begin(), distances.end()) &&
                 closest == expected && expected < ray.max_t && tests < 100 &&
                 free > 1.5f && free < 2.5f && selected >= 5
             ? 0
             : 1;
}

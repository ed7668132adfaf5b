// An engine that already keeps axis-aligned boxes as a structure of arrays: two
// more planes make an octahedron world of them, with no copy of the rest, and a
// query in double precision around a far-away camera.
#include <halfspace/halfspace.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <vector>

int main() {
  constexpr std::size_t kCount = 10'000;
  std::array<std::vector<float>, 3> low;   // the engine's own
  std::array<std::vector<float>, 3> high;  // memory
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::array<std::size_t, 3> cell = {i % 100, i / 100 % 10, i / 1000};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k].push_back(8e6f + 3.0f * static_cast<float>(cell[k]));
      high[k].push_back(low[k].back() + 1.0f);
    }
  }

  halfspace::AabbView3 boxes;
  boxes.size = kCount;
  for (std::size_t k = 0; k < 3; ++k) {
    boxes.min[k] = low[k].data();
    boxes.max[k] = high[k].data();
  }
  std::vector<float> d_min(kCount);
  std::vector<float> d_max(kCount);
  halfspace::FitStatus status;
  halfspace::BoundBoxes(halfspace::BoxesOf(boxes),
                        halfspace::DPlanes3{d_min.data(), d_max.data(), kCount},
                        {}, &status);

  halfspace::AaboView3 world;
  world.size = kCount;
  for (std::size_t k = 0; k < 3; ++k) {
    world.min[k] = boxes.min[k];
    world.max[k] = boxes.max[k];
  }
  world.min[3] = d_min.data();
  world.max[3] = d_max.data();

  // A float cannot hold this place to better than half a metre.
  const halfspace::Sphere<3, double> camera = {
      {8e6 + 90.3, 8e6 + 9.7, 8e6 + 9.1}, 12.5};
  const halfspace::Aabo3 query = halfspace::BoundSphere(camera, &status);
  const std::size_t octahedra = halfspace::CountSurvivors(world, query);
  const std::size_t plain = halfspace::CountSurvivors(boxes, query.aabb());
  std::printf("%zu boxes are near the camera; without D, %zu\n", octahedra,
              plain);
  const bool ok = status.everything == 0 && 0 < octahedra && octahedra < plain;
  return ok ? 0 : 1;
}

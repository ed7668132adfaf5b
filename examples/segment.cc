// A ray segment against the triangles of a mesh, each with its own bound: which
// triangles need the exact intersection test?
//
// The caller keeps the planes in memory of their own; the library only looks at
// them, and writes one bit for each triangle.
#include <halfspace/halfspace.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

constexpr std::size_t kSide = 32;                      // cells of a wavy sheet
constexpr std::size_t kTriangles = 2 * kSide * kSide;  // two in each cell

using Corners = std::array<float, 9>;

std::array<float, 3> PointOfSheet(std::size_t x, std::size_t y) {
  const auto u = static_cast<float>(x);
  const auto v = static_cast<float>(y);
  return {u, v, std::sin(0.3f * u) + std::cos(0.2f * v)};
}

Corners TriangleOfSheet(std::size_t i) {
  const std::size_t x = i / 2 % kSide;
  const std::size_t y = i / 2 / kSide;
  const std::size_t odd = i % 2;
  Corners corners{};
  std::size_t n = 0;
  for (const auto& p : {PointOfSheet(x + odd, y + odd), PointOfSheet(x + 1, y),
                        PointOfSheet(x, y + 1)}) {
    for (float v : p) corners[n++] = v;
  }
  return corners;
}

}  // namespace

int main() {
  std::array<std::vector<float>, 8> planes;  // minima of X Y Z D, then maxima
  for (std::size_t i = 0; i < kTriangles; ++i) {
    const Corners corners = TriangleOfSheet(i);
    const halfspace::Aabo3 bound =
        halfspace::BoundPoints(halfspace::Points3{corners.data(), 3});
    for (std::size_t k = 0; k < 4; ++k) {
      planes[k].push_back(bound.min[k]);
      planes[4 + k].push_back(bound.max[k]);
    }
  }
  halfspace::AaboView3 world;
  for (std::size_t k = 0; k < 4; ++k) {
    world.min[k] = planes[k].data();
    world.max[k] = planes[4 + k].data();
  }
  world.size = kTriangles;

  const float segment[] = {10.2f, 12.7f, 9, 11.1f, 13.3f, -9};
  const halfspace::Aabo3 query =
      halfspace::BoundPoints(halfspace::Points3{segment, 2});

  std::vector<std::uint64_t> mask(halfspace::MaskWords(kTriangles));
  halfspace::SurvivorMask(world, query, mask);
  int candidates = 0;
  for (std::uint64_t word : mask) candidates += std::popcount(word);
  std::printf("%d of %zu triangles go on to the exact test\n", candidates,
              kTriangles);
  return candidates == 0 ? 1 : 0;
}

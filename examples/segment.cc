// A ray segment against the triangles of a mesh, each with its own bound: which
// triangles need the exact intersection test? And the triangle that it hits
// first, by a mesh that makes this test.
//
// A long diagonal segment fits one bound badly, so it is cut into pieces, each
// a query of its own.
#include <halfspace/halfspace.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <vector>

namespace {

constexpr std::uint32_t kSide = 33;  // vertices of a wavy sheet, along an edge

std::vector<halfspace::Point3> VerticesOfSheet() {
  std::vector<halfspace::Point3> vertices;
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const auto u = static_cast<float>(x);
      const auto v = static_cast<float>(y);
      vertices.push_back({u, v, std::sin(0.3f * u) + std::cos(0.2f * v)});
    }
  }
  return vertices;
}

std::vector<std::uint32_t> TrianglesOfSheet() {
  std::vector<std::uint32_t> indices;
  for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t i = y * kSide + x;
      indices.insert(indices.end(), {i, i + 1, i + kSide});
      indices.insert(indices.end(), {i + 1, i + kSide + 1, i + kSide});
    }
  }
  return indices;
}

// The triangles that some piece of the segment may touch.
std::size_t Candidates(const halfspace::AaboWorld3& world,
                       const halfspace::Segment3& segment,
                       std::size_t piece_count) {
  std::vector<halfspace::Aabo3> pieces(piece_count);
  halfspace::BoundSegmentPieces(segment, std::span(pieces));
  std::vector<std::uint64_t> any(halfspace::MaskWords(world.size()));
  std::vector<std::uint64_t> mask(any.size());
  for (const halfspace::Aabo3& piece : pieces) {
    halfspace::SurvivorMask(world, piece, mask);
    for (std::size_t w = 0; w < mask.size(); ++w) any[w] |= mask[w];
  }
  return halfspace::CountBits(any);
}

}  // namespace

int main() {
  const std::vector<halfspace::Point3> vertices = VerticesOfSheet();
  const std::vector<std::uint32_t> indices = TrianglesOfSheet();
  halfspace::AaboWorld3 world;
  world.Resize(indices.size() / 3);
  halfspace::BoundTriangles(
      halfspace::Points3{vertices[0].data(), vertices.size()}, indices,
      world.planes());

  const halfspace::Segment3 segment = {{2, 3, 9}, {30, 29, -9}};
  const std::size_t whole = Candidates(world, segment, 1);
  const std::size_t pieces = Candidates(world, segment, 16);
  std::printf(
      "%zu of %zu triangles go on to the exact test; %zu in 16 pieces\n", whole,
      world.size(), pieces);

  const auto& [a, b] = segment;
  const halfspace::TriangleMesh mesh(vertices, indices);
  const halfspace::MeshHit hit =
      mesh.FirstHit({a, {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, 1});
  std::printf("it hits triangle %u after %.1f %% of its length\n", hit.id,
              100 * hit.t);
  return 0 < pieces && pieces < whole && hit.t < 1 ? 0 : 1;
}

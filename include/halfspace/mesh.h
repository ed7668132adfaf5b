// TriangleMesh: rays and closest points on triangles that do not move.
//
//   halfspace::TriangleMesh mesh(vertices, indices);  // 3 indices a triangle
//   halfspace::MeshHit hit = mesh.FirstHit({eye, direction, max_t});
//   if (hit.id != halfspace::kNoId) Paint(hit.id, hit.t);
//   halfspace::MeshPoint near = mesh.ClosestPoint({x, y, z});
//
// The id of a triangle is its index in the list of the constructor. A mesh
// copies its corners. If triangles move, build a new mesh, or keep a Bvh of
// their boxes and call HitTriangle() for the boxes that a ray enters
// (triangles.h).
//
// A ray hits a triangle, and a point has a distance from it, exactly where
// HitTriangle() and ClosestPoint() of triangles.h say so: no ray passes between
// triangles that share an edge. Results are the same on every target and in
// every floating-point mode.
//
// NaN and infinities: a triangle with one is never found. A ray with one in its
// origin or its direction hits nothing, and a point with one has no closest
// triangle. A triangle without an area is hit by no ray, and can be the closest
// one.
//
// Errors (error.h): the target is not supported; `max_t` or `max_distance` is
// negative or NaN; memory is null or misaligned; there are not as many results
// as queries.
//
// Cost: docs/bvh.md compares it with Embree. The filters of a mesh need
// coordinates below 2^30 for closest points and below 2^60 for rays. Beyond
// that, and in scenes smaller than 2^-50, results are the same, but a query
// tests all triangles of up to 16 that it visits.
//
// Thread safety: calls on one mesh may run at the same time, with 4 KiB of
// stack. Only the constructors allocate.
//
// Source: a 16-wide BVH by the surface area heuristic (Wald, "On fast
// Construction of SAH-based Bounding Volume Hierarchies", 2007). The test of 16
// triangles is that of Woop, Benthin and Wald, "Watertight Ray/Triangle
// Intersection", 2013, with a bound of its error (docs/exactness.md).
#ifndef HALFSPACE_MESH_H_
#define HALFSPACE_MESH_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "halfspace/bvh_nearest.h"
#include "halfspace/export.h"
#include "halfspace/memory.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"
#include "halfspace/target.h"
#include "halfspace/visit.h"

namespace halfspace {

// The first triangle that a ray hits, and where: kNoId and infinity if there is
// none.
struct MeshHit {
  std::uint32_t id;
  float t;
};

// The triangle that is closest to a point, its distance, and the closest point
// on it: kNoId, infinity and NaN if there is none.
struct MeshPoint {
  std::uint32_t id;
  float distance;
  Point<3> point;
};

namespace detail {

struct MeshState;
// Returns the new limit of t. A negative one ends the search.
using MeshHitFunction = float (*)(void* context, std::uint32_t id, float t);

}  // namespace detail

class HALFSPACE_API TriangleMesh {
 public:
  // An empty mesh, in which queries find nothing.
  TriangleMesh() = default;

  // Triangle i has the vertices indices[3 * i], indices[3 * i + 1] and
  // indices[3 * i + 2]. `indices.size()` must be a multiple of 3, each index
  // less than `vertices.size()`, and the number of triangles less than 2^27.
  //
  // Cost: O(n log(n)), about 0.5 us a triangle, and 60 to 80 bytes a triangle.
  TriangleMesh(Span<const Point<3>> vertices, Span<const std::uint32_t> indices,
               const MemoryResource& memory = {});
  explicit TriangleMesh(Span<const Triangle<3>> triangles,
                        const MemoryResource& memory = {});

  TriangleMesh(TriangleMesh&& other) noexcept : state_(other.state_) {
    other.state_ = nullptr;
  }
  TriangleMesh& operator=(TriangleMesh&& other) noexcept {
    detail::MeshState* const its = other.state_;
    other.state_ = state_;
    state_ = its;
    return *this;
  }
  ~TriangleMesh();

  // The number of triangles, also of those with a NaN or an infinity.
  [[nodiscard]] std::size_t size() const;
  // The size of the memory that it owns.
  [[nodiscard]] std::size_t bytes() const;

  // Writes the first hit of each ray: the one with the least t, and of those
  // the one with the least id. `hits.size()` must be `rays.size()`.
  void FirstHits(Span<const Ray<3>> rays, Span<MeshHit> hits,
                 Target target = {}) const;
  [[nodiscard]] MeshHit FirstHit(const Ray<3>& ray) const {
    MeshHit hit;
    FirstHits({&ray, 1}, {&hit, 1});
    return hit;
  }

  // Writes whether each ray hits a triangle: a search that ends at any hit.
  // `is_hit.size()` must be `rays.size()`.
  void Occluded(Span<const Ray<3>> rays, Span<bool> is_hit,
                Target target = {}) const;
  [[nodiscard]] bool Occluded(const Ray<3>& ray) const {
    bool is_hit = false;
    Occluded({&ray, 1}, {&is_hit, 1});
    return is_hit;
  }

  // Calls function(std::uint32_t id, float t) for each triangle that the ray
  // hits, near ones first, but not sorted. The function returns nothing, a
  // Visit, or a Limit of t (visit.h). Its exceptions pass through. It runs in
  // the caller's floating-point mode.
  template <typename Function>
  void ForEachHit(const Ray<3>& ray, Function&& function,
                  Target target = {}) const {
    detail::Callback call{function};
    CallForHits(ray, &decltype(call)::template Run<float, std::uint32_t, float>,
                &call, target);
  }

  // Writes the triangle that is closest to each point and within
  // `max_distance`: of those with the least distance, as ClosestPoint() returns
  // it, the one with the least id. `results.size()` must be `points.size()`.
  void ClosestPoints(
      Span<const Point<3>> points, Span<MeshPoint> results,
      float max_distance = std::numeric_limits<float>::infinity(),
      Target target = {}) const;
  [[nodiscard]] MeshPoint ClosestPoint(
      const Point<3>& point,
      float max_distance = std::numeric_limits<float>::infinity()) const {
    MeshPoint result;
    ClosestPoints({&point, 1}, {&result, 1}, max_distance);
    return result;
  }

 private:
  void CallForHits(const Ray<3>& ray, detail::MeshHitFunction function,
                   void* context, Target target) const;

  detail::MeshState* state_ = nullptr;
};

}  // namespace halfspace

#endif  // HALFSPACE_MESH_H_

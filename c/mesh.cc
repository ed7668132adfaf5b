// hs_mesh_...().
#include "halfspace/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "c/call.h"
#include "c/columns.h"

using halfspace::Limit;
using halfspace::MemoryResource;
using halfspace::MeshHit;
using halfspace::MeshPoint;
using halfspace::Point;
using halfspace::Ray;
using halfspace::Span;
using halfspace::Target;
using halfspace::c::Call;
using halfspace::c::CheckColumns;
using halfspace::c::CheckFloats;
using halfspace::c::ForEachRows;
using halfspace::c::kMostRows;
using halfspace::c::ReadTarget;
using halfspace::c::Run;
using halfspace::c::Values;

struct hs_mesh {
  hs_mesh(const MemoryResource& its_memory, Span<const Point<3>> vertices,
          Span<const std::uint32_t> indices)
      : memory(its_memory), mesh(vertices, indices, its_memory) {}
  hs_mesh(const MemoryResource& its_memory,
          Span<const halfspace::Triangle<3>> triangles)
      : memory(its_memory), mesh(triangles, its_memory) {}

  const MemoryResource memory;
  const halfspace::TriangleMesh mesh;
};

namespace halfspace::c {
namespace {

// Calls run(rays, begin) for up to 256 rays at a time.
template <typename Function>
void ForEachRays(const Call& call, const hs_mesh* mesh, const hs_columns* rays,
                 const Function& run) {
  static_assert(sizeof(Ray<3>) == 7 * sizeof(float));
  call.CheckPointer("mesh", mesh);
  const Values values = Values::OfColumns(7);
  CheckColumns(call, "rays", rays, values);
  CheckFloats(call, "rays", *rays);
  ForEachRows(
      *rays, values,
      [&](const float* rows, std::size_t begin, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
          CheckNotNegative(call, "rays", 6, "limits of t", "ray", begin + i,
                           rows[7 * i + 6]);
        }
        run(Span<const Ray<3>>(reinterpret_cast<const Ray<3>*>(rows), count),
            begin);
      });
}

}  // namespace
}  // namespace halfspace::c

hs_status hs_mesh_create(const hs_columns* vertices, const uint32_t* indices,
                         size_t faces, const hs_allocator* allocator,
                         hs_mesh** mesh) {
  return Run("hs_mesh_create", [&](const Call& call) {
    constexpr std::size_t kCorners = 3;
    const Values values = Values::OfColumns(3);
    CheckColumns(call, "vertices", vertices, values);
    CheckFloats(call, "vertices", *vertices);
    call.CheckPointer("mesh", mesh);
    MemoryResource memory;
    if (allocator != nullptr) {
      call.CheckPointer("allocator", allocator);
      memory = halfspace::c::ReadAllocator(call, *allocator, "allocator");
    }
    if (indices != nullptr) {
      call.CheckArray("indices", indices, kCorners * faces);
    } else if (faces > vertices->count / kCorners) {
      call.Fail(HS_INVALID_ARGUMENT, "faces",
                "expected at most a third of the %zu vertices, got %zu",
                vertices->count, faces);
    }
    const halfspace::c::AllRows rows(*vertices, values, memory);
    const auto* const points =
        reinterpret_cast<const Point<3>*>(rows.floats().data());
    *mesh =
        indices != nullptr
            ? halfspace::c::New<hs_mesh>(
                  memory, memory, Span<const Point<3>>(points, vertices->count),
                  Span<const std::uint32_t>(indices, kCorners * faces))
            : halfspace::c::New<hs_mesh>(
                  memory, memory,
                  Span<const halfspace::Triangle<3>>(
                      reinterpret_cast<const halfspace::Triangle<3>*>(points),
                      faces));
  });
}

void hs_mesh_destroy(hs_mesh* mesh) {
  if (mesh != nullptr) halfspace::c::Delete(mesh->memory, mesh);
}

hs_status hs_mesh_raycast(const hs_mesh* mesh, const hs_columns* rays,
                          const char* target, uint32_t* ids, float* ts) {
  return Run("hs_mesh_raycast", [&](const Call& call) {
    call.CheckPointer("rays", rays);
    call.CheckArray("ids", ids, rays->count);
    if (ts != nullptr) call.CheckPointer("ts", ts);
    const Target its_target = ReadTarget(call, nullptr, target);
    halfspace::c::ForEachRays(
        call, mesh, rays, [&](Span<const Ray<3>> some, std::size_t begin) {
          std::array<MeshHit, kMostRows> hits;
          mesh->mesh.FirstHits(some, {hits.data(), some.size()}, its_target);
          for (std::size_t i = 0; i < some.size(); ++i) {
            ids[begin + i] = hits[i].id;
            if (ts != nullptr) ts[begin + i] = hits[i].t;
          }
        });
  });
}

hs_status hs_mesh_occluded(const hs_mesh* mesh, const hs_columns* rays,
                           const char* target, uint8_t* is_hit) {
  return Run("hs_mesh_occluded", [&](const Call& call) {
    call.CheckPointer("rays", rays);
    call.CheckArray("is_hit", is_hit, rays->count);
    const Target its_target = ReadTarget(call, nullptr, target);
    halfspace::c::ForEachRays(
        call, mesh, rays, [&](Span<const Ray<3>> some, std::size_t begin) {
          std::array<bool, kMostRows> are_hit;
          mesh->mesh.Occluded(some, {are_hit.data(), some.size()}, its_target);
          for (std::size_t i = 0; i < some.size(); ++i) {
            is_hit[begin + i] = are_hit[i] ? 1 : 0;
          }
        });
  });
}

hs_status hs_mesh_raycast_each(const hs_mesh* mesh, const hs_columns* rays,
                               const char* target, hs_hit_function function,
                               void* context) {
  return Run("hs_mesh_raycast_each", [&](const Call& call) {
    call.CheckPointer("function", function);
    const Target its_target = ReadTarget(call, nullptr, target);
    halfspace::c::ForEachRays(
        call, mesh, rays, [&](Span<const Ray<3>> some, std::size_t begin) {
          for (std::size_t i = 0; i < some.size(); ++i) {
            mesh->mesh.ForEachHit(
                some[i],
                [&](std::uint32_t id, float t) {
                  return Limit{function(context, begin + i, id, t)};
                },
                its_target);
          }
        });
  });
}

hs_status hs_mesh_closest_points(const hs_mesh* mesh, const hs_columns* points,
                                 float max_distance, const char* target,
                                 uint32_t* ids, float* closest,
                                 float* distances) {
  return Run("hs_mesh_closest_points", [&](const Call& call) {
    call.CheckPointer("mesh", mesh);
    const Values values = Values::OfColumns(3);
    CheckColumns(call, "points", points, values);
    CheckFloats(call, "points", *points);
    call.CheckArray("ids", ids, points->count);
    if (closest != nullptr) {
      call.CheckArray("closest", closest, 3 * points->count);
    }
    if (distances != nullptr) call.CheckPointer("distances", distances);
    const Target its_target = ReadTarget(call, nullptr, target);
    ForEachRows(*points, values,
                [&](const float* rows, std::size_t begin, std::size_t count) {
                  std::array<MeshPoint, kMostRows> found;
                  mesh->mesh.ClosestPoints(
                      {reinterpret_cast<const Point<3>*>(rows), count},
                      {found.data(), count}, max_distance, its_target);
                  for (std::size_t i = 0; i < count; ++i) {
                    ids[begin + i] = found[i].id;
                    if (distances != nullptr)
                      distances[begin + i] = found[i].distance;
                    if (closest != nullptr) {
                      std::copy_n(found[i].point.data(), 3,
                                  closest + 3 * (begin + i));
                    }
                  }
                });
  });
}

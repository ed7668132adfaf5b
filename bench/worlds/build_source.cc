#include "bench/worlds/build_source.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "bench/base/aligned_vector.h"
#include "bench/inner/target_loops.h"
#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

// Vertices lie in rows of this many, two triangles between four of them.
constexpr std::size_t kRow = 64;

// As many objects as move about `bytes`, in steps that copiers can do.
std::size_t ObjectsFor(std::size_t bytes, std::size_t bytes_per_object) {
  return std::max(kCopyObjects,
                  bytes / bytes_per_object / kCopyObjects * kCopyObjects);
}

// Adds an array that describes all objects, which a copy reads.
template <typename T>
void Read(BuildSource& source, const T* begin, std::size_t count) {
  source.copy.reads.push_back({reinterpret_cast<const unsigned char*>(begin),
                               count * sizeof(T) / source.objects});
}

BuildSource SourceOf(std::string shapes, std::size_t objects) {
  BuildSource source;
  source.shapes = std::move(shapes);
  source.planes = "aabo";
  source.objects = objects;
  source.copy.objects = objects;
  source.built = std::make_shared<AaboWorld3>();
  source.built->Resize(objects);
  const AaboPlanes3 planes = source.built->planes();
  for (const auto& all : {planes.min, planes.max}) {
    for (float* plane : all) {
      source.copy.writes.push_back(
          {reinterpret_cast<unsigned char*>(plane), sizeof(float)});
    }
  }
  return source;
}

Aabb3 BoxOf(const Workload& workload, std::size_t i) {
  return workload.objects.Get(i % workload.objects.size()).aabb();
}

Point<3> MiddleOf(const Aabb3& box) {
  Point<3> middle;
  for (std::size_t k = 0; k < 3; ++k) {
    middle[k] = 0.5f * box.min[k] + 0.5f * box.max[k];
  }
  return middle;
}

BuildSource MakeBoxes(const Workload& workload, std::size_t bytes) {
  BuildSource source = SourceOf("boxes", ObjectsFor(bytes, 24 + 32));
  auto boxes = std::make_shared<AabbWorld3>();
  boxes->Reserve(source.objects);
  for (std::size_t i = 0; i < source.objects; ++i) {
    boxes->Push(BoxOf(workload, i));
  }
  const AabbView3 view = boxes->view();
  for (const float* plane : view.min) Read(source, plane, view.size);
  for (const float* plane : view.max) Read(source, plane, view.size);
  source.build = [boxes, built = source.built](const FitOptions& options,
                                               FitStatus* status) {
    return BoundBoxes(BoxesOf(boxes->view()), built->planes(), options, status);
  };
  source.single = [boxes](std::size_t i) { return BoundAabb(boxes->Get(i)); };
  return source;
}

// The spheres within the boxes' longest sides. Their planes, the center's and
// the radius', are a SimplexWorld's, for its alignment.
BuildSource MakeSpheres(const Workload& workload, std::size_t bytes) {
  BuildSource source = SourceOf("spheres", ObjectsFor(bytes, 16 + 32));
  auto columns = std::make_shared<SimplexWorld3>();
  columns->Reserve(source.objects);
  for (std::size_t i = 0; i < source.objects; ++i) {
    const Aabb3 box = BoxOf(workload, i);
    const Point<3> center = MiddleOf(box);
    float radius = 0.0f;
    for (std::size_t k = 0; k < 3; ++k) {
      radius = std::max(radius, box.max[k] - center[k]);
    }
    columns->Push(UpSimplex3{{center[0], center[1], center[2], radius}});
  }
  const SimplexView3 view = columns->view();
  for (const float* plane : view.min) Read(source, plane, view.size);
  source.build = [columns, built = source.built](const FitOptions& options,
                                                 FitStatus* status) {
    const SimplexView3 all = columns->view();
    const Spheres<3> spheres{
        {all.min[0], all.min[1], all.min[2]}, all.min[3], all.size, 1};
    return BoundSpheres(spheres, built->planes(), options, status);
  };
  source.single = [columns](std::size_t i) {
    const UpSimplex3 s = columns->Get(i);
    return BoundSphere(Sphere3{{s.min[0], s.min[1], s.min[2]}, s.min[3]});
  };
  return source;
}

struct Triangles {
  AlignedVector<float> coords;           // vertex i: x, y, z from 3 * i on
  AlignedVector<std::uint32_t> indices;  // triangle t: 3 from 3 * t on

  Points3 vertices() const { return {coords.data(), coords.size() / 3}; }
};

// A grid, which has half as many vertices as triangles, as closed meshes do.
BuildSource MakeTriangles(const Workload& workload, std::size_t bytes) {
  BuildSource source = SourceOf("triangles", ObjectsFor(bytes, 12 + 6 + 32));
  auto mesh = std::make_shared<Triangles>();
  const std::size_t vertices = source.objects / 2;
  for (std::size_t v = 0; v < vertices; ++v) {
    for (float coord : MiddleOf(BoxOf(workload, v))) {
      mesh->coords.push_back(coord);
    }
  }
  const auto add = [&](std::size_t vertex) {
    mesh->indices.push_back(static_cast<std::uint32_t>(vertex % vertices));
  };
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t corner : {v, v + 1, v + kRow}) add(corner);
    for (std::size_t corner : {v + 1, v + kRow, v + kRow + 1}) add(corner);
  }
  Read(source, mesh->indices.data(), mesh->indices.size());
  Read(source, mesh->coords.data(), mesh->coords.size());
  source.build = [mesh, built = source.built](const FitOptions& options,
                                              FitStatus* status) {
    return BoundTriangles(mesh->vertices(), mesh->indices, built->planes(),
                          options, status);
  };
  source.single = [mesh](std::size_t i) {
    return BoundPoints(mesh->vertices(), std::span<const std::uint32_t>(
                                             &mesh->indices[3 * i], 3));
  };
  return source;
}

constexpr std::size_t kChecked = 64;

std::string WrongBound(const Aabo3& built, const Aabo3& single) {
  if (!(built.aabb() == single.aabb())) {
    return "X, Y or Z is not that of the builder of one shape";
  }
  const bool encloses = built.min[kDAxis] <= single.min[kDAxis] &&
                        built.max[kDAxis] >= single.max[kDAxis];
  return encloses ? "" : "D does not enclose that of the builder of one shape";
}

}  // namespace

BuildSource MakeBuildSource(BuildKind kind, const Workload& workload,
                            std::size_t bytes) {
  switch (kind) {
    case BuildKind::kBoxes:
      return MakeBoxes(workload, bytes);
    case BuildKind::kSpheres:
      return MakeSpheres(workload, bytes);
    case BuildKind::kTriangles:
      break;
  }
  return MakeTriangles(workload, bytes);
}

std::string CheckBuild(const BuildSource& source, const FitOptions& options) {
  // What is looked at afterwards must have been written.
  const AaboPlanes3 planes = source.built->planes();
  const std::size_t step = std::max<std::size_t>(1, source.objects / kChecked);
  for (std::size_t i = 0; i < source.objects; i += step) {
    for (std::size_t k = 0; k <= kDAxis; ++k) {
      planes.min[k][i] = std::numeric_limits<float>::quiet_NaN();
      planes.max[k][i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const Target ran = source.build(options, nullptr);
  if (ran != options.target) return "another target ran";
  for (std::size_t i = 0; i < source.objects; i += step) {
    const std::string wrong =
        WrongBound(source.built->Get(i), source.single(i));
    if (!wrong.empty()) return "object " + std::to_string(i) + ": " + wrong;
  }
  return {};
}

}  // namespace halfspace::bench

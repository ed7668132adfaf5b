#include "bench/input/gltf_reader.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "bench/input/gltf_accessor.h"
#include "bench/input/gltf_buffers.h"
#include "bench/input/gltf_document.h"
#include "bench/input/gltf_nodes.h"
#include "bench/input/input_error.h"

namespace halfspace::bench {
namespace {

enum class Mode { kList = 4, kStrip = 5, kFan = 6 };

struct Primitive {
  GltfValue value;
  Mode mode;
  std::size_t positions;  // of the mesh's
  std::optional<GltfAccessor> indices;
  std::size_t corners;

  std::size_t triangles() const {
    return mode == Mode::kList ? corners / 3 : corners - 2;
  }

  // Which of the corners triangle t has, in the order of the specification.
  std::array<std::size_t, 3> CornersOf(std::size_t t) const {
    if (mode == Mode::kList) return {3 * t, 3 * t + 1, 3 * t + 2};
    if (mode == Mode::kFan) return {0, t + 1, t + 2};
    return {t, t + 1 + t % 2, t + 2 - t % 2};
  }
};

// What is the same for all instances of a mesh. Primitives often share their
// positions.
struct Part {
  std::vector<GltfAccessor> positions;
  std::vector<Primitive> primitives;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
};

class SceneReader {
 public:
  SceneReader(const std::string& path, std::string content,
              const MeshLimits& limits)
      : document_(path, std::move(content)),
        buffers_(document_, limits.buffer_bytes),
        limits_(limits) {}

  Mesh Read() {
    const std::vector<GltfInstance> instances = MeshInstances(document_);
    std::size_t vertices = 0;
    std::size_t triangles = 0;
    for (const GltfInstance& instance : instances) {
      const Part& part = PartOf(instance.mesh);
      vertices += part.vertices;
      triangles += part.triangles;
      CheckLimit(vertices, limits_.vertices, "vertices");
      CheckLimit(triangles, limits_.triangles, "triangles");
    }
    if (triangles == 0) {
      document_.root().Fail("has no triangle in its scene",
                            "export a scene with meshes");
    }
    mesh_.coords.reserve(3 * vertices);
    mesh_.indices.reserve(3 * triangles);
    for (const GltfInstance& instance : instances) Add(instance);
    return std::move(mesh_);
  }

 private:
  void CheckLimit(std::size_t count, std::size_t limit,
                  const std::string& what) const {
    if (count <= limit) return;
    throw InputError(document_.path(),
                     "the scene has more than " + std::to_string(limit) + " " +
                         what + ", those of all instances together",
                     "split it into several files");
  }

  const Part& PartOf(std::size_t mesh) {
    const auto [known, is_new] = parts_.try_emplace(mesh);
    Part& part = known->second;
    if (!is_new) return part;
    const GltfValue primitives =
        document_.root().At("meshes").At(mesh).At("primitives");
    std::map<std::uint64_t, std::size_t> known_positions;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      AddPrimitive(primitives.At(i), part, known_positions);
    }
    for (const GltfAccessor& each : part.positions) {
      part.vertices += each.count();
    }
    for (const Primitive& each : part.primitives) {
      part.triangles += each.triangles();
    }
    return part;
  }

  void AddPrimitive(const GltfValue& primitive, Part& part,
                    std::map<std::uint64_t, std::size_t>& known_positions) {
    const std::uint64_t mode =
        primitive.Whole("mode", static_cast<std::uint64_t>(Mode::kList));
    if (mode > static_cast<std::uint64_t>(Mode::kFan)) {
      primitive.At("mode").Fail("is " + std::to_string(mode) +
                                ", which is no mode");
    }
    if (mode < static_cast<std::uint64_t>(Mode::kList)) return;
    const GltfValue position = primitive.At("attributes").At("POSITION");
    const auto [known, is_new] =
        known_positions.try_emplace(position.Whole(), part.positions.size());
    if (is_new) {
      part.positions.push_back(Accessor(position, GltfKind::kPositions));
    }
    Primitive added = {primitive, static_cast<Mode>(mode), known->second,
                       std::nullopt, part.positions[known->second].count()};
    if (primitive.Has("indices")) {
      added.indices = Accessor(primitive.At("indices"), GltfKind::kIndices);
      added.corners = added.indices->count();
    }
    if (added.corners < 3 ||
        (added.mode == Mode::kList && added.corners % 3 != 0)) {
      primitive.Fail("has " + std::to_string(added.corners) +
                     " corners, which make no whole triangles");
    }
    part.primitives.push_back(std::move(added));
  }

  GltfAccessor Accessor(const GltfValue& index, GltfKind kind) {
    return {document_, buffers_, document_.Refer(index, "accessors"), kind};
  }

  void Add(const GltfInstance& instance) {
    const Part& part = PartOf(instance.mesh);
    std::vector<std::size_t> first_vertices;
    for (const GltfAccessor& positions : part.positions) {
      first_vertices.push_back(mesh_.vertices());
      AddVertices(positions.Values(), instance);
    }
    for (const Primitive& primitive : part.primitives) {
      AddTriangles(primitive, first_vertices[primitive.positions],
                   part.positions[primitive.positions].count());
    }
  }

  void AddVertices(const std::vector<double>& positions,
                   const GltfInstance& instance) {
    for (std::size_t i = 0; i < positions.size(); i += 3) {
      for (const std::array<double, 4>& row : instance.to_scene) {
        const double sum = row[0] * positions[i] + row[1] * positions[i + 1] +
                           row[2] * positions[i + 2] + row[3];
        // Not by way of a float: what is beyond its range may become anything.
        if (!(std::abs(sum) <= std::numeric_limits<float>::max())) {
          throw InputError(document_.path(),
                           "a vertex of meshes[" +
                               std::to_string(instance.mesh) +
                               "] is, where its node moves it, too large for a "
                               "32-bit float",
                           "scale the coordinates down");
        }
        mesh_.coords.push_back(static_cast<float>(sum));
      }
    }
  }

  void AddTriangles(const Primitive& primitive, std::size_t first_vertex,
                    std::size_t vertices) {
    std::vector<double> indices;
    if (primitive.indices) indices = primitive.indices->Values();
    for (std::size_t t = 0; t < primitive.triangles(); ++t) {
      for (const std::size_t corner : primitive.CornersOf(t)) {
        const auto vertex = primitive.indices
                                ? static_cast<std::size_t>(indices[corner])
                                : corner;
        if (vertex >= vertices) {
          primitive.value.Fail("has the index " + std::to_string(vertex) +
                               ", and " + std::to_string(vertices) +
                               " vertices");
        }
        mesh_.indices.push_back(
            static_cast<std::uint32_t>(first_vertex + vertex));
      }
    }
  }

  GltfDocument document_;
  GltfBuffers buffers_;
  MeshLimits limits_;
  std::map<std::size_t, Part> parts_;  // of the meshes that are instanced
  Mesh mesh_;
};

}  // namespace

Mesh ReadGltf(const std::string& path, std::string content,
              const MeshLimits& limits) {
  return SceneReader(path, std::move(content), limits).Read();
}

}  // namespace halfspace::bench

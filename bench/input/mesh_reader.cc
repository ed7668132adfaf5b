#include "bench/input/mesh_reader.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "bench/input/input_file.h"
#include "bench/input/text_lines.h"

#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

namespace halfspace::bench {
namespace {

constexpr const char* kAdvice =
    "give an OBJ file with v and f lines; assimp converts other formats";

// tinyobjloader reads a number that it does not understand as 0, which would
// move triangles.
void CheckNumbers(const std::string& path, const std::string& text) {
  TextLines lines(path, text);
  while (const std::optional<std::string_view> line = lines.Next()) {
    std::string_view rest = SkipBlanks(*line);
    if (rest.size() < 2 || rest[0] != 'v' || !IsBlank(rest[1])) continue;
    std::size_t count = 0;
    rest = SkipBlanks(rest.substr(1));
    while (!rest.empty() && rest.front() != '#') {
      const std::string_view field = rest.substr(0, rest.find_first_of(" \t"));
      ParseFloat(lines, field);
      rest = SkipBlanks(rest.substr(field.size()));
      ++count;
    }
    if (count < 3) {
      lines.Fail("a vertex with " + std::to_string(count) + " numbers",
                 "write v x y z");
    }
  }
}

class MeshBuilder {
 public:
  MeshBuilder(const std::string& path, const MeshLimits& limits)
      : path_(path), limits_(limits) {}

  void AddVertex(float x, float y, float z) {
    if (mesh_.vertices() == limits_.vertices) {
      Fail("more than " + std::to_string(limits_.vertices) + " vertices",
           "split the mesh into several files");
    }
    mesh_.coords.insert(mesh_.coords.end(), {x, y, z});
  }

  void AddFace(const tinyobj::index_t* corners, int count) {
    ++faces_;
    if (count < 3) FailAtFace("has fewer than 3 corners", "write f 1 2 3");
    const auto most = static_cast<std::uint32_t>(count - 2);
    if (most > limits_.triangles - mesh_.triangles()) {
      Fail("more than " + std::to_string(limits_.triangles) + " triangles",
           "split the mesh into several files");
    }
    const std::uint32_t first = VertexOf(corners[0]);
    std::uint32_t previous = VertexOf(corners[1]);
    for (int i = 2; i < count; ++i) {
      const std::uint32_t next = VertexOf(corners[i]);
      mesh_.indices.insert(mesh_.indices.end(), {first, previous, next});
      previous = next;
    }
  }

  // A face may name a vertex that comes after it.
  Mesh Take() {
    if (mesh_.vertices() == 0) Fail("the file has no vertex", kAdvice);
    if (mesh_.triangles() == 0) Fail("the file has no face", kAdvice);
    if (largest_ >= mesh_.vertices()) {
      Fail("a face names vertex " + std::to_string(largest_ + 1) +
               ", and the file has " + std::to_string(mesh_.vertices()),
           "name a vertex of this file, it may be truncated");
    }
    return std::move(mesh_);
  }

 private:
  // OBJ counts from 1, or back from -1, the last vertex so far.
  std::uint32_t VertexOf(const tinyobj::index_t& corner) {
    const std::int64_t vertex = corner.vertex_index;
    const auto known = static_cast<std::int64_t>(mesh_.vertices());
    if (vertex == 0) {
      FailAtFace("has a corner that is no number of a vertex",
                 "write v, v/vt, v//vn or v/vt/vn, counted from 1");
    }
    if (vertex < -known) {
      FailAtFace("counts back " + std::to_string(-vertex) + " vertices, and " +
                     std::to_string(known) + " come before it",
                 "count back from -1, the last vertex before the face");
    }
    const auto index =
        static_cast<std::uint32_t>(vertex < 0 ? known + vertex : vertex - 1);
    largest_ = std::max(largest_, index);
    return index;
  }

  [[noreturn]] void Fail(const std::string& problem,
                         const std::string& advice) const {
    throw InputError(path_, problem, advice);
  }
  [[noreturn]] void FailAtFace(const std::string& problem,
                               const std::string& advice) const {
    Fail("face " + std::to_string(faces_) + " " + problem, advice);
  }

  const std::string& path_;
  MeshLimits limits_;
  Mesh mesh_;
  std::size_t faces_ = 0;
  std::uint32_t largest_ = 0;
};

}  // namespace

Mesh ReadMesh(const std::string& path, const MeshLimits& limits) {
  std::string text = ReadText(path);
  CheckNumbers(path, text);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  std::istringstream stream(std::move(text));
  MeshBuilder builder(path, limits);
  tinyobj::callback_t calls;
  calls.vertex_cb = [](void* data, float x, float y, float z, float /*w*/) {
    static_cast<MeshBuilder*>(data)->AddVertex(x, y, z);
  };
  calls.index_cb = [](void* data, tinyobj::index_t* corners, int count) {
    static_cast<MeshBuilder*>(data)->AddFace(corners, count);
  };
  tinyobj::LoadObjWithCallback(stream, calls, &builder);
  return builder.Take();
}

}  // namespace halfspace::bench

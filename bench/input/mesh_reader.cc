#include "bench/input/mesh_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "bench/input/text_lines.h"

namespace halfspace::bench {
namespace {

constexpr const char* kObjAdvice =
    "give an OBJ file with v and f lines; assimp converts other formats";

// Removes the first field from `rest` and returns it; nothing at the end of the
// line, or at a comment.
std::optional<std::string_view> NextField(std::string_view& rest) {
  rest = SkipBlanks(rest);
  if (rest.empty() || rest.front() == '#') return std::nullopt;
  const std::string_view field = rest.substr(0, rest.find_first_of(" \t"));
  rest.remove_prefix(field.size());
  return field;
}

class ObjReader {
 public:
  ObjReader(const std::string& path, const MeshLimits& limits)
      : lines_(path, ReadText(path)), limits_(limits) {}

  Mesh Read() {
    while (const std::optional<std::string_view> line = lines_.Next()) {
      std::string_view rest = *line;
      const std::optional<std::string_view> word = NextField(rest);
      if (word == "v") AddVertex(rest);
      if (word == "f") AddFace(rest);
    }
    if (mesh_.vertices() == 0)
      lines_.Fail("the file has no vertex", kObjAdvice);
    if (mesh_.triangles() == 0) lines_.Fail("the file has no face", kObjAdvice);
    // A face may name a vertex that comes after it.
    if (largest_ >= mesh_.vertices()) {
      lines_.FailAt(line_of_largest_,
                    "a face names vertex " + std::to_string(largest_ + 1) +
                        ", and the file has " +
                        std::to_string(mesh_.vertices()),
                    "name a vertex of this file, it may be truncated");
    }
    return std::move(mesh_);
  }

 private:
  // x, y and z. A weight and colours can follow.
  void AddVertex(std::string_view rest) {
    if (mesh_.vertices() == limits_.vertices) {
      FailAtLimit(limits_.vertices, "vertices");
    }
    std::size_t count = 0;
    while (const std::optional<std::string_view> field = NextField(rest)) {
      const float number = ParseFloat(lines_, *field);
      if (count++ < 3) mesh_.coords.push_back(number);
    }
    if (count < 3) {
      lines_.Fail("a vertex with " + std::to_string(count) + " numbers",
                  "write v x y z");
    }
  }

  void AddFace(std::string_view rest) {
    std::array<std::uint32_t, 3> fan = {};
    std::size_t count = 0;
    while (const std::optional<std::string_view> field = NextField(rest)) {
      fan[std::min<std::size_t>(count++, 2)] = VertexOf(*field);
      if (count < 3) continue;
      if (mesh_.triangles() == limits_.triangles) {
        FailAtLimit(limits_.triangles, "triangles");
      }
      mesh_.indices.insert(mesh_.indices.end(), fan.begin(), fan.end());
      fan[1] = fan[2];
    }
    if (count < 3) {
      lines_.Fail("a face with " + std::to_string(count) + " corners",
                  "write f 1 2 3");
    }
  }

  // OBJ counts from 1, or back from -1, the last vertex so far.
  std::uint32_t VertexOf(std::string_view corner) {
    const char* const end = corner.data() + corner.size();
    std::int64_t vertex = 0;
    const auto [stop, error] = std::from_chars(corner.data(), end, vertex);
    const std::string_view others(stop, static_cast<std::size_t>(end - stop));
    const bool is_corner =
        error == std::errc() && vertex != 0 &&
        (others.empty() || others.front() == '/') &&
        others.find_first_not_of("/-0123456789") == std::string_view::npos &&
        std::count(others.begin(), others.end(), '/') <= 2;
    if (!is_corner) {
      lines_.Fail("the corner " + Quoted(corner) + " has no number of a vertex",
                  "write v, v/vt, v//vn or v/vt/vn, counted from 1");
    }
    const std::size_t known = mesh_.vertices();
    if (vertex < -static_cast<std::int64_t>(known)) {
      lines_.Fail("a face counts back " + std::to_string(vertex).substr(1) +
                      " vertices, and " + std::to_string(known) +
                      " come before it",
                  "count back from -1, the last vertex before the face");
    }
    const std::uint64_t index =
        vertex < 0 ? known - static_cast<std::uint64_t>(-vertex)
                   : static_cast<std::uint64_t>(vertex) - 1;
    if (index >= largest_) {
      largest_ = index;
      line_of_largest_ = lines_.number();
    }
    // Read() fails if it does not fit.
    return static_cast<std::uint32_t>(index);
  }

  [[noreturn]] void FailAtLimit(std::uint32_t limit, const char* of) const {
    lines_.Fail("more than " + std::to_string(limit) + " " + of,
                "split the mesh into several files");
  }

  TextLines lines_;
  MeshLimits limits_;
  Mesh mesh_;
  std::uint64_t largest_ = 0;
  std::size_t line_of_largest_ = 0;
};

}  // namespace

Mesh ReadMesh(const std::string& path, const MeshLimits& limits) {
  return ObjReader(path, limits).Read();
}

}  // namespace halfspace::bench

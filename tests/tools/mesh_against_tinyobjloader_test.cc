// On good files the mesh reader gives the points and polygons that
// tinyobjloader gives.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "bench/input/mesh_reader.h"
#include "tests/tools/temp_file.h"

#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

namespace halfspace::bench {
namespace {

// Writes good files, in every form that both readers know.
class ObjWriter {
 public:
  explicit ObjWriter(std::uint32_t seed) : random_(seed) {}

  std::string Write() {
    for (int part = 0; part < 20; ++part) {
      AddStatementsToSkip(part);
      for (std::size_t i = 1 + Below(20); i != 0; --i) AddVertex();
      AddFace(3 + Below(253));  // tinyobjloader counts corners in one byte
      for (std::size_t i = Below(20); i != 0; --i) AddFace(3 + Below(3));
    }
    return text_;
  }

 private:
  std::size_t Below(std::size_t bound) { return random_() % bound; }
  std::string Integer(std::size_t value) { return std::to_string(value); }
  void EndLine() { text_ += Below(2) == 0 ? "\n" : " \r\n"; }

  void AddStatementsToSkip(int part) {
    text_ += "# part\n\ng part" + std::to_string(part) + "\nusemtl red";
    EndLine();
    text_ += "vt 0.5 0.5\nvn 0 0 1\n";
    ++parts_;
  }

  // Eighths of small numbers: tinyobjloader, which rounds more than once, gets
  // them right.
  std::string Coordinate() {
    std::string text = Below(2) == 0 ? "-" : "";
    text += Integer(Below(1000));
    text.append(".").append(Integer(125 * Below(8)));
    if (Below(4) == 0) text += Below(2) == 0 ? "e2" : "e-2";
    return text;
  }

  void AddVertex() {
    text_ += Below(4) == 0 ? "\tv" : "v";
    for (int k = 0; k < 3; ++k) {
      text_ += Below(4) == 0 ? "\t " : " ";
      text_ += Coordinate();
    }
    const std::array<const char*, 3> kExtras = {"", " 1.0", " 0.25 0.5 0.75"};
    text_ += kExtras[Below(kExtras.size())];
    EndLine();
    ++vertices_;
  }

  void AddFace(std::size_t corners) {
    const std::size_t form = Below(4);
    text_ += "f";
    for (std::size_t i = 0; i < corners; ++i) {
      text_.append(" ").append(Vertex());
      if (form == 1 || form == 3) {
        text_.append("/").append(Integer(1 + Below(parts_)));
      }
      if (form == 2) text_.append("//").append(Integer(1 + Below(parts_)));
      if (form == 3) text_ += "/-1";
    }
    EndLine();
  }

  std::string Vertex() {
    const std::size_t number = 1 + Below(vertices_);
    return std::string(Below(2) == 0 ? "" : "-").append(Integer(number));
  }

  std::mt19937 random_;
  std::string text_;
  std::size_t vertices_ = 0;
  std::size_t parts_ = 0;
};

void AppendFans(const tinyobj::mesh_t& polygons,
                std::vector<std::uint32_t>& triangles) {
  std::size_t first = 0;
  const auto vertex = [&](std::size_t corner) {
    return static_cast<std::uint32_t>(
        polygons.indices[first + corner].vertex_index);
  };
  for (const std::size_t corners : polygons.num_face_vertices) {
    for (std::size_t i = 2; i < corners; ++i) {
      triangles.insert(triangles.end(), {vertex(0), vertex(i - 1), vertex(i)});
    }
    first += corners;
  }
}

Mesh ReadWithTinyobjloader(const std::string& text) {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning;
  std::string error;
  std::istringstream stream(text);
  EXPECT_TRUE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning,
                               &error, &stream, /*readMatFn=*/nullptr,
                               /*triangulate=*/false))
      << error;
  Mesh mesh;
  mesh.coords = attributes.vertices;
  for (const tinyobj::shape_t& shape : shapes) {
    AppendFans(shape.mesh, mesh.indices);
  }
  return mesh;
}

class AgainstTinyobjloader : public testing::TestWithParam<std::uint32_t> {};

TEST_P(AgainstTinyobjloader, SamePointsAndPolygons) {
  const std::string text = ObjWriter(GetParam()).Write();
  const Mesh expected = ReadWithTinyobjloader(text);
  const Mesh mesh = ReadMesh(TempFile(text).path());
  ASSERT_GT(expected.triangles(), 20u);
  EXPECT_EQ(mesh.coords, expected.coords);
  EXPECT_EQ(mesh.indices, expected.indices);
}

INSTANTIATE_TEST_SUITE_P(Seeds, AgainstTinyobjloader,
                         testing::Range<std::uint32_t>(1, 33));

}  // namespace
}  // namespace halfspace::bench

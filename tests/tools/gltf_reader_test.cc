// What the reader of glTF finds in good files. Coordinates are computed by
// hand.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "bench/input/mesh_reader.h"
#include "tests/tools/gltf_files.h"
#include "tests/tools/temp_file.h"

namespace halfspace::bench {
namespace {

using Coords = std::vector<float>;
using Indices = std::vector<std::uint32_t>;

const Coords kSquare = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
const Indices kTwoTriangles = {0, 1, 2, 0, 2, 3};

Mesh Read(std::string_view content) {
  return ReadMesh(TempFile(content).path());
}

Mesh ReadSquare(const Json& json) { return Read(Glb(json, SquareBytes())); }

TEST(GltfMesh, ReadsGlb) {
  const Mesh mesh = ReadSquare(Square());
  EXPECT_EQ(mesh.coords, kSquare);
  EXPECT_EQ(mesh.indices, kTwoTriangles);
}

// 3 floats are 12 bytes: AAAAAAAAAAAAAAAA is (0, 0, 0), AACAPwAAAAAAAAAA
// (1, 0, 0) and AAAAAAAAgD8AAAAA (0, 1, 0).
constexpr std::string_view kTriangle =
    "\n {\"asset\": {\"version\": \"2.0\"},"
    "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}],"
    "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126,"
    "                 \"count\": 3.0, \"type\": \"VEC3\"}],"
    "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}],"
    "\"buffers\": [{\"byteLength\": 36, \"uri\": "
    "\"data:application/octet-stream;base64,"
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}";

TEST(GltfMesh, ReadsJsonWithItsBufferAndWithoutAScene) {
  const Mesh mesh = Read(kTriangle);
  EXPECT_EQ(mesh.coords, (Coords{0, 0, 0, 1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
}

TEST(GltfMesh, ReadsBase64OfEveryLength) {
  // 37 and 38 bytes, of which 36 count.
  for (const char* more : {"AA==", "AAA=", "AA", "AAA", "AAAA", ""}) {
    std::string text(kTriangle);
    text.insert(text.size() - 4, more);
    EXPECT_EQ(Read(text).coords, (Coords{0, 0, 0, 1, 0, 0, 0, 1, 0})) << more;
  }
}

TEST(GltfMesh, ReadsABufferBelowItsFolder) {
  namespace fs = std::filesystem;
  std::string name = testing::TempDir() + "halfspace-gltf-XXXXXX";
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const fs::path folder = name;
  fs::create_directory(folder / "a b");
  std::ofstream(folder / "a b" / "c.bin", std::ios::binary) << SquareBytes();
  std::ofstream(folder / "square.gltf")
      << With(Square(), "/buffers/0/uri", "\"a%20b/./c.bin\"").dump();
  EXPECT_EQ(ReadMesh(folder / "square.gltf").coords, kSquare);
  fs::remove_all(folder);
}

TEST(GltfMesh, ReadsStridesOffsetsAndEveryIndexType) {
  // Two unused bytes, then a position and an unused float for each vertex.
  const std::string positions =
      "??" + Floats({1, 2, 3, 9, 4, 5, 6, 9, 7, 8, 9});
  Json json = Square();
  json["bufferViews"][0] = {
      {"buffer", 0}, {"byteLength", 46}, {"byteStride", 16}};
  json["accessors"][0]["byteOffset"] = 2;
  json["accessors"][0]["count"] = 3;
  json["accessors"][1]["count"] = 3;
  for (const int size : {1, 2, 4}) {
    json["accessors"][1]["componentType"] = size == 4 ? 5125 : 5119 + 2 * size;
    json["bufferViews"][1] = {
        {"buffer", 0}, {"byteOffset", 46}, {"byteLength", 3 * size}};
    json["buffers"][0]["byteLength"] = 46 + 3 * size;
    const Mesh mesh = Read(Glb(json, positions + Wholes({2, 0, 1}, size)));
    EXPECT_EQ(mesh.coords, (Coords{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    EXPECT_EQ(mesh.indices, (Indices{2, 0, 1})) << size;
  }
}

TEST(GltfMesh, TakesStripsAndFansApart) {
  Json json = Square();
  json["accessors"][1]["count"] = 5;
  const std::string bin = SquareBytes().substr(0, 48) +
                          Wholes({0, 1, 2, 3, 0}, 2) + std::string(2, '?');
  const auto primitive = "/meshes/0/primitives/0/mode";
  EXPECT_EQ(Read(Glb(With(json, primitive, "5"), bin)).indices,
            (Indices{0, 1, 2, 1, 3, 2, 2, 3, 0}));
  EXPECT_EQ(Read(Glb(With(json, primitive, "6"), bin)).indices,
            (Indices{0, 1, 2, 0, 2, 3, 0, 3, 0}));
  json["meshes"][0]["primitives"][0].erase("indices");
  EXPECT_EQ(Read(Glb(With(json, primitive, "5"), bin)).indices,
            (Indices{0, 1, 2, 1, 3, 2}));
  EXPECT_EQ(Read(Glb(With(json, primitive, "6"), bin)).indices,
            (Indices{0, 1, 2, 0, 2, 3}));
}

TEST(GltfMesh, SkipsPointsAndLinesAndSharesPositions) {
  const Json json = With(Square(), "/meshes/0/primitives",
                         R"([{"attributes": {"POSITION": 0}, "mode": 0},
                             {"attributes": {}, "mode": 3},
                             {"attributes": {"POSITION": 0}, "indices": 1},
                             {"attributes": {"POSITION": 0}, "mode": 6}])");
  const Mesh mesh = ReadSquare(json);
  EXPECT_EQ(mesh.coords, kSquare);
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3}));
}

TEST(GltfMesh, ReadsIntegerPositions) {
  // Signed: c / 127, at least -1. Unsigned: c / 255. As they are otherwise.
  Json json = Square();
  json["accessors"][0]["count"] = 3;
  json["meshes"][0]["primitives"][0].erase("indices");
  json["bufferViews"][0]["byteStride"] = 4;
  json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const std::string bin =
      Wholes({127, 0x80, 0x81, 0, 0, 0, 0, 0, 51, 0, 0, 0}, 1) +
      std::string(48, '\0');
  json["accessors"][0]["componentType"] = 5120;
  EXPECT_EQ(Read(Glb(json, bin)).coords,
            (Coords{127, -128, -127, 0, 0, 0, 51, 0, 0}));
  json["accessors"][0]["normalized"] = true;
  EXPECT_EQ(Read(Glb(json, bin)).coords,
            (Coords{1, -1, -1, 0, 0, 0, 51.0f / 127, 0, 0}));
  json["accessors"][0]["componentType"] = 5121;
  EXPECT_EQ(
      Read(Glb(json, bin)).coords,
      (Coords{127.0f / 255, 128.0f / 255, 129.0f / 255, 0, 0, 0, 0.2f, 0, 0}));
  const std::string words =
      Wholes({0x7FFF, 0x8000, 0xFFFF, 0, 0, 0, 0, 0, 3, 0, 0, 0}, 2) +
      std::string(36, '\0');
  json["bufferViews"][0]["byteStride"] = 8;
  json["accessors"][0]["componentType"] = 5122;
  json["accessors"][0]["normalized"] = false;
  EXPECT_EQ(Read(Glb(json, words)).coords,
            (Coords{32767, -32768, -1, 0, 0, 0, 3, 0, 0}));
  json["accessors"][0]["componentType"] = 5123;
  json["accessors"][0]["normalized"] = true;
  EXPECT_EQ(Read(Glb(json, words)).coords,
            (Coords{32767.0f / 65535, 32768.0f / 65535, 1, 0, 0, 0,
                    3.0f / 65535, 0, 0}));
}

TEST(GltfMesh, ReadsSparseAccessors) {
  // Vertex 2 becomes (7, 8, 9), and index 5 becomes 1.
  Json json = Square();
  json["accessors"][0]["sparse"] = Json::parse(
      R"({"count": 1, "indices": {"bufferView": 2, "componentType": 5121},
          "values": {"bufferView": 2, "byteOffset": 4}})");
  json["accessors"][1]["sparse"] = Json::parse(
      R"({"count": 1,
          "indices": {"bufferView": 2, "componentType": 5121, "byteOffset": 1},
          "values": {"bufferView": 2, "byteOffset": 2}})");
  json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 16}});
  json["buffers"][0]["byteLength"] = 76;
  const Mesh mesh = Read(
      Glb(json, SquareBytes() + Wholes({2, 5, 1, 0}, 1) + Floats({7, 8, 9})));
  EXPECT_EQ(mesh.coords, (Coords{0, 0, 0, 1, 0, 0, 7, 8, 9, 0, 1, 0}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 2, 1}));
}

TEST(GltfMesh, MovesTheVerticesByTheNodes) {
  // (x, y, 0) scaled to (2x, 3y, 0); turned by a quarter around z, which takes
  // x to y and y to -x: (-3y, 2x, 0); moved by (10, 20, 30); and the parent
  // doubles that.
  Json json = Square();
  json["nodes"] = Json::parse(R"([
      {"children": [1], "matrix": [2,0,0,0, 0,2,0,0, 0,0,2,0, 0,0,0,1]},
      {"mesh": 0, "scale": [2, 3, 4], "translation": [10, 20, 30],
       "rotation": [0, 0, 1, 1]}])");
  EXPECT_EQ(ReadSquare(json).coords,
            (Coords{20, 40, 60, 20, 44, 60, 14, 44, 60, 14, 40, 60}));
}

TEST(GltfMesh, TakesMatricesByColumns) {
  const Json json = With(Square(), "/nodes/0/matrix",
                         "[1,2,3,0, 10,20,30,0, 0,0,0,0, 100,200,300,1]");
  EXPECT_EQ(ReadSquare(json).coords, (Coords{100, 200, 300, 101, 202, 303, 111,
                                             222, 333, 110, 220, 330}));
}

TEST(GltfMesh, ComputesInDouble) {
  // In float, 16777216 + 1 - 16777216 is 0.
  Json json = With(Square(), "/nodes/0", R"({"children": [1],
                   "translation": [16777216, 0, 0]})");
  json["nodes"].push_back({{"mesh", 0}, {"translation", {-16777216, 0, 0}}});
  EXPECT_EQ(ReadSquare(json).coords, kSquare);
}

TEST(GltfMesh, RepeatsInstancesOfTheDefaultScene) {
  Json json = Square();
  json["nodes"] = Json::parse(R"([{"mesh": 0}, {"mesh": 0},
      {"mesh": 0, "translation": [5, 0, 0]}, {"camera": 0}])");
  json["scenes"] = Json::parse(R"([{"nodes": [0]}, {"nodes": [1, 2, 3]}])");
  json["scene"] = 1;
  const Mesh mesh = ReadSquare(json);
  EXPECT_EQ(mesh.coords, (Coords{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0,
                                 5, 0, 0, 6, 0, 0, 6, 1, 0, 5, 1, 0}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7}));
  json.erase("scene");  // the first one
  EXPECT_EQ(ReadSquare(json).coords, kSquare);
}

TEST(GltfMesh, IgnoresHowThingsLook) {
  Json json = Square();
  json["extensionsRequired"] = {"KHR_texture_transform", "EXT_texture_webp",
                                "KHR_materials_unlit"};
  json["images"] = {{{"uri", "/no/such/image.png"}}};
  json["buffers"].push_back({{"byteLength", 1}, {"uri", "/no/such/file"}});
  json["extras"] = "\xC3\xA9";
  EXPECT_EQ(ReadSquare(json).coords, kSquare);
}

}  // namespace
}  // namespace halfspace::bench

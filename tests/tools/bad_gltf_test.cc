// What the reader of glTF says of bad files: one line each.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "bench/input/mesh_reader.h"
#include "tests/tools/bad_file.h"
#include "tests/tools/gltf_files.h"
#include "tests/tools/mutations.h"
#include "tests/tools/temp_file.h"

namespace halfspace::bench {
namespace {

void Read(const std::string& path) { ReadMesh(path); }

void ExpectProblem(std::string_view content, const std::string& problem) {
  const TempFile file(content);
  const std::optional<std::string> message = ErrorOf(Read, file.path());
  ASSERT_TRUE(message.has_value()) << "was accepted";
  ExpectWellFormed(*message, file.path());
  const std::string expected = file.path() + problem + "; ";
  EXPECT_EQ(message->substr(0, expected.size()), expected);
}

// The square, where `value` replaces what the JSON pointer names.
struct BadValue {
  const char* pointer;
  const char* value;
  const char* problem;
};

void PrintTo(const BadValue& bad, std::ostream* out) {
  *out << bad.pointer << " = " << bad.value;
}

class BadGltfMesh : public testing::TestWithParam<BadValue> {};

TEST_P(BadGltfMesh, IsRefused) {
  const BadValue& bad = GetParam();
  ExpectProblem(Glb(With(Square(), bad.pointer, bad.value), SquareBytes()),
                std::string(": ") + bad.problem);
}

INSTANTIATE_TEST_SUITE_P(
    Document, BadGltfMesh,
    testing::Values(
        BadValue{"/asset", "{}", "asset.version is missing"},
        BadValue{"/asset/version", "2", "asset.version is no JSON string"},
        BadValue{"/asset/version", "\"1.0\"", "asset.version is \"1.0\""},
        BadValue{"/asset/minVersion", "\"2.1\"", "asset.minVersion is \"2.1\""},
        BadValue{"/extensionsRequired", "[\"KHR_draco_mesh_compression\"]",
                 "extensionsRequired has \"KHR_draco_mesh_compression\", which "
                 "is not read"},
        BadValue{"/extensionsRequired",
                 "[\"KHR_materials_unlit\", \"EXT_meshopt_compression\"]",
                 "extensionsRequired has \"EXT_meshopt_compression\", which is "
                 "not read"},
        BadValue{"/extensionsRequired", "[\"\\u001b\\u00e9\"]",
                 "extensionsRequired has \"\\x1b\\xc3\\xa9\", which is not "
                 "read"},
        BadValue{"/meshes", "7", "meshes is no JSON array"},
        BadValue{"/meshes/0", "[]", "meshes[0] is no JSON object"},
        BadValue{"/meshes/0/primitives", "[]",
                 "the file has no triangle in its scene"}));

INSTANTIATE_TEST_SUITE_P(
    Nodes, BadGltfMesh,
    testing::Values(
        BadValue{"/scene", "1", "scene is 1, and scenes has 1"},
        BadValue{"/scene", "-1", "scene is no whole number"},
        BadValue{"/scene", "0.5", "scene is no whole number"},
        BadValue{"/scene", "true", "scene is no whole number"},
        BadValue{"/scene", "18446744073709551616",
                 "scene is too large a number"},
        BadValue{"/scenes/0", "{}", "the file has no triangle in its scene"},
        BadValue{"/scenes/0/nodes/0", "1",
                 "scenes[0].nodes[0] is 1, and nodes has 1"},
        BadValue{"/scenes/0/nodes", "[0, 0]",
                 "scenes[0].nodes[0] is node 0, which is in a cycle or has two "
                 "parents"},
        BadValue{"/nodes/0/children", "[0]",
                 "nodes[0].children[0] is node 0, which is in a cycle or has "
                 "two parents"},
        BadValue{"/nodes", R"([{"children": [1]}, {"children": [0]}])",
                 "nodes[1].children[0] is node 0, which is in a cycle or has "
                 "two parents"},
        BadValue{"/nodes",
                 R"([{"children": [1, 2]}, {"children": [3]},
                     {"children": [3]}, {"mesh": 0}])",
                 "nodes[2].children[0] is node 3, which is in a cycle or has "
                 "two parents"},
        BadValue{"/nodes/0/mesh", "1", "nodes[0].mesh is 1, and meshes has 1"},
        BadValue{"/nodes/0/extensions", R"({"EXT_mesh_gpu_instancing": {}})",
                 "nodes[0] has EXT_mesh_gpu_instancing, which is not read"},
        BadValue{"/nodes/0/scale", "[1, 2]",
                 "nodes[0].scale has 2 numbers, where 3 are needed"},
        BadValue{"/nodes/0/scale", "[1, 2, \"3\"]",
                 "nodes[0].scale[2] is no number"},
        BadValue{"/nodes/0/rotation", "[0, 0, 0, 0]",
                 "nodes[0].rotation is no quaternion of a rotation"},
        BadValue{"/nodes/0/matrix", "[0,0,0,0, 0,0,0,0, 0,0,0,0, 0,0,0,2]",
                 "nodes[0].matrix has a last row other than 0 0 0 1"},
        BadValue{"/nodes/0", R"({"matrix": [], "translation": [0, 0, 0]})",
                 "nodes[0].translation is beside a matrix"},
        BadValue{"/nodes/0/translation", "[1e39, 0, 0]",
                 "a vertex of meshes[0] is, where its node moves it, too large "
                 "for a 32-bit float"},
        BadValue{"/nodes/0/scale", "[1e308, 1e308, 1e308]",
                 "a vertex of meshes[0] is, where its node moves it, too large "
                 "for a 32-bit float"}));

INSTANTIATE_TEST_SUITE_P(
    Primitives, BadGltfMesh,
    testing::Values(
        BadValue{"/meshes/0/primitives/0/mode", "7",
                 "meshes[0].primitives[0].mode is 7, which is no mode"},
        BadValue{"/meshes/0/primitives/0/attributes", "{}",
                 "meshes[0].primitives[0].attributes.POSITION is missing"},
        BadValue{"/meshes/0/primitives/0/attributes/POSITION", "2",
                 "meshes[0].primitives[0].attributes.POSITION is 2, and "
                 "accessors has 2"},
        BadValue{"/accessors/1/count", "4",
                 "meshes[0].primitives[0] has 4 corners, which make no whole "
                 "triangles"},
        BadValue{"/meshes/0/primitives/0",
                 R"({"attributes": {"POSITION": 0}, "mode": 4})",
                 "meshes[0].primitives[0] has 4 corners, which make no whole "
                 "triangles"},
        BadValue{"/accessors/0/count", "3",
                 "meshes[0].primitives[0] has the index 3, and 3 vertices"}));

INSTANTIATE_TEST_SUITE_P(
    Accessors, BadGltfMesh,
    testing::Values(
        BadValue{"/accessors/0/type", "\"VEC4\"",
                 "accessors[0].type is \"VEC4\", where VEC3 is needed"},
        BadValue{"/accessors/1/type", "\"VEC3\"",
                 "accessors[1].type is \"VEC3\", where SCALAR is needed"},
        BadValue{"/accessors/0/componentType", "5125",
                 "accessors[0].componentType is 5125, which no position has"},
        BadValue{"/accessors/0/componentType", "4294972422",
                 "accessors[0].componentType is 4294972422, which no position "
                 "has"},
        BadValue{"/accessors/1/componentType", "5126",
                 "accessors[1].componentType is 5126, which no index has"},
        BadValue{"/accessors/0/normalized", "1",
                 "accessors[0].normalized is neither true nor false"},
        BadValue{"/accessors/0/count", "0", "accessors[0] has no elements"},
        BadValue{"/accessors/0/count", "5",
                 "accessors[0] has 5 elements, more than its bufferView of 48 "
                 "bytes holds"},
        BadValue{"/accessors/0/count", "9007199254740991",
                 "accessors[0] has 9007199254740991 elements, more than its "
                 "bufferView of 48 bytes holds"},
        BadValue{"/accessors/0/byteOffset", "4",
                 "accessors[0] has 4 elements, more than its bufferView of 48 "
                 "bytes holds"},
        BadValue{"/accessors/0/byteOffset", "9007199254740991",
                 "accessors[0] has 4 elements, more than its bufferView of 48 "
                 "bytes holds"},
        BadValue{"/accessors/0/bufferView", "2",
                 "accessors[0].bufferView is 2, and bufferViews has 2"},
        BadValue{"/accessors/0",
                 R"({"componentType": 5126, "count": 4, "type": "VEC3"})",
                 "accessors[0] has no bufferView: it is compressed, or sparse "
                 "over zeros, neither of which is read"},
        BadValue{"/accessors/0/sparse", R"({"count": 0, "indices": {}})",
                 "accessors[0].sparse has a count of 0, where accessors[0] has "
                 "4"},
        BadValue{"/accessors/0/sparse", R"({"count": 5, "indices": {}})",
                 "accessors[0].sparse has a count of 5, where accessors[0] has "
                 "4"},
        BadValue{"/accessors/0/sparse",
                 R"({"count": 1, "indices": {"bufferView": 1,
                     "byteOffset": 12, "componentType": 5121}})",
                 "accessors[0].sparse.indices has 1 elements, more than its "
                 "bufferView of 12 bytes holds"},
        BadValue{"/accessors/0/sparse",
                 R"({"count": 1, "indices": {"bufferView": 1,
                     "componentType": 5121}, "values": {"bufferView": 1,
                     "byteOffset": 1}})",
                 "accessors[0].sparse.values has 1 elements, more than its "
                 "bufferView of 12 bytes holds"},
        BadValue{"/accessors/0/sparse",
                 R"({"count": 1, "indices": {"bufferView": 0, "byteOffset": 14,
                     "componentType": 5123}, "values": {"bufferView": 0}})",
                 "accessors[0].sparse replaces an element after the last"}));

INSTANTIATE_TEST_SUITE_P(
    Buffers, BadGltfMesh,
    testing::Values(
        BadValue{"/bufferViews/0/byteStride", "8",
                 "bufferViews[0] has a byteStride of 8, where elements have 12 "
                 "bytes"},
        BadValue{"/bufferViews/0/byteStride", "0",
                 "bufferViews[0] has a byteStride of 0, where elements have 12 "
                 "bytes"},
        BadValue{"/bufferViews/0/byteStride", "9007199254740991",
                 "bufferViews[0] has a byteStride of 9007199254740991, where "
                 "elements have 12 bytes"},
        BadValue{"/bufferViews/0/byteLength", "61",
                 "bufferViews[0] ends at byte 61 of buffers[0], which has 60"},
        BadValue{"/bufferViews/1/byteOffset", "61",
                 "bufferViews[1] ends at byte 73 of buffers[0], which has 60"},
        BadValue{"/bufferViews/0/buffer", "1",
                 "bufferViews[0].buffer is 1, and buffers has 1"},
        BadValue{"/buffers/0/byteLength", "61",
                 "buffers[0] has 60 bytes, and its byteLength is 61"},
        BadValue{"/buffers/0/byteLength", "9007199254740991",
                 "buffers[0] has 60 bytes, and its byteLength is "
                 "9007199254740991"},
        BadValue{"/buffers/0/uri", "\"data:,abc\"",
                 "buffers[0].uri is no base64"},
        BadValue{"/buffers/0/uri", "\"data:;base64,A===\"",
                 "buffers[0].uri is no base64"},
        BadValue{"/buffers/0/uri", "\"data:;base64,AA-A\"",
                 "buffers[0].uri is no base64"},
        BadValue{"/buffers/0/uri", "\"data:;base64,AAAA\"",
                 "buffers[0] has 3 bytes, and its byteLength is 60"},
        BadValue{"/buffers/0/uri", "\"\"",
                 "buffers[0].uri is \"\", outside the folder of the file"},
        BadValue{"/buffers/0/uri", "\"/etc/passwd\"",
                 "buffers[0].uri is \"/etc/passwd\", outside the folder of the "
                 "file"},
        BadValue{"/buffers/0/uri", "\"a/../../b\"",
                 "buffers[0].uri is \"a/../../b\", outside the folder of the "
                 "file"},
        BadValue{"/buffers/0/uri", "\"%2e%2E/b\"",
                 "buffers[0].uri is \"%2e%2E/b\", outside the folder of the "
                 "file"},
        BadValue{"/buffers/0/uri", "\"..\\\\b\"",
                 "buffers[0].uri is \"..\\b\", outside the folder of the file"},
        BadValue{"/buffers/0/uri", "\"file:b\"",
                 "buffers[0].uri is \"file:b\", outside the folder of the "
                 "file"},
        BadValue{"/buffers/0/uri", "\"halfspace-none.bin\"",
                 "buffers[0].uri is \"halfspace-none.bin\", and there is no "
                 "such file"},
        BadValue{"/buffers/0/uri", "\".\"",
                 "buffers[0].uri is \".\", and there is no such file"},
        BadValue{"/buffers/0/uri", "\"a%00b\"",
                 "buffers[0].uri is \"a%00b\", outside the folder of the "
                 "file"},
        BadValue{"/buffers", "[{\"byteLength\": 1}]",
                 "bufferViews[0] ends at byte 48 of buffers[0], which has "
                 "1"}));

TEST(BadGltfFile, NamesTheLineOfMalformedJson) {
  ExpectProblem("{\n\"asset\": \n]", ":3: malformed JSON");
  ExpectProblem("{\"asset\": \"\xFF\"}", ":1: malformed JSON");
  ExpectProblem("{\"asset\": 1e999}",
                ": a number in the JSON is too large for a double");
  ExpectProblem(GlbOfText("{\n!", ""), ": malformed JSON in line 2 of the GLB");
  ExpectProblem(GlbOfText("[]", ""), ": the file is no JSON object");
}

TEST(BadGltfFile, ChecksTheChunksOfAGlb) {
  const std::string good = Glb(Square(), SquareBytes());
  const auto with = [&good](std::size_t at, std::uint32_t value) {
    return std::string(good).replace(at, 4, Wholes({value}, 4));
  };
  ExpectProblem(good.substr(0, 11),
                ": the GLB ends after 11 bytes, within a header or a chunk");
  ExpectProblem(with(4, 1), ": a GLB of version 1");
  const std::string size = std::to_string(good.size());
  ExpectProblem(with(8, 5),
                ": the header of the GLB says 5 bytes, and the "
                "file has " +
                    size);
  ExpectProblem(good + "x", ": the header of the GLB says " + size +
                                " bytes, and the file has " +
                                std::to_string(good.size() + 1));
  for (const std::uint32_t bytes : {1000000u, 0xFFFFFFFFu}) {
    ExpectProblem(with(12, bytes), ": the GLB ends after " + size +
                                       " bytes, within a header or a chunk");
  }
  ExpectProblem(with(16, 0x004E4942),
                ": the first chunk of the GLB is not its JSON");
  ExpectProblem("glTF" + Wholes({2, 12}, 4),
                ": the first chunk of the GLB is not its JSON");
  const std::string buffer =
      ": buffers[0] has no uri, and is not the first of a GLB with a BIN chunk";
  ExpectProblem(with(good.size() - 64, 7), buffer);
  ExpectProblem(Square().dump(), buffer);
}

TEST(BadGltfFile, RefusesNumbersThatAreNoPlaces) {
  const std::string bin = SquareBytes();
  const auto with = [&bin](std::size_t at, const std::string& bytes) {
    return Glb(Square(), std::string(bin).replace(at, bytes.size(), bytes));
  };
  for (const float bad : {NAN, INFINITY}) {
    ExpectProblem(with(40, Floats({bad})),
                  ": accessors[0] has a coordinate at element 3 that is not a "
                  "finite number");
  }
  ExpectProblem(with(50, Wholes({0xFFFF}, 2)),
                ": accessors[1] has at element 1 the greatest index of its "
                "type, which restarts a strip");
  ExpectProblem(with(50, Wholes({4}, 2)),
                ": meshes[0].primitives[0] has the index 4, and 4 vertices");
}

TEST(BadGltfFile, HoldsItsLimits) {
  Json json = Square();
  json["scenes"][0]["nodes"] = {0, 1};
  json["nodes"].push_back({{"mesh", 0}});
  const TempFile file(Glb(json, SquareBytes()));
  EXPECT_EQ(ReadMesh(file.path(), {.vertices = 8, .triangles = 4}).triangles(),
            4u);
  const auto error_with = [&file](MeshLimits limits) {
    return ErrorOf(
        [limits](const std::string& path) { ReadMesh(path, limits); },
        file.path());
  };
  EXPECT_EQ(error_with({.vertices = 7}),
            file.path() +
                ": the scene has more than 7 vertices, those of all "
                "instances together; split it into several files");
  EXPECT_EQ(error_with({.triangles = 3}),
            file.path() +
                ": the scene has more than 3 triangles, those of all "
                "instances together; split it into several files");
}

TEST(BadGltfFile, HoldsTheLimitOfBuffersInFiles) {
  const TempFile bin(SquareBytes());
  const std::string name = bin.path().substr(testing::TempDir().size());
  const TempFile file(
      With(Square(), "/buffers/0/uri", "\"" + name + "\"").dump());
  EXPECT_EQ(ReadMesh(file.path(), {.buffer_bytes = 60}).triangles(), 2u);
  EXPECT_EQ(
      ErrorOf(
          [](const std::string& path) { ReadMesh(path, {.buffer_bytes = 59}); },
          file.path()),
      file.path() +
          ": buffers[0] takes more than the memory that is "
          "free; give a smaller one");
}

TEST(BadGltfFile, FollowsNoLinkOutOfItsFolder) {
  const TempFile outside(SquareBytes());
  const std::string folder = testing::TempDir() + "gltf-links";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  std::filesystem::create_symlink(outside.path(), folder + "/link.bin");
  const std::string path = folder + "/square.gltf";
  std::ofstream(path)
      << With(Square(), "/buffers/0/uri", "\"link.bin\"").dump();
  EXPECT_EQ(ErrorOf([](const std::string& file) { ReadMesh(file); }, path),
            path +
                ": buffers[0].uri is \"link.bin\", a link out of the "
                "folder; put the file itself there, or give a GLB");
  std::filesystem::remove_all(folder);
}

// A reader that calls itself for each level would need a larger stack.
TEST(BadGltfFile, DepthTakesNoStack) {
  constexpr std::size_t kDepth = 1 << 19;
  std::string text = Square().dump();
  text.pop_back();
  text += ",\"extras\":" + std::string(kDepth, '[') + std::string(kDepth, ']') +
          "}";
  ExpectProblem(text,
                ": buffers[0] has no uri, and is not the first of a GLB "
                "with a BIN chunk");
  Json json = Square();
  json["nodes"].clear();
  for (std::size_t i = 1; i < 100000; ++i) {
    json["nodes"].push_back({{"children", {i}}});
  }
  json["nodes"].push_back({{"mesh", 0}});
  const TempFile file(Glb(json, SquareBytes()));
  EXPECT_EQ(ReadMesh(file.path()).triangles(), 2u);
}

void ExpectSound(const Mesh& mesh) {
  EXPECT_GT(mesh.triangles(), 0u);
  EXPECT_EQ(mesh.coords.size() % 3, 0u);
  EXPECT_EQ(mesh.indices.size() % 3, 0u);
  EXPECT_TRUE(std::all_of(mesh.coords.begin(), mesh.coords.end(),
                          [](float x) { return std::isfinite(x); }));
  EXPECT_LT(*std::max_element(mesh.indices.begin(), mesh.indices.end()),
            mesh.vertices());
}

Mesh ReadDefault(const std::string& path) { return ReadMesh(path); }

// A larger scene than the square's, so that there is more to damage.
Json Scene() {
  Json json = Square();
  json["nodes"] = Json::parse(R"([{"mesh": 0, "children": [1]},
      {"mesh": 0, "scale": [2, 1, 1], "rotation": [0, 0, 0, 1]}])");
  json["accessors"][0]["byteOffset"] = 0;
  json["bufferViews"][0]["byteStride"] = 12;
  json["accessors"][1]["sparse"] = Json::parse(
      R"({"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
          "values": {"bufferView": 1, "byteOffset": 2}})");
  return json;
}

TEST(BadGltfFile, MutationsOfAGlbAreRefusedOrGiveASoundMesh) {
  // Part of it is no matter, so that some mutations are harmless.
  const std::string unused(500, ' ');
  ExpectSafeOnMutations(Glb(Scene(), SquareBytes() + unused), ReadDefault,
                        ExpectSound, Edits::kReplace);
}

TEST(BadGltfFile, MutationsOfJsonAreRefusedOrGiveASoundMesh) {
  Json json =
      With(Scene(), "/buffers/0/uri",
           "\"data:;base64,"
           "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAA"
           "AAABAAIAAAACAAMA\"");
  json["images"] = {{{"name", std::string(500, ' ')}}};  // no matter
  ExpectSafeOnMutations(json.dump(), ReadDefault, ExpectSound);
}

}  // namespace
}  // namespace halfspace::bench

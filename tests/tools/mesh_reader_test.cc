#include "bench/input/mesh_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/tools/bad_file.h"
#include "tests/tools/mutations.h"
#include "tests/tools/temp_file.h"

namespace halfspace::bench {
namespace {

using Floats = std::vector<float>;
using Indices = std::vector<std::uint32_t>;

Mesh Read(std::string_view content) {
  return ReadMesh(TempFile(content).path());
}

Mesh ReadDefault(const std::string& path) { return ReadMesh(path); }

constexpr std::string_view kSquare =
    "v 0 0 0\n"
    "v 1 0 0\n"
    "v 1 1 0\n"
    "v 0 1 0\n";

std::string OnSquare(std::string_view faces) {
  return std::string(kSquare).append(faces);
}

TEST(ObjMesh, ReadsTriangles) {
  const Mesh mesh = Read("v 1 2 3\nv -4 5.5 6e1\nv .5 8. +9 1\nf 1 2 3\n");
  EXPECT_EQ(mesh.coords, (Floats{1, 2, 3, -4, 5.5, 60, .5, 8, 9}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
}

TEST(ObjMesh, FansPolygonsInOrder) {
  EXPECT_EQ(
      Read(OnSquare("v 2 2 2\nf 5 4 3 2 1\nf 1 2 3\nf 2 3 4 5\n")).indices,
      (Indices{4, 3, 2, 4, 2, 1, 4, 1, 0, 0, 1, 2, 1, 2, 3, 1, 3, 4}));
}

TEST(ObjMesh, FansPolygonOf300Corners) {
  std::string text;
  std::string face = "f";
  Indices expected;
  for (std::uint32_t i = 0; i < 300; ++i) {
    text.append("v ").append(std::to_string(i)).append(" 0 1\n");
    face.append(" ").append(std::to_string(i + 1));
    if (i >= 2) expected.insert(expected.end(), {0, i - 1, i});
  }
  EXPECT_EQ(Read(text + face + "\n").indices, expected);
}

TEST(ObjMesh, CountsBackFromTheFaceAndForward) {
  EXPECT_EQ(Read("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 2 0 0\nf -3 -2 -1\n").indices,
            (Indices{0, 1, 2, 0, 1, 2}));
}

TEST(ObjMesh, SkipsEverythingElse) {
  const Mesh mesh = Read(
      "\xEF\xBB\xBF"
      "# comment\r\nmtllib none.mtl\no a\r\nv\t0 0 0\r\nv 1 0 0\nv 1 1 0 # c\n"
      "vt 0.5 word\nvn nan 0 1\ng a b\nusemtl red\ns off\nl 1 9\n"
      "f 1/1 2/2 3/3 # c\nf 1//1 2//-1 3//0\nf 2/1/1 3/9/9 1/-1/2");
  EXPECT_EQ(mesh.coords, (Floats{0, 0, 0, 1, 0, 0, 1, 1, 0}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 1, 2, 1, 2, 0}));
}

TEST(ObjMesh, EndsLinesAtCrLfOrBoth) {
  const Mesh mesh =
      Read("# c\rv 0 0 0\rv 1 0 0\r\nv 1 1 0\n\rf 1 2 3\r\rf 2 3 1\r");
  EXPECT_EQ(mesh.coords, (Floats{0, 0, 0, 1, 0, 0, 1, 1, 0}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 1, 2, 0}));
}

TEST(ObjMesh, RoundsNumbersToTheNearestFloat) {
  const std::string zeros(400, '0');
  const Mesh mesh = Read("v 0e999 1" + zeros + "e-400 ." + zeros +
                         "1e401\nv 16777217 0.1234567891234 1e-46\n"
                         "f 1 2 1\n");
  EXPECT_EQ(mesh.coords, (Floats{0, 1, 1, 16777216, 0.1234567891234f, 0}));
}

class BadLine : public testing::TestWithParam<BadFile> {};

TEST_P(BadLine, IsRefused) { ExpectRejected(ReadDefault, GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    ObjMesh, BadLine,
    testing::Values(
        BadFile{"Empty", "", 1, "the file is empty"},
        BadFile{"NulByte", OnSquare(std::string("#\0 \n", 4)), 5,
                "a NUL byte, so this is no text file"},
        BadFile{"TwoNumbers", OnSquare("v 1 2\nf 1 2 3\n"), 5,
                "a vertex with 2 numbers"},
        BadFile{"Word", "v 0 0 0\nv 1 two 3\n", 2, "\"two\" is not a number"},
        BadFile{"NaN", "v 0 0 0\n\nv nan 0 0\n", 3,
                "\"nan\" is not a finite number"},
        BadFile{"Infinity", "v 0 0 -Infinity\n", 1,
                "\"-Infinity\" is not a finite number"},
        BadFile{"Overflow", "v 0 0 3.4028236e38\n", 1,
                "\"3.4028236e38\" is too large for a 32-bit float"},
        BadFile{"VertexAlone", "v\nv 0 0 0\nf 1 1 1\n", 1,
                "a vertex with 0 numbers"},
        BadFile{"OverflowAfterCr", "# c\rv 0 0 0\rv 1e39 0 0\rf 1 1 1\r", 3,
                "\"1e39\" is too large for a 32-bit float"},
        BadFile{"NoVertex", "# nothing\n", 1, "the file has no vertex"},
        BadFile{"NoFace", OnSquare(""), 4, "the file has no face"},
        BadFile{"TwoCorners", OnSquare("f 1 2 3\nf 1 2\n"), 6,
                "a face with 2 corners"},
        BadFile{"LettersBehindACorner", OnSquare("f 1 2 3x\n"), 5,
                "the corner \"3x\" has no number of a vertex"},
        BadFile{"LettersInACorner", OnSquare("f 1 2 3/x\n"), 5,
                "the corner \"3/x\" has no number of a vertex"},
        BadFile{"FourNumbersInACorner", OnSquare("f 1 2 3/1/1/1\n"), 5,
                "the corner \"3/1/1/1\" has no number of a vertex"},
        BadFile{"Vertex0", OnSquare("f 0 1 2\n"), 5,
                "the corner \"0\" has no number of a vertex"},
        BadFile{"NoVertexNumber", OnSquare("f 1 2 /3\n"), 5,
                "the corner \"/3\" has no number of a vertex"},
        BadFile{"BeyondAllIntegers", OnSquare("f 1 2 99999999999999999999\n"),
                5,
                "the corner \"99999999999999999999\" has no number of a "
                "vertex"},
        BadFile{"TooFarBack", "f 1 2 3\n" + OnSquare("f -5 1 2\n"), 6,
                "a face counts back 5 vertices, and 4 come before it"},
        BadFile{"Back2To32", OnSquare("f -4294967295 1 2\n"), 5,
                "a face counts back 4294967295 vertices, and 4 come before "
                "it"},
        BadFile{"VertexAfterTheLast", OnSquare("f 2 3 5\nf 1 2 3\n"), 5,
                "a face names vertex 5, and the file has 4"},
        BadFile{"LargestOfTwo", OnSquare("f 2 3 5\nf 1 2 2147483647\n"), 6,
                "a face names vertex 2147483647, and the file has 4"},
        BadFile{"Vertex2To32", OnSquare("f 1 2 4294967299\n"), 5,
                "a face names vertex 4294967299, and the file has 4"}),
    NameOf);

TEST(ObjMesh, RefusesWhatIsNoReadableFile) {
  ExpectUnreadable(ReadDefault, testing::TempDir());
  ExpectUnreadable(ReadDefault, testing::TempDir() + "no/such/file.obj");
}

TEST(ObjMesh, HoldsItsLimits) {
  const TempFile file(OnSquare("f 1 2 3\nf 1 2 3 4\n"));
  EXPECT_EQ(ReadMesh(file.path(), {.vertices = 4, .triangles = 3}).triangles(),
            3u);
  EXPECT_THROW(ReadMesh(file.path(), {.vertices = 3}), InputError);
  EXPECT_THROW(ReadMesh(file.path(), {.triangles = 2}), InputError);
}

TEST(ObjMesh, MutationsAreRefusedOrGiveASoundMesh) {
  ExpectSafeOnMutations(
      "# mesh\r\n"
      "mtllib a.mtl\n"
      "v 0 0 0\nv 1.5 -2e1 +3 1\n\tv 1 1 0 .1 .2 .3\n v 0 1 0\n"
      "vt 0 0\nvn 0 0 1\ng part\n"
      "f 1 2 3\nf 1/1 2/1 3/1 4/1\nf -4//1 -3//1 -1//1\n"
      "v 1e-3 1e+3 12345.678\nf 5 4 3 2 1",
      ReadDefault, [](const Mesh& mesh) {
        EXPECT_EQ(mesh.coords.size() % 3, 0u);
        EXPECT_EQ(mesh.indices.size() % 3, 0u);
        EXPECT_GT(mesh.triangles(), 0u);
        EXPECT_TRUE(std::all_of(mesh.coords.begin(), mesh.coords.end(),
                                [](float x) { return std::isfinite(x); }));
        EXPECT_LT(*std::max_element(mesh.indices.begin(), mesh.indices.end()),
                  mesh.vertices());
      });
}

}  // namespace
}  // namespace halfspace::bench

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bench/input/mesh_reader.h"
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
  const Mesh mesh = Read("v 1 2 3\nv -4 5.5 6e1\nv .5 8. +9\nf 1 2 3\n");
  EXPECT_EQ(mesh.coords, (Floats{1, 2, 3, -4, 5.5, 60, .5, 8, 9}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
  EXPECT_EQ(mesh.vertices(), 3u);
  EXPECT_EQ(mesh.triangles(), 1u);
}

TEST(ObjMesh, FansQuads) {
  EXPECT_EQ(Read(OnSquare("f 1 2 3 4\n")).indices, (Indices{0, 1, 2, 0, 2, 3}));
}

TEST(ObjMesh, FansMixedPolygonsInOrder) {
  EXPECT_EQ(
      Read(OnSquare("v 2 2 2\nf 5 4 3 2 1\nf 1 2 3\nf 2 3 4 5\n")).indices,
      (Indices{4, 3, 2, 4, 2, 1, 4, 1, 0, 0, 1, 2, 1, 2, 3, 1, 3, 4}));
}

TEST(ObjMesh, FansPolygonOf300Corners) {
  constexpr std::uint32_t kCorners = 300;
  std::string text;
  std::string face = "f";
  Indices expected;
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    text.append("v ").append(std::to_string(i)).append(" 0 1\n");
    face.append(" ").append(std::to_string(i + 1));
    if (i >= 2) expected.insert(expected.end(), {0, i - 1, i});
  }
  const Mesh mesh = Read(text + face + "\n");
  EXPECT_EQ(mesh.vertices(), kCorners);
  EXPECT_EQ(mesh.triangles(), kCorners - 2);
  EXPECT_EQ(mesh.indices, expected);
}

TEST(ObjMesh, NegativeIndicesCountBackFromTheFace) {
  EXPECT_EQ(Read("v 0 0 0\nv 1 0 0\nv 2 0 0\nf -3 -2 -1\nv 3 0 0\nf -4 -1 2\n")
                .indices,
            (Indices{0, 1, 2, 0, 3, 1}));
}

TEST(ObjMesh, FacesMayComeBeforeTheirVertices) {
  EXPECT_EQ(Read("f 1 2 3\nf 4 3 1\n" + OnSquare("")).indices,
            (Indices{0, 1, 2, 3, 2, 0}));
}

TEST(ObjMesh, IgnoresTextureAndNormalIndices) {
  EXPECT_EQ(
      Read(OnSquare("f 1/1 2/2 3/3\nf 1//1 2//-1 4//0\nf 2/1/1 3/9/9 4/-1/2\n"))
          .indices,
      (Indices{0, 1, 2, 0, 1, 3, 1, 2, 3}));
}

TEST(ObjMesh, IgnoresWeightAndColour) {
  EXPECT_EQ(Read("v 1 2 3 0.5\nv 4 5 6 .1 .2 .3\nv 7 8 9\nf 1 2 3\n").coords,
            (Floats{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(ObjMesh, SkipsOtherStatements) {
  const Mesh mesh =
      Read(OnSquare("# a comment with a path, C:\\meshes\\\n"
                    "#v 9 9 9\n"
                    "\n"
                    "  \t\n"
                    "mtllib does-not-exist.mtl\n"
                    "o thing\ng a b c\ns off\nusemtl red\n"
                    "vt 0.5 word\nvn nan 0 1\nvp 1\nl 1 99\np 99\n"
                    "cstype bezier\ndeg 3\ncurv 0 1 \\\n 1 2 3\nend\n"
                    "f 1 2 3 # and one behind a face\n"));
  EXPECT_EQ(mesh.vertices(), 4u);
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
}

TEST(ObjMesh, ReadsCrLfTabsBlanksByteOrderMarkAndNoLastLineEnd) {
  const Mesh mesh = Read(
      "\xEF\xBB\xBF"
      "v\t1 \t2  3 \r\n\t v 4 5 6\r\n v 7 8 9\t\r\n\r\nf 1\t2 3");
  EXPECT_EQ(mesh.coords, (Floats{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
}

TEST(ObjMesh, BackslashContinuesLine) {
  const Mesh mesh = Read(
      "v 1 \\\n2 3\nv 4 5 6\\\n\nv 7 8\\\r\n \\\n9\n"
      "g a \\\n b\nf \\\n1 2 \\\n \\\n 3\n");
  EXPECT_EQ(mesh.coords, (Floats{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
}

TEST(ObjMesh, RoundsDecimalsToTheNearestFloat) {
  // Just above the midpoint of 1 and its successor: by way of a double it would
  // become 1.
  const Mesh mesh = Read(
      "v 1.000000059604644775390625000001 16777217 0.1\n"
      "v 1e-50 -1e-400 7.1e-46\n"
      "v 3.4028235e38 -3.40282346638528859811704183484516925440e+38 1e-40\n"
      "f 1 2 3\n");
  EXPECT_EQ(mesh.coords,
            (Floats{0x1.000002p0f, 16777216.0f, 0x1.99999ap-4f, 0.0f, -0.0f,
                    0x1p-149f, 0x1.fffffep127f, -0x1.fffffep127f, 1e-40f}));
  EXPECT_TRUE(std::signbit(mesh.coords[4]));
}

TEST(ObjMesh, AcceptsDegenerateFaces) {
  EXPECT_EQ(Read("v 1 1 1\nf 1 1 1\n").indices, (Indices{0, 0, 0}));
}

class BadObjMesh : public testing::TestWithParam<BadFile> {};

TEST_P(BadObjMesh, IsRefusedAtItsLine) {
  ExpectRejected(ReadDefault, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Structure, BadObjMesh,
    testing::Values(
        BadFile{"Empty", "", 1, "the file is empty"},
        BadFile{"OnlyByteOrderMark", "\xEF\xBB\xBF", 1, "the file is empty"},
        BadFile{"OnlyBlankLines", "\n\n \n", 3,
                "the file ends without a vertex"},
        BadFile{"NoVertices", "# nothing\nf 1 2 3\n", 2,
                "the file ends without a vertex"},
        BadFile{"NoFaces", std::string(kSquare), 4,
                "the file ends without a face"},
        BadFile{"NulByte", OnSquare(std::string("f 1 2 3\n#\n# \0 \n", 15)), 7,
                "a NUL byte, so this is no text file"},
        BadFile{"BinaryGarbage", OnSquare("\x89PNG\x1a\x7f\xff\n"), 5,
                "\"\\x89PNG\\x1a\\x7f\\xff\" is no statement that can be read"},
        BadFile{"UnknownStatement", OnSquare("vertex 1 2 3\nf 1 2 3\n"), 5,
                "\"vertex\" is no statement that can be read"},
        BadFile{"UpperCase", "V 1 2 3\n", 1,
                "\"V\" is no statement that can be read"},
        BadFile{"OtherFile", OnSquare("call other.obj\n"), 5,
                "\"call\" is no statement that can be read"},
        BadFile{"WordOfMostCharacters", std::string(32, 'x'), 1,
                "\"xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx\" is no statement that "
                "can be read"},
        BadFile{"LongWordIsShortened", std::string(5000, 'x'), 1,
                "\"xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...\" is no statement that "
                "can be read"},
        BadFile{"EndsAfterBackslash", OnSquare("f 1 2 3 \\\n"), 5,
                "the file ends after a backslash, which continues a line"},
        BadFile{"BackslashSplitsNumber", OnSquare("f 1 2 3\\\n4\n"), 6,
                "the backslash before this line splits a word"},
        BadFile{"BackslashWouldSwallowVertex",
                "mtllib C:\\meshes\\\n" + OnSquare("f 1 2 3\n"), 2,
                "the backslash before this line splits a word"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Vertices, BadObjMesh,
    testing::Values(
        BadFile{"NoNumbers", "v\nf 1 1 1\n", 1, "a vertex with 0 numbers"},
        BadFile{"TwoNumbers", OnSquare("v 1 2\nf 1 2 3\n"), 5,
                "a vertex with 2 numbers"},
        BadFile{"CutOffAtTheEnd", "f 1 2 3\nv 0 0 0\nv 1 1", 3,
                "a vertex with 2 numbers"},
        BadFile{"FiveNumbers", "v 1 2 3 4 5\n", 1, "a vertex with 5 numbers"},
        BadFile{"SevenNumbers", "v 1 2 3 4 5 6 7\n", 1,
                "a vertex with 7 numbers"},
        BadFile{"CommentInsteadOfNumber", "v 1 2 # 3\n", 1,
                "a vertex with 2 numbers"},
        BadFile{"ContinuedButShort", "\nv 1 \\\n\nf 1 1 1\n", 2,
                "a vertex with 1 numbers"},
        BadFile{"Word", "v 0 0 0\nv 1 two 3\n", 2, "\"two\" is not a number"},
        BadFile{"WordOnContinuedLine", "v 0 \\\n 0 \\\n zero\n", 3,
                "\"zero\" is not a number"},
        BadFile{"TrailingGarbage", "v 1.0abc 2 3\n", 1,
                "\"1.0abc\" is not a number"},
        BadFile{"DecimalComma", "v 1,5 2 3\n", 1, "\"1,5\" is not a number"},
        BadFile{"TwoPoints", "v 1.2.3 2 3\n", 1, "\"1.2.3\" is not a number"},
        BadFile{"NoExponent", "v 1e 2 3\n", 1, "\"1e\" is not a number"},
        BadFile{"Hexadecimal", "v 0x10 2 3\n", 1, "\"0x10\" is not a number"},
        BadFile{"SignsOnly", "v 1 2 -\n", 1, "\"-\" is not a number"},
        BadFile{"PlusOnly", "v 1 2 +\n", 1, "\"+\" is not a number"},
        BadFile{"TwoSigns", "v 1 2 +-3\n", 1, "\"+-3\" is not a number"},
        BadFile{"TwoPlusSigns", "v 1 2 ++3\n", 1, "\"++3\" is not a number"},
        BadFile{"LoneCarriageReturn", "v 1 2 3\rv 1 2 3\n", 1,
                "\"3\\x0dv\" is not a number"},
        BadFile{"NaN", "v 0 0 0\n\nv nan 0 0\n", 3,
                "\"nan\" is not a finite number"},
        BadFile{"SignedNaN", "v -NaN 0 0\n", 1,
                "\"-NaN\" is not a finite number"},
        BadFile{"PrintedNaN", "v -1.#IND 0 0\n", 1,
                "\"-1.#IND\" is not a number"},
        BadFile{"Inf", "v 0 inf 0\n", 1, "\"inf\" is not a finite number"},
        BadFile{"Infinity", "v 0 0 -Infinity\n", 1,
                "\"-Infinity\" is not a finite number"},
        BadFile{"BadWeight", "v 0 0 0 nan\n", 1,
                "\"nan\" is not a finite number"},
        BadFile{"BadColour", "v 0 0 0 1 1 red\n", 1, "\"red\" is not a number"},
        BadFile{"Overflow", "v 0 0 3.4028236e38\n", 1,
                "\"3.4028236e38\" is too large for a 32-bit float"},
        BadFile{"NegativeOverflow", "v 0 0 -1e99999999999\n", 1,
                "\"-1e99999999999\" is too large for a 32-bit float"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Faces, BadObjMesh,
    testing::Values(
        BadFile{"NoCorners", OnSquare("f\n"), 5, "a face with 0 corners"},
        BadFile{"OneCorner", OnSquare("f 1\n"), 5, "a face with 1 corners"},
        BadFile{"TwoCorners", OnSquare("f 1 2 3\nf 1 2\n"), 6,
                "a face with 2 corners"},
        BadFile{"CutOffAtTheEnd", OnSquare("f 1 2 3\nf 2 3"), 6,
                "a face with 2 corners"},
        BadFile{"Word", OnSquare("f 1 2 three\n"), 5,
                "\"three\" is no corner of a face"},
        BadFile{"Fraction", OnSquare("f 1 2 3.0\n"), 5,
                "\"3.0\" is no corner of a face"},
        BadFile{"TrailingGarbage", OnSquare("f 1 2 3x\n"), 5,
                "\"3x\" is no corner of a face"},
        BadFile{"NothingAfterSlash", OnSquare("f 1/ 2/ 3/\n"), 5,
                "\"1/\" is no corner of a face"},
        BadFile{"WordAfterSlash", OnSquare("f 1/1 2/x 3/1\n"), 5,
                "\"2/x\" is no corner of a face"},
        BadFile{"NothingAfterTwoSlashes", OnSquare("f 1//1 2//1 3//\n"), 5,
                "\"3//\" is no corner of a face"},
        BadFile{"NothingAfterLastSlash", OnSquare("f 1/1/ 2 3\n"), 5,
                "\"1/1/\" is no corner of a face"},
        BadFile{"NothingBeforeSlash", OnSquare("f /1 2 3\n"), 5,
                "\"/1\" is no corner of a face"},
        BadFile{"FourParts", OnSquare("f 1/1/1/1 2 3\n"), 5,
                "\"1/1/1/1\" is no corner of a face"},
        BadFile{"ThreeSlashes", OnSquare("f 1///1 2 3\n"), 5,
                "\"1///1\" is no corner of a face"},
        BadFile{"Comma", OnSquare("f 1,2,3\n"), 5,
                "\"1,2,3\" is no corner of a face"},
        BadFile{"Zero", OnSquare("f 0/1 1 2\n"), 5, "vertex 0 in \"0/1\""},
        BadFile{"NegativeZero", OnSquare("f 1 2 -0\n"), 5,
                "vertex 0 in \"-0\""},
        BadFile{"TooFarBack", OnSquare("f -4 -3 -2\nf -5//1 -4 -3\n"), 6,
                "\"-5//1\" is out of range: only 4 vertices come before it"},
        BadFile{"BackBeforeAnyVertex", "f -1 -1 -1\n" + OnSquare(""), 1,
                "\"-1\" is out of range: only 0 vertices come before it"},
        BadFile{"TooFar", OnSquare("f 1 2 3\nf 2 3 5\n# end\n"), 6,
                "vertex 5 is out of range: the file has 4 vertices"},
        BadFile{"FirstOfSeveralTooFar",
                OnSquare("f 1 2 5\nv 9 9 9\nf 1 2 7\nf 1 2 6\nf 1 2 8\n"), 7,
                "vertex 7 is out of range: the file has 5 vertices"},
        BadFile{"TooFarOnContinuedLine", OnSquare("f 1 2 \\\n 3 \\\n 9\n"), 7,
                "vertex 9 is out of range: the file has 4 vertices"},
        BadFile{"Beyond31Bits", OnSquare("f 1 2 2147483649\n"), 5,
                "vertex 2147483649 is out of range: the file has 4 vertices"},
        BadFile{"Beyond32Bits", OnSquare("f 1 2 4294967297\n"), 5,
                "\"4294967297\" is out of range: a mesh has at most "
                "4294967295 vertices"},
        BadFile{"Beyond64Bits", OnSquare("f 1 2 18446744073709551617\n"), 5,
                "\"18446744073709551617\" is out of range: a mesh has at most "
                "4294967295 vertices"},
        BadFile{"Beyond64BitsBack", OnSquare("f 1 2 -18446744073709551615\n"),
                5,
                "\"-18446744073709551615\" is out of range: only 4 vertices "
                "come before it"}),
    NameOf);

TEST(ObjMesh, RefusesWhatIsNoReadableFile) {
  ExpectUnreadable(ReadDefault, testing::TempDir());
  ExpectUnreadable(ReadDefault, testing::TempDir() + "no/such/file.obj");
}

TEST(ObjMesh, HoldsItsLimits) {
  const TempFile file(OnSquare("f 1 2 3\nf \\\n 1 2 3 4\n"));
  EXPECT_EQ(ReadMesh(file.path(), {.vertices = 4, .triangles = 3}).triangles(),
            3u);
  const auto read_with = [](MeshLimits limits) {
    return [limits](const std::string& path) { ReadMesh(path, limits); };
  };
  EXPECT_EQ(ErrorOf(read_with({.vertices = 3}), file.path()),
            file.path() +
                ":4: more than 3 vertices; split the mesh into several files");
  EXPECT_EQ(ErrorOf(read_with({.triangles = 2}), file.path()),
            file.path() +
                ":6: more than 2 triangles; split the mesh into several files");
}

TEST(ObjMesh, MutationsAreRefusedOrGiveASoundMesh) {
  ExpectSafeOnMutations(
      "# mesh\r\n"
      "mtllib a.mtl\n"
      "v 0 0 0\nv 1.5 -2e1 +3 1\n\tv 1 1 0 .1 .2 .3\n v 0 1 0\n"
      "vt 0 0\nvn 0 0 1\ng part \\\n  two\n"
      "f 1 2 3\nf 1/1 2/1 3/1 4/1\nf -4//1 -3//1 -1//1\n"
      "f 1/1/1 2/1/1 \\\n 3/1/1 5/1/1\n"
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

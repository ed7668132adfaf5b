// The readers of other people's files: what they take, and what they say of
// wrong and of damaged ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "bench/input/bounds_reader.h"
#include "bench/input/mesh_reader.h"
#include "bench/input/text_lines.h"

namespace halfspace::bench {
namespace {

// A file for as long as a test needs it.
class TempFile {
 public:
  // Tests run in several processes at once, so the name is random.
  explicit TempFile(std::string_view content)
      : path_(testing::TempDir() + "halfspace-" +
              std::to_string(std::random_device()()) + "-" +
              std::to_string(std::random_device()())) {
    std::ofstream file(path_, std::ios::binary);
    file << content;
    file.close();
    if (!file) ADD_FAILURE() << "cannot write " << path_;
  }
  ~TempFile() { std::remove(path_.c_str()); }

  TempFile(const TempFile&) = delete;
  TempFile& operator=(const TempFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

struct BadFile {
  std::string content;
  std::size_t line;
  std::string_view problem;
};

// The message of the InputError that `read(path)` throws; nothing if it throws
// none. Any other exception fails the test.
template <typename Read>
std::optional<std::string> ErrorOf(const Read& read, const std::string& path) {
  try {
    read(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return std::nullopt;
}

// One line that a terminal can show whatever the file holds, with the place
// first, and advice.
void ExpectWellFormed(const std::string& message, const std::string& path) {
  EXPECT_EQ(message.find(path + ":"), 0u) << message;
  EXPECT_NE(message.find("; "), std::string::npos) << message;
  EXPECT_TRUE(std::all_of(message.begin(), message.end(), [](char c) {
    return c >= ' ' && c <= '~';
  })) << message;
}

template <typename Read>
void ExpectRefused(const Read& read, const std::vector<BadFile>& files) {
  for (const auto& [content, line, problem] : files) {
    SCOPED_TRACE(problem);
    const TempFile file(content);
    const std::optional<std::string> message = ErrorOf(read, file.path());
    ASSERT_TRUE(message.has_value()) << "was accepted";
    ExpectWellFormed(*message, file.path());
    std::string expected = file.path() + ":" + std::to_string(line) + ": ";
    expected.append(problem).append("; ");
    EXPECT_EQ(message->substr(0, expected.size()), expected) << *message;
  }
}

// The text after an edit or two, or cut short: the same on every machine.
std::string Mutated(std::string text, std::mt19937& random) {
  // What readers give a meaning to.
  constexpr std::string_view kTelling = "0123456789+-.eEnaif/\\#,vf \t\r\n";
  // Not std::uniform_int_distribution, which differs between libraries.
  const auto below = [&](std::size_t bound) { return random() % bound; };
  if (below(16) == 0) text.resize(below(text.size()));
  for (std::size_t edits = 1 + below(2); edits != 0; --edits) {
    const std::size_t at = below(text.size() + 1);
    const char c = below(4) == 0 ? static_cast<char>(below(256))
                                 : kTelling[below(kTelling.size())];
    switch (below(4)) {
      case 0:
        text.replace(at, 1, 1, c);
        break;
      case 1:
        text.insert(at, 1, c);
        break;
      case 2:
        text.erase(at, 1 + below(4));
        break;
      default:
        text.insert(at, text.substr(below(text.size() + 1), below(24)));
    }
  }
  return text;
}

// ---- Meshes.

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

TEST(ObjMesh, RoundsNumbersToTheNearestFloat) {
  const std::string zeros(400, '0');
  const Mesh mesh = Read("v 0e999 1" + zeros + "e-400 ." + zeros +
                         "1e401\nv 16777217 0.1234567891234 1e-46\n"
                         "f 1 2 1\n");
  EXPECT_EQ(mesh.coords, (Floats{0, 1, 1, 16777216, 0.1234567891234f, 0}));
}

TEST(ObjMesh, RefusesBadLines) {
  ExpectRefused(
      ReadDefault,
      {{"", 1, "the file is empty"},
       {OnSquare(std::string("#\0 \n", 4)), 5,
        "a NUL byte, so this is no text file"},
       {OnSquare("v 1 2\nf 1 2 3\n"), 5, "a vertex with 2 numbers"},
       {"v 0 0 0\nv 1 two 3\n", 2, "\"two\" is not a number"},
       {"v 0 0 0\n\nv nan 0 0\n", 3, "\"nan\" is not a finite number"},
       {"v 0 0 3.4028236e38\n", 1,
        "\"3.4028236e38\" is too large for a 32-bit float"},
       {"# c\rv 0 0 0\rv 1e39 0 0\rf 1 1 1\r", 3,
        "\"1e39\" is too large for a 32-bit float"},
       {"# nothing\n", 1, "the file has no vertex"},
       {OnSquare(""), 4, "the file has no face"},
       {OnSquare("f 1 2 3\nf 1 2\n"), 6, "a face with 2 corners"},
       {OnSquare("f 1 2 3x\n"), 5,
        "the corner \"3x\" has no number of a vertex"},
       {OnSquare("f 1 2 3/x\n"), 5,
        "the corner \"3/x\" has no number of a vertex"},
       {OnSquare("f 1 2 3/1/1/1\n"), 5,
        "the corner \"3/1/1/1\" has no number of a vertex"},
       {OnSquare("f 0 1 2\n"), 5, "the corner \"0\" has no number of a vertex"},
       {OnSquare("f 1 2 /3\n"), 5,
        "the corner \"/3\" has no number of a vertex"},
       {OnSquare("f 1 2 99999999999999999999\n"), 5,
        "the corner \"99999999999999999999\" has no number of a "
        "vertex"},
       {"f 1 2 3\n" + OnSquare("f -5 1 2\n"), 6,
        "a face counts back 5 vertices, and 4 come before it"},
       {OnSquare("f -4294967295 1 2\n"), 5,
        "a face counts back 4294967295 vertices, and 4 come before "
        "it"},
       {OnSquare("f 2 3 5\nf 1 2 3\n"), 5,
        "a face names vertex 5, and the file has 4"},
       {OnSquare("f 2 3 5\nf 1 2 2147483647\n"), 6,
        "a face names vertex 2147483647, and the file has 4"},
       {OnSquare("f 1 2 4294967299\n"), 5,
        "a face names vertex 4294967299, and the file has 4"}});
}

TEST(ObjMesh, RefusesWhatIsNoReadableFile) {
  for (const char* name : {"", "no/such/file.obj"}) {
    const std::string path = testing::TempDir() + name;
    const std::optional<std::string> message = ErrorOf(ReadDefault, path);
    ASSERT_TRUE(message.has_value()) << "was accepted";
    EXPECT_EQ(message->find(path + ": cannot be read: "), 0u) << *message;
    EXPECT_NE(message->find("; give the path of a readable file"),
              std::string::npos)
        << *message;
  }
}

TEST(ObjMesh, HoldsItsLimits) {
  const TempFile file(OnSquare("f 1 2 3\nf 1 2 3 4\n"));
  EXPECT_EQ(ReadMesh(file.path(), {.vertices = 4, .triangles = 3}).triangles(),
            3u);
  EXPECT_THROW(ReadMesh(file.path(), {.vertices = 3}), InputError);
  EXPECT_THROW(ReadMesh(file.path(), {.triangles = 2}), InputError);
}

// Each damaged version of a good file is refused with a well-formed message, or
// is a mesh. What the reader of bounds shares with this one is tested here.
TEST(ObjMesh, MutationsAreRefusedOrGiveASoundMesh) {
  constexpr int kMutations = 8000;
  std::mt19937 random(20240229);
  int refused = 0;
  for (int i = 0; i < kMutations; ++i) {
    const std::string text = Mutated(
        "# mesh\r\n"
        "mtllib a.mtl\n"
        "v 0 0 0\nv 1.5 -2e1 +3 1\n\tv 1 1 0 .1 .2 .3\n v 0 1 0\n"
        "vt 0 0\nvn 0 0 1\ng part\n"
        "f 1 2 3\nf 1/1 2/1 3/1 4/1\nf -4//1 -3//1 -1//1\n"
        "v 1e-3 1e+3 12345.678\nf 5 4 3 2 1",
        random);
    const TempFile file(text);
    const std::optional<std::string> message = ErrorOf(
        [](const std::string& path) {
          const Mesh mesh = ReadMesh(path);
          EXPECT_EQ(mesh.coords.size() % 3, 0u);
          EXPECT_EQ(mesh.indices.size() % 3, 0u);
          EXPECT_GT(mesh.triangles(), 0u);
          EXPECT_TRUE(std::all_of(mesh.coords.begin(), mesh.coords.end(),
                                  [](float x) { return std::isfinite(x); }));
          EXPECT_LT(*std::max_element(mesh.indices.begin(), mesh.indices.end()),
                    mesh.vertices());
        },
        file.path());
    if (message) {
      ++refused;
      ExpectWellFormed(*message, file.path());
    }
    if (HasFailure()) FAIL() << "on mutation " << i << ":\n" << text;
  }
  // Else the mutations are too weak, or too strong, to show anything.
  EXPECT_GT(refused, kMutations / 10);
  EXPECT_LT(refused, kMutations - kMutations / 10);
}

// ---- Bounds.

using Boxes = std::vector<Aabb3>;

Boxes ReadBoxes(std::string_view content) {
  return ReadBounds(TempFile(content).path());
}

TEST(BoundsReader, ReadsRowsInOrder) {
  EXPECT_EQ(ReadBoxes("0,1,2,3,4,5\n-1.5,-2e1,+3,.5,6.,7\n1,2,3,1,2,3\n"),
            (Boxes{{{0, 1, 2}, {3, 4, 5}},
                   {{-1.5, -20, 3}, {.5, 6, 7}},
                   {{1, 2, 3}, {1, 2, 3}}}));
}

TEST(BoundsReader, SkipsHeaderCommentsBlanksAndLineEnds) {
  EXPECT_EQ(ReadBoxes("\xEF\xBB\xBF# boxes\r\n"
                      "\r\n"
                      " minx,miny,minz,maxx,maxy,maxz\r\n"
                      "\t0 , 1,\t2,3 ,4, 5 \r\n"
                      "  # between\r\n"
                      " \t\r\n"
                      "6,7,8,9,10,11"),
            (Boxes{{{0, 1, 2}, {3, 4, 5}}, {{6, 7, 8}, {9, 10, 11}}}));
  EXPECT_EQ(ReadBoxes("# boxes\r0,1,2,3,4,5\r\r6,7,8,9,10,11\r"),
            (Boxes{{{0, 1, 2}, {3, 4, 5}}, {{6, 7, 8}, {9, 10, 11}}}));
}

// A good row whose last number has zeros at its end, `length` characters.
std::string RowOfLength(std::size_t length) {
  std::string row = "0,0,0,1,1,1.";
  row.resize(length, '0');
  return row;
}

// Of numbers and of files, the rows of meshes have what both readers share.
TEST(BoundsReader, RefusesBadLines) {
  ExpectRefused(
      ReadBounds,
      {{"# x\nminx,miny,minz,maxx,maxy,maxz\n", 2,
        "the file ends without a box"},
       {"\xff\xfe\x01", 1,
        "expected 6 fields with commas between them, found 1 in "
        "\"\\xff\\xfe\\x01\""},
       {"0,0,0,1,1,1\n0,0,0,1,1\n", 2,
        "expected 6 fields with commas between them, found 5 in "
        "\"0,0,0,1,1\""},
       {"0,0,0,1,1,1,\n", 1,
        "expected 6 fields with commas between them, found 7 in "
        "\"0,0,0,1,1,1,\""},
       {"\n0,0,,1,1,1\n", 2, "\"\" is not a number"},
       {"0,0,0,1,1,1m\n", 1, "\"1m\" is not a number"},
       {"0,one,0,nan,1,1\n", 1, "\"one\" is not a number"},
       {"# a\n0,1e1,0,1,1,1\n", 2, "miny \"1e1\" is above maxy \"1\""},
       {"xmin,ymin,zmin,xmax,ymax,zmax\n", 1, "\"xmin\" is not a number"},
       {"0,0,0,1,1,1\nminx,miny,minz,maxx,maxy,maxz\n", 2,
        "\"minx\" is not a number"},
       // The first line is as long as it may be.
       {RowOfLength(4096) + "\n" + RowOfLength(4097), 2,
        "the line is 4097 characters long, expected at most 4096"},
       {std::string("#").append(4096, ' '), 1,
        "the line is 4097 characters long, expected at most 4096"}});
}

}  // namespace
}  // namespace halfspace::bench

#include "bench/input/bounds_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tests/tools/bad_file.h"
#include "tests/tools/mutations.h"
#include "tests/tools/temp_file.h"

namespace halfspace::bench {
namespace {

using Boxes = std::vector<Aabb3>;

Boxes Read(std::string_view content) {
  return ReadBounds(TempFile(content).path());
}

TEST(BoundsReader, ReadsRowsInOrder) {
  EXPECT_EQ(Read("0,1,2,3,4,5\n-1.5,-2e1,+3,.5,6.,7\n"),
            (Boxes{{{0, 1, 2}, {3, 4, 5}}, {{-1.5, -20, 3}, {.5, 6, 7}}}));
}

TEST(BoundsReader, ReadsPointsAndExtremes) {
  EXPECT_EQ(Read("1,2,3,1,2,3\n"
                 "-3.4028235e38,-0,0.1,3.4028235e38,0,16777217\n"),
            (Boxes{{{1, 2, 3}, {1, 2, 3}},
                   {{-0x1.fffffep127f, 0, 0x1.99999ap-4f},
                    {0x1.fffffep127f, 0, 16777216}}}));
}

TEST(BoundsReader, SkipsHeaderCommentsBlanksAndLineEnds) {
  EXPECT_EQ(Read("\xEF\xBB\xBF# boxes\r\n"
                 "\r\n"
                 " minx,miny,minz,maxx,maxy,maxz\r\n"
                 "\t0 , 1,\t2,3 ,4, 5 \r\n"
                 "  # between\r\n"
                 " \t\r\n"
                 "6,7,8,9,10,11"),
            (Boxes{{{0, 1, 2}, {3, 4, 5}}, {{6, 7, 8}, {9, 10, 11}}}));
  EXPECT_EQ(Read("# boxes\r0,1,2,3,4,5\r\r6,7,8,9,10,11\r"),
            (Boxes{{{0, 1, 2}, {3, 4, 5}}, {{6, 7, 8}, {9, 10, 11}}}));
}

// A good row whose last number has zeros at its end, `length` characters.
std::string RowOfLength(std::size_t length) {
  std::string row = "0,0,0,1,1,1.";
  row.resize(length, '0');
  return row;
}

class BadBounds : public testing::TestWithParam<BadFile> {};

TEST_P(BadBounds, AreRefusedAtTheirLine) {
  ExpectRejected(ReadBounds, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    All, BadBounds,
    testing::Values(
        BadFile{"Empty", "", 1, "the file is empty"},
        BadFile{"OnlyHeader", "# x\nminx,miny,minz,maxx,maxy,maxz\n", 2,
                "the file ends without a box"},
        BadFile{"OnlyBlankLines", "\n\n\n", 3, "the file ends without a box"},
        BadFile{"NulByte", std::string("0,0,0,1,1,1\n\n0,0\0,0,1,1,1\n", 26), 3,
                "a NUL byte, so this is no text file"},
        BadFile{"BinaryGarbage", "\xff\xfe\x01", 1,
                "expected 6 fields with commas between them, found 1 in "
                "\"\\xff\\xfe\\x01\""},
        BadFile{"FiveFields", "0,0,0,1,1,1\n0,0,0,1,1\n", 2,
                "expected 6 fields with commas between them, found 5 in "
                "\"0,0,0,1,1\""},
        BadFile{"CommaAtTheEnd", "0,0,0,1,1,1,\n", 1,
                "expected 6 fields with commas between them, found 7 in "
                "\"0,0,0,1,1,1,\""},
        BadFile{"EmptyField", "\n0,0,,1,1,1\n", 2, "\"\" is not a number"},
        BadFile{"TwoNumbersInAField", "0,0,0 0,1,1,1\n", 1,
                "\"0 0\" is not a number"},
        BadFile{"Hexadecimal", "0x1,0,0,1,1,1\n", 1, "\"0x1\" is not a number"},
        BadFile{"TrailingGarbage", "0,0,0,1,1,1m\n", 1,
                "\"1m\" is not a number"},
        BadFile{"FirstOfTwoWrongFields", "0,one,0,nan,1,1\n", 1,
                "\"one\" is not a number"},
        BadFile{"Inf", "-inf,0,0,1,1,1\n", 1,
                "\"-inf\" is not a finite number"},
        BadFile{"InvertedY", "# a\n0,1e1,0,1,1,1\n", 2,
                "miny \"1e1\" is above maxy \"1\""},
        BadFile{"InvertedZ", "0,0,1.5,1,1,1\n", 1,
                "minz \"1.5\" is above maxz \"1\""},
        BadFile{"OtherHeader", "xmin,ymin,zmin,xmax,ymax,zmax\n", 1,
                "\"xmin\" is not a number"},
        BadFile{"HeaderWithinRows",
                "0,0,0,1,1,1\nminx,miny,minz,maxx,maxy,maxz\n", 2,
                "\"minx\" is not a number"},
        BadFile{"OverlongLine", RowOfLength(4096) + "\n" + RowOfLength(4097), 2,
                "the line is 4097 characters long, expected at most 4096"},
        BadFile{"OverlongComment", std::string("#").append(4096, ' '), 1,
                "the line is 4097 characters long, expected at most 4096"}),
    NameOf);

TEST(BoundsReader, AcceptsTheLongestLine) {
  EXPECT_EQ(Read(RowOfLength(4096)), (Boxes{{{0, 0, 0}, {1, 1, 1}}}));
}

TEST(BoundsReader, RefusesWhatIsNoReadableFile) {
  ExpectUnreadable(ReadBounds, testing::TempDir());
  ExpectUnreadable(ReadBounds, testing::TempDir() + "no/such/file.csv");
}

TEST(BoundsReader, MutationsAreRefusedOrGiveSoundBoxes) {
  ExpectSafeOnMutations(
      "# boxes\r\nminx,miny,minz,maxx,maxy,maxz\n"
      "0,0,0,1,1,1\n -1.5, 2e1,\t-3 ,+4,50.25,6\r\n\n"
      "1e-3,-1e+3,-12345.678,1,1,1\n-5,-5,-5,5,5,5",
      ReadBounds, [](const Boxes& boxes) {
        EXPECT_FALSE(boxes.empty());
        for (const Aabb3& box : boxes) {
          for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_TRUE(std::isfinite(box.min[k]));
            EXPECT_TRUE(std::isfinite(box.max[k]));
            EXPECT_LE(box.min[k], box.max[k]);
          }
        }
      });
}

}  // namespace
}  // namespace halfspace::bench

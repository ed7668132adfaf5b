// What the section table1 prints beside its counts.
#include <gtest/gtest.h>

#include <cstddef>
#include <sstream>
#include <string>

#include "bench/report/paper.h"
#include "bench/report/report.h"

namespace halfspace::bench {
namespace {

std::string TextOf(std::size_t objects, std::size_t queries) {
  Table1Result result;
  result.objects = objects;
  result.queries = queries;
  result.work = kPaperWork;
  result.accepts = {200, 500, 180};
  std::ostringstream text;
  WriteText(text, result);
  return text.str();
}

bool Contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

TEST(Table1ReportTest, PapersSurvivorsAreBesideThoseOfASceneOfItsSize) {
  const std::string text = TextOf(kPaperObjects, kPaperQueries);
  EXPECT_TRUE(Contains(text, "simplex      500       2.50  47 559 2.18"))
      << text;
}

TEST(Table1ReportTest, AnotherSceneHasOnlyThePapersLooseness) {
  for (const std::string& text : {TextOf(kPaperObjects / 8, kPaperQueries),
                                  TextOf(kPaperObjects, kPaperQueries / 2)}) {
    EXPECT_FALSE(Contains(text, "47 559")) << text;
    EXPECT_TRUE(Contains(text, "paper's looseness")) << text;
    EXPECT_TRUE(Contains(text, "2.18")) << text;
  }
}

}  // namespace
}  // namespace halfspace::bench

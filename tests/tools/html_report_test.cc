// The page of --report: its arithmetic, and that no text of a report gets out
// of its place.
#include "bench/report/html_report.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/report/figures.h"
#include "bench/report/gnuplot.h"
#include "bench/report/html_parts.h"
#include "bench/report/report.h"

namespace halfspace::bench {
namespace {

Json Ratio(double median) {
  return {{"median", median}, {"quartiles", {median * 0.9, median * 1.1}}};
}

Json WayOf(const std::string& text, const char* schedule, double ns) {
  return {{"shape", text},
          {"schedule", schedule},
          {"precision", text},
          {"ns_with_exact", ns}};
}

// A report with one of everything, in which each text is `text`, where it may
// be any.
Json ReportWith(const std::string& text) {
  Json sections = {
      {"machine",
       {{"cpu", text},
        {"extensions", {text}},
        {"targets", {{"chosen", text}, {"compiled", {text}}}},
        {"virtual", true}}},
      {"table1",
       {{"seed", 1},
        {"widths", {1, 8, 16, 64, 256, 1024, 4096}},
        {"half_spaces",
         {{"aabb", {1, 2, 3, 4, 5, 5, 6}},
          {"simplex", {1, 2, 3, 4, 4, 4, 4}},
          {"aabo", {1, 2, 3, 4, 5, 5, 5}}}}}},
      {"crossover",
       {{"rows",
         {{{"target", text},
           {"working_set", text},
           {"schedule", "every-plane"},
           {"w", 16},
           {"simplex_ns", 0.5},
           {"aabb_ns", 0.25},
           {"aabo_ns", nullptr}},
          {{"target", text},
           {"working_set", text},
           {"schedule", "every-plane"},
           {"w", 64},
           {"simplex_ns", 0.2},
           {"aabb_ns", 0.25},
           {"aabo_ns", 0.3}}}},
        {"targets",
         {{{"target", text},
           {"lanes", 16},
           {"working_set", text},
           {"w_star", 32},
           {"at_most", false}}}},
        {"not_reached", {text}}}},
      {"kernels",
       {{"rows",
         {{{"shape", "simplex"},
           {"target", text},
           {"schedule", text},
           {"working_set", text},
           {"objects", 1000},
           {"ns_per_object", 0.2},
           {"gigabytes_per_second", 80},
           {"percent_of_read", 50}}}}}},
      {"quality",
       {{"survivors", {{"aabb", 100}, {"simplex", 216}, {"aabo", 90}}}}},
      {"model",
       {{"shapes",
         {{{"shape", "simplex"},
           {"schedule", text},
           {"ns_per_object", 0.2},
           {"candidates", 1e-3}}}},
        {"break_even", {{{"against", text}, {"ns", 12.5}}}},
        {"exact_tests",
         {{{"name", text}, {"ns", 35}, {"quartiles", {34, 36}}}}}}},
      {"sweep",
       {{"map",
         {{{"w", 16},
           {"slab_overlap", 0.05},
           {"simplex_over_aabb", Ratio(0.9)}}}},
        {"cells",
         {{{"size", 0.01},
           {"objects", 1000},
           {"winner", text},
           {"ns", 50},
           {"is_tie", true},
           {"ways",
            {WayOf(text, "sorted", 50), WayOf(text, "flat", 900),
             WayOf(text, "staged", 553)}}}}}}},
      {"answers",
       {{"answers", {{{"question", text}, {"answer", text}}}},
        {"not_reached", {text}}}},
      {"other",
       {{text, text}, {"rows", {{{text, text}, {"list", {text, {text}}}}}}}}};
  return {{"schema", kReportSchema},
          {"context", {{"cpu", text}, {"date", text}, {"command", text}}},
          {"benchmarks", Json::array()},
          {"sections", std::move(sections)}};
}

std::string PageOf(const Json& report) {
  return HtmlReport({report.dump()}).html;
}

std::string ErrorOf(const std::string& json) {
  try {
    CheckReport(json);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

// The figures of kind `i`.
std::vector<Figure> FiguresOf(const Json& report, std::size_t i) {
  return kFigureKinds.at(i).make({report.at("sections"), "sections"});
}

std::size_t Count(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos;
       at += what.size()) {
    ++count;
  }
  return count;
}

TEST(HtmlReportTest, EscapesWhatHtmlTakesForItsOwn) {
  EXPECT_EQ(Escaped("<a href=\"x\">&'"),
            "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  EXPECT_EQ(Escaped(std::string("a\x1b\0b\xc2\x9b", 6)), "a  b ");
  EXPECT_LT(Escaped(std::string(100'000, 'x')).size(), 1000u);
  // Not cut inside a character of two bytes.
  std::string umlauts = "x";
  for (int i = 0; i < 1000; ++i) umlauts += "\xc3\xa4";
  EXPECT_EQ(Escaped(umlauts), "x...");
}

TEST(HtmlReportTest, NoTextLeavesItsPlace) {
  const std::string plain = PageOf(ReportWith("plain"));
  for (const std::string hostile :
       {"<script>alert(1)</script>", "\"><img src=x onerror=alert(1)>",
        "'; system('touch x'); '", "`touch x`", "</style></table></svg>",
        "EOD\nset output 'x'\n!touch x", "<!--", "]]>"}) {
    const std::string page = PageOf(ReportWith(hostile));
    EXPECT_EQ(Count(page, "<"), Count(plain, "<")) << hostile;
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("<img"), std::string::npos);
    EXPECT_EQ(page.find("<!--"), std::string::npos);
    for (std::size_t i = 0; i < kFigureKinds.size(); ++i) {
      for (const Figure& figure : FiguresOf(ReportWith(hostile), i)) {
        const std::string script = GnuplotScript(figure);
        EXPECT_EQ(script.find_first_of("`!|;\\\""), std::string::npos);
        EXPECT_EQ(script.find("system("), std::string::npos);
        EXPECT_EQ(Count(script, "'") % 2, 0u);
        // A text has no line of its own.
        EXPECT_EQ(Count(script, "\nset output"), 0u);
      }
    }
  }
}

TEST(HtmlReportTest, IdsAreUniqueAndKnown) {
  const std::string report = ReportWith("plain").dump();
  const std::string page = HtmlReport({report, report}).html;
  std::set<std::string> ids;
  for (const char* quote : {"'", "\""}) {
    const std::string id = std::string(" id=") + quote;
    for (std::size_t at = 0; (at = page.find(id, at)) != std::string::npos;) {
      at += id.size();
      const std::string name = page.substr(at, page.find(quote[0], at) - at);
      EXPECT_TRUE(ids.insert(name).second) << name << " is there twice";
    }
  }
  for (std::size_t at = 0;
       (at = page.find("href='#", at)) != std::string::npos;) {
    at += 7;
    EXPECT_TRUE(ids.contains(page.substr(at, page.find('\'', at) - at)));
  }
  EXPECT_EQ(page.find(">nan"), std::string::npos);
  EXPECT_EQ(page.find("rgb(  "), std::string::npos);
  EXPECT_LT(page.size(), kMostPageBytes);
}

TEST(HtmlReportTest, FiguresHaveTheNumbersOfTheReport) {
  const Json report = ReportWith("plain");
  // Bars, of the AABB's 100.
  const std::vector<Figure> bars = FiguresOf(report, 1);
  ASSERT_EQ(bars.size(), 1u);
  ASSERT_EQ(bars[0].series.size(), 3u);
  EXPECT_DOUBLE_EQ(bars[0].series[0].points.at(0).second, 2.16);
  EXPECT_DOUBLE_EQ(bars[0].series[2].points.at(0).second, 0.9);
  // A simplex has 16 bytes; reading is twice as fast as 50 %.
  const std::vector<Figure> bandwidth = FiguresOf(report, 3);
  ASSERT_EQ(bandwidth.size(), 1u);
  ASSERT_EQ(bandwidth[0].series.size(), 2u);
  EXPECT_EQ(bandwidth[0].series[0].points.at(0), std::pair(16'000.0, 80.0));
  EXPECT_EQ(bandwidth[0].series[1].points.at(0), std::pair(16'000.0, 160.0));
  // 0.2 + 0.001 * 1 and 0.2 + 0.001 * 10 000.
  const std::vector<Figure> totals = FiguresOf(report, 4);
  ASSERT_EQ(totals.size(), 1u);
  EXPECT_NEAR(totals[0].series[0].points.front().second, 0.201, 1e-12);
  EXPECT_NEAR(totals[0].series[0].points.back().second, 10.2, 1e-9);
  ASSERT_EQ(totals[0].marks.size(), 2u);
  EXPECT_EQ(totals[0].marks[0].x, 12.5);
  const std::vector<Figure> widths = FiguresOf(report, 2);
  ASSERT_EQ(widths.size(), 1u);
  EXPECT_EQ(widths[0].marks.at(0).name, "w* = 32");
  EXPECT_EQ(widths[0].table.at(1),
            (std::vector<std::string>{"16", "0.5", "0.25", "-"}));
  const std::string page = PageOf(report);
  EXPECT_NE(page.find(">0.90</td>"), std::string::npos);
  EXPECT_NE(page.find("plain (a tie)"), std::string::npos);
  EXPECT_NE(page.find("<small>scan: plain staged plain, 553 ns</small>"),
            std::string::npos);
}

TEST(HtmlReportTest, AWinnerThatIsAScanIsNamedOnce) {
  Json report = ReportWith("plain");
  report["sections"]["sweep"]["cells"][0]["winner"] = "plain staged plain";
  EXPECT_EQ(PageOf(report).find("scan: "), std::string::npos);
}

TEST(HtmlReportTest, AQuestionMayHaveTwoAnswers) {
  Json report = ReportWith("plain");
  Json& answers = report["sections"]["answers"]["answers"];
  answers.push_back({{"question", "plain"}, {"answer", "another"}});
  EXPECT_NE(PageOf(report).find("<td>plain<br>another</td>"),
            std::string::npos);
}

// Of --target: the machine would choose another.
TEST(HtmlReportTest, ATargetThatWasNotMeasuredIsNotDrawn) {
  Json report = ReportWith("plain");
  report["sections"]["machine"]["targets"]["chosen"] = "another";
  const std::vector<Figure> bandwidth = FiguresOf(report, 3);
  ASSERT_EQ(bandwidth.size(), 1u);
  EXPECT_EQ(bandwidth[0].name, "plain");
}

TEST(HtmlReportTest, ScriptsHaveNamesOfLettersAndDigits) {
  Figure figure;
  figure.x = {"a", Scale::kLinear, 1, 2};
  figure.y = {"b", Scale::kLinear, 1, 2};
  figure.series.push_back(
      {"`x` $(y) \xc3\xa4 '", Ink::kAabb, Stroke::kSolid, {{1, 2}}});
  EXPECT_NE(GnuplotScript(figure).find("title '_x_ __y_ __ _'"),
            std::string::npos)
      << GnuplotScript(figure);
}

TEST(HtmlReportTest, SvgThatIsNoneGivesNoFigure) {
  for (const char* svg : {"", "gnuplot: no terminal", "<svg>", "</svg>"}) {
    EXPECT_EQ(InlineSvg(svg, "f1-", "label"), "") << svg;
  }
}

// Whatever stands in PATH under its name.
TEST(HtmlReportTest, WhereGnuplotFailsThereAreTables) {
  const std::filesystem::path folder = testing::TempDir() + "halfspace-" +
                                       std::to_string(std::random_device()());
  std::filesystem::create_directory(folder);
  const std::string path = getenv("PATH");
  setenv("PATH", folder.c_str(), 1);
  const HtmlPage absent = HtmlReport({ReportWith("plain").dump()});
  std::filesystem::create_symlink("/bin/false", folder / "gnuplot");
  const HtmlPage failed = HtmlReport({ReportWith("plain").dump()});
  setenv("PATH", path.c_str(), 1);
  std::filesystem::remove_all(folder);

  EXPECT_EQ(absent.failed_figures, 0u);
  EXPECT_EQ(failed.failed_figures, kFigureKinds.size());
  EXPECT_NE(absent.html.find("gnuplot-nox"), std::string::npos);
  EXPECT_EQ(failed.html.find("gnuplot-nox"), std::string::npos);
  for (const HtmlPage& page : {absent, failed}) {
    EXPECT_EQ(page.html.find("<svg"), std::string::npos);
    EXPECT_NE(page.html.find(">2.16</td>"), std::string::npos);
  }
}

TEST(HtmlReportTest, WhatIsAbsentIsLeftOut) {
  Json report = ReportWith("plain");
  report["sections"] = Json::object();
  const std::string page = PageOf(report);
  for (const char* section : {"answers", "crossover", "table1", "quality",
                              "kernels", "model", "sweep"}) {
    EXPECT_NE(page.find("not measured; --details " + std::string(section)),
              std::string::npos)
        << section;
  }
  EXPECT_EQ(page.find("<svg"), std::string::npos);
}

TEST(HtmlReportTest, EmptyListsAndNullsAreNothing) {
  Json report = ReportWith("plain");
  const Json full = report["sections"];
  for (const auto& [name, section] : full.items()) {
    for (const auto& [key, value] : section.items()) {
      if (!value.is_array() || name == "table1") continue;
      for (const Json& none : {Json::array(), Json(nullptr)}) {
        // Rows are what makes these sections.
        if (key == "rows" && none.is_null()) continue;
        report["sections"] = full;
        report["sections"][name][key] = none;
        EXPECT_EQ(ErrorOf(report.dump()), "") << name << " " << key;
      }
    }
  }
}

TEST(HtmlReportTest, NumbersOutOfBoundsAreNotDrawn) {
  for (double value : {0.0, -1.0, 1e300, 1e-300}) {
    Json report = ReportWith("plain");
    for (Json& row : report["sections"]["crossover"]["rows"]) {
      row["simplex_ns"] = value;
      row["w"] = value;
    }
    report["sections"]["kernels"]["rows"][0]["percent_of_read"] = value;
    report["sections"]["quality"]["survivors"]["aabb"] = value;
    report["sections"]["model"]["shapes"][0]["candidates"] = value;
    report["sections"]["sweep"]["map"][0]["simplex_over_aabb"]["median"] =
        value;
    const std::string page = PageOf(report);
    EXPECT_EQ(page.find(">inf"), std::string::npos) << value;
    EXPECT_EQ(page.find(">nan"), std::string::npos) << value;
  }
}

TEST(HtmlReportTest, SaysWhatIsWrong) {
  const std::string good = ReportWith("plain").dump();
  EXPECT_EQ(ErrorOf(good), "");
  EXPECT_EQ(ErrorOf(""), "no JSON report of this program");
  EXPECT_EQ(ErrorOf(good.substr(0, good.size() / 2)),
            "no JSON report of this program");
  EXPECT_EQ(ErrorOf("[1]"), "the report is no object");
  EXPECT_EQ(ErrorOf("{}"), "the report has no schema");
  EXPECT_EQ(ErrorOf("{\"schema\": \"3\"}"), "the report.schema is no number");
  EXPECT_EQ(ErrorOf("{\"schema\": 1e400}"), "no JSON report of this program");
  EXPECT_EQ(ErrorOf("{\"schema\": 1}"),
            "a report of schema 1, not " + std::to_string(kReportSchema));
  EXPECT_EQ(ErrorOf(std::string(100'000, '[')), "nested too deep");

  Json report = ReportWith("plain");
  report["sections"]["kernels"]["rows"][0]["objects"] = "1000";
  EXPECT_EQ(ErrorOf(report.dump()),
            "sections.kernels.rows[0].objects is no number");
  report = ReportWith("plain");
  report["sections"]["quality"]["survivors"].erase("aabo");
  EXPECT_EQ(ErrorOf(report.dump()), "sections.quality.survivors has no aabo");
  report = ReportWith("plain");
  report["sections"]["table1"]["half_spaces"]["aabb"] = {1, 2};
  EXPECT_EQ(ErrorOf(report.dump()),
            "sections.table1.half_spaces.aabb is not as long as widths");
  report = ReportWith("plain");
  report["context"]["cpu"] = 1;
  EXPECT_EQ(ErrorOf(report.dump()), "the report.context.cpu is no text");
}

// Each value of each section, replaced by those of other types: a page, or one
// line that says what is wrong.
TEST(HtmlReportTest, AnyTypeAnywhere) {
  const Json flat = ReportWith("plain").flatten();
  for (const auto& [pointer, value] : flat.items()) {
    for (const Json& other :
         {Json(nullptr), Json("x"), Json(true), Json(-1), Json::array(),
          Json::object(), Json({{"a", {1, {2}}}}), Json({{{"b", 1}}, 2})}) {
      Json report = ReportWith("plain");
      report[Json::json_pointer(pointer)] = other;
      const std::string error = ErrorOf(report.dump());
      EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    }
  }
}

}  // namespace
}  // namespace halfspace::bench

#include "bench/report/html_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "bench/report/figures.h"
#include "bench/report/gnuplot.h"
#include "bench/report/html_parts.h"
#include "bench/report/page_style.h"
#include "bench/report/report.h"
#include "bench/report/report_field.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kMostAnswers = 64;

// One machine of the page.
struct Run {
  explicit Run(Json parsed)
      : json(std::move(parsed)), name(Root().At("context").At("cpu").Text()) {}

  ReportField Root() const { return {json, "the report"}; }
  ReportField Context() const { return {json["context"], "context"}; }
  ReportField Sections() const {
    return {Root().At("sections").json(), "sections"};
  }

  Json json;
  std::string name;
  std::vector<std::vector<Figure>> figures;  // by kind
};

using Rows = std::vector<std::vector<std::string>>;

// A part of each run, under its name if there are several.
template <typename MakePart>
std::string Beside(const std::vector<Run>& runs, const MakePart& make) {
  if (runs.size() == 1) return make(runs[0]);
  std::string html = "<div class=\"beside\">\n";
  for (const Run& run : runs) {
    html += "<div>" + Element("h3", run.name) + make(run) + "</div>\n";
  }
  return html + "</div>\n";
}

std::string NotMeasured(const char* section) {
  return std::string("<p class=\"soft\">not measured; --details ") + section +
         " measures it</p>\n";
}

// The answers: a row for each question, a column for each machine.
std::string AnswerCell(const Run& run, const std::string& question) {
  const auto answers = run.Sections().Find("answers");
  if (!answers) return "<td>not measured</td>";
  std::string html;
  for (const ReportField& row : answers->List("answers")) {
    if (row.At("question").Text() != question) continue;
    html += (html.empty() ? "" : "<br>") + Escaped(row.At("answer").Text());
  }
  return "<td>" + (html.empty() ? "-" : html) + "</td>";
}

std::string Answers(const std::vector<Run>& runs) {
  std::vector<std::string> questions;
  std::string not_reached;
  for (const Run& run : runs) {
    const auto answers = run.Sections().Find("answers");
    if (!answers) continue;
    for (const ReportField& row : answers->List("answers")) {
      const std::string question = row.At("question").Text();
      if (std::find(questions.begin(), questions.end(), question) ==
          questions.end()) {
        questions.push_back(question);
      }
      if (questions.size() > kMostAnswers) answers->Fail("are too many");
    }
    for (const ReportField& line : answers->List("not_reached")) {
      not_reached +=
          Element("li", (runs.size() > 1 ? run.name + ": " : "") + line.Text());
    }
  }
  if (questions.empty()) return NotMeasured("answers");
  std::string html =
      "<div class=\"scroll\" tabindex=\"0\">"
      "<table class=\"words\">\n";
  if (runs.size() > 1) {
    html += "<thead><tr><td></td>";
    for (const Run& run : runs) {
      html += "<th scope=\"col\">" + Escaped(run.name) + "</th>";
    }
    html += "</tr></thead>\n";
  }
  html += "<tbody>\n";
  for (const std::string& question : questions) {
    html += "<tr><th scope=\"row\">" + Escaped(question) + "</th>";
    for (const Run& run : runs) html += AnswerCell(run, question);
    html += "</tr>\n";
  }
  html += "</tbody></table></div>\n";
  if (not_reached.empty()) return html;
  return html + "<h3>Not reached</h3>\n<ul>" + not_reached + "</ul>\n";
}

std::string WStars(const Run& run) {
  const auto crossover = run.Sections().Find("crossover");
  if (!crossover) return NotMeasured("crossover");
  Rows rows = {{"target", "lanes", "working set", "w*"}};
  for (const ReportField& row : crossover->List("targets")) {
    const auto w_star = row.Find("w_star");
    const auto at_most = row.Find("at_most");
    std::string text = "none";
    if (w_star) {
      text = (at_most && at_most->Flag() ? "at most " : "") +
             Digits(std::round(w_star->Number()));
    }
    rows.push_back({row.At("target").Text(), Digits(row.At("lanes").Number()),
                    row.At("working_set").Text(), text});
  }
  return HtmlTable(rows);
}

std::string CachesOf(const ReportField& context) {
  std::string text;
  for (const ReportField& cache : context.List("caches")) {
    if (!text.empty()) text += ", ";
    text += "L" + Digits(cache.At("level").Number()) + " " +
            Digits(cache.At("size").Number() / 1024.0) + " KiB";
  }
  return text;
}

// A row for each property that one of the machines has.
std::string Machines(const std::vector<Run>& runs) {
  constexpr std::array kKeys = {
      "cpu",        "system",   "architecture", "cores",    "affinity",
      "virtual",    "emulated", "extensions",   "compiler", "flags",
      "build_type", "highway",  "version"};
  Rows rows(1);
  rows[0].emplace_back();
  for (const Run& run : runs) rows[0].push_back(run.name);
  const auto add = [&](const std::string& key, const auto& text_of) {
    std::vector<std::string> row = {key};
    bool has_text = false;
    for (const Run& run : runs) {
      row.push_back(text_of(run));
      has_text = has_text || !row.back().empty();
    }
    if (has_text) rows.push_back(std::move(row));
  };
  for (const char* key : kKeys) {
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    add(name, [key](const Run& run) -> std::string {
      const auto machine = run.Sections().Find("machine");
      const auto value = (machine ? *machine : run.Context()).Find(key);
      return value ? ValueText(value->json()) : "";
    });
  }
  for (const char* key : {"compiled", "supported", "chosen"}) {
    add(std::string("targets ") + key, [key](const Run& run) -> std::string {
      const auto machine = run.Sections().Find("machine");
      const auto targets = machine ? machine->Find("targets") : machine;
      const auto value = targets ? targets->Find(key) : targets;
      return value ? ValueText(value->json()) : "";
    });
  }
  add("caches", [](const Run& run) { return CachesOf(run.Context()); });
  if (runs.size() == 1) rows[0].clear();
  std::string html = HtmlTable(rows);
  html.insert(html.find("<table") + 6, " class=\"machines\"");
  return html;
}

// The figures of one kind, of all machines.
class Drawer {
 public:
  std::string Html(const Figure& figure, const FigureKind& kind,
                   const std::string& machine) {
    std::string label = std::string(kind.title) + ": " + figure.name;
    if (!machine.empty()) label += ", " + machine;
    std::string svg;
    if (is_installed_) is_installed_ = RunGnuplot(GnuplotScript(figure), svg);
    const std::string prefix = "f" + std::to_string(++figures_) + "-";
    svg = InlineSvg(svg, prefix, Escaped(label));
    std::string html = "<figure>\n";
    if (!figure.name.empty()) {
      html += Element(machine.empty() ? "h3" : "h4", figure.name);
    }
    if (svg.empty() && is_installed_) ++failed_;
    html += svg;
    if (!figure.remarks.empty()) {
      html += "<figcaption>";
      for (const std::string& remark : figure.remarks) {
        html += Escaped(remark) + "<br>";
      }
      html += "</figcaption>\n";
    }
    const std::string table = HtmlTable(figure.table);
    html += svg.empty() ? table
                        : "<details><summary>The numbers</summary>" + table +
                              "</details>\n";
    return html + "</figure>\n";
  }

  bool is_installed() const { return is_installed_; }
  std::size_t failed() const { return failed_; }

 private:
  bool is_installed_ = true;
  std::size_t failed_ = 0;
  std::size_t figures_ = 0;
};

// Machines are read off the same scale.
void ShareY(std::vector<Run>& runs, std::size_t kind) {
  std::vector<Figure*> all;
  for (Run& run : runs) {
    for (Figure& figure : run.figures[kind]) all.push_back(&figure);
  }
  if (all.empty()) return;
  double low = all.front()->y.low;
  double high = all.front()->y.high;
  for (const Figure* figure : all) {
    low = std::min(low, figure->y.low);
    high = std::max(high, figure->y.high);
  }
  for (Figure* figure : all) {
    figure->y.low = low;
    figure->y.high = high;
  }
}

// The figures of one kind, beside each other: of one machine, or of several.
std::string Figures(const std::vector<Run>& runs, std::size_t kind,
                    Drawer& drawer) {
  const FigureKind& of = kFigureKinds[kind];
  const bool is_compared = runs.size() > 1;
  std::string html;
  for (const Run& run : runs) {
    std::string part;
    for (const Figure& figure : run.figures[kind]) {
      part += drawer.Html(figure, of, is_compared ? run.name : "");
    }
    if (part.empty()) part = NotMeasured(of.section);
    html += is_compared ? "<div>" + Element("h3", run.name) + part + "</div>\n"
                        : part;
  }
  const bool is_wide = is_compared || of.is_series;
  return std::string(is_wide ? "<section class=\"wide\">\n" : "<section>\n") +
         Element("h2", of.title) + Element("p", of.caption) +
         (is_wide ? "<div class=\"beside\">\n" + html + "</div>\n" : html) +
         "</section>\n";
}

std::string Figures(const std::vector<Run>& runs, Drawer& drawer) {
  std::string html = "<div class=\"beside kinds\">\n";
  for (std::size_t i = 0; i < kFigureKinds.size(); ++i) {
    html += Figures(runs, i, drawer);
  }
  return html + "</div>\n";
}

std::string Maps(const std::vector<Run>& runs) {
  const auto map = [&runs](const char* title, const char* caption,
                           std::string (*make)(const ReportField&)) {
    return Element("h2", title) + Element("p", caption) +
           Beside(runs, [make](const Run& run) {
             const auto sweep = run.Sections().Find("sweep");
             const std::string html = sweep ? make(*sweep) : "";
             return html.empty() ? NotMeasured("sweep") : html;
           });
  };
  return map("Simplex over AABB",
             "The simplex's time over the AABB's: below 1 the simplex is "
             "faster, and the cell is blue.",
             RatioMap) +
         map("The fastest",
             "What answers one query fastest, and its time with the exact "
             "tests of its survivors.",
             FastestTable);
}

std::string HowMeasured(const Run& run) {
  const ReportField context = run.Context();
  std::string html;
  const auto add = [&html](const char* name, const std::string& text) {
    if (!text.empty()) html += Element("li", std::string(name) + ": " + text);
  };
  for (const char* key :
       {"date", "command", "options", "seed", "repetitions"}) {
    const auto value = context.Find(key);
    add(key, value ? ValueText(value->json()) : "");
  }
  const auto machine = run.Sections().Find("machine");
  const auto is_virtual = machine ? machine->Find("virtual") : std::nullopt;
  if (is_virtual && is_virtual->Flag()) {
    add("a virtual machine",
        "its neighbours disturb it; trust the ratios, not the times");
  }
  const auto noise = run.Sections().Find("noise");
  if (noise && noise->At("is_noisy").Flag()) {
    add("noise", "something disturbed this run: the clock changed by " +
                     Digits(100.0 * noise->At("clock_drift").Number()) +
                     " %, where " +
                     Digits(100.0 * noise->At("limit").Number()) +
                     " % are allowed, or a kernel differs from itself");
  }
  return "<ul>" + html + "</ul>\n";
}

std::string Remarks(const Run& run) {
  std::string html;
  for (const auto& [name, section] : run.Sections().json().items()) {
    if (name == "answers") continue;  // which has them on top
    const ReportField field(section, name);
    for (const char* key : {"remarks", "not_reached"}) {
      for (const ReportField& line : field.List(key)) {
        html += Element("li", name + ": " + line.Text());
      }
    }
  }
  return html.empty() ? "<p>None.</p>\n" : "<ul>" + html + "</ul>\n";
}

std::string AllNumbers(const Run& run) {
  std::string html;
  for (const auto& [name, section] : run.Sections().json().items()) {
    html += "<details>" + Element("summary", name) + HtmlOf(section) +
            "</details>\n";
  }
  return html;
}

HtmlPage MakePage(const std::vector<Run>& runs, bool has_all_numbers) {
  Drawer drawer;
  const std::string title =
      runs.size() == 1 ? runs[0].name
                       : std::to_string(runs.size()) + " machines compared";
  const std::string figures = Figures(runs, drawer);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
      "<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
      "'none'; style-src 'unsafe-inline'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n" +
      Element("title", "cpuinfo-bench: " + title) + "<style>" + kPageStyle +
      "</style>\n</head>\n<body>\n<header>\n" + Element("h1", title) +
      "<p class=\"soft\">Which bounds reject fastest here: bounding simplex, "
      "AABB or AABO. Measured by cpuinfo-bench.</p>\n</header>\n<main>\n"
      "<h2>Answers</h2>\n" +
      Answers(runs) +
      "<h2>w*</h2>\n<p>The width of a batch from which on the simplex is "
      "faster than the AABB, with an early-out after every half-space.</p>\n" +
      Beside(runs, WStars) +
      (runs.size() == 1 ? "<h2>Machine</h2>\n" : "<h2>Machines</h2>\n") +
      Machines(runs);
  if (!drawer.is_installed()) {
    html +=
        "<p class=\"soft\">Figures are drawn by gnuplot where it is "
        "installed (Debian: gnuplot-nox); these are their numbers.</p>\n";
  }
  html += figures + Maps(runs) + "<h2>How it was measured</h2>\n" +
          Beside(runs, HowMeasured) +
          "<p>A ratio is the median of the ratios of repetitions that were "
          "timed close to each other, in random order, with its quartiles in "
          "brackets.</p>\n<h2>Remarks</h2>\n" +
          Beside(runs, Remarks) +
          "<section class=\"numbers\">\n<h2>All numbers</h2>\n" +
          (has_all_numbers
               ? Beside(runs, AllNumbers)
               : "<p>Too many for a page; the JSON reports have them.</p>\n") +
          "</section>\n</main>\n</body>\n</html>\n";
  return {std::move(html), drawer.failed()};
}

}  // namespace

void CheckReport(std::string_view json) {
  const Run run(ParseReport(json));
  for (const FigureKind& kind : kFigureKinds) kind.make(run.Sections());
  const std::vector<Run> runs = {run};
  Answers(runs);
  Machines(runs);
  Maps(runs);
  for (const auto part : {WStars, HowMeasured, Remarks, AllNumbers}) part(run);
}

HtmlPage HtmlReport(const std::vector<std::string>& reports) {
  std::vector<Run> runs;
  for (const std::string& report : reports) {
    runs.emplace_back(ParseReport(report));
    Run& run = runs.back();
    const auto is_same = [&run](const Run& other) {
      return other.Context().At("cpu").Text() == run.Context().At("cpu").Text();
    };
    const auto same = std::count_if(runs.begin(), runs.end(), is_same);
    if (same > 1) run.name += " (" + std::to_string(same) + ")";
    for (const FigureKind& kind : kFigureKinds) {
      run.figures.push_back(kind.make(run.Sections()));
    }
  }
  for (std::size_t i = 0; i < kFigureKinds.size(); ++i) {
    if (!kFigureKinds[i].is_series) ShareY(runs, i);
  }
  for (const bool has_all_numbers : {true, false}) {
    HtmlPage page = MakePage(runs, has_all_numbers);
    if (page.html.size() <= kMostPageBytes) return page;
  }
  throw std::invalid_argument("reports too large for a page of 2 MiB");
}

}  // namespace halfspace::bench

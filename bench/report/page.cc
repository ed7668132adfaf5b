// The page to read, from a report in JSON: what was measured here, or
// elsewhere.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/report/report.h"
#include "bench/report/report_parts.h"

namespace halfspace::bench {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kWidth = 90;

std::string String(const Json& json) {
  return Printable(json.get<std::string>());
}

void WriteLine(std::ostream& out, std::string line) {
  line.resize(line.find_last_not_of(' ') + 1);
  out << line << '\n';
}

// Words in lines of at most kWidth, the first after `title`, the others as far
// to the right.
void WriteWrapped(std::ostream& out, const std::string& title,
                  const std::string& text) {
  const std::string indent(title.size(), ' ');
  std::string line = title;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (line.size() + word.size() > kWidth && line.size() > title.size()) {
      WriteLine(out, line);
      line = indent;
    }
    line += word + ' ';
    at = end + 1;
  }
  WriteLine(out, line);
}

std::string Padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

void WriteMachine(std::ostream& out, const Json& report) {
  const Json& context = report.at("context");
  std::string text =
      String(context.at("cpu")) + ", " + String(context.at("system")) + ", " +
      std::to_string(context.at("num_cpus").get<int>()) + " CPUs, caches";
  for (const Json& cache : context.at("caches")) {
    text += " L" + std::to_string(cache.at("level").get<int>()) + " " +
            std::to_string(cache.at("size").get<std::size_t>() / 1024) + " KiB";
  }
  if (context.at("caches").empty()) text += " unknown";
  const Json& sections = report.at("sections");
  if (sections.contains("machine")) {
    const Json& machine = sections.at("machine");
    text += "; best target " + String(machine.at("targets").at("chosen")) +
            "; built by " + String(machine.at("compiler"));
    if (machine.at("virtual")) text += "; a virtual machine";
    if (machine.at("emulated")) text += "; emulated: times mean nothing";
  }
  WriteWrapped(out, "machine    ", text);
  WriteWrapped(
      out, "run        ",
      "cpuinfo-bench " +
          (context.at("command").get<std::string>().empty()
               ? ""
               : String(context.at("command")) + " ") +
          "(" + String(context.at("halfspace_version")) + "), " +
          String(context.at("date")) + ", seed " +
          std::to_string(context.at("seed").get<std::uint64_t>()) +
          ", medians of " +
          std::to_string(context.at("repetitions").get<std::size_t>()) +
          " repetitions [quartiles]");
  if (!sections.contains("noise")) return;
  const Json& noise = sections.at("noise");
  const Json& same = noise.at("same_over_same").at("quartiles");
  WriteWrapped(out, "noise      ",
               std::string("a kernel against itself: ") +
                   Fixed(same.at(0).get<double>(), 2) + " to " +
                   Fixed(same.at(1).get<double>(), 2) +
                   "; the clock changed by " +
                   Fixed(100.0 * noise.at("clock_drift").get<double>(), 1) +
                   " %" + (noise.at("is_noisy") ? ": a noisy run" : ""));
}

void WriteAnswers(std::ostream& out, const Json& sections) {
  if (!sections.contains("answers")) return;
  out << "\nWhat to use";
  if (sections.contains("sweep")) {
    const Json& sweep = sections.at("sweep");
    out << ", one query a call over "
        << Grouped(sweep.at("own").at("objects").get<std::size_t>())
        << " objects, " << Fixed(sweep.at("exact_ns").get<double>(), 0)
        << " ns a survivor (" << String(sweep.at("exact_test")) << ")";
  }
  out << "\n\n";
  for (const Json& answer : sections.at("answers").at("answers")) {
    WriteWrapped(out, "  " + Padded(String(answer.at("question")), 11),
                 String(answer.at("answer")));
  }
}

// The fastest schedule of each shape in each working set, as bars.
void WriteKernels(std::ostream& out, const Json& sections) {
  if (!sections.contains("kernels") || !sections.contains("machine")) return;
  constexpr double kBar = 40.0;
  const Json& chosen = sections.at("machine").at("targets").at("chosen");
  std::vector<std::string> sets;
  std::map<std::pair<std::string, std::string>, const Json*> best;
  double most = 0.0;
  for (const Json& row : sections.at("kernels").at("rows")) {
    if (row.at("target") != chosen) continue;
    const std::string set = row.at("working_set");
    if (std::find(sets.begin(), sets.end(), set) == sets.end()) {
      sets.push_back(set);
    }
    const Json*& fastest = best[{set, row.at("shape").get<std::string>()}];
    const double ns = row.at("ns_per_object");
    if (fastest == nullptr || ns < fastest->at("ns_per_object").get<double>()) {
      fastest = &row;
    }
  }
  for (const auto& [key, row] : best) {
    most = std::max(most, row->at("ns_per_object").get<double>());
  }
  if (best.empty() || most <= 0.0) return;
  out << "\nA flat or staged scan of one query, ns an object ("
      << String(chosen) << ")\n\n";
  for (const std::string& set : sets) {
    for (const char* shape : {"simplex", "aabb", "aabo"}) {
      const Json* row = best[{set, shape}];
      if (row == nullptr) continue;
      const double ns = row->at("ns_per_object");
      out << "  "
          << Padded(shape == std::string("simplex") ? Printable(set) : "", 8)
          << Padded(shape, 8) << Padded(String(row->at("schedule")), 8)
          << Fixed(ns, 3) << " ["
          << Fixed(row->at("ns_quartiles").at(0).get<double>(), 3) << ", "
          << Fixed(row->at("ns_quartiles").at(1).get<double>(), 3) << "] "
          << std::string(static_cast<std::size_t>(std::clamp(
                             std::ceil(kBar * ns / most), 1.0, kBar)),
                         '#')
          << '\n';
    }
  }
}

std::string WidthText(const Json& w, bool is_at_most) {
  if (w.is_null()) return "none";
  return (is_at_most ? "at most " : "") + Fixed(w.get<double>(), 0);
}

// The width from which on the simplex leads, of each target.
void WriteCrossover(std::ostream& out, const Json& sections) {
  if (!sections.contains("crossover")) return;
  std::string text;
  for (const Json& star : sections.at("crossover").at("targets")) {
    text += (text.empty() ? "" : "; ") + String(star.at("target")) + " (" +
            std::to_string(star.at("lanes").get<std::size_t>()) + " lanes, " +
            String(star.at("working_set")) + ") " +
            WidthText(star.at("w_star"), star.at("at_most"));
    const Json& quartiles = star.at("quartiles");
    if (!star.at("w_star").is_null() && !star.at("at_most")) {
      text += " [" + WidthText(quartiles.at(0), false) + ", " +
              WidthText(quartiles.at(1), false) + "]";
    }
  }
  out << "\nEarly-out after every half-space, in batches of w: from w* on the "
         "simplex leads the box\n\n";
  WriteWrapped(out, "  w*         ", text);
}

void WriteModel(std::ostream& out, const Json& sections) {
  if (!sections.contains("model")) return;
  const Json& model = sections.at("model");
  const Json& crossover = model.at("crossover");
  const auto at = [&](const char* by) {
    const Json& lead = crossover.at(by);
    return WidthText(lead.at("w"), lead.at("at_most"));
  };
  WriteWrapped(out, "  predicted  ",
               "w* by half-spaces expected " + at("expected") + ", counted " +
                   at("counted") + ", by their time " + at("predicted") +
                   ", measured " + at("measured") + " (" +
                   String(model.at("target")) + ", " +
                   String(model.at("working_set")) + ")");
  for (const Json& each : model.at("break_even")) {
    BreakEven even;
    even.against = String(each.at("against"));
    if (!each.at("ns").is_null()) {
      even.ns = each.at("ns").get<double>();
      even.low = each.at("quartiles").at(0);
      even.high = each.at("quartiles").at(1);
    }
    WriteWrapped(out, "  break-even ", BreakEvenText(even));
  }
}

// A line for each size of objects, a column for each number of them.
void WriteMap(std::ostream& out, const Json& sections) {
  if (!sections.contains("sweep")) return;
  std::vector<double> sizes;
  std::vector<std::size_t> counts;
  std::map<std::pair<double, std::size_t>, std::string> winners;
  const auto add = [](auto& list, auto value) {
    if (std::find(list.begin(), list.end(), value) == list.end()) {
      list.push_back(value);
    }
  };
  for (const Json& cell : sections.at("sweep").at("cells")) {
    const double size = cell.at("size");
    const std::size_t objects = cell.at("objects");
    add(sizes, size);
    add(counts, objects);
    winners[{size, objects}] = String(cell.at("winner")) +
                               (cell.at("is_tie") ? " ~" : "") + ", " +
                               Fixed(1e-3 * cell.at("ns").get<double>(), 2);
  }
  if (sizes.empty()) return;
  out << "\nFastest way, and us a query with its exact tests, by size of "
         "objects "
         "(of the world's side)\nand their number; ~ where another is as "
         "fast\n\n";
  std::vector<std::string> header = {"size"};
  for (std::size_t count : counts) header.push_back(Grouped(count));
  TextTable table(header);
  for (double size : sizes) {
    std::vector<std::string> row = {Fixed(100.0 * size, 1) + " %"};
    for (std::size_t count : counts) row.push_back(winners[{size, count}]);
    table.AddRow(row);
  }
  table.Write(out, header.size());
}

void WriteReport(std::ostream& out, const Json& report) {
  const Json& sections = report.at("sections");
  WriteMachine(out, report);
  WriteAnswers(out, sections);
  WriteKernels(out, sections);
  WriteCrossover(out, sections);
  WriteModel(out, sections);
  WriteMap(out, sections);
  out << '\n';
  if (sections.contains("answers")) {
    std::string reasons;
    for (const Json& reason : sections.at("answers").at("not_reached")) {
      reasons += (reasons.empty() ? "" : "; ") + String(reason);
    }
    if (!reasons.empty()) WriteWrapped(out, "not reached: ", reasons);
  }
  out << "--details SECTION prints the tables of a section (--list), --format "
         "json everything.\n";
}

}  // namespace

void WritePage(std::ostream& out, std::string_view json) {
  try {
    const Json report = Json::parse(json);
    if (report.at("schema") != kReportSchema) {
      throw std::invalid_argument("a report of schema " +
                                  report.at("schema").dump() + ", not " +
                                  std::to_string(kReportSchema));
    }
    WriteReport(out, report);
  } catch (const Json::exception&) {
    throw std::invalid_argument("no JSON report of this program");
  }
}

}  // namespace halfspace::bench

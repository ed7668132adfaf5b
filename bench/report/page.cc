// The page to read, from a report in JSON: of this run, or of anybody's.
#include <algorithm>
#include <cmath>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/report/figures.h"
#include "bench/report/report.h"
#include "bench/report/report_field.h"
#include "bench/report/report_parts.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kWidth = 90;

std::string Text(const ReportField& field) { return Printable(field.Text()); }

std::string Whole(const ReportField& field) { return Fixed(field.Number(), 0); }

std::string Count(double count) {
  return Grouped(static_cast<std::size_t>(std::clamp(count, 0.0, 1e15)));
}

Ratio Spread(const ReportField& field) {
  const std::vector<ReportField> quartiles = field.List();
  if (quartiles.size() != 2) field.Fail("is no pair of quartiles");
  return {0.0, quartiles[0].Number(), quartiles[1].Number()};
}

std::string Text(const ReportField& median, const ReportField& quartiles,
                 int digits) {
  Ratio ratio = Spread(quartiles);
  ratio.median = median.Number();
  return RatioText(ratio, digits);
}

// A ratio, with its quartiles.
std::string TextOfRatio(const ReportField& ratio) {
  return Text(ratio.At("median"), ratio.At("quartiles"), 2);
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

void WriteMachine(std::ostream& out, const ReportField& report) {
  const ReportField context = report.At("context");
  std::string text = Text(context.At("cpu")) + ", " +
                     Text(context.At("system")) + ", " +
                     Whole(context.At("num_cpus")) + " CPUs, caches";
  const std::vector<ReportField> caches = context.List("caches");
  for (const ReportField& cache : caches) {
    text += " L" + Whole(cache.At("level")) + " " +
            Fixed(cache.At("size").Number() / 1024, 0) + " KiB";
  }
  if (caches.empty()) text += " unknown";
  if (const auto machine = report.At("sections").Find("machine")) {
    text += "; best target " + Text(machine->At("targets").At("chosen")) +
            "; built by " + Text(machine->At("compiler"));
    if (machine->At("virtual").Flag()) text += "; a virtual machine";
    if (machine->At("emulated").Flag()) {
      text += "; emulated: times mean nothing";
    }
  }
  WriteWrapped(out, "machine    ", text);
  const std::string command = Text(context.At("command"));
  WriteWrapped(out, "run        ",
               "cpuinfo-bench " + command + (command.empty() ? "(" : " (") +
                   Text(context.At("halfspace_version")) + "), " +
                   Text(context.At("date")) + ", seed " +
                   Whole(context.At("seed")) + ", medians of " +
                   Whole(context.At("repetitions")) +
                   " repetitions [their quartiles; runs differ by more]");
  if (const auto noise = report.At("sections").Find("noise")) {
    const Ratio same = Spread(noise->At("same_over_same").At("quartiles"));
    WriteWrapped(out, "noise      ",
                 "a kernel against itself: " + Fixed(same.low, 2) + " to " +
                     Fixed(same.high, 2) + "; the clock changed by " +
                     Fixed(100.0 * noise->At("clock_drift").Number(), 1) +
                     " %" +
                     (noise->At("is_noisy").Flag() ? ": a noisy run" : ""));
  }
}

void WriteAnswers(std::ostream& out, const ReportField& sections) {
  const auto answers = sections.Find("answers");
  if (!answers) return;
  out << "\nWhat to use";
  if (const auto sweep = sections.Find("sweep")) {
    out << ", one query a call over "
        << Count(sweep->At("own").At("objects").Number()) << " objects, "
        << Whole(sweep->At("exact_ns")) << " ns a survivor ("
        << Text(sweep->At("exact_test")) << ")";
  }
  out << "\n";
  for (const ReportField& answer : answers->List("answers")) {
    WriteWrapped(out, "  " + Padded(Text(answer.At("question")), 11),
                 Text(answer.At("answer")));
  }
}

// The fastest schedule of each shape, as bars: where all fits a cache of the
// core, and where it does not.
void WriteKernels(std::ostream& out, const ReportField& sections) {
  constexpr double kBar = 40.0;
  std::vector<ReportField> rows = FastestKernels(sections);
  if (rows.empty()) return;
  const std::string last = rows.back().At("working_set").Text();
  std::erase_if(rows, [&last](const ReportField& row) {
    const std::string set = row.At("working_set").Text();
    return set != "L2" && set != last;
  });
  double most = 0.0;
  for (const ReportField& row : rows) {
    most = std::max(most, row.At("ns_per_object").Number());
  }
  if (most <= 0.0) return;
  out << "\nA scan of one query, ns an object (" << Text(rows[0].At("target"))
      << ")\n";
  std::string before;
  for (const ReportField& row : rows) {
    const std::string set = Text(row.At("working_set"));
    const ReportField ns = row.At("ns_per_object");
    out << "  " << Padded(set == before ? "" : set, 8)
        << Padded(Text(row.At("shape")), 8)
        << Padded(Text(row.At("schedule")), 8)
        << Text(ns, row.At("ns_quartiles"), 3) << " "
        << std::string(static_cast<std::size_t>(std::clamp(
                           std::ceil(kBar * ns.Number() / most), 1.0, kBar)),
                       '#')
        << '\n';
    before = set;
  }
}

// A width from which on the simplex leads.
std::string WidthText(const std::optional<ReportField>& w, bool is_at_most) {
  if (!w) return "none";
  return (is_at_most ? "at most " : "") + Whole(*w);
}

void WriteCrossover(std::ostream& out, const ReportField& sections) {
  const auto crossover = sections.Find("crossover");
  if (!crossover) return;
  const std::vector<ReportField> targets = crossover->List("targets");
  std::string text;
  for (const ReportField& star : targets) {
    const auto w = star.Find("w_star");
    const bool is_at_most = star.At("at_most").Flag();
    text += (text.empty() ? "" : "; ") + Text(star.At("target")) + " " +
            WidthText(w, is_at_most);
    if (!w || is_at_most) continue;
    std::string spread;
    for (const ReportField& each : star.At("quartiles").List()) {
      spread += (spread.empty() ? "" : ", ") +
                (each.json().is_null() ? "none" : Whole(each));
    }
    text += " [" + spread + "]";
  }
  if (!targets.empty()) {
    text += " (" + Text(targets[0].At("working_set")) + ")";
  }
  out << "\nEarly-out after every half-space, in batches of w: from w* on the "
         "simplex leads the box\n";
  WriteWrapped(out, "  w*         ", text);
}

void WriteModel(std::ostream& out, const ReportField& sections) {
  const auto model = sections.Find("model");
  if (!model) return;
  const auto at = [&](const char* by) {
    const ReportField lead = model->At("crossover").At(by);
    return WidthText(lead.Find("w"), lead.At("at_most").Flag());
  };
  WriteWrapped(out, "  predicted  ",
               "w* by the half-spaces expected " + at("expected") +
                   ", counted " + at("counted") + ", by their time " +
                   at("predicted") + ", measured " + at("measured") + " (" +
                   Text(model->At("target")) + ", " +
                   Text(model->At("working_set")) + ")");
  std::string limits;
  for (const ReportField& each : model->List("break_even")) {
    const auto ns = each.Find("ns");
    if (!ns) continue;
    limits += (limits.empty() ? "" : ", or ") +
              Text(*ns, each.At("quartiles"), 0) + " ns against the " +
              Text(each.At("against"));
  }
  WriteWrapped(out, "  break-even ",
               limits.empty()
                   ? "the simplex saves no time, or keeps no more"
                   : "with an exact test of more than " + limits +
                         ", the simplex's extra candidates cost more than it "
                         "saves");
}

// The fastest schedule of each volume, where and on what the first row is.
std::string VolumesText(const std::vector<ReportField>& rows) {
  struct Volume {
    std::string name;
    double ratio;
    std::string text;
  };
  std::vector<Volume> volumes;
  for (const ReportField& row : rows) {
    if (row.At("working_set").Text() != rows[0].At("working_set").Text() ||
        row.At("target").Text() != rows[0].At("target").Text()) {
      continue;
    }
    const Volume volume = {Text(row.At("volume")),
                           row.At("over_simplex").At("median").Number(),
                           TextOfRatio(row.At("over_simplex")) + " and " +
                               Fixed(row.At("looseness").Number(), 2)};
    const auto same = std::find_if(
        volumes.begin(), volumes.end(),
        [&](const Volume& other) { return other.name == volume.name; });
    if (same == volumes.end()) {
      volumes.push_back(volume);
    } else if (volume.ratio < same->ratio) {
      *same = volume;
    }
  }
  std::string text;
  for (const Volume& volume : volumes) {
    if (volume.name == "simplex") continue;
    text += (text.empty() ? "" : "; ") + volume.name + " " + volume.text;
  }
  return "time over the simplex's, and survivors over the box's: " + text +
         " (" + Text(rows[0].At("working_set")) + ")";
}

// The last axes of each world over its first, by the simplex's survivors.
std::string AlignmentText(const std::vector<ReportField>& rows) {
  std::string text;
  for (std::size_t i = 0; i + 1 < rows.size(); i += 2) {
    const auto survivors = [&rows](std::size_t row) {
      return rows[row].At("survivors").At("simplex").Number();
    };
    text += (text.empty() ? "" : ", ") + Text(rows[i].At("world")) + " " +
            Fixed(survivors(i + 1) / survivors(i), 2);
  }
  return text;
}

void WriteClaims(std::ostream& out, const ReportField& sections) {
  const auto rows_of = [&sections](const char* name, const char* list) {
    const auto section = sections.Find(name);
    return section ? section->List(list) : std::vector<ReportField>();
  };
  const auto volumes = rows_of("volumes", "rows");
  const auto dimensions = rows_of("volumes", "dimensions");
  const auto dual = rows_of("dual", "rows");
  const auto construction = rows_of("axes", "construction");
  if (!volumes.empty() || !dual.empty() || !construction.empty()) out << '\n';
  if (!volumes.empty()) WriteWrapped(out, "volumes    ", VolumesText(volumes));
  std::string text;
  for (const ReportField& row : dimensions) {
    text += (text.empty() ? "" : ", ") + Whole(row.At("dimensions")) + "D " +
            TextOfRatio(row.At("simplex_over_fastest_aabb"));
  }
  if (!text.empty()) {
    WriteWrapped(out, "dimensions ",
                 "time of the simplex over the box's: " + text);
  }
  if (!dual.empty()) {
    WriteWrapped(out, "dual       ",
                 "an octahedron's second simplex is read for " +
                     Fixed(100.0 * dual[0].At("second_of_64").Number(), 2) +
                     " % of groups of 64 objects; so it takes " +
                     TextOfRatio(dual[0].At("staged_over_flat")) +
                     " of the time of testing all planes");
  }
  if (construction.size() > 1) {
    WriteWrapped(out, "axes       ",
                 "a regular simplex's take " +
                     TextOfRatio(construction[1].At("over_standard")) +
                     " times as long to build; their simplex keeps, times what "
                     "the standard one does: " +
                     AlignmentText(rows_of("axes", "alignment")));
  }
}

// A line for each size of objects, a column for each number of them.
void WriteFastest(std::ostream& out, const ReportField& sections) {
  const auto sweep = sections.Find("sweep");
  if (!sweep) return;
  std::vector<double> counts;
  std::vector<std::vector<std::string>> rows;
  for (const ReportField& cell : sweep->List("cells")) {
    const double count = cell.At("objects").Number();
    const std::string size = Fixed(100.0 * cell.At("size").Number(), 1) + " %";
    auto column = std::find(counts.begin(), counts.end(), count);
    if (column == counts.end()) column = counts.insert(column, count);
    if (rows.empty() || rows.back()[0] != size) rows.push_back({size});
    rows.back().resize(static_cast<std::size_t>(column - counts.begin()) + 1);
    rows.back().push_back(Text(cell.At("winner")) +
                          (cell.At("is_tie").Flag() ? " ~, " : ", ") +
                          Fixed(1e-3 * cell.At("ns").Number(), 2));
  }
  if (rows.empty()) return;
  out << "\nFastest way, and us a query with its exact tests, by size of "
         "objects "
         "(of the world's side)\nand their number; ~ where another is as "
         "fast\n";
  std::vector<std::string> header = {"size"};
  for (double count : counts) header.push_back(Count(count));
  TextTable table(header);
  for (std::vector<std::string>& row : rows) {
    row.resize(header.size());
    table.AddRow(row);
  }
  table.Write(out, header.size());
}

void WriteNotReached(std::ostream& out, const ReportField& sections) {
  const auto answers = sections.Find("answers");
  if (!answers) return;
  std::string reasons;
  for (const ReportField& reason : answers->List("not_reached")) {
    reasons += (reasons.empty() ? "" : "; ") + Text(reason);
  }
  if (!reasons.empty()) WriteWrapped(out, "not reached ", reasons);
}

}  // namespace

void WritePage(std::ostream& out, std::string_view json) {
  const Json parsed = ParseReport(json);
  const ReportField report(parsed, "the report");
  const ReportField sections = report.At("sections");
  WriteMachine(out, report);
  WriteAnswers(out, sections);
  WriteKernels(out, sections);
  WriteCrossover(out, sections);
  WriteModel(out, sections);
  WriteClaims(out, sections);
  WriteFastest(out, sections);
  out << '\n';
  WriteNotReached(out, sections);
  out << "--details SECTION prints the tables of a section (--list), --report "
         "FILE.html draws figures.\n";
}

}  // namespace halfspace::bench

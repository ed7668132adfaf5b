// The text of the sections that the page is drawn from: the cost model, the
// sweep, threads, noise and answers.
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/report/report.h"
#include "bench/report/report_parts.h"

namespace halfspace::bench {
namespace {

std::string Text(const LeadFrom& lead) {
  if (!lead.w) return "no crossover";
  return (lead.is_at_most ? "at most " : "") + Fixed(*lead.w, 0);
}

std::string Percent(const std::optional<double>& share) {
  return share ? Fixed(100.0 * *share, 1) + " %" : "own";
}

void WriteWays(std::ostream& out, const SweepCell& cell) {
  TextTable table({"shape", "schedule", "precision", "us", "survivors",
                   "with exact tests", "of the best"});
  std::vector<Way> ways = cell.ways;
  std::sort(ways.begin(), ways.end(), [](const Way& a, const Way& b) {
    return a.ns_with_exact < b.ns_with_exact;
  });
  for (const Way& way : ways) {
    table.AddRow({way.shape, way.schedule, way.precision,
                  Fixed(way.ns * 1e-3, 3), Fixed(way.survivors, 1),
                  Fixed(way.ns_with_exact * 1e-3, 3), RatioText(way.of_best)});
  }
  table.Write(out, 3);
}

// Up to which exact test the simplex pays.
std::string BreakEvenText(const BreakEven& break_even) {
  if (!break_even.ns) {
    return "Against the " + break_even.against +
           " the simplex saves no time, or keeps no more.";
  }
  return "With an exact test of more than " +
         RatioText({*break_even.ns, break_even.low, break_even.high}, 0) +
         " ns the simplex's extra candidates cost more than it saves against "
         "the " +
         break_even.against + ".";
}

}  // namespace

void WriteText(std::ostream& out, const ModelResult& result) {
  Heading(out, "model",
          "E[C] half-spaces an object, each of a compare's time, against what "
          "is measured");
  out << "  " << result.target << ", " << result.working_set << ", "
      << Grouped(result.objects) << " objects: a compare "
      << Fixed(result.compare_ns, 4) << " ns an object, a call "
      << Fixed(result.call_ns, 1) << " ns, "
      << Fixed(result.call_ns / static_cast<double>(result.objects), 4)
      << " an object\n\n";
  TextTable rows({"shape", "w", "p", "E[C]", "counted", "compare ns",
                  "predicted ns", "measured ns", "measured/predicted"});
  for (const ModelShape& shape : result.shapes) {
    for (const ModelRow& row : shape.rows) {
      rows.AddRow({shape.shape, std::to_string(row.w), Fixed(row.p, 3),
                   Fixed(row.expected, 2), Fixed(row.counted, 2),
                   Fixed(row.compare_ns, 4), Fixed(row.predicted_ns, 4),
                   Fixed(row.measured_ns, 4),
                   RatioText(row.measured_over_predicted)});
    }
  }
  rows.Write(out, 1);
  out << "\n  Adv(w), the AABB's cost over the simplex's\n\n";
  TextTable advantages({"w", "expected", "counted", "predicted", "measured"});
  for (const AdvantageRow& row : result.advantages) {
    advantages.AddRow({std::to_string(row.w), Fixed(row.expected, 2),
                       Fixed(row.counted, 2), Fixed(row.predicted, 2),
                       RatioText(row.measured)});
  }
  advantages.AddRow({"w*", Text(result.expected), Text(result.counted),
                     Text(result.predicted), Text(result.measured)});
  advantages.Write(out, 1);
  out << '\n';
  TextTable shapes({"shape", "schedule", "ns/object", "candidates"});
  for (const ModelShape& shape : result.shapes) {
    shapes.AddRow({shape.shape, shape.schedule, Fixed(shape.ns_per_object, 4),
                   Fixed(shape.candidates * 1e6, 2) + " in a million"});
  }
  shapes.Write(out, 2);
  out << '\n';
  TextTable exact({"exact test", "ns", "quartiles"});
  for (const ExactTest& test : result.exact_tests) {
    exact.AddRow({test.name, Fixed(test.ns, 1),
                  Fixed(test.low, 1) + " to " + Fixed(test.high, 1)});
  }
  exact.Write(out, 1);
  out << '\n';
  for (const BreakEven& each : result.break_even) {
    out << "  " << BreakEvenText(each) << '\n';
  }
}

void WriteText(std::ostream& out, const SweepResult& result) {
  Heading(out, "sweep",
          "the fastest way to a list of survivors and their exact tests");
  out << "  " << result.target << "; an exact test of "
      << Fixed(result.exact_ns, 1) << " ns (" << result.exact_test << ")\n\n";
  TextTable table({"object size", "objects", "winner", "", "X overlap",
                   "survivors", "us a query"});
  for (const SweepCell& cell : result.cells) {
    const Way& best = cell.ways[cell.best];
    table.AddRow({Percent(cell.size), Grouped(cell.objects), best.name(),
                  cell.is_tie ? "tie" : "", Percent(cell.slab_overlap),
                  Fixed(best.survivors, 1),
                  Fixed(best.ns_with_exact * 1e-3, 3)});
  }
  table.Write(out, 4);
  out << "\n  Own workload, " << Grouped(result.own.objects) << " objects\n\n";
  WriteWays(out, result.own);
  out << "\n  Simplex over AABB, early-out in batches of w\n\n";
  TextTable map({"w", "X overlap", "time [quartiles]"});
  for (const MapPoint& point : result.map) {
    map.AddRow({std::to_string(point.w), Percent(point.slab_overlap),
                RatioText(point.simplex_over_aabb)});
  }
  map.Write(out, 0);
}

void WriteText(std::ostream& out, const ThreadsResult& result) {
  Heading(out, "threads", "scans that threads share; real time");
  TextTable table({"work", "threads", "ns/pair", "times as fast as one"});
  for (const ThreadsRow& row : result.rows) {
    table.AddRow({row.work, std::to_string(row.threads),
                  Fixed(row.ns_per_pair, 4), RatioText(row.times)});
  }
  table.Write(out, 1);
  WriteNotReached(out, result.not_reached);
}

void WriteText(std::ostream& out, const NoiseResult& result) {
  Heading(out, "noise", "what disturbed this run");
  out << "  A kernel timed against itself: " << RatioText(result.same_over_same)
      << " times; the clock changed by " << Fixed(100.0 * result.clock_drift, 1)
      << " %. A run is noisy from " << Fixed(100.0 * result.limit, 0) << " % on"
      << (result.is_noisy() ? ": this one is.\n" : ": this one is not.\n");
}

void WriteText(std::ostream& out, const AnswersResult& result) {
  Heading(out, "answers", "what to use on this machine");
  for (const Answer& answer : result.answers) {
    out << "  " << answer.question << ": " << answer.text << '\n';
  }
  WriteNotReached(out, result.not_reached);
}

}  // namespace halfspace::bench

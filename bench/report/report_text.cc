#include <string>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/report/paper.h"
#include "bench/report/report.h"
#include "bench/report/report_parts.h"

namespace halfspace::bench {
namespace {

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += ' ';
    text += word;
  }
  return text.empty() ? "unknown" : text;
}

std::string CachesOf(const Machine& machine) {
  std::string text;
  for (const Cache& cache : machine.caches) {
    if (!text.empty()) text += ", ";
    text += 'L';
    text += std::to_string(cache.level) + " " +
            std::to_string(cache.bytes >> 10) + " KiB";
  }
  return text.empty() ? "unknown: 32 KiB, 256 KiB and 8 MiB are taken" : text;
}

std::string Looseness(std::size_t survivors, std::size_t of_aabb) {
  if (of_aabb == 0) return "-";
  return Fixed(static_cast<double>(survivors) / static_cast<double>(of_aabb),
               2);
}

void AddSurvivorRows(TextTable& table, const PerShape<std::size_t>& count) {
  table.AddRow(
      {"aabb", Grouped(count.aabb), Looseness(count.aabb, count.aabb)});
  table.AddRow({"simplex", Grouped(count.simplex),
                Looseness(count.simplex, count.aabb)});
  table.AddRow(
      {"aabo", Grouped(count.aabo), Looseness(count.aabo, count.aabb)});
}

}  // namespace

void WriteText(std::ostream& out, const MachineResult& result) {
  const Machine& m = result.machine;
  Heading(out, "machine", m.cpu);
  TextTable table({"system", m.system + ", " + m.architecture});
  table.AddRow({"cores", std::to_string(m.cores) + ", of which this run uses " +
                             m.affinity});
  table.AddRow({"caches", CachesOf(m)});
  table.AddRow({"extensions", Joined(m.isa)});
  table.AddRow({"compiled", Joined(result.compiled)});
  table.AddRow({"supported", Joined(result.supported)});
  table.AddRow({"chosen", result.chosen + ", " + result.why_chosen});
  table.AddRow({"built by", result.build.compiler + ", " + result.build.type +
                                ", Highway " + result.build.highway});
  table.AddRow({"flags", result.build.flags});
  table.AddRow({"version", result.build.version});
  table.Write(out, 2);
  if (m.is_emulated) {
    out << "\n  Warning: this CPU is emulated. Answers and counts hold, times "
           "mean nothing.\n";
  } else if (m.is_virtual) {
    out << "\n  Warning: a virtual machine. Neighbours disturb it: trust the "
           "ratios, not the times.\n";
  }
  if (result.build.type == "debug") {
    out << "\n  Warning: a debug build. Times mean nothing.\n";
  }
}

void WriteText(std::ostream& out, const CheckResult& result) {
  Heading(out, "check",
          "every target, shape and schedule against the scalar reference");
  out << "  " << Grouped(result.masks) << " masks of "
      << Grouped(result.objects)
      << " objects agree bit for bit: " << Joined(result.targets) << '\n';
}

void WriteText(std::ostream& out, const Table1Result& result) {
  Heading(out, "table1",
          "half-spaces evaluated per object, early-out in batches of w");
  out << "  " << Grouped(result.objects) << " objects, " << result.queries
      << " queries, seed " << result.seed << "; in brackets the paper's\n\n";
  TextTable table({"w", "aabb", "", "simplex", "", "aabo", ""});
  const auto paper = [](double value) { return "(" + Fixed(value, 2) + ")"; };
  for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
    table.AddRow({std::to_string(kWorkWidths[i]), Fixed(result.work.aabb[i], 2),
                  paper(kPaperWork.aabb[i]), Fixed(result.work.simplex[i], 2),
                  paper(kPaperWork.simplex[i]), Fixed(result.work.aabo[i], 2),
                  paper(kPaperWork.aabo[i])});
  }
  table.Write(out, 0);
  out << '\n';
  // Survivors grow with the scene; how loose a shape is does not.
  const bool is_papers_size =
      result.objects == kPaperObjects && result.queries == kPaperQueries;
  TextTable accepts({"shape", "accepts", "looseness",
                     is_papers_size ? "paper's" : "paper's looseness"});
  const auto add = [&](const char* name, std::size_t count,
                       std::size_t papers) {
    accepts.AddRow({name, Grouped(count), Looseness(count, result.accepts.aabb),
                    (is_papers_size ? Grouped(papers) + " " : "") +
                        Looseness(papers, kPaperAccepts.aabb)});
  };
  add("aabb", result.accepts.aabb, kPaperAccepts.aabb);
  add("simplex", result.accepts.simplex, kPaperAccepts.simplex);
  add("aabo", result.accepts.aabo, kPaperAccepts.aabo);
  accepts.Write(out, 1);
}

void WriteText(std::ostream& out, const CrossoverResult& result) {
  Heading(
      out, "crossover",
      "ns per object; every-plane stops a batch of w after each half-space");
  TextTable table({"target", "set", "schedule", "w", "aabb", "simplex", "aabo",
                   "simplex/aabb [quartiles]"});
  for (const CrossoverRow& row : result.rows) {
    table.AddRow(
        {row.target, row.working_set, row.schedule,
         row.w ? std::to_string(*row.w) : "-", Fixed(row.ns.aabb, 4),
         Fixed(row.ns.simplex, 4), Fixed(row.ns.aabo, 4),
         row.simplex_over_aabb ? RatioText(*row.simplex_over_aabb) : "-"});
  }
  table.Write(out, 3);
  out << '\n';
  TextTable stars({"target", "set", "lanes", "w*"});
  for (const WStar& star : result.w_stars) {
    std::string text = "no crossover";
    if (star.w_star) {
      text = (star.is_at_most ? "at most " : "") + Fixed(*star.w_star, 0);
    }
    stars.AddRow(
        {star.target, star.working_set, std::to_string(star.lanes), text});
  }
  stars.Write(out, 2);
  WriteNotReached(out, result.not_reached);
}

void WriteText(std::ostream& out, const KernelsResult& result) {
  Heading(out, "kernels",
          "GB/s of whole records; percent of reading the same planes");
  TextTable table({"shape", "set", "target", "schedule", "objects", "ns/object",
                   "Gobjects/s", "GB/s", "% of read"});
  for (const KernelRow& row : result.rows) {
    table.AddRow({row.shape, row.working_set, row.target, row.schedule,
                  Grouped(row.objects), Fixed(row.ns_per_object, 4),
                  Fixed(1.0 / row.ns_per_object, 2),
                  Fixed(row.gigabytes_per_second, 1),
                  Fixed(row.percent_of_read.median, 0)});
  }
  table.Write(out, 4);
  WriteNotReached(out, result.not_reached);
}

void WriteText(std::ostream& out, const BuildResult& result) {
  Heading(out, "build",
          "bounding many shapes; percent of copying the same bytes");
  TextTable table({"shapes", "to", "rounding", "set", "target", "objects", "ns",
                   "per", "GB/s", "% of copy", "fastest copy", "its GB/s"});
  for (const BuildRow& row : result.rows) {
    table.AddRow({row.shapes, row.planes, row.rounding, row.working_set,
                  row.target, Grouped(row.objects), Fixed(row.ns_per_item, 3),
                  row.item, Fixed(row.gigabytes_per_second, 1),
                  Fixed(row.percent_of_copy.median, 0), row.copy,
                  Fixed(row.copy_gigabytes_per_second, 1)});
  }
  table.Write(out, 5);
  if (!result.thresholds.empty()) out << '\n';
  for (const BuildThreshold& threshold : result.thresholds) {
    out << "  " << threshold.target << ": boxes to aabo in memory at "
        << Fixed(threshold.percent_of_copy, 0)
        << " % of copying; aim: at least "
        << Fixed(thresholds::kBuildPercentOfCopy, 0)
        << (threshold.is_met() ? ", met" : ", missed") << '\n';
  }
  out << '\n';
  TextTable singles({"one shape at a time", "ns"});
  for (const SingleBuildRow& row : result.singles) {
    singles.AddRow({row.call, Fixed(row.ns_per_call, 1)});
  }
  singles.Write(out, 1);
  WriteNotReached(out, result.not_reached);
}

void WriteText(std::ostream& out, const QualityResult& result) {
  Heading(out, "quality", "survivors, of " + Printable(result.workload));
  out << "  " << Grouped(result.objects) << " objects, "
      << Grouped(result.queries) << " queries\n\n";
  TextTable table({"shape", "survivors", "looseness"});
  AddSurvivorRows(table, result.survivors);
  table.Write(out, 1);
}

void WriteText(std::ostream& out, const SegmentsResult& result) {
  Heading(out, "segments",
          "objects kept by a long segment in pieces, of " +
              Printable(result.workload));
  out << "  " << Grouped(result.objects) << " objects, means of "
      << result.segments << " segments, seed " << result.seed
      << "; one test reads " << kRecordBytes.simplex << " (simplex), "
      << kRecordBytes.aabb << " (aabb), " << kRecordBytes.aabo
      << " (aabo) bytes\n\n";
  TextTable table({"direction", "length", "pieces", "aabb", "simplex", "aabo",
                   "floor", "tests"});
  for (const SegmentRow& row : result.rows) {
    table.AddRow({row.direction, Fixed(100.0 * row.length, 0) + " %",
                  std::to_string(row.pieces), Fixed(row.kept.aabb, 1),
                  Fixed(row.kept.simplex, 1), Fixed(row.kept.aabo, 1),
                  Fixed(row.floor, 1), Grouped(row.tests)});
  }
  table.Write(out, 1);
}

}  // namespace halfspace::bench

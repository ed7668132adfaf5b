#include <optional>
#include <string>

#include "bench/base/text_table.h"
#include "bench/report/report.h"
#include "bench/report/report_parts.h"

namespace halfspace::bench {

namespace {

std::optional<double> InMicroseconds(std::optional<double> ns) {
  if (ns) *ns /= 1e3;
  return ns;
}

}  // namespace

void WriteText(std::ostream& out, const SortedResult& result) {
  Heading(
      out, "sorted",
      "us a query; times as fast as the fastest competitor, which has 1.00");
  for (const SortedWorkload& workload : result.workloads) {
    out << "  " << workload.name << ": " << Grouped(workload.objects)
        << " boxes, of which a query finds " << Fixed(workload.survivors, 1);
    if (workload.blocks > 0.0) {
      out << " in " << Fixed(workload.blocks, 1) << " blocks of 64, each in "
          << Fixed(workload.rows.front().ns / workload.blocks, 1) << " ns";
    }
    out << "\n\n";
    TextTable rows({"what", "target", "us", "times", "in turns: us", "times"});
    for (const SortedRow& row : workload.rows) {
      rows.AddRow({row.name, row.target.empty() ? "-" : row.target,
                   Fixed(row.ns / 1e3, 3), Fixed(row.over_fastest, 2),
                   Fixed(InMicroseconds(row.ns_in_turns), 3),
                   Fixed(row.over_fastest_in_turns, 2)});
    }
    rows.Write(out, 2);
    out << '\n';
  }
  TextTable jobs({"of all objects", "objects", "ms"});
  for (const SortedJob& job : result.jobs) {
    jobs.AddRow({job.name, Grouped(job.objects), Fixed(job.ms, 1)});
  }
  jobs.Write(out, 1);
  out << '\n';
  if (result.scan_is_faster_below) {
    if (*result.scan_is_faster_below > 0.0) {
      out << "  Below " << Fixed(*result.scan_is_faster_below, 0)
          << " boxes a flat scan is faster, one query a call.\n";
    } else {
      out << "  A flat scan is at no size faster, one query a call.\n";
    }
  }
  for (const std::string& remark : result.remarks) {
    out << "  " << remark << ".\n";
  }
  out << '\n';
  WriteRatios(out, result.ratios,
              " One that is missed is no failure, and no wrong answer.");
  WriteNotReached(out, result.not_reached);
}

}  // namespace halfspace::bench

// The two forms of the results.
#ifndef HALFSPACE_BENCH_REPORT_REPORT_H_
#define HALFSPACE_BENCH_REPORT_REPORT_H_

#include <ostream>
#include <string>
#include <string_view>

#include "bench/report/results.h"

namespace halfspace::bench {

// One section for a person; nothing for a section without a result. Called as
// soon as the section is done.
void WriteText(std::ostream& out, const MachineResult& result);
void WriteText(std::ostream& out, const CheckResult& result);
void WriteText(std::ostream& out, const Table1Result& result);
void WriteText(std::ostream& out, const CrossoverResult& result);
void WriteText(std::ostream& out, const KernelsResult& result);
void WriteText(std::ostream& out, const BuildResult& result);
void WriteText(std::ostream& out, const ThroughputResult& result);
void WriteText(std::ostream& out, const SortedResult& result);
void WriteText(std::ostream& out, const QualityResult& result);
void WriteText(std::ostream& out, const VolumesResult& result);
void WriteText(std::ostream& out, const DualResult& result);
void WriteText(std::ostream& out, const AxesResult& result);
void WriteText(std::ostream& out, const SegmentsResult& result);
void WriteText(std::ostream& out, const ModelResult& result);
void WriteText(std::ostream& out, const SweepResult& result);
void WriteText(std::ostream& out, const ThreadsResult& result);
void WriteText(std::ostream& out, const NoiseResult& result);
void WriteText(std::ostream& out, const AnswersResult& result);

// Everything, for a program: docs/cpuinfo-bench.md describes the schema.
inline constexpr int kReportSchema = 3;
std::string ToJson(const Results& results);

// The page to read, at most 60 lines, of a report that ToJson() has made, now
// or on another machine. What was not measured is left out. Throws
// std::invalid_argument, with what is wrong, for what is no report.
void WritePage(std::ostream& out, std::string_view json);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_REPORT_H_

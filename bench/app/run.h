// Runs the selected sections.
#ifndef HALFSPACE_BENCH_APP_RUN_H_
#define HALFSPACE_BENCH_APP_RUN_H_

#include <optional>
#include <ostream>

#include "bench/base/progress.h"
#include "bench/report/table.h"
#include "bench/sections/options.h"
#include "bench/worlds/workload.h"

namespace halfspace::bench {

// Exit codes of the program.
inline constexpr int kExitOk = 0;
inline constexpr int kExitWrongAnswer = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitBadInput = 3;
inline constexpr int kExitFailed = 4;

// `input` is the workload of a file, if one was given. With `text`, the report
// is written there: the page at the end, the tables of --details as soon as
// their sections are done. Throws WrongAnswer, and UsageError if the scene does
// not fit the memory.
Report RunSections(const BenchOptions& options, std::optional<Workload> input,
                   Progress& progress, std::ostream* text);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_APP_RUN_H_

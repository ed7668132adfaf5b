// Runs the selected sections, in order.
#ifndef HALFSPACE_BENCH_APP_RUN_H_
#define HALFSPACE_BENCH_APP_RUN_H_

#include <optional>
#include <ostream>

#include "bench/app/options.h"
#include "bench/base/progress.h"
#include "bench/report/results.h"
#include "bench/worlds/workload.h"

namespace halfspace::bench {

// `input` is the workload of a file, if one was given; the paper's scene is
// made where it is needed. With `text`, each section is written there as soon
// as it is done. Throws WrongAnswer, and UsageError if the scene does not fit
// the memory.
Results Run(const BenchOptions& options, std::optional<Workload> input,
            Progress& progress, std::ostream* text);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_APP_RUN_H_

// The page of --report, of this run or of the files of --render.
#ifndef HALFSPACE_BENCH_APP_HTML_PAGE_H_
#define HALFSPACE_BENCH_APP_HTML_PAGE_H_

#include <string>
#include <vector>

#include "bench/app/options.h"
#include "bench/app/out_file.h"

namespace halfspace::bench {

// Of these JSON reports.
void WriteHtml(OutFile& file, const std::vector<std::string>& reports);

// What --render does: the pages of stored reports. The exit code. Throws
// InputError, and UsageError of a file that cannot be written.
int Render(const BenchOptions& options);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_APP_HTML_PAGE_H_

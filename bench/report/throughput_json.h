// The sections `throughput` and `sorted` of the JSON report.
#ifndef HALFSPACE_BENCH_REPORT_THROUGHPUT_JSON_H_
#define HALFSPACE_BENCH_REPORT_THROUGHPUT_JSON_H_

#include <nlohmann/json.hpp>

#include "bench/report/results.h"

namespace halfspace::bench {

nlohmann::ordered_json ToJson(const ThroughputResult& result);
nlohmann::ordered_json ToJson(const SortedResult& result);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_THROUGHPUT_JSON_H_

// The sections `volumes`, `dual` and `axes` of the JSON report.
#ifndef HALFSPACE_BENCH_REPORT_ALTERNATIVES_JSON_H_
#define HALFSPACE_BENCH_REPORT_ALTERNATIVES_JSON_H_

#include <nlohmann/json.hpp>

#include "bench/report/alternatives.h"

namespace halfspace::bench {

nlohmann::ordered_json ToJson(const VolumesResult& result);
nlohmann::ordered_json ToJson(const DualResult& result);
nlohmann::ordered_json ToJson(const AxesResult& result);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_ALTERNATIVES_JSON_H_

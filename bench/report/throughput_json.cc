#include "bench/report/throughput_json.h"

#include <optional>
#include <string>
#include <vector>

namespace halfspace::bench {
namespace {

using Json = nlohmann::ordered_json;

Json OrNull(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json OrNull(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json ToJson(const std::vector<ThroughputRatio>& ratios) {
  Json list = Json::array();
  for (const ThroughputRatio& ratio : ratios) {
    list.push_back(
        {{"threshold", ratio.threshold},
         {"name", ratio.name},
         {"value", ratio.value},
         {"needed", ratio.needed},
         {"better", ratio.is_higher_better ? "higher" : "lower"},
         {"met", ratio.is_met()},
         {"quartiles", ratio.quartiles
                           ? Json({ratio.quartiles->low, ratio.quartiles->high})
                           : Json(nullptr)}});
  }
  return list;
}

}  // namespace

Json ToJson(const ThroughputResult& result) {
  Json rows = Json::array();
  for (const ThroughputRow& row : result.rows) {
    rows.push_back(
        {{"name", row.name},
         {"objects", row.objects},
         {"queries", row.queries},
         {"working_set", row.working_set},
         {"target", OrNull(row.target)},
         {"ns_per_pair", row.ns_per_pair},
         {"ceiling",
          row.ceiling ? Json(result.rows[*row.ceiling].name) : Json(nullptr)},
         {"percent_of_ceiling", OrNull(row.percent_of_ceiling)}});
  }
  Json survivors = nullptr;
  if (result.survivors) {
    survivors = {{"aabb", result.survivors->aabb},
                 {"simplex", result.survivors->simplex},
                 {"aabo", result.survivors->aabo}};
  }
  return {{"rows", rows},
          {"ratios", ToJson(result.ratios)},
          {"survivors", survivors},
          {"not_reached", result.not_reached}};
}

Json ToJson(const SortedResult& result) {
  Json workloads = Json::array();
  for (const SortedWorkload& workload : result.workloads) {
    Json rows = Json::array();
    for (const SortedRow& row : workload.rows) {
      rows.push_back(
          {{"name", row.name},
           {"target", OrNull(row.target)},
           {"ns_per_query", row.ns},
           {"ns_per_query_in_turns", OrNull(row.ns_in_turns)},
           {"over_fastest", OrNull(row.over_fastest)},
           {"over_fastest_in_turns", OrNull(row.over_fastest_in_turns)}});
    }
    workloads.push_back({{"name", workload.name},
                         {"objects", workload.objects},
                         {"survivors_per_query", workload.survivors},
                         {"blocks_per_query", workload.blocks},
                         {"rows", rows}});
  }
  Json jobs = Json::array();
  for (const SortedJob& job : result.jobs) {
    jobs.push_back(
        {{"name", job.name}, {"objects", job.objects}, {"ms", job.ms}});
  }
  return {{"workloads", workloads},
          {"jobs", jobs},
          {"scan_is_faster_below", OrNull(result.scan_is_faster_below)},
          {"ratios", ToJson(result.ratios)},
          {"remarks", result.remarks},
          {"not_reached", result.not_reached}};
}

}  // namespace halfspace::bench

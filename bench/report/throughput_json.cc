#include "bench/report/throughput_json.h"

namespace halfspace::bench {
namespace {

using Json = nlohmann::ordered_json;

Json OrNull(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
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
         {"percent_of_ceiling", row.percent_of_ceiling
                                    ? Json(*row.percent_of_ceiling)
                                    : Json(nullptr)}});
  }
  Json ratios = Json::array();
  for (const ThroughputRatio& ratio : result.ratios) {
    ratios.push_back(
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
  Json survivors = nullptr;
  if (result.survivors) {
    survivors = {{"aabb", result.survivors->aabb},
                 {"simplex", result.survivors->simplex},
                 {"aabo", result.survivors->aabo}};
  }
  return {{"rows", rows},
          {"ratios", ratios},
          {"survivors", survivors},
          {"not_reached", result.not_reached}};
}

}  // namespace halfspace::bench

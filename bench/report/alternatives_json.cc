#include "bench/report/alternatives_json.h"

namespace halfspace::bench {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const Ratio& ratio) {
  return {{"median", ratio.median}, {"quartiles", {ratio.low, ratio.high}}};
}

Json Survivors(std::size_t aabb, std::size_t simplex, std::size_t aabo) {
  return {{"aabb", aabb}, {"simplex", simplex}, {"aabo", aabo}};
}

}  // namespace

Json ToJson(const VolumesResult& result) {
  Json rows = Json::array();
  for (const VolumeRow& row : result.rows) {
    rows.push_back({{"volume", row.volume},
                    {"schedule", row.schedule},
                    {"target", row.target},
                    {"working_set", row.working_set},
                    {"objects", row.objects},
                    {"bytes_per_object", row.bytes_per_object},
                    {"ns_per_object", row.ns_per_object},
                    {"over_simplex", ToJson(row.over_simplex)},
                    {"looseness", row.looseness}});
  }
  Json dimensions = Json::array();
  for (const DimensionRow& row : result.dimensions) {
    dimensions.push_back(
        {{"dimensions", row.dimensions},
         {"target", row.target},
         {"objects", row.objects},
         {"scale", row.scale},
         {"simplex_ns", row.simplex_ns},
         {"aabb_flat_ns", row.aabb_flat_ns},
         {"aabb_staged_ns", row.aabb_staged_ns},
         {"aabo_flat_ns", row.aabo_flat_ns},
         {"aabo_staged_ns", row.aabo_staged_ns},
         {"simplex_over_flat_aabb", ToJson(row.simplex_over_flat_aabb)},
         {"simplex_over_fastest_aabb", ToJson(row.simplex_over_fastest_aabb)},
         {"queries", row.queries},
         {"survivors", Survivors(row.aabb_survivors, row.simplex_survivors,
                                 row.aabo_survivors)}});
  }
  return {{"workload", result.workload},
          {"distinct", result.distinct},
          {"rows", rows},
          {"dimensions", dimensions},
          {"not_reached", result.not_reached}};
}

Json ToJson(const DualResult& result) {
  Json rows = Json::array();
  for (const DualRow& row : result.rows) {
    rows.push_back({{"content", row.content},
                    {"working_set", row.working_set},
                    {"target", row.target},
                    {"lanes", row.lanes},
                    {"objects", row.objects},
                    {"second_of_1", row.second_of_1},
                    {"second_of_lanes", row.second_of_lanes},
                    {"second_of_64", row.second_of_64},
                    {"simplex_ns", row.simplex_ns},
                    {"refined_ns", row.refined_ns},
                    {"flat_ns", row.flat_ns},
                    {"staged_ns", row.staged_ns},
                    {"staged_over_flat", ToJson(row.staged_over_flat)},
                    {"refined_over_staged", ToJson(row.refined_over_staged)},
                    {"staged_over_simplex", ToJson(row.staged_over_simplex)}});
  }
  return {{"rows", rows}, {"not_reached", result.not_reached}};
}

Json ToJson(const AxesResult& result) {
  Json construction = Json::array();
  for (const ConstructionRow& row : result.construction) {
    construction.push_back({{"axes", row.axes},
                            {"target", row.target},
                            {"clouds", row.clouds},
                            {"flops_per_point", row.flops_per_point},
                            {"rounded_planes", row.rounded_planes},
                            {"ns_per_cloud", row.ns_per_cloud},
                            {"over_standard", ToJson(row.over_standard)},
                            {"pad_over_extent", row.pad_over_extent}});
  }
  Json alignment = Json::array();
  for (const AlignmentRow& row : result.alignment) {
    alignment.push_back(
        {{"world", row.world},
         {"objects", row.objects},
         {"queries", row.queries},
         {"axes", row.axes},
         {"survivors", Survivors(row.aabb_survivors, row.simplex_survivors,
                                 row.aabo_survivors)}});
  }
  return {{"seed", result.seed},
          {"construction", construction},
          {"alignment", alignment}};
}

}  // namespace halfspace::bench

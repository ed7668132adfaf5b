#include <ctime>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/report/report.h"
#include "bench/report/throughput_json.h"

namespace halfspace::bench {
namespace {

// Ordered, so that the file reads as the sections run.
using Json = nlohmann::ordered_json;

template <typename T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

template <typename T>
Json ToJson(const PerShape<T>& values) {
  return {{"aabb", values.aabb},
          {"simplex", values.simplex},
          {"aabo", values.aabo}};
}

std::string Now() {
  const std::time_t now = std::time(nullptr);
  char text[32] = "";
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  return text;
}

// Google Benchmark's names where it has them; the build type is this program's
// own, not that of the installed benchmark library.
Json ContextJson(const MachineResult& result, const std::string& options) {
  const Machine& m = result.machine;
  Json caches = Json::array();
  for (const Cache& cache : m.caches) {
    caches.push_back({{"type", cache.level == 1 ? "Data" : "Unified"},
                      {"level", cache.level},
                      {"size", cache.bytes},
                      {"num_sharing", cache.shared_by}});
  }
  return {{"date", Now()},      {"executable", "cpuinfo-bench"},
          {"options", options}, {"num_cpus", m.cores},
          {"caches", caches},   {"library_build_type", result.build.type},
          {"cpu", m.cpu},       {"architecture", m.architecture},
          {"system", m.system}, {"halfspace_version", result.build.version}};
}

Json BenchmarksJson(const std::vector<Timing>& timings) {
  Json list = Json::array();
  for (const Timing& timing : timings) {
    const double nanoseconds = timing.Median() * timing.items;
    list.push_back({{"name", timing.name + "_median"},
                    {"run_name", timing.name},
                    {"run_type", "aggregate"},
                    {"aggregate_name", "median"},
                    {"repetitions", timing.samples.size()},
                    {"iterations", timing.iterations},
                    {"cpu_time", nanoseconds},
                    {"time_unit", "ns"},
                    {"items_per_second", 1e9 / timing.Median()}});
  }
  return list;
}

Json ToJson(const MachineResult& result) {
  const Machine& m = result.machine;
  return {{"cpu", m.cpu},
          {"architecture", m.architecture},
          {"system", m.system},
          {"cores", m.cores},
          {"affinity", m.affinity},
          {"virtual", m.is_virtual},
          {"emulated", m.is_emulated},
          {"extensions", m.isa},
          {"targets",
           {{"compiled", result.compiled},
            {"supported", result.supported},
            {"chosen", result.chosen},
            {"why", result.why_chosen}}},
          {"compiler", result.build.compiler},
          {"flags", result.build.flags},
          {"build_type", result.build.type},
          {"highway", result.build.highway},
          {"version", result.build.version}};
}

Json ToJson(const CheckResult& result) {
  return {{"targets", result.targets},
          {"objects", result.objects},
          {"queries", result.queries},
          {"masks", result.masks},
          {"passed", true}};
}

Json ToJson(const Table1Result& result) {
  return {{"objects", result.objects},
          {"queries", result.queries},
          {"seed", result.seed},
          {"widths", kWorkWidths},
          {"half_spaces",
           {{"aabb", result.work.aabb},
            {"simplex", result.work.simplex},
            {"aabo", result.work.aabo}}},
          {"accepts", ToJson(result.accepts)}};
}

Json ToJson(const std::optional<Ratio>& ratio) {
  if (!ratio) return nullptr;
  return {{"median", ratio->median}, {"quartiles", {ratio->low, ratio->high}}};
}

Json ToJson(const CrossoverResult& result) {
  Json rows = Json::array();
  for (const CrossoverRow& row : result.rows) {
    rows.push_back({{"target", row.target},
                    {"lanes", row.lanes},
                    {"working_set", row.working_set},
                    {"schedule", row.schedule},
                    {"w", OrNull(row.w)},
                    {"aabb_ns", OrNull(row.ns.aabb)},
                    {"simplex_ns", OrNull(row.ns.simplex)},
                    {"aabo_ns", OrNull(row.ns.aabo)},
                    {"simplex_over_aabb", ToJson(row.simplex_over_aabb)}});
  }
  Json targets = Json::array();
  for (const WStar& star : result.w_stars) {
    targets.push_back({{"target", star.target},
                       {"lanes", star.lanes},
                       {"working_set", star.working_set},
                       {"w_star", OrNull(star.w_star)},
                       {"at_most", star.is_at_most}});
  }
  return {{"rows", rows},
          {"targets", targets},
          {"not_reached", result.not_reached}};
}

Json ToJson(const KernelsResult& result) {
  Json rows = Json::array();
  for (const KernelRow& row : result.rows) {
    rows.push_back(
        {{"shape", row.shape},
         {"target", row.target},
         {"schedule", row.schedule},
         {"working_set", row.working_set},
         {"objects", row.objects},
         {"ns_per_object", row.ns_per_object},
         {"objects_per_second", 1e9 / row.ns_per_object},
         {"gigabytes_per_second", row.gigabytes_per_second},
         {"percent_of_read", row.percent_of_read.median},
         {"quartiles", {row.percent_of_read.low, row.percent_of_read.high}}});
  }
  return {{"rows", rows}, {"not_reached", result.not_reached}};
}

Json ToJson(const BuildResult& result) {
  Json rows = Json::array();
  for (const BuildRow& row : result.rows) {
    rows.push_back(
        {{"shapes", row.shapes},
         {"planes", row.planes},
         {"rounding", row.rounding},
         {"target", row.target},
         {"working_set", row.working_set},
         {"objects", row.objects},
         {"item", row.item},
         {"ns_per_item", row.ns_per_item},
         {"gigabytes_per_second", row.gigabytes_per_second},
         {"percent_of_copy", row.percent_of_copy.median},
         {"quartiles", {row.percent_of_copy.low, row.percent_of_copy.high}},
         {"copy", row.copy},
         {"copy_gigabytes_per_second", row.copy_gigabytes_per_second}});
  }
  Json thresholds = Json::array();
  for (const BuildThreshold& threshold : result.thresholds) {
    thresholds.push_back({{"target", threshold.target},
                          {"percent_of_copy", threshold.percent_of_copy},
                          {"at_least", thresholds::kBuildPercentOfCopy},
                          {"met", threshold.is_met()}});
  }
  Json singles = Json::array();
  for (const SingleBuildRow& row : result.singles) {
    singles.push_back({{"call", row.call}, {"ns_per_call", row.ns_per_call}});
  }
  return {{"rows", rows},
          {"thresholds", thresholds},
          {"singles", singles},
          {"not_reached", result.not_reached}};
}

Json ToJson(const QualityResult& result) {
  return {{"workload", result.workload},
          {"objects", result.objects},
          {"queries", result.queries},
          {"survivors", ToJson(result.survivors)}};
}

Json ToJson(const SegmentsResult& result) {
  Json rows = Json::array();
  for (const SegmentRow& row : result.rows) {
    rows.push_back({{"direction", row.direction},
                    {"length", row.length},
                    {"pieces", row.pieces},
                    {"kept", ToJson(row.kept)},
                    {"floor", row.floor},
                    {"tests", row.tests},
                    {"bytes",
                     {{"aabb", row.tests * kRecordBytes.aabb},
                      {"simplex", row.tests * kRecordBytes.simplex},
                      {"aabo", row.tests * kRecordBytes.aabo}}}});
  }
  return {{"workload", result.workload},
          {"objects", result.objects},
          {"segments", result.segments},
          {"seed", result.seed},
          {"rows", rows}};
}

Json ToJson(const VerdictResult& result) {
  return {{"sentences", result.sentences}};
}

template <typename T>
void AddSection(Json& sections, const char* name,
                const std::optional<T>& result) {
  if (result) sections[name] = ToJson(*result);
}

}  // namespace

std::string ToJson(const Results& results) {
  Json sections = Json::object();
  AddSection(sections, "machine", results.machine);
  AddSection(sections, "check", results.check);
  AddSection(sections, "table1", results.table1);
  AddSection(sections, "crossover", results.crossover);
  AddSection(sections, "kernels", results.kernels);
  AddSection(sections, "build", results.build);
  AddSection(sections, "throughput", results.throughput);
  AddSection(sections, "sorted", results.sorted);
  AddSection(sections, "quality", results.quality);
  AddSection(sections, "segments", results.segments);
  AddSection(sections, "verdict", results.verdict);
  Json root = {{"schema", kReportSchema},
               {"context", ContextJson(results.context, results.options)},
               {"benchmarks", BenchmarksJson(results.timings)},
               {"sections", sections}};
  // A file name in another encoding must not stop the report.
  return root.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace halfspace::bench

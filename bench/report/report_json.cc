#include <ctime>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/report/alternatives_json.h"
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
Json ContextJson(const Results& results) {
  const MachineResult& result = results.context;
  const Machine& m = result.machine;
  Json caches = Json::array();
  for (const Cache& cache : m.caches) {
    caches.push_back({{"type", cache.level == 1 ? "Data" : "Unified"},
                      {"level", cache.level},
                      {"size", cache.bytes},
                      {"num_sharing", cache.shared_by}});
  }
  return {{"date", Now()},
          {"executable", "cpuinfo-bench"},
          {"options", results.options},
          {"command", results.command},
          {"seed", results.seed},
          {"repetitions", results.repetitions},
          {"num_cpus", m.cores},
          {"caches", caches},
          {"library_build_type", result.build.type},
          {"cpu", m.cpu},
          {"architecture", m.architecture},
          {"system", m.system},
          {"halfspace_version", result.build.version}};
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
                    {"quartiles",
                     {timing.Quantile(0.25) * timing.items,
                      timing.Quantile(0.75) * timing.items}},
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

Json ToJson(const Ratio& ratio) {
  return {{"median", ratio.median}, {"quartiles", {ratio.low, ratio.high}}};
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
                    {"simplex_over_aabb", row.simplex_over_aabb
                                              ? ToJson(*row.simplex_over_aabb)
                                              : Json(nullptr)}});
  }
  Json targets = Json::array();
  for (const WStar& star : result.w_stars) {
    targets.push_back({{"target", star.target},
                       {"lanes", star.lanes},
                       {"working_set", star.working_set},
                       {"w_star", OrNull(star.w_star)},
                       {"at_most", star.is_at_most},
                       {"quartiles", {OrNull(star.low), OrNull(star.high)}}});
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
         {"ns_quartiles", {row.low, row.high}},
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

Json ToJson(const LeadFrom& lead) {
  return {{"w", OrNull(lead.w)}, {"at_most", lead.is_at_most}};
}

Json ToJson(const ModelResult& result) {
  Json shapes = Json::array();
  for (const ModelShape& shape : result.shapes) {
    Json rows = Json::array();
    for (const ModelRow& row : shape.rows) {
      rows.push_back(
          {{"w", row.w},
           {"p", row.p},
           {"expected_half_spaces", row.expected},
           {"counted_half_spaces", row.counted},
           {"compare_ns", row.compare_ns},
           {"predicted_ns", row.predicted_ns},
           {"measured_ns", row.measured_ns},
           {"measured_over_predicted", ToJson(row.measured_over_predicted)}});
    }
    shapes.push_back({{"shape", shape.shape},
                      {"planes", shape.planes},
                      {"schedule", shape.schedule},
                      {"ns_per_object", shape.ns_per_object},
                      {"candidates", shape.candidates},
                      {"rows", rows}});
  }
  Json advantages = Json::array();
  for (const AdvantageRow& row : result.advantages) {
    advantages.push_back({{"w", row.w},
                          {"expected", row.expected},
                          {"counted", row.counted},
                          {"predicted", row.predicted},
                          {"measured", ToJson(row.measured)}});
  }
  Json exact_tests = Json::array();
  for (const ExactTest& test : result.exact_tests) {
    exact_tests.push_back({{"name", test.name},
                           {"ns", test.ns},
                           {"quartiles", {test.low, test.high}}});
  }
  Json break_even = Json::array();
  for (const BreakEven& each : result.break_even) {
    break_even.push_back(
        {{"against", each.against},
         {"ns", OrNull(each.ns)},
         {"quartiles", each.ns ? Json({each.low, each.high}) : Json(nullptr)}});
  }
  return {{"target", result.target},
          {"working_set", result.working_set},
          {"objects", result.objects},
          {"compare_ns", result.compare_ns},
          {"call_ns", result.call_ns},
          {"shapes", shapes},
          {"advantages", advantages},
          {"crossover",
           {{"expected", ToJson(result.expected)},
            {"counted", ToJson(result.counted)},
            {"predicted", ToJson(result.predicted)},
            {"measured", ToJson(result.measured)}}},
          {"exact_tests", exact_tests},
          {"break_even", break_even}};
}

Json ToJson(const SweepCell& cell) {
  Json ways = Json::array();
  for (const Way& way : cell.ways) {
    ways.push_back({{"shape", way.shape},
                    {"schedule", way.schedule},
                    {"precision", way.precision},
                    {"ns", way.ns},
                    {"quartiles", {way.low, way.high}},
                    {"survivors", way.survivors},
                    {"ns_with_exact", way.ns_with_exact},
                    {"of_best", ToJson(way.of_best)}});
  }
  const Way& best = cell.ways[cell.best];
  return {{"size", OrNull(cell.size)},
          {"objects", cell.objects},
          {"slab_overlap", cell.slab_overlap},
          {"survivors", best.survivors},
          {"winner", best.name()},
          {"ns", best.ns_with_exact},
          {"is_tie", cell.is_tie},
          {"ways", ways}};
}

Json ToJson(const SweepResult& result) {
  Json cells = Json::array();
  for (const SweepCell& cell : result.cells) cells.push_back(ToJson(cell));
  Json map = Json::array();
  for (const MapPoint& point : result.map) {
    map.push_back({{"w", point.w},
                   {"slab_overlap", point.slab_overlap},
                   {"simplex_over_aabb", ToJson(point.simplex_over_aabb)}});
  }
  return {{"target", result.target},
          {"exact_ns", result.exact_ns},
          {"exact_test", result.exact_test},
          {"own", ToJson(result.own)},
          {"cells", cells},
          {"map", map}};
}

Json ToJson(const ThreadsResult& result) {
  Json rows = Json::array();
  for (const ThreadsRow& row : result.rows) {
    rows.push_back({{"work", row.work},
                    {"threads", row.threads},
                    {"ns_per_pair", row.ns_per_pair},
                    {"times", ToJson(row.times)}});
  }
  return {{"rows", rows}, {"not_reached", result.not_reached}};
}

Json ToJson(const NoiseResult& result) {
  return {{"same_over_same", ToJson(result.same_over_same)},
          {"clock_drift", result.clock_drift},
          {"limit", result.limit},
          {"is_noisy", result.is_noisy()}};
}

Json ToJson(const AnswersResult& result) {
  Json answers = Json::array();
  for (const Answer& answer : result.answers) {
    answers.push_back({{"question", answer.question},
                       {"answer", answer.text},
                       {"figure", answer.times.median},
                       {"quartiles", {answer.times.low, answer.times.high}},
                       {"is_tie", answer.is_tie}});
  }
  return {{"answers", answers}, {"not_reached", result.not_reached}};
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
  AddSection(sections, "volumes", results.volumes);
  AddSection(sections, "dual", results.dual);
  AddSection(sections, "axes", results.axes);
  AddSection(sections, "segments", results.segments);
  AddSection(sections, "model", results.model);
  AddSection(sections, "sweep", results.sweep);
  AddSection(sections, "threads", results.threads);
  AddSection(sections, "noise", results.noise);
  AddSection(sections, "answers", results.answers);
  Json root = {{"schema", kReportSchema},
               {"context", ContextJson(results)},
               {"benchmarks", BenchmarksJson(results.timings)},
               {"sections", sections}};
  // A file name in another encoding must not stop the report.
  return root.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace halfspace::bench

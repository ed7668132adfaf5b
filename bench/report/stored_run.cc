#include "bench/report/stored_run.h"

#include <initializer_list>
#include <stdexcept>

#include "bench/report/report.h"
#include "bench/report/report_field.h"
#include "bench/report/report_parts.h"

namespace halfspace::bench {
namespace {

using Ratios = std::map<std::string, StoredRatio>;

void Add(Ratios& ratios, const Json& row, const char* section,
         std::initializer_list<const char*> keys, const char* value,
         bool is_higher_better) {
  const Json& quartiles = row.at("quartiles");
  if (quartiles.is_null()) return;
  std::string name = section;
  for (const char* key : keys) {
    name += std::string(", ") + row.at(key).get<std::string>();
  }
  ratios[name] = {{row.at(value), quartiles.at(0), quartiles.at(1)},
                  is_higher_better};
}

// Of a report, those whose repetitions were interleaved.
Ratios RatiosOf(const Json& report) {
  Ratios ratios;
  const Json& sections = report.at("sections");
  if (sections.contains("kernels")) {
    for (const Json& row : sections.at("kernels").at("rows")) {
      Add(ratios, row, "kernels",
          {"shape", "schedule", "working_set", "target"}, "percent_of_read",
          true);
    }
  }
  if (sections.contains("build")) {
    for (const Json& row : sections.at("build").at("rows")) {
      Add(ratios, row, "build",
          {"shapes", "planes", "rounding", "working_set", "target"},
          "percent_of_copy", true);
    }
  }
  for (const char* section : {"throughput", "sorted"}) {
    if (!sections.contains(section)) continue;
    for (const Json& row : sections.at(section).at("ratios")) {
      Add(ratios, row, section, {"name"}, "value",
          row.at("better") == "higher");
    }
  }
  return ratios;
}

}  // namespace

bool IsWorse(const StoredRatio& stored, const Ratio& now) {
  return stored.is_higher_better
             ? now.high < stored.ratio.low * (1.0 - kTolerance)
             : now.low > stored.ratio.high * (1.0 + kTolerance);
}

StoredRun::StoredRun(std::string_view json) {
  const Json report = ParseReport(json);
  try {
    cpu_ = report.at("context").at("cpu");
    options_ = report.at("context").at("options");
    ratios_ = RatiosOf(report);
  } catch (const Json::exception&) {
    throw std::invalid_argument("no JSON report of this program");
  }
  if (ratios_.empty()) {
    throw std::invalid_argument("a report without a ratio to compare");
  }
}

std::string StoredRun::WhyIncomparable(const std::string& cpu,
                                       const std::string& options) const {
  if (cpu != cpu_) return "it is of " + cpu_ + ", and this is " + cpu;
  if (options != options_) {
    return "it was made with \"" + options_ + "\", and this run with \"" +
           options + "\"";
  }
  return {};
}

std::vector<Regression> StoredRun::RegressionsIn(const Results& results,
                                                 std::size_t& compared) const {
  std::vector<Regression> regressions;
  compared = 0;
  for (const auto& [name, now] : RatiosOf(ParseReport(ToJson(results)))) {
    const auto stored = ratios_.find(name);
    if (stored == ratios_.end()) continue;
    ++compared;
    if (IsWorse(stored->second, now.ratio)) {
      regressions.push_back({name.substr(0, name.find(',')), name,
                             name + ": " + RatioText(now.ratio) + ", was " +
                                 RatioText(stored->second.ratio)});
    }
  }
  return regressions;
}

}  // namespace halfspace::bench

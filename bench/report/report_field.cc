#include "bench/report/report_field.h"

#include "bench/report/report.h"

namespace halfspace::bench {
namespace {

constexpr int kMostDepth = 16;

}  // namespace

Json ParseReport(std::string_view text) {
  if (text.size() > kMostReportBytes) {
    throw std::invalid_argument("larger than any report of this program");
  }
  const auto check = [](int depth, Json::parse_event_t, Json&) {
    if (depth > kMostDepth) throw std::invalid_argument("nested too deep");
    return true;
  };
  Json report;
  try {
    report = Json::parse(text, check);
  } catch (const Json::exception&) {
    throw std::invalid_argument("no JSON report of this program");
  }
  const ReportField schema = ReportField(report, "the report").At("schema");
  if (schema.Number() != kReportSchema) {
    throw std::invalid_argument("a report of schema " + schema.json().dump() +
                                ", not " + std::to_string(kReportSchema));
  }
  return report;
}

}  // namespace halfspace::bench

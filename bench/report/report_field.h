// A value of a JSON report, and where it stands there: a report comes from
// somebody's file, so that every use of it is checked, and what is wrong named.
#ifndef HALFSPACE_BENCH_REPORT_REPORT_FIELD_H_
#define HALFSPACE_BENCH_REPORT_REPORT_FIELD_H_

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace halfspace::bench {

// Ordered, as the sections ran.
using Json = nlohmann::ordered_json;

// All but the constructor throw std::invalid_argument where the value is of
// another type.
class ReportField {
 public:
  // `json` must outlive this.
  ReportField(const Json& json, std::string path)
      : json_(&json), path_(std::move(path)) {}

  const Json& json() const { return *json_; }

  ReportField At(const char* key) const {
    const std::optional<ReportField> field = Find(key);
    if (!field) Fail(std::string("has no ") + key);
    return *field;
  }

  // Nothing if it is absent or null.
  std::optional<ReportField> Find(const char* key) const {
    if (!json_->is_object()) Fail("is no object");
    const auto found = json_->find(key);
    if (found == json_->end() || found->is_null()) return std::nullopt;
    return ReportField(*found, path_ + "." + key);
  }

  // The elements of a list.
  std::vector<ReportField> List() const {
    if (!json_->is_array()) Fail("is no list");
    std::vector<ReportField> list;
    for (std::size_t i = 0; i < json_->size(); ++i) {
      list.emplace_back((*json_)[i], path_ + "[" + std::to_string(i) + "]");
    }
    return list;
  }

  // Those of the list `key`, none if there is no such list.
  std::vector<ReportField> List(const char* key) const {
    const std::optional<ReportField> list = Find(key);
    return list ? list->List() : std::vector<ReportField>();
  }

  double Number() const {
    if (!json_->is_number()) Fail("is no number");
    return json_->get<double>();
  }

  std::string Text() const {
    if (!json_->is_string()) Fail("is no text");
    return json_->get<std::string>();
  }

  bool Flag() const {
    if (!json_->is_boolean()) Fail("is neither true nor false");
    return json_->get<bool>();
  }

  [[noreturn]] void Fail(const std::string& why) const {
    throw std::invalid_argument(path_ + " " + why);
  }

 private:
  const Json* json_;
  std::string path_;
};

// A longer text is no report of this program.
inline constexpr std::size_t kMostReportBytes = std::size_t{32} << 20;

// The text that ToJson() gives, whoever wrote it. Throws std::invalid_argument,
// with what is wrong, for what is no report of this schema.
Json ParseReport(std::string_view text);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_REPORT_FIELD_H_

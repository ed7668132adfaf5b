#include <algorithm>
#include <utility>

#include "bench/sections/sections.h"
#include "bench/sections/throughput.h"

namespace halfspace::bench {

Throughput::Throughput(const Context& context, bool is_quick,
                       ThroughputResult& result, std::string section)
    : context_(context),
      is_quick_(is_quick),
      result_(result),
      section_(std::move(section)) {
  bool has_avx512 = false;
  for (Target target : context.targets) {
    const bool is_named = (IsAvx512(target) && !has_avx512) || IsAvx2(target) ||
                          target.name() == "SSE4";
    if (is_named) targets_.push_back(target);
    has_avx512 |= IsAvx512(target);
  }
  if (targets_.empty()) targets_.push_back(context.targets.front());
  if (is_quick) targets_.resize(1, targets_.front());
}

Timings Throughput::TimeWith(const Effort& effort, std::vector<Case> cases) {
  for (Case& c : cases) {
    c.name = section_ + "/" + c.name;
    c.group = section_;
  }
  return TimeCases(cases, effort, context_);
}

void Throughput::AddTimings(const Timings& timings) {
  context_.timings.insert(context_.timings.end(), timings.begin(),
                          timings.end());
}

Timings Throughput::Time(std::vector<Case> cases) {
  return TimeWith(context_.effort, std::move(cases));
}

Timings Throughput::TimeLong(std::vector<Case> cases) {
  constexpr std::size_t kMostRepetitions = 5;
  Effort effort = context_.effort;
  effort.repetitions = std::min(effort.repetitions, kMostRepetitions);
  return TimeWith(effort, std::move(cases));
}

Timings Throughput::TimeBriefly(std::vector<Case> cases) {
  constexpr double kShare = 1.0 / 5.0;
  Effort effort = context_.effort;
  effort.seconds_per_repetition *= kShare;
  return TimeWith(effort, std::move(cases));
}

Timings Throughput::TimeRuns(std::vector<Case> cases, std::size_t repetitions) {
  return TimeWith({repetitions, 0.0}, std::move(cases));
}

std::size_t Throughput::AddRow(ThroughputRow row) {
  result_.rows.push_back(std::move(row));
  return result_.rows.size() - 1;
}

std::size_t Throughput::AddCeiling(const Ceiling& ceiling, ThroughputRow row) {
  const std::size_t place = AddRow(std::move(row));
  ceilings_.emplace_back(ceiling, place);
  return place;
}

void Throughput::AddRowUnder(const Ceiling& ceiling, ThroughputRow row) {
  for (const auto& [timed, place] : ceilings_) {
    if (timed != ceiling) continue;
    row.ceiling = place;
    row.percent_of_ceiling =
        100.0 * result_.rows[place].ns_per_pair / row.ns_per_pair;
  }
  AddRow(std::move(row));
}

void Throughput::AddRowsInTurn(const ThroughputRow& row, const Timing& all,
                               const Timing& few, Rows rows) {
  constexpr double kDifference = 0.03;
  const Ratio ratio = RatioOf(all, few);
  const bool differ =
      ratio.low > 1.0 + kDifference || ratio.high < 1.0 / (1.0 + kDifference);
  if (!differ && rows == Rows::kIfTheyDiffer) return;
  ThroughputRow added = row;
  const auto objects = static_cast<double>(row.objects);
  added.ns_per_pair = all.Median() / objects;
  AddRow(added);
  if (!differ) return;
  added.name += ", " + std::to_string(kFewQueries) + " queries in turn";
  added.ns_per_pair = few.Median() / objects;
  AddRow(added);
}

std::size_t FastestOf(const Timings& timings,
                      const std::vector<std::size_t>& among) {
  std::size_t fastest = among.front();
  for (std::size_t i : among) {
    if (timings[i].Median() < timings[fastest].Median()) fastest = i;
  }
  return fastest;
}

void RunParts(ThroughputParts& parts, Throughput& throughput) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    throughput.progress().BeginPart(i, parts.size());
    parts[i](throughput);
    // With what it holds: worlds of many megabytes.
    parts[i] = nullptr;
  }
}

ThroughputResult RunThroughput(const Workload& workload,
                               const std::vector<WorkingSet*>& sets,
                               const Machine& machine, std::uint64_t seed,
                               bool is_quick, const Context& context) {
  ThroughputResult result;
  Throughput throughput(context, is_quick, result);
  ThroughputParts parts;
  AddCeilingParts(workload, machine, sets, parts);
  AddManyParts(workload, machine, seed, is_quick, parts);
  AddQuantizedParts(workload, machine, is_quick, parts);
  AddOutputParts(workload, parts);
  AddSizeParts(workload, machine, parts);
  AddQueryParts(workload, parts);
  AddCompetitorParts(seed, parts);
  RunParts(parts, throughput);
  std::stable_sort(result.ratios.begin(), result.ratios.end(),
                   [](const ThroughputRatio& a, const ThroughputRatio& b) {
                     return a.threshold < b.threshold;
                   });
  return result;
}

}  // namespace halfspace::bench

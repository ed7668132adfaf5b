#include "bench/sections/throughput.h"

#include <algorithm>

#include "bench/sections/sections.h"

namespace halfspace::bench {

Throughput::Throughput(Run& run, std::string section)
    : run_(run), section_(std::move(section)) {
  for (Target target : run.targets) {
    if (IsAvx512(target) || IsAvx2(target) || target.name() == "SSE4") {
      targets_.push_back(target);
    }
  }
  if (targets_.empty()) targets_.push_back(run.targets.front());
  if (run.is_quick()) targets_.resize(1, targets_.front());
}

Timings Throughput::TimeWith(const Effort& effort, std::vector<Case> cases) {
  for (Case& c : cases) {
    c.name = section_ + "/" + c.name;
    c.group = section_;
  }
  return run_.Time(cases, effort);
}

Timings Throughput::Time(std::vector<Case> cases) {
  return TimeWith(run_.effort, std::move(cases));
}

Timings Throughput::TimeLong(std::vector<Case> cases) {
  constexpr std::size_t kMostRepetitions = 5;
  Effort effort = run_.effort;
  effort.repetitions = std::min(effort.repetitions, kMostRepetitions);
  return TimeWith(effort, std::move(cases));
}

Timings Throughput::TimeBriefly(std::vector<Case> cases) {
  constexpr double kShare = 1.0 / 5.0;
  Effort effort = run_.effort;
  effort.seconds_per_repetition *= kShare;
  return TimeWith(effort, std::move(cases));
}

Timings Throughput::TimeRuns(std::vector<Case> cases, std::size_t repetitions) {
  return TimeWith({repetitions, 0.0}, std::move(cases));
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

void Throughput::AddRatio(const Aim& aim, Target target,
                          const std::string& name, const Cell& value) {
  const double needed = aim.For(target);
  const bool is_met =
      aim.is_higher_better ? *value.value >= needed : *value.value <= needed;
  aims_.push_back({name, value.With(is_met ? Flag::kMet : Flag::kMissed),
                   (aim.is_higher_better ? ">= " : "<= ") + Fixed(needed, 2)});
}

Table Throughput::Rows() const {
  Table table{
      section_,
      "ns per object and query, next to its ceiling",
      {Key("what"), Key("set"), Key("target"), Key("objects"), Key("queries"),
       Value("ns/pair", "", 4), Value("ceiling"), Value("% of it", "", 0)}};
  for (const ThroughputRow& row : rows_) {
    table.Add({row.name, row.working_set, row.target, row.objects, row.queries,
               row.ns_per_pair, row.ceiling, row.percent_of_ceiling});
  }
  return table;
}

Table Throughput::Aims() const {
  Table table{section_ + ": aims",
              "ratios that the library aims at",
              {Key("ratio"), Value("value"), Value("aim")},
              aims_,
              notes_};
  const auto met =
      std::count_if(aims_.begin(), aims_.end(),
                    [](const Row& row) { return row[1].flag == Flag::kMet; });
  table.notes.insert(table.notes.begin(),
                     std::to_string(met) + " of " +
                         std::to_string(aims_.size()) +
                         " aims are met. A missed aim is no wrong answer.");
  return table;
}

Tables RunThroughput(Run& run) {
  Throughput throughput(run, "throughput");
  const Workload& workload = run.Measured();
  const std::uint64_t seed = run.options.seed;
  ThroughputParts parts;
  AddCeilingParts(run.Sets({"L3", "memory"}), parts);
  AddManyParts(workload, run.machine, seed, run.is_quick(), parts);
  AddQuantizedParts(workload, run.machine, run.is_quick(), parts);
  AddCallParts(workload, parts);
  RunParts(parts, throughput);
  for (const std::string& note : run.NotReached()) throughput.AddNote(note);
  return {throughput.Rows(), throughput.Aims()};
}

}  // namespace halfspace::bench

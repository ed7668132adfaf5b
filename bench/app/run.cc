#include "bench/app/run.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <map>
#include <new>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/machine.h"
#include "bench/sections/run.h"

namespace halfspace::bench {
namespace {

std::string Now() {
  const std::time_t now = std::time(nullptr);
  char text[32] = "";
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%MZ", std::gmtime(&now));
  return text;
}

Context ContextOf(const Run& run) {
  const Build build = DescribeBuild();
  const Machine& machine = run.machine;
  const char* kind = machine.is_emulated  ? "emulated"
                     : machine.is_virtual ? "virtual"
                                          : "physical";
  return {{"version", build.version},
          {"date", Now()},
          {"command", run.options.command},
          {"scope", run.options.Scope()},
          {"seed", std::to_string(run.options.seed)},
          {"repetitions", std::to_string(run.effort.repetitions)},
          {"cpu", machine.cpu},
          {"model", machine.Model()},
          {"caches", machine.CachesText()},
          {"cores", std::to_string(machine.cores)},
          {"machine", kind},
          {"system", machine.system + ", " + machine.architecture},
          {"compiler", build.compiler},
          {"flags", build.flags},
          {"build", build.type},
          {"highway", build.highway},
          {"target", NameOf(run.best())}};
}

void WriteHead(std::ostream& out, const Report& report) {
  out << ThisProgram().name << ' ' << report.ValueOf("version") << ' '
      << Printable(report.ValueOf("command")) << "; seed "
      << report.ValueOf("seed") << "; " << report.ValueOf("caches") << '\n'
      << report.ValueOf("cpu") << " (" << report.ValueOf("model") << ")\n";
}

}  // namespace

Report RunSections(const BenchOptions& options, std::optional<Workload> input,
                   Progress& progress, std::ostream* text) {
  Run run(options, std::move(input), progress);
  Report report{ContextOf(run), {}};
  std::map<std::string_view, Tables> all;  // of each section
  bool needs_verdict = false;
  std::size_t first_sections = 0;
  for (const Section& section : ThisProgram().sections) {
    if (!options.Wants(section.name)) continue;
    progress.Plan(section.name, 1, section.seconds);
    first_sections += (section.flags & kLast) == 0 ? 1 : 0;
    needs_verdict |=
        !run.machine.is_emulated && (section.flags & kVerdict) != 0;
  }
  if (needs_verdict) {
    progress.Plan(kVerdictGroup, run.VerdictGroups(), kVerdictGroupSeconds);
  }
  bool is_first = true;
  const auto write = [&](const Tables& tables) {
    if (text == nullptr) return;
    // Whole or not at all. Streams swallow std::bad_alloc unless told not to.
    std::ostringstream out;
    out.exceptions(std::ios::badbit);
    if (std::exchange(is_first, false)) {
      if (run.is_page()) {
        for (const Table& table : tables) WriteLead(out, table);
        out << '\n';
      }
      WriteHead(out, report);
    }
    if (!run.is_page()) {
      for (const Table& table : tables) {
        if (!table.lead.empty()) out << '\n';
        WriteLead(out, table);
      }
    }
    for (const Table& table : tables) WriteText(out, table);
    *text << out.str() << std::flush;
  };
  for (unsigned pass : {0u, kLast}) {
    for (const Section& section : ThisProgram().sections) {
      if (!options.Wants(section.name) || (section.flags & kLast) != pass) {
        continue;
      }
      run.clock.Sample();
      try {
        // The groups are measured before each section, so that they are spread
        // over the run.
        if (needs_verdict && pass == 0) {
          const std::size_t groups =
              std::max<std::size_t>(1, run.VerdictGroups() / first_sections);
          for (std::size_t g = 0; g < groups; ++g) run.AddVerdictGroup();
        } else if (needs_verdict) {
          run.TheVerdict();
        }
        progress.Begin(section.name);
        const Tables& tables = all[section.name] = section.run(run);
        progress.Clear();
        if (!run.is_page()) write(tables);
      } catch (const std::bad_alloc&) {
        throw UsageError("not enough memory for the section " +
                         std::string(section.name) +
                         "; choose fewer --objects, or --quick");
      }
    }
  }
  progress.Clear();
  for (const Section& section : ThisProgram().sections) {
    for (Table& table : all[section.name]) {
      report.tables.push_back(std::move(table));
    }
  }
  for (const Table& table : report.tables) {
    if (table.name == "noise" && !table.rows.empty()) {
      report.context.emplace_back("noise", table.rows.back()[1].text);
    }
  }
  if (run.is_page()) write(report.tables);
  return report;
}

}  // namespace halfspace::bench

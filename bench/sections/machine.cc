#include <span>
#include <string>

#include "bench/base/text.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

// With Highway's name where that differs.
std::string NamesOf(std::span<const Target> targets) {
  std::string names;
  for (Target target : targets) {
    if (!names.empty()) names += ", ";
    names += NameOf(target);
    if (NameOf(target) != target.name()) {
      names += " (" + std::string(target.name()) + ")";
    }
  }
  return names;
}

}  // namespace

Tables RunMachine(Run& run) {
  const Machine& machine = run.machine;
  const TargetChoice choice = DescribeTargetChoice();
  const Build build = DescribeBuild();
  std::string isa;
  for (const std::string& name : machine.isa) isa += name + " ";
  Table table{"machine", machine.cpu, {Key("what"), Value("value")}};
  table.Add({"model", machine.Model()});
  table.Add({"system", machine.system + ", " + machine.architecture});
  table.Add({"cores", std::to_string(machine.cores) +
                          ", of which this run uses " + machine.affinity});
  table.Add({"caches", machine.CachesText()});
  table.Add({"extensions", isa});
  table.Add({"compiled", NamesOf(CompiledTargets())});
  table.Add({"supported", NamesOf(SupportedTargets())});
  table.Add(
      {"chosen", NameOf(choice.target) +
                     (choice.requested.empty()
                          ? ", the best that is compiled and supported"
                          : ", which HALFSPACE_TARGET or --target asks for")});
  table.Add({"built by", build.compiler + ", " + build.type + ", Highway " +
                             build.highway + ", " + build.flags});
  if (build.type != "release") {
    table.notes.push_back("Warning: a debug build. Its times mean nothing.");
  }
  if (machine.is_virtual) {
    table.notes.push_back(
        "This is a virtual machine. Others share its hardware, so trust "
        "counts, "
        "and ratios within their ranges, but not times.");
  }
  if (machine.is_emulated) {
    table.notes.push_back(
        "The CPU is emulated. Only counts mean anything, and there are no "
        "answers.");
  }
  return {table};
}

}  // namespace halfspace::bench

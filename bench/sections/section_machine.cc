#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

std::vector<std::string> NamesOf(std::span<const Target> targets) {
  std::vector<std::string> names;
  for (Target target : targets) names.emplace_back(target.name());
  return names;
}

}  // namespace

MachineResult RunMachine() {
  const TargetChoice choice = DescribeTargetChoice();
  MachineResult result;
  result.machine = DescribeMachine();
  result.build = DescribeBuild();
  result.compiled = NamesOf(CompiledTargets());
  result.supported = NamesOf(SupportedTargets());
  result.chosen = choice.target.name();
  result.why_chosen = choice.requested.empty()
                          ? "the best that is compiled and supported"
                          : "HALFSPACE_TARGET asks for it";
  return result;
}

}  // namespace halfspace::bench

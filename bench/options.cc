#include "bench/options.h"

#include <CLI/CLI.hpp>
#include <iostream>

#include "halfspace/targets.h"
#include "halfspace/version.h"

namespace halfspace::bench {
namespace {

// A scene of more would take 32 GiB.
constexpr std::size_t kMostObjects = std::size_t{1} << 30;
constexpr std::size_t kMostQueries = std::size_t{1} << 20;
constexpr std::size_t kMostRepetitions = 1000;

std::string SupportedTargetNames() {
  std::string names;
  for (Target target : SupportedTargets()) {
    if (!names.empty()) names += ", ";
    names += target.name();
  }
  return names;
}

std::string CheckTarget(const std::string& name) {
  if (FindTarget(name)) return {};
  return "\"" + name + "\" is not supported here; choose one of " +
         SupportedTargetNames();
}

}  // namespace

std::optional<int> ParseOptions(int argc, char** argv, BenchOptions& options) {
  CLI::App app{
      "Measures on this machine when a bounding simplex rejects faster than a "
      "box,\nand when it does not."};
  app.name("cpuinfo-bench");
  app.set_version_flag("--version",
                       std::string("cpuinfo-bench ") + HALFSPACE_VERSION_STRING,
                       "Print the version and exit");
  app.add_flag("--quick", options.is_quick,
               "A smaller scene and fewer repetitions: under 40 seconds");
  const std::vector<std::string> sections(kSections.begin(), kSections.end());
  app.add_option("--only", options.only,
                 "Only these sections, separated by commas (see --list)")
      ->delimiter(',')
      ->check(CLI::IsMember(sections))
      ->type_name("SECTION,...");
  auto* mesh = app.add_option("--mesh", options.mesh,
                              "Measure on the triangles of an OBJ file")
                   ->type_name("FILE.obj");
  app.add_option("--bounds", options.bounds,
                 "Measure on boxes: rows minx,miny,minz,maxx,maxy,maxz")
      ->type_name("FILE.csv")
      ->excludes(mesh);
  app.add_option("--objects", options.objects,
                 "Objects in the scene (default 4194304)")
      ->check(CLI::Range(std::size_t{64}, kMostObjects))
      ->type_name("N");
  app.add_option("--queries", options.queries,
                 "Queries (default 128; 256 or a few more with a file)")
      ->check(CLI::Range(std::size_t{1}, kMostQueries))
      ->type_name("N");
  app.add_option("--seed", options.seed, "Seed of the scene (default 1)")
      ->type_name("N");
  app.add_option("--target", options.target,
                 "Measure this target only: " + SupportedTargetNames())
      ->check(CheckTarget)
      ->type_name("NAME");
  app.add_option("--repetitions", options.repetitions,
                 "Repetitions of every measurement (default 7, quick 3)")
      ->check(CLI::Range(std::size_t{1}, kMostRepetitions))
      ->type_name("N");
  std::string format = "text";
  app.add_option("--format", format, "text (default) or json")
      ->check(CLI::IsMember({"text", "json"}))
      ->type_name("text|json");
  app.add_option("--out", options.out, "Write the results to this file")
      ->type_name("FILE");
  app.add_flag("--list", options.is_list, "List the sections and exit");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitUsage;
  }
  options.format = format == "json" ? Format::kJson : Format::kText;
  return std::nullopt;
}

}  // namespace halfspace::bench

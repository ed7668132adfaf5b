#include "bench/sections/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include "bench/base/text.h"
#include "bench/sections/run.h"
#include "halfspace/targets.h"
#include "halfspace/version.h"

namespace halfspace::bench {
namespace {

// A scene of more would take 32 GiB.
constexpr double kMostOfScene = 0x1p30;
constexpr double kMostQueries = 0x1p20;
constexpr double kMostRepetitions = 1000;
// Further up, not every whole number is a double.
constexpr double kMostSeed = 0x1p53 - 1;

std::vector<std::string> SupportedTargetNames() {
  std::vector<std::string> names;
  for (Target target : SupportedTargets()) names.emplace_back(target.name());
  return names;
}

// Decimal: 010 is ten, and 0x10 nothing. 1e6 is a whole number, too. Leaves
// plain digits for CLI11, which would read others as octal.
CLI::Validator Whole(double least, double most) {
  const std::string range = Fixed(least, 0) + " to " + Fixed(most, 0);
  const auto check = [=](std::string& text) -> std::string {
    const double value = ParseNumber<double>(text).value_or(-1.0);
    if (!(value >= least && value <= most && value == std::floor(value))) {
      return "\"" + text + "\" is not a whole number from " + range;
    }
    text = Fixed(value, 0);
    return {};
  };
  return CLI::Validator(check, range);
}

// CLI::Range would let NaN pass.
CLI::Validator Above0UpTo(double most) {
  const std::string range = "above 0 up to " + Fixed(most, 0);
  const auto check = [=](const std::string& text) -> std::string {
    const double value = ParseNumber<double>(text).value_or(0);
    const bool is_within = value > 0 && value <= most;
    return is_within ? "" : "\"" + text + "\" is not a number " + range;
  };
  return CLI::Validator(check, range);
}

std::string CheckFileName(const std::string& name) {
  return name.empty() ? "an empty file name" : "";
}

std::string CheckSection(const std::string& name) {
  const auto& sections = ThisProgram().sections;
  const bool is_section =
      std::any_of(sections.begin(), sections.end(),
                  [&](const Section& each) { return each.name == name; });
  return name == kAllSections || is_section
             ? ""
             : "\"" + name + "\" is not a section; --list prints them";
}

// Without what CLI11 says of checks, defaults, and what an option excludes.
class Help : public CLI::Formatter {
 public:
  Help() { column_width(24); }
  std::string make_option_opts(const CLI::Option* option) const override {
    return option->get_type_size() == 0 ? "" : ' ' + option->get_type_name();
  }
};

}  // namespace

std::string BenchOptions::Scope() const {
  std::ostringstream text;
  const auto add = [&text](bool is_given, const char* option,
                           const auto& value) {
    if (is_given) text << (text.tellp() > 0 ? " " : "") << option << value;
  };
  add(is_quick, "--quick", "");
  add(!mesh.empty(), "--mesh ", mesh);
  add(!bounds.empty(), "--bounds ", bounds);
  add(!query_bounds.empty(), "--query-bounds ", query_bounds);
  add(query_size != 0, "--query-size ", query_size);
  add(objects != 0, "--objects ", objects);
  add(queries != 0, "--queries ", queries);
  add(seed != 1, "--seed ", seed);
  add(exact_ns.has_value(), "--exact-ns ", Fixed(exact_ns, 3));
  return text.str();
}

bool BenchOptions::Wants(std::string_view section) const {
  if (is_strict && section == "noise") return true;
  const auto has = [this](std::string_view name) {
    return std::find(details.begin(), details.end(), name) != details.end();
  };
  if (!details.empty()) return has(section) || has(kAllSections);
  return std::any_of(ThisProgram().sections.begin(),
                     ThisProgram().sections.end(),
                     [section](const Section& each) {
                       return each.name == section && (each.flags & kPage) != 0;
                     });
}

bool ParseOptions(int argc, char** argv, BenchOptions& options) {
  CLI::App app{ThisProgram().what};
  app.name(ThisProgram().name);
  app.formatter(std::make_shared<Help>());
  app.set_version_flag(
      "--version",
      std::string(ThisProgram().name) + " " + HALFSPACE_VERSION_STRING,
      "Print the version and exit");
  app.add_flag("--quick", options.is_quick,
               "Use a smaller scene and fewer repetitions:\nabout 40 seconds");
  app.add_option("--details", options.details,
                 "Measure these sections at length and print their\n"
                 "tables; separated by commas; see --list. \"all\"\n"
                 "takes 5 to 15 minutes")
      ->delimiter(',')
      ->check(CheckSection)
      ->type_name("SECTION,...");
  auto* mesh =
      app.add_option("--mesh", options.mesh,
                     "Measure on the triangles of a Wavefront OBJ file")
          ->check(CheckFileName)
          ->type_name("FILE.obj");
  app.add_option("--bounds", options.bounds,
                 "Measure on boxes: rows minx,miny,minz,maxx,maxy,maxz")
      ->check(CheckFileName)
      ->type_name("FILE.csv")
      ->excludes(mesh);
  auto* query_bounds =
      app.add_option("--query-bounds", options.query_bounds,
                     "Query with these boxes, not with those of --mesh\n"
                     "or --bounds")
          ->check(CheckFileName)
          ->type_name("FILE.csv");
  app.add_option("--query-size", options.query_size,
                 "Query with random boxes whose sides are this\n"
                 "percentage of the sides of the box around --mesh or\n"
                 "--bounds")
      ->check(Above0UpTo(100))
      ->type_name("PERCENT")
      ->excludes(query_bounds);
  app.add_option("--objects", options.objects,
                 "Objects in the scene (default 4194304)")
      ->transform(Whole(64, kMostOfScene))
      ->type_name("N");
  app.add_option("--queries", options.queries,
                 "Queries (default 20000 to time; 128 to count\n"
                 "survivors, with a file 256 or a few more)")
      ->transform(Whole(1, kMostQueries))
      ->type_name("N");
  app.add_option("--seed", options.seed,
                 "Seed of the scene and of --query-size (default 1)")
      ->transform(Whole(0, kMostSeed))
      ->type_name("N");
  app.add_option("--target", options.target, "Measure this target only")
      ->check(CLI::IsMember(SupportedTargetNames()).description(""))
      ->type_name("NAME");
  app.add_option("--repetitions", options.repetitions,
                 "Repetitions of every measurement (default 5, with\n"
                 "--details 7, with --quick 3)")
      ->transform(Whole(1, kMostRepetitions))
      ->type_name("N");
  app.add_option("--exact-ns", options.exact_ns,
                 "Time of your exact test of one survivor (default:\n"
                 "measured, of two triangles)")
      ->check(Above0UpTo(1e9))
      ->type_name("NS");
  app.add_flag("--strict", options.is_strict,
               "Exit with 4 if something disturbed the run");
  std::string format = "text";
  app.add_option("--format", format, "The form of the report, text by default")
      ->check(CLI::IsMember({"text", "json"}).description(""))
      ->type_name("text|json");
  app.add_option("--out", options.out, "Write the report to this file")
      ->check(CheckFileName)
      ->type_name("FILE");
  app.add_flag("--list", options.is_list, "List the sections and exit");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      throw UsageError(std::string(error.what()) +
                       "; --help lists the options");
    }
    app.exit(error);
    return false;
  }
  if (options.mesh.empty() && options.bounds.empty() &&
      (!options.query_bounds.empty() || options.query_size != 0)) {
    throw UsageError(
        "--query-bounds and --query-size are for a file; give --mesh or "
        "--bounds");
  }
  for (int i = 1; i < argc; ++i) {
    options.command += (i == 1 ? "" : " ") + std::string(argv[i]);
  }
  // A program without a page runs all of its sections.
  if (options.details.empty() &&
      std::none_of(
          ThisProgram().sections.begin(), ThisProgram().sections.end(),
          [](const Section& each) { return (each.flags & kPage) != 0; })) {
    options.details.emplace_back(kAllSections);
  }
  options.format = format == "json" ? Format::kJson : Format::kText;
  return true;
}

}  // namespace halfspace::bench

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

// Checks a decimal number: 010 is ten, 0x10 is an error, and 1e6 is a whole
// number. Rewrites a whole number as plain digits, because CLI11 would read 010
// as octal. CLI11 would let NaN pass.
CLI::Validator Number(bool is_whole, double least, double most) {
  const std::string range =
      (is_whole ? "whole number from " : "number above ") + Fixed(least, 0) +
      " to " + Fixed(most, 0);
  const auto check = [=](std::string& text) -> std::string {
    const double value = ParseNumber<double>(text).value_or(-1.0);
    const bool is_within =
        is_whole ? value >= least && value == std::floor(value) : value > least;
    if (!is_within || !(value <= most)) {
      return "\"" + text + "\" is not a " + range;
    }
    if (is_whole) text = Fixed(value, 0);
    return {};
  };
  return CLI::Validator(check, range);
}

std::string CheckFileName(const std::string& name) {
  return name.empty() ? "an empty file name" : "";
}

bool IsOnPage(const Section& section) { return (section.flags & kPage) != 0; }

std::string CheckSection(const std::string& name) {
  return name == kAllSections || ThisProgram().HasAny([&](const auto& each) {
    return each.name == name;
  })
             ? ""
             : "\"" + name + "\" is not a section; --list prints them";
}

// Prints the type of an option's value, and leaves out the checks, defaults and
// excluded options that CLI11 adds.
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
  if (!details.empty()) {
    return std::any_of(details.begin(), details.end(), [&](const auto& each) {
      return each == section || each == kAllSections;
    });
  }
  return ThisProgram().HasAny([section](const Section& each) {
    return each.name == section && IsOnPage(each);
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
  const auto add = [&app](const char* name, auto& value, const char* type,
                          const char* what) {
    return app.add_option(name, value, what)->type_name(type);
  };
  const auto add_file = [&](const char* name, std::string& file,
                            const char* type, const char* what) {
    return add(name, file, type, what)->check(CheckFileName);
  };
  const auto add_count = [&](const char* name, auto& count, double least,
                             double most, const char* what) {
    add(name, count, "N", what)->transform(Number(true, least, most));
  };
  app.add_flag("--quick", options.is_quick,
               "Use a smaller scene and fewer repetitions:\nabout 40 seconds");
  add("--details", options.details, "SECTION,...",
      "Measure these sections at length and print their\n"
      "tables; separated by commas; see --list. \"all\"\n"
      "takes 5 to 15 minutes")
      ->delimiter(',')
      ->check(CheckSection);
  auto* mesh = add_file("--mesh", options.mesh, "FILE.obj",
                        "Measure on the triangles of a Wavefront OBJ file");
  add_file("--bounds", options.bounds, "FILE.csv",
           "Measure on boxes: rows minx,miny,minz,maxx,maxy,maxz")
      ->excludes(mesh);
  auto* query_bounds =
      add_file("--query-bounds", options.query_bounds, "FILE.csv",
               "Query with these boxes instead of the boxes of\n"
               "--mesh or --bounds");
  add("--query-size", options.query_size, "PERCENT",
      "Query with random boxes whose sides are this\n"
      "percentage of the sides of the box around --mesh or\n"
      "--bounds")
      ->transform(Number(false, 0, 100))
      ->excludes(query_bounds);
  // A scene of more would take 32 GiB.
  add_count("--objects", options.objects, 64, 0x1p30,
            "Objects in the scene (default 4194304)");
  add_count("--queries", options.queries, 1, 0x1p20,
            "Queries (default 20000 to time; 128 to count\n"
            "survivors, with a file 256 or a few more)");
  // Further up, not every whole number is a double.
  add_count("--seed", options.seed, 0, 0x1p53 - 1,
            "Seed of the scene and of --query-size (default 1)");
  std::vector<std::string> targets;
  for (Target target : SupportedTargets()) targets.emplace_back(target.name());
  add("--target", options.target, "NAME", "Measure this target only")
      ->check(CLI::IsMember(targets).description(""));
  add_count("--repetitions", options.repetitions, 1, 1000,
            "Repetitions of every measurement (default 5, with\n"
            "--details 7, with --quick 3)");
  add("--exact-ns", options.exact_ns, "NS",
      "Time of your exact test of one survivor (default:\n"
      "measured, of two triangles)")
      ->transform(Number(false, 0, 1e9));
  app.add_flag("--strict", options.is_strict,
               "Exit with 4 if something disturbed the run");
  std::string format = "text";
  add("--format", format, "text|json",
      "The form of the report, text by default")
      ->check(CLI::IsMember({"text", "json"}).description(""));
  add_file("--out", options.out, "FILE", "Write the report to this file");
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
  if (options.details.empty() && !ThisProgram().HasAny(IsOnPage)) {
    options.details.emplace_back(kAllSections);
  }
  options.is_json = format == "json";
  return true;
}

}  // namespace halfspace::bench

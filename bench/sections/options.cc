#include "bench/sections/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <system_error>
#include <utility>

#include "bench/base/text.h"
#include "bench/sections/sections.h"
#include "halfspace/targets.h"
#include "halfspace/version.h"

namespace halfspace::bench {
namespace {

// A scene of more would take 32 GiB.
constexpr std::size_t kMostObjects = std::size_t{1} << 30;
constexpr std::size_t kMostQueries = std::size_t{1} << 20;
constexpr std::size_t kMostRepetitions = 1000;

// Stores the value of an option. Returns what is wrong with it; else nothing.
using Take = std::function<std::string(const std::string& value)>;

struct Option {
  const char* name;
  const char* value;  // what --help calls it; empty: the option has none
  std::string help;
  Take take;
  bool may_repeat = false;
};

Take Switch(bool& flag) {
  return [&flag](const std::string&) {
    flag = true;
    return "";
  };
}

Take FileName(std::string& to) {
  return [&to](const std::string& name) {
    to = name;
    return name.empty() ? "an empty file name" : "";
  };
}

// Whether a number is all of the text. Decimal: 010 is ten, and 0x10 nothing.
template <typename Number>
bool IsNumber(const std::string& text, Number& number) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end;
}

// 1e6 is a whole number, too.
template <typename T>
Take Whole(T& to, std::uint64_t least, std::uint64_t most) {
  return [=, &to](const std::string& text) -> std::string {
    std::uint64_t whole = 0;
    bool is_whole = IsNumber(text, whole);
    double value = 0;
    // Further up, not every whole number is a double.
    if (!is_whole && IsNumber(text, value) && value >= 0 && value < 0x1p53 &&
        value == std::floor(value)) {
      whole = static_cast<std::uint64_t>(value);
      is_whole = true;
    }
    if (!is_whole || whole < least || whole > most) {
      return "\"" + text + "\" is not a whole number from " +
             std::to_string(least) + " to " + std::to_string(most);
    }
    to = whole;
    return {};
  };
}

template <typename T>
Take Above0UpTo(T& to, double most) {
  return [=, &to](const std::string& text) -> std::string {
    double value = 0;
    if (!IsNumber(text, value) || !(value > 0 && value <= most)) {
      return "\"" + text + "\" is not a number above 0 up to " + Fixed(most, 0);
    }
    to = value;
    return {};
  };
}

std::string SupportedTargetNames() {
  std::string names;
  for (Target target : SupportedTargets()) {
    if (!names.empty()) names += ", ";
    names += target.name();
  }
  return names;
}

std::string TakeSections(const std::string& list,
                         std::vector<std::string>& sections) {
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    sections.push_back(list.substr(begin, end - begin));
    begin = end + 1;
    const std::string& name = sections.back();
    const bool is_section = std::any_of(
        ThisProgram().sections.begin(), ThisProgram().sections.end(),
        [&](const Section& each) { return each.name == name; });
    if (name != kAllSections && !is_section) {
      return "\"" + name + "\" is not a section; --list prints them";
    }
  }
  return {};
}

std::vector<Option> OptionsOf(BenchOptions& options) {
  return {
      {"--quick", "", "Smaller scene, fewer repetitions: about 40 seconds",
       Switch(options.is_quick)},
      {"--details", "SECTION,...", "Sections to measure at length, or \"all\"",
       [&options](const std::string& list) {
         return TakeSections(list, options.details);
       },
       /*may_repeat=*/true},
      {"--mesh", "FILE.obj", "Measure on triangles of a Wavefront OBJ file",
       FileName(options.mesh)},
      {"--bounds", "FILE.csv", "Measure on minx,miny,minz,maxx,maxy,maxz",
       FileName(options.bounds)},
      {"--query-bounds", "FILE.csv", "Query with these boxes",
       FileName(options.query_bounds)},
      {"--query-size", "PERCENT", "Query with random boxes of this size",
       Above0UpTo(options.query_size, 100)},
      {"--objects", "N", "Objects in the scene (default 4194304)",
       Whole(options.objects, 64, kMostObjects)},
      {"--queries", "N", "Queries to count with, and to time",
       Whole(options.queries, 1, kMostQueries)},
      {"--seed", "N", "Seed of the scene and of --query-size (default 1)",
       Whole(options.seed, 0, std::numeric_limits<std::uint64_t>::max())},
      {"--target", "NAME", "Only this target: " + SupportedTargetNames(),
       [&options](const std::string& name) {
         options.target = name;
         return FindTarget(name)
                    ? ""
                    : "\"" + name + "\" is not supported here; " +
                          "choose one of " + SupportedTargetNames();
       }},
      {"--repetitions", "N", "Repetitions of every measurement",
       Whole(options.repetitions, 1, kMostRepetitions)},
      {"--exact-ns", "NS", "Time of your exact test of one survivor",
       Above0UpTo(options.exact_ns, 1e9)},
      {"--strict", "", "Exit with 4 if something disturbed the run",
       Switch(options.is_strict)},
      {"--format", "text|json", "The form of the report, text by default",
       [&options](const std::string& name) {
         options.format = name == "json" ? Format::kJson : Format::kText;
         return name == "json" || name == "text"
                    ? ""
                    : "\"" + name + "\" is neither text nor json";
       }},
      {"--out", "FILE", "Write the report to this file", FileName(options.out)},
      {"--list", "", "List the sections and exit", Switch(options.is_list)},
      {"--version", "", "Print the version and exit", {}},
      {"--help", "", "Print this text and exit, as -h does", {}}};
}

void PrintHelp(const std::vector<Option>& options) {
  std::cout << ThisProgram().what << "\nUsage: " << ThisProgram().name
            << " [OPTION...]; the manual page explains them\n\n";
  for (const Option& option : options) {
    std::string head = std::string("  ") + option.name + ' ' + option.value;
    head.resize(std::max<std::size_t>(head.size() + 1, 26), ' ');
    std::cout << head << option.help << '\n';
  }
}

}  // namespace

std::string BenchOptions::Scope() const {
  std::string text;
  const auto add = [&text](const std::string& option) {
    text += (text.empty() ? "" : " ") + option;
  };
  if (is_quick) add("--quick");
  if (!mesh.empty()) add("--mesh " + mesh);
  if (!bounds.empty()) add("--bounds " + bounds);
  if (!query_bounds.empty()) add("--query-bounds " + query_bounds);
  if (query_size != 0) {
    std::string size = Fixed(query_size, 6);
    size.erase(size.find_last_not_of('0') + 1);
    if (size.back() == '.') size.pop_back();
    add("--query-size " + size);
  }
  if (objects != 0) add("--objects " + std::to_string(objects));
  if (queries != 0) add("--queries " + std::to_string(queries));
  if (seed != 1) add("--seed " + std::to_string(seed));
  if (exact_ns) add("--exact-ns " + Fixed(*exact_ns, 3));
  return text;
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
  const std::vector<Option> all = OptionsOf(options);
  std::vector<std::string> given;
  const auto is_given = [&given](std::string_view name) {
    return std::find(given.begin(), given.end(), name) != given.end();
  };
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    options.command += (i == 1 ? "" : " ") + word;
    const std::size_t equals = std::min(word.find('='), word.size());
    const std::string name = word == "-h" ? "--help" : word.substr(0, equals);
    const auto option =
        std::find_if(all.begin(), all.end(),
                     [&](const Option& each) { return each.name == name; });
    const auto fail = [&](const std::string& why) {
      throw UsageError(name + ": " + why + "; --help lists the options");
    };
    if (option == all.end()) fail("there is no such option");
    if (is_given(name) && !option->may_repeat) fail("it is given twice");
    given.push_back(name);
    std::string value;
    if (*option->value == '\0') {
      if (equals != word.size()) fail("it takes no value");
    } else if (equals != word.size()) {
      value = word.substr(equals + 1);
    } else if (i + 1 == argc ||
               std::string_view(argv[i + 1]).starts_with("--")) {
      fail(std::string("it needs a value, ") + option->value);
    } else {
      value = argv[++i];
      options.command += " " + value;
    }
    if (option->take) {
      const std::string wrong = option->take(value);
      if (!wrong.empty()) fail(wrong);
    }
  }
  if (is_given("--help")) {
    PrintHelp(all);
    return false;
  }
  if (is_given("--version")) {
    std::cout << ThisProgram().name << ' ' << HALFSPACE_VERSION_STRING << '\n';
    return false;
  }
  for (const auto& [one, other] :
       {std::pair("--mesh", "--bounds"),
        std::pair("--query-bounds", "--query-size")}) {
    if (is_given(one) && is_given(other)) {
      throw UsageError(std::string(one) + " excludes " + other);
    }
  }
  if (options.mesh.empty() && options.bounds.empty() &&
      (is_given("--query-bounds") || is_given("--query-size"))) {
    throw UsageError(
        "--query-bounds and --query-size are for a file; give --mesh or "
        "--bounds");
  }
  // A program without a page runs all of its sections.
  if (options.details.empty() &&
      std::none_of(
          ThisProgram().sections.begin(), ThisProgram().sections.end(),
          [](const Section& each) { return (each.flags & kPage) != 0; })) {
    options.details.emplace_back(kAllSections);
  }
  return true;
}

}  // namespace halfspace::bench

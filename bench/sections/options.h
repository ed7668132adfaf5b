// The command line of cpuinfo-bench.
#ifndef HALFSPACE_BENCH_SECTIONS_OPTIONS_H_
#define HALFSPACE_BENCH_SECTIONS_OPTIONS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace halfspace::bench {

inline constexpr std::string_view kAllSections = "all";

struct BenchOptions {
  std::string command;  // as it was typed
  bool is_quick = false;
  // Sections to measure at length and print; empty: the page, in short.
  std::vector<std::string> details;
  std::string mesh;
  std::string bounds;
  std::string query_bounds;
  double query_size = 0;    // percent; 0: none
  std::size_t objects = 0;  // 0: the default of the run
  std::size_t queries = 0;
  std::uint64_t seed = 1;
  std::string target;  // empty: all
  std::size_t repetitions = 0;
  std::optional<double> exact_ns;  // empty: that of a triangle pair, measured
  bool is_strict = false;
  bool is_json = false;
  std::string out;
  bool is_list = false;

  // Returns the options that choose what is measured, as on the command line,
  // without the sections. Runs with different scopes are not compared.
  std::string Scope() const;

  bool Wants(std::string_view section) const;
};

// The message says what is wrong with the command line, and what to do.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Fills `options`. False if only help or the version was requested, which has
// been printed. Throws UsageError.
bool ParseOptions(int argc, char** argv, BenchOptions& options);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_OPTIONS_H_

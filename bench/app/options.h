// The command line of cpuinfo-bench.
#ifndef HALFSPACE_BENCH_APP_OPTIONS_H_
#define HALFSPACE_BENCH_APP_OPTIONS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace halfspace::bench {

inline constexpr std::array<std::string_view, 11> kSections = {
    "machine",    "check",  "table1",  "crossover", "kernels", "build",
    "throughput", "sorted", "quality", "segments",  "verdict"};

enum class Format { kText, kJson };

struct BenchOptions {
  bool is_quick = false;
  std::vector<std::string> only;  // empty: all sections
  std::string mesh;
  std::string bounds;
  std::size_t objects = 0;  // 0: the default of the run
  std::size_t queries = 0;
  std::uint64_t seed = 1;
  std::string target;  // empty: all
  std::size_t repetitions = 0;
  Format format = Format::kText;
  std::string out;
  std::string against;  // a stored report; empty: none
  bool is_list = false;

  // Those that choose what is measured, as on the command line, but for the
  // sections: runs that differ in them are not compared.
  std::string Scope() const;

  bool Wants(std::string_view section) const {
    return only.empty() ||
           std::find(only.begin(), only.end(), section) != only.end();
  }
};

inline constexpr int kExitOk = 0;
inline constexpr int kExitWrongAnswer = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitBadInput = 3;
inline constexpr int kExitFailed = 4;
inline constexpr int kExitWorse = 5;

// What is wrong with the command line, and what to do.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Fills `options`. False if only help or the version was requested, which has
// been printed. Throws UsageError.
bool ParseOptions(int argc, char** argv, BenchOptions& options);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_APP_OPTIONS_H_

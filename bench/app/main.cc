// cpuinfo-bench: measures on this machine what the bounding simplex, the AABB
// and the AABO cost, and where each wins.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "bench/app/html_page.h"
#include "bench/app/options.h"
#include "bench/app/out_file.h"
#include "bench/app/report_file.h"
#include "bench/app/run.h"
#include "bench/base/progress.h"
#include "bench/base/text_table.h"
#include "bench/base/write_whole.h"
#include "bench/input/bounds_reader.h"
#include "bench/input/input_error.h"
#include "bench/input/mesh_reader.h"
#include "bench/report/report.h"
#include "bench/report/stored_run.h"
#include "bench/sections/sections.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

int Fail(const std::string& what, int code) {
  std::cerr << "cpuinfo-bench: " << Printable(what) << '\n';
  return code;
}

// So many that they and their bounds fit the memory.
MeshLimits LimitsOf(std::size_t memory) {
  MeshLimits limits;
  if (memory == 0) return limits;
  const auto most = [memory](std::size_t bytes, std::uint32_t limit) {
    return static_cast<std::uint32_t>(
        std::min<std::size_t>(memory / bytes, limit));
  };
  constexpr std::size_t kCoordinates = 3 * sizeof(float);
  constexpr std::size_t kIndices = 3 * sizeof(std::uint32_t);
  limits.vertices = most(2 * kCoordinates, limits.vertices);
  limits.triangles = most(2 * (kIndices + sizeof(Aabo3)), limits.triangles);
  return limits;
}

Workload ReadWorkload(const BenchOptions& options) {
  if (!options.mesh.empty()) {
    const Mesh mesh = ReadMesh(options.mesh, LimitsOf(FreeMemory()));
    return WorkloadOfTriangles(options.mesh, mesh.coords, mesh.indices,
                               options.queries);
  }
  return WorkloadOfBoxes(options.bounds, ReadBounds(options.bounds),
                         options.queries);
}

// What `read` makes of a file, if it fits the memory, and not all objects of
// what it makes are without bounds.
template <typename Read>
Workload ReadFile(const std::string& path, const Read& read) {
  constexpr const char* kSmaller = "give a smaller one";
  const std::size_t available = FreeMemory();
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (!error && available != 0 && bytes > available) {
    throw InputError(path,
                     "the file takes " + Mebibytes(bytes) +
                         ", too much for the " + Mebibytes(available) +
                         " that are free",
                     kSmaller);
  }
  std::optional<Workload> workload;
  try {
    workload = read();
  } catch (const std::bad_alloc&) {
    throw InputError(path, "the file does not fit the memory", kSmaller);
  }
  for (std::size_t i = 0; i < workload->objects.size(); ++i) {
    if (workload->objects.Get(i) != Aabo3::Everything()) {
      return *std::move(workload);
    }
  }
  throw InputError(path,
                   "all bounds are Everything(), which no test rejects, "
                   "because coordinates beyond 2^125 cannot be bounded",
                   "scale the coordinates down");
}

// The file of --mesh or --bounds, with its queries; nothing if neither was
// given.
std::optional<Workload> ReadInput(const BenchOptions& options) {
  const std::string& path =
      options.mesh.empty() ? options.bounds : options.mesh;
  if (path.empty()) return std::nullopt;
  Workload workload = ReadFile(path, [&] { return ReadWorkload(options); });
  const std::string& queries = options.query_bounds;
  if (!queries.empty()) {
    const Workload source = ReadFile(queries, [&] {
      return WorkloadOfBoxes(queries, ReadBounds(queries), options.queries);
    });
    QueryWith(workload, source.objects, options.queries);
  } else if (options.query_size != 0) {
    QueryWith(workload,
              RandomBoxes(workload, options.query_size, options.queries,
                          options.seed),
              options.queries);
  }
  return workload;
}

// The report of --against; nothing if none was given. Before anything is
// measured.
std::optional<StoredRun> ReadStoredRun(const BenchOptions& options) {
  const std::string& path = options.against;
  if (path.empty()) return std::nullopt;
  StoredRun stored =
      ReadReport(path, [](const std::string& text) { return StoredRun(text); });
  const std::string why =
      stored.WhyIncomparable(RunMachine().machine.cpu, options.Scope());
  if (!why.empty()) {
    throw UsageError("--against " + path + ": " + why +
                     "; compare runs of the same machine and options");
  }
  return stored;
}

// Says what is worse than in the stored run, and still is when its sections run
// again: elsewhere in memory, and beside other neighbours, 4 of 96 ratios of
// the same program were worse.
int Compare(const Results& results, const StoredRun& stored,
            const BenchOptions& options) {
  const std::string& path = options.against;
  std::size_t compared = 0;
  std::vector<Regression> worse = stored.RegressionsIn(results, compared);
  if (compared == 0) {
    throw UsageError("--against " + path +
                     ": no ratio is in both runs; choose sections and targets "
                     "that it has, of kernels, build, throughput and sorted");
  }
  if (!worse.empty()) {
    BenchOptions again = options;
    again.details.clear();
    for (const Regression& regression : worse) {
      again.details.push_back(regression.section);
    }
    Progress progress;
    const Results second = Run(again, ReadInput(options), progress, nullptr);
    progress.Clear();
    std::size_t ignored = 0;
    const std::vector<Regression> twice = stored.RegressionsIn(second, ignored);
    std::erase_if(worse, [&twice](const Regression& once) {
      return std::none_of(twice.begin(), twice.end(),
                          [&once](const Regression& other) {
                            return other.ratio == once.ratio;
                          });
    });
  }
  for (const Regression& regression : worse) {
    std::cerr << "cpuinfo-bench: worse: " << Printable(regression.text) << '\n';
  }
  std::cerr << "cpuinfo-bench: " << worse.size() << " of " << compared
            << " ratios are worse than in " << Printable(path) << '\n';
  return worse.empty() ? kExitOk : kExitWorse;
}

Results RunTo(std::ostream& out, const BenchOptions& options,
              std::optional<Workload> input) {
  const bool is_text = options.format == Format::kText;
  const bool is_page = options.details.empty();
  Progress progress;
  Results results = Run(options, std::move(input), progress,
                        is_text && !is_page ? &out : nullptr);
  progress.Clear();
  if (!is_text) {
    out << ToJson(results) + '\n';
  } else if (is_page) {
    WriteWhole(out,
               [&](std::ostream& page) { WritePage(page, ToJson(results)); });
  }
  return results;
}

int Main(int argc, char** argv) {
  BenchOptions options;
  if (!ParseOptions(argc, argv, options)) return kExitOk;
  if (options.is_list) {
    for (std::string_view section : kSections) std::cout << section << '\n';
    return kExitOk;
  }
  CheckOutputs(options);
  if (!options.render.empty()) return Render(options);
  if (const TargetChoice choice = DescribeTargetChoice();
      !choice.error.empty()) {
    return Fail("HALFSPACE_TARGET: " + choice.error, kExitUsage);
  }
  const std::optional<StoredRun> stored = ReadStoredRun(options);
  std::optional<Workload> input = ReadInput(options);
  std::optional<OutFile> page;
  if (!options.report.empty()) page.emplace(options.report);
  Results results;
  if (options.out.empty()) {
    results = RunTo(std::cout, options, std::move(input));
  } else {
    OutFile file(options.out);
    std::ostringstream text;
    text.exceptions(std::ios::badbit);
    results = RunTo(text, options, std::move(input));
    file.Write(text.str());
  }
  if (page) WriteHtml(*page, {ToJson(results)});
  if (options.is_strict && results.noise && results.noise->is_noisy()) {
    return Fail(
        "--strict: something disturbed the run, which is reported all the same "
        "(the section noise says how much); run again when the machine is idle",
        kExitFailed);
  }
  return stored ? Compare(results, *stored, options) : kExitOk;
}

}  // namespace
}  // namespace halfspace::bench

int main(int argc, char** argv) {
  using namespace halfspace::bench;
  try {
    const int code = Main(argc, argv);
    std::cout.flush();
    if (std::cout) return code;
    return Fail("standard output: writing failed; is the disk full?",
                kExitFailed);
  } catch (const UsageError& error) {
    return Fail(error.what(), kExitUsage);
  } catch (const WrongAnswer& error) {
    return Fail(std::string("wrong answer: ") + error.what() +
                    ". Please report this machine.",
                kExitWrongAnswer);
  } catch (const InputError& error) {
    return Fail(error.what(), kExitBadInput);
  } catch (const std::bad_alloc&) {
    return Fail(
        "not enough memory; free some, or choose --quick, fewer --objects or "
        "fewer sections by --details",
        kExitFailed);
  } catch (const std::exception& error) {
    return Fail(error.what(), kExitFailed);
  } catch (...) {
    return Fail("an unknown error", kExitFailed);
  }
}

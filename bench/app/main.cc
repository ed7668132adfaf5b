// The main function of cpuinfo-bench and of paper-bench.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "bench/app/run.h"
#include "bench/base/progress.h"
#include "bench/base/text.h"
#include "bench/input/bounds_reader.h"
#include "bench/input/mesh_reader.h"
#include "bench/input/text_lines.h"
#include "bench/measure/machine.h"
#include "bench/report/table.h"
#include "bench/sections/options.h"
#include "bench/sections/run.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

int Fail(const std::string& what, int code) {
  std::cerr << ThisProgram().name << ": " << Printable(what) << '\n';
  return code;
}

constexpr const char* kNoMemory =
    "not enough memory; free some, raise the limit of ulimit -v, or choose "
    "--quick, fewer --objects or fewer sections by --details";

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

Report RunTo(std::ostream& out, const BenchOptions& options,
             std::optional<Workload> input) {
  Progress progress(ThisProgram().name);
  Report report = RunSections(options, std::move(input), progress,
                              options.is_json ? nullptr : &out);
  if (options.is_json) out << ToJson(report);
  return report;
}

// Throws UsageError if the file of --out cannot be written, or is also a file
// to read, under any of its names: before the run rather than after it.
void CheckOut(const BenchOptions& options) {
  namespace fs = std::filesystem;
  std::error_code error;
  const std::pair<const char*, std::string> inputs[] = {
      {"--mesh", options.mesh},
      {"--bounds", options.bounds},
      {"--query-bounds", options.query_bounds}};
  for (const auto& [option, path] : inputs) {
    if (!path.empty() && fs::is_regular_file(options.out, error) &&
        fs::equivalent(options.out, path, error)) {
      throw UsageError("--out " + options.out +
                       " would overwrite the file of " + option + " " + path +
                       "; name another file");
    }
  }
  const bool is_new = !fs::exists(options.out, error);
  // Appending leaves it as it is.
  if (!std::ofstream(options.out, std::ios::app)) {
    throw UsageError(options.out + ": cannot be written; choose another file");
  }
  if (is_new) fs::remove(options.out, error);
}

int Main(int argc, char** argv) {
  BenchOptions options;
  if (!ParseOptions(argc, argv, options)) return kExitOk;
  if (options.is_list) {
    for (const Section& section : ThisProgram().sections) {
      std::cout << section.name << '\n';
    }
    return kExitOk;
  }
  if (!options.out.empty()) CheckOut(options);
  // Builders and refits take no target: they run on the chosen one.
  if (!options.target.empty()) {
#if defined(_WIN32)
    _putenv_s("HALFSPACE_TARGET", options.target.c_str());
#else
    setenv("HALFSPACE_TARGET", options.target.c_str(), 1);
#endif
  }
  if (const TargetChoice choice = DescribeTargetChoice();
      !choice.error.empty()) {
    return Fail("HALFSPACE_TARGET: " + std::string(choice.error), kExitUsage);
  }
  std::optional<Workload> input = ReadInput(options);
  std::ostringstream text;
  text.exceptions(std::ios::badbit);
  const Report report =
      RunTo(options.out.empty() ? std::cout : text, options, std::move(input));
  std::cout << std::flush;
  if (!options.out.empty()) {
    std::ofstream file(options.out);
    file << text.str();
    file.close();
    if (!file) {
      throw std::runtime_error(options.out +
                               ": writing failed; is the disk full?");
    }
  }
  if (options.is_strict && report.ValueOf("noise") == "noisy") {
    return Fail(
        "--strict: something disturbed the run, which is reported all the same "
        "(the section noise says how much); run again when the machine is idle",
        kExitFailed);
  }
  return kExitOk;
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
    return Fail(kNoMemory, kExitFailed);
  } catch (const std::exception& error) {
    return Fail(error.what(), kExitFailed);
  } catch (...) {
    return Fail("an unknown error", kExitFailed);
  }
}

// cpuinfo-bench: measures on this machine what the bounding simplex, the AABB
// and the AABO cost, and where each wins.
#include <fstream>
#include <iostream>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "bench/bounds_reader.h"
#include "bench/input_error.h"
#include "bench/mesh_reader.h"
#include "bench/options.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/run.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

int List() {
  for (std::string_view section : kSections) std::cout << section << '\n';
  return kExitOk;
}

int Fail(const std::string& what, int code) {
  std::cerr << "cpuinfo-bench: " << what << '\n';
  return code;
}

// The file of --mesh or --bounds; nothing if neither was given.
std::optional<Workload> ReadInput(const BenchOptions& options) {
  if (!options.mesh.empty()) {
    const Mesh mesh = ReadMesh(options.mesh);
    return WorkloadOfTriangles(options.mesh, mesh.coords, mesh.indices,
                               options.queries);
  }
  if (!options.bounds.empty()) {
    return WorkloadOfBoxes(options.bounds, ReadBounds(options.bounds),
                           options.queries);
  }
  return std::nullopt;
}

int RunTo(std::ostream& out, const BenchOptions& options,
          std::optional<Workload> input) {
  const bool is_text = options.format == Format::kText;
  Progress progress;
  const Results results =
      Run(options, std::move(input), progress, is_text ? &out : nullptr);
  progress.Clear();
  if (!is_text) out << ToJson(results) << '\n';
  out.flush();
  return kExitOk;
}

int Main(int argc, char** argv) {
  BenchOptions options;
  if (const std::optional<int> code = ParseOptions(argc, argv, options)) {
    return *code;
  }
  if (options.is_list) return List();
  if (const TargetChoice choice = DescribeTargetChoice();
      !choice.error.empty()) {
    return Fail("HALFSPACE_TARGET: " + choice.error, kExitUsage);
  }
  std::optional<Workload> input = ReadInput(options);
  if (options.out.empty()) {
    const int code = RunTo(std::cout, options, std::move(input));
    return std::cout ? code : Fail("standard output: cannot write", kExitUsage);
  }
  std::ofstream file(options.out);
  if (!file) {
    return Fail(options.out + ": cannot be written; choose another --out",
                kExitUsage);
  }
  const int code = RunTo(file, options, std::move(input));
  return file ? code
              : Fail(options.out + ": writing failed; is the disk full?",
                     kExitUsage);
}

}  // namespace
}  // namespace halfspace::bench

int main(int argc, char** argv) {
  using namespace halfspace::bench;
  try {
    return Main(argc, argv);
  } catch (const WrongAnswer& error) {
    return Fail(std::string("wrong answer: ") + error.what() +
                    ". Please report this machine.",
                kExitWrongAnswer);
  } catch (const InputError& error) {
    return Fail(error.what(), kExitBadInput);
  } catch (const std::bad_alloc&) {
    return Fail("out of memory; choose fewer --objects or a smaller file",
                kExitUsage);
  }
}

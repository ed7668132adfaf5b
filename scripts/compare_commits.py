#!/usr/bin/env python3
"""Compares two commits in turns on this machine: the speed of flat scans, or what it
costs to include a header:

    scripts/compare_commits.py OLD [NEW] [--runs N] [--objects N,N...]
    scripts/compare_commits.py OLD [NEW] --headers

OLD and NEW are commits. Without NEW it is the working tree, with all changes. The
same program is linked to the library of each and run N times in turns, so that
both meet the same clock and the same neighbours. A row shows the median of each
in ns, the range of its runs, and median of NEW / median of OLD.

`--headers` compares instead what it costs to include a header: its preprocessed
lines in C++20, and the processor's time to compile a file that includes it alone,
by the compiler in CXX (default: g++), in ms.

`--directory DIR` keeps worktrees and builds for the next comparison.
"""

import argparse
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent

HEADERS = ["halfspace.h", "reject.h", "world.h", "bvh.h", "broad_phase.h",
           "quantized.h", "span.h", "kernels.h"]

PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(compare LANGUAGES CXX)
add_subdirectory(${LIBRARY} library)
add_executable(compare ${PROGRAM})
target_compile_features(compare PRIVATE cxx_std_20)
target_link_libraries(compare PRIVATE halfspace::halfspace)
"""

# Compiles with both: it uses views, calls and targets by name, and nothing that a
# call returns.
PROGRAM = r"""
#include <halfspace/halfspace.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

halfspace::Aabo3 RandomBound(std::mt19937& random) {
  std::uniform_real_distribution<float> place(0, 1);
  constexpr float kHalf = 0.02f;
  halfspace::Aabo3 bound{};
  float sum = 0;
  for (int k = 0; k < 3; ++k) {
    const float center = place(random);
    sum += center;
    bound.min[k] = center - kHalf;
    bound.max[k] = center + kHalf;
  }
  bound.min[3] = -sum - 2 * kHalf;
  bound.max[3] = -sum + 2 * kHalf;
  return bound;
}

template <typename Query>
Query QueryOf(const halfspace::Aabo3& bound) {
  Query query{};
  for (std::size_t k = 0; k < query.max.size(); ++k) {
    if constexpr (requires { query.min; }) query.min[k] = bound.min[k];
    query.max[k] = bound.max[k];
  }
  return query;
}

// The least time of a call. `call` makes one, for a query by its number.
template <typename Call>
double Nanoseconds(const Call& call) {
  constexpr double kSample = 2e6;
  double best = 1e30;
  std::size_t calls = 1;
  for (int sample = 0; sample < 9;) {
    const auto begin = Clock::now();
    for (std::size_t i = 0; i < calls; ++i) call(i);
    const double took =
        std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
    if (took < kSample / 2) {
      calls = std::max(2 * calls,
                       static_cast<std::size_t>(double(calls) * kSample / took));
      continue;
    }
    best = std::min(best, took / double(calls));
    ++sample;
  }
  return best;
}

template <typename View>
void Measure(const char* shape, const View& view,
             const std::vector<halfspace::Aabo3>& bounds) {
  std::vector<typename View::Query> queries;
  for (const auto& bound : bounds) {
    queries.push_back(QueryOf<typename View::Query>(bound));
  }
  const std::size_t last = queries.size() - 1;
  std::vector<std::uint64_t> mask(halfspace::MaskWords(view.size));
  std::vector<std::uint32_t> ids(view.size);
  for (const char* name : {"SSE4", "AVX2", "AVX3"}) {
    const auto target = halfspace::FindTarget(name);
    if (!target) continue;
    halfspace::Options options;
    options.target = *target;
    const auto row = [&](const char* call, double ns, const char* unit) {
      std::printf("%s of %zu, %s, %s\t%s\t%.9g\n", shape, view.size, call,
                  name, unit, ns);
    };
    const double ns = Nanoseconds([&](std::size_t i) {
      halfspace::SurvivorMask(view, queries[i & last], mask, options);
    });
    if (view.size >= 1024) {
      row("mask", ns / double(view.size), "ns an object");
      continue;
    }
    row("mask", ns, "ns a call");
    row("ids", Nanoseconds([&](std::size_t i) {
          (void)halfspace::Survivors(view, queries[i & last], ids, options);
        }),
        "ns a call");
  }
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    std::mt19937 random(1);
    std::vector<halfspace::Aabo3> queries(16);
    for (auto& query : queries) query = RandomBound(random);
    const std::size_t size = std::strtoull(argv[i], nullptr, 10);
    halfspace::AaboWorld3 world;
    world.Reserve(size);
    for (std::size_t k = 0; k < size; ++k) world.Push(RandomBound(random));
    Measure("simplex", world.view().simplex(), queries);
    Measure("AABB", world.view().aabb(), queries);
    Measure("AABO", world.view(), queries);
  }
}
"""


def run(*command, **options):
    return subprocess.run(command, check=True, **options)


def build(source, directory, program):
    """Builds the library of `source` and the program; returns its path."""
    (directory / "CMakeLists.txt").write_text(PROJECT)
    binaries = directory / "build"
    quiet = {"stdout": subprocess.DEVNULL}
    run("cmake", "-S", directory, "-B", binaries, f"-DLIBRARY={source}",
        f"-DPROGRAM={program}", "-DCMAKE_BUILD_TYPE=Release",
        "-DHALFSPACE_DIMS=3", **quiet)
    run("cmake", "--build", binaries, "--parallel", str(os.cpu_count()),
        "--target", "compare", **quiet)
    return binaries / "compare"


def source_of(commit, directory):
    """Returns the directory of the sources of `commit`."""
    directory.mkdir(parents=True, exist_ok=True)
    if commit is None:
        return ROOT
    tree = directory / "source"
    if tree.exists():
        run("git", "-C", tree, "checkout", "--quiet", "--detach", commit)
    else:
        run("git", "-C", ROOT, "worktree", "add", "--quiet", "--detach", tree,
            commit)
    return tree


def measure(binary, objects, rows):
    output = run(binary, *objects, capture_output=True, text=True).stdout
    for line in output.splitlines():
        row, unit, ns = line.split("\t")
        rows.setdefault((row, unit), []).append(float(ns))


def summary(values):
    return (f"{statistics.median(values):8.3f} "
            f"[{min(values):.3f}, {max(values):.3f}]")


def compare(options, directory):
    program = directory / "compare.cc"
    program.write_text(PROGRAM)
    commits = [options.old, options.new]
    binaries = []
    for commit, name in zip(commits, ["old", "new"]):
        source = source_of(commit, directory / name)
        binaries.append(build(source, directory / name, program))
    results = [{}, {}]
    for _ in range(options.runs):
        for binary, rows in zip(binaries, results):
            measure(binary, options.objects.split(","), rows)
    print(f"{'':36} {'unit':12} {'old':>26} {'new':>26}   new / old")
    for (row, unit), old in results[0].items():
        new = results[1][row, unit]
        ratio = statistics.median(new) / statistics.median(old)
        print(f"{row:36} {unit:12} {summary(old):>26} {summary(new):>26}"
              f"   {ratio:.2f}")


def include(source, header, directory):
    """Returns the preprocessed lines of a header and the ms to compile it."""
    program = directory / "include.cc"
    program.write_text(f"#include <halfspace/{header}>\n")
    command = [os.environ.get("CXX", "g++"), "-std=c++20", f"-I{source}/include",
               program]
    text = run(*command, "-E", capture_output=True).stdout
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run(*command, "-c", "-o", os.devnull)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = (after.ru_utime + after.ru_stime - before.ru_utime -
               before.ru_stime)
    return text.count(b"\n"), 1000 * seconds


def compare_headers(options, directory):
    sources = [source_of(commit, directory / name)
               for commit, name in [(options.old, "old"), (options.new, "new")]]
    print(f"{'':14} {'old lines':>10} {'new lines':>10} {'old ms':>26} "
          f"{'new ms':>26}   new / old")
    for header in HEADERS:
        if not all((source / "include/halfspace" / header).exists()
                   for source in sources):
            continue
        results = [[include(source, header, directory) for source in sources]
                   for _ in range(options.runs)]
        lines = [lines for lines, _ in results[0]]
        old, new = ([run[k][1] for run in results] for k in (0, 1))
        ratio = statistics.median(new) / statistics.median(old)
        print(f"{header:14} {lines[0]:10} {lines[1]:10} {summary(old):>26} "
              f"{summary(new):>26}   {ratio:.2f}")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("old", metavar="OLD")
    parser.add_argument("new", metavar="NEW", nargs="?")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument(
        "--objects", default="10,16384,262144,524288,2097152,16777216",
        help="world sizes; smaller than 1024: time of a call, with ids too")
    parser.add_argument("--headers", action="store_true")
    parser.add_argument("--directory", type=pathlib.Path)
    options = parser.parse_args()
    compare_them = compare_headers if options.headers else compare
    if options.directory is not None:
        options.directory.mkdir(parents=True, exist_ok=True)
        compare_them(options, options.directory.resolve())
        return
    with tempfile.TemporaryDirectory() as directory:
        try:
            compare_them(options, pathlib.Path(directory))
        finally:
            for name in ("old", "new"):
                tree = pathlib.Path(directory) / name / "source"
                if tree.exists():
                    run("git", "-C", ROOT, "worktree", "remove", "--force",
                        tree)


if __name__ == "__main__":
    main()

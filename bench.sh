#!/usr/bin/env bash
# Measures this machine: installs what is missing, builds cpuinfo-bench, or with --paper
# paper-bench, and runs it with the arguments given. Only its results go to stdout.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

for argument in "$@"; do
  case $argument in -h | --help)
    if [ ! -x "$root/build/bench/bench/cpuinfo-bench" ]; then
      say "usage: ./bench.sh [--paper] [OPTION...]: installs what is missing," \
        "builds cpuinfo-bench, or with --paper paper-bench, and runs it with" \
        "these options. They are in docs/cpuinfo-bench.md; once it is built," \
        "--help lists them."
      exit 0
    fi
    ;;
  esac
done

# CGAL is under the GPL, and so is a tool that was built with it.
arguments=()
cgal=OFF
# The kernels of 4 dimensions are compiled for the experiments of the paper alone.
program=cpuinfo-bench
folder=bench
dims="2;3"
for argument in "$@"; do
  case $argument in
    --with-cgal)
      cgal=ON
      competitor_packages+=(libcgal-dev)
      ;;
    --paper)
      program=paper-bench
      folder=release
      dims="2;3;4"
      ;;
    *) arguments+=("$argument") ;;
  esac
done

prepare_machine "${competitor_packages[@]}"
build_preset release -B "$folder" "-DHALFSPACE_BENCH_CGAL=$cgal" \
  "-DHALFSPACE_DIMS=$dims" "$program"
say "==> run $program"
exec "$root/build/$folder/bench/$program" "${arguments[@]}"

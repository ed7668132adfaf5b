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
        "these options. They are in docs/cpuinfo-bench.1; once it is built," \
        "--help lists them."
      exit 0
    fi
    ;;
  esac
done

# The options that may be given, as its manual lists them. Before anything is installed.
known=$(sed -nE '/^\.SH OPTIONS/,/^\.SH EXIT/s/\\(f[A-Z])?//gp' "$root/docs/cpuinfo-bench.1" |
  grep -oE '(^| )--?[a-z-]+' | tr -d ' ')
for argument in "$@"; do
  if [[ $argument == -* ]] && ! grep -qxF -e "${argument%%=*}" <<<"$known"$'\n--paper'; then
    say "./bench.sh: \"$argument\" is no option of it. Its options are in docs/cpuinfo-bench.1."
    exit 2
  fi
done

# The kernels of 4 dimensions are compiled for the experiments of the paper alone. The
# library is compiled without what cpuinfo-bench does not call, and without --details and
# --list also the tool without the sections that are not on the page.
arguments=()
program=cpuinfo-bench
folder=bench
alone=PAGE
packages=()
for argument in "$@"; do
  case $argument in
    --paper) program=paper-bench ;;
    *) arguments+=("$argument") ;;
  esac
  case $argument in
    --paper | --details* | --list)
      alone=ON
      packages=("${competitor_packages[@]}")
      ;;
  esac
done
options=("-DHALFSPACE_DIMS=2;3" -DHALFSPACE_C=OFF "-DHALFSPACE_BENCH_ALONE=$alone")
if [ "$program" = paper-bench ]; then
  folder=release
  options=()
fi

prepare_machine "${packages[@]}"
build_preset release -B "$folder" "${options[@]}" "$program"
say "==> run $program"
exec "$root/build/$folder/bench/$program" "${arguments[@]}"

#!/usr/bin/env bash
# Measures this machine: installs what is missing, builds cpuinfo-bench and runs
# it with the arguments given. Only its results go to stdout.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

for argument in "$@"; do
  case $argument in -h | --help)
    if [ ! -x "$root/build/release/bench/cpuinfo-bench" ]; then
      say "usage: ./bench.sh [OPTION...]: installs what is missing, builds" \
        "cpuinfo-bench, and runs it with these options. They are in" \
        "docs/cpuinfo-bench.md; once it is built, --help lists them."
      exit 0
    fi
    ;;
  esac
done

prepare_machine "${competitor_packages[@]}" "${page_packages[@]}"
build_preset release cpuinfo-bench
say "==> run cpuinfo-bench"
exec "$root/build/release/bench/cpuinfo-bench" "$@"

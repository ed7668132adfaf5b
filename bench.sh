#!/usr/bin/env bash
# Measures this machine: installs what is missing, builds cpuinfo-bench and runs
# it with the arguments given. Only its results go to stdout.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

prepare_machine "${peer_packages[@]}"
build_preset release cpuinfo-bench
say "==> run cpuinfo-bench"
exec "$root/build/release/bench/cpuinfo-bench" "$@"

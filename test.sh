#!/usr/bin/env bash
# Tests the library on this machine: installs what is missing, builds, and runs
# every test. Arguments are passed on to ctest.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

prepare_machine
build_preset release
test_preset release "$@"

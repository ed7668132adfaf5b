#!/usr/bin/env bash
# Tests the library: see usage below.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"
source "$root/scripts/machines.sh"

usage="usage: ./test.sh [--full] [--arm | --windows | --machine NAME] [CTEST ARGUMENT...]

Installs what is missing, builds the library in 3 dimensions, and runs the tests that
can fail on one machine and pass on another: scans on every target that the machine
can run, in every way to call them; hashes of the answers of all other kernels and
builders; the choice of a target; and threads.

  --full     everything: 2, 3 and 4 dimensions; what all machines have in common, such
             as exact bounds and the checks of arguments; and the tests of the C API, of
             cpuinfo-bench, of the examples, and of the installed package
  --arm      for arm64 instead: cross-compiles, and runs under qemu, on NEON, SVE, SVE2
             and their fixed-width forms, the tests of what differs there, at a
             hundredth of their scale
  --windows  for 64-bit Windows instead: cross-compiles a DLL of 2 and 3 dimensions by
             mingw-w64, and runs in wine, at a tenth of their scale, the same tests except
             those that need GMP, the tests of the C API, the examples, and cpuinfo-bench
             from the zip that cpack makes
  --machine NAME
             for ${machines[*]} instead, or all for one after
             another: cross-compiles the library in 3 dimensions, and runs under qemu the
             hashes of answers and the tests of the bytes of a BVH and of a broad phase

Other arguments are options of ctest that choose tests and what is printed, as in
./test.sh -R Range.
HALFSPACE_TEST_SCALE=0.1 makes random tests a tenth as long, here and natively."

preset=release
is_full=
while [ $# -gt 0 ]; do
  case $1 in
    --full) is_full=1 ;;
    --arm) preset=aarch64 ;;
    --windows) preset=windows ;;
    --machine)
      shift
      preset=machine
      case " ${machines[*]} " in
        *" ${1-} "*) chosen=("$1") ;;
        *)
          if [ "${1-}" != all ]; then
            say "./test.sh: --machine \"${1-}\" is none of ${machines[*]} and all."
            exit 2
          fi
          chosen=("${machines[@]}")
          ;;
      esac
      ;;
    -h | --help)
      printf '%s\n' "$usage"
      exit 0
      ;;
    *) break ;;
  esac
  shift
done
# Whoever chooses tests reads what ctest says of them.
# shellcheck disable=SC2034  # for test_preset
if [ $# -gt 0 ]; then show_all=yes; fi

# The options of ctest that may follow. Before anything is installed.
for argument in "$@"; do
  case ${argument%%=*} in
    -E | -FA | -FC | -FS | -I | -L | -LE | -N | -O | -Q | -R | -U | -V | -VV | -j | -j[0-9]*) ;;
    --exclude-regex | --label-exclude | --label-regex | --tests-regex | --union) ;;
    --fixture-exclude-any | --fixture-exclude-cleanup | --fixture-exclude-setup) ;;
    --extra-verbose | --no-label-summary | --output-junit | --output-log) ;;
    --output-on-failure | --print-labels | --progress | --quiet | --show-only) ;;
    --max-width | --parallel | --repeat | --rerun-failed | --schedule-random) ;;
    --stop-on-failure | --stop-time | --test-load | --timeout | --verbose) ;;
    -*)
      say "./test.sh: \"$argument\" is no option of it, and none of ctest that it passes on." \
        "./test.sh --help lists its own."
      exit 2
      ;;
  esac
done

if [ "$is_full" ]; then
  prepare_machine "${page_test_packages[@]}" "${example_packages[@]}" doxygen qemu-user
else
  prepare_machine
fi
if [ "$preset" = aarch64 ]; then prepare_arm; fi
if [ "$preset" = machine ]; then
  for machine in "${chosen[@]}"; do test_machine "$machine" "$@"; done
elif [ "$preset" = windows ]; then
  install_packages "${windows_packages[@]}"
  build_preset windows "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG" -DHALFSPACE_UNITY=ON \
    "${windows_tests[@]}"
  test_preset windows --tests-regex "$windows_names" "$@"
elif [ "$is_full" ]; then
  build_preset "$preset" -DHALFSPACE_TEST_ONLY_3D=OFF
  test_preset "$preset" "$@"
elif [ "$preset" = aarch64 ]; then
  build_preset "$preset" "${library_tests[@]}"
  test_preset "$preset" --label-regex '^library$' "$@"
else
  # In a folder of its own: a library of all dimensions, and its tests, would be built
  # again after bench.sh or --full.
  build_preset release -B test -DHALFSPACE_UNITY=ON -DHALFSPACE_DIMS=3 -DHALFSPACE_C=OFF \
    -DHALFSPACE_BUILD_TOOLS=OFF -DHALFSPACE_BUILD_EXAMPLES=OFF "${machine_tests[@]}"
  test_preset release -B test --label-regex '^library$' "$@"
fi

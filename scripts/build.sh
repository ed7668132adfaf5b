# shellcheck shell=bash
# From a fresh clone to a build of one preset. After steps.sh; needs `root`, the
# top of the repository.

# What tests the library itself: its targets for Ninja, its tests' label.
# shellcheck disable=SC2034  # for those who source this
library_tests=(tests/kernels/all tests/library/all)
# Those of them that can fail on one machine and pass on another. What the other kernels
# return, hash_test compares with known hashes.
# shellcheck disable=SC2034
machine_tests=(
  scan_test kernels_test reject_test hash_test fast_math_caller_test
  targets_test environment_test detect_targets_test
  broad_phase_threads_test dispatch_race_test range_threads_test)

# Windows runs these, which need neither GMP nor Highway's library. Wine takes seconds to
# start, so the tests try few values of HALFSPACE_TARGET.
# shellcheck disable=SC2034
windows_tests=(
  scan_test kernels_test reject_test hash_test targets_test environment_test
  broad_phase_threads_test dispatch_race_test range_threads_test c_test examples/all cpuinfo-bench)
# shellcheck disable=SC2034
windows_names='^((scan|kernels|reject|hash|targets|c|.*_threads|dispatch_race)_test$|example|environment_test.(SSE4|unknown)|package.(stack|zip))'

# build_preset PRESET [-B FOLDER] [-DNAME=VALUE...] [TARGET...]: the build is in
# build/FOLDER, without -B in build/PRESET.
build_preset() {
  local preset=$1 folder=$1 choice=() options=()
  shift
  if [ "${1-}" = -B ]; then
    folder=$2
    shift 2
  fi
  while [[ ${1-} == -D* ]]; do
    options+=("$1")
    shift
  done
  if [ $# -gt 0 ]; then choice=(--target "$@"); fi
  # shellcheck disable=SC2154  # root is the caller's
  # Where changes are accepted, warnings are errors; a user's newer compiler may
  # have new ones. And there the times of cpuinfo-bench do not matter.
  step "configure $folder" cmake -S "$root" --preset "$preset" -B "$root/build/$folder" \
    -DHALFSPACE_WERROR="${HALFSPACE_WERROR:-OFF}" \
    -DHALFSPACE_BENCH_UNOPTIMISED="${HALFSPACE_BENCH_UNOPTIMISED:-OFF}" "${options[@]}"
  step "build $folder" cmake --build "$root/build/$folder" "${choice[@]}"
}

# Two programs that start at once would each start a server of wine, and one of them then
# looks for its socket in the other's folder. The server ends a minute after the last program.
# Its status is 2 if it runs already. Wine's services start here too, as a test that started
# them would seem to run until they end: they keep its output open.
start_wine() (
  export WINEPREFIX=$root/build/windows/wine PATH=$PATH:/usr/lib/wine
  mkdir -p "$WINEPREFIX"
  wineserver --persistent=60 || [ $? -eq 2 ]
  WINEDEBUG=-all WINEDLLOVERRIDES=mscoree,mshtml= wine64 wineboot
)

# test_preset PRESET [-B FOLDER] [CTEST ARGUMENT...]: says how many tests failed, and
# shows what they said. With `show_all` the output of ctest is shown, and not in a log.
test_preset() {
  local preset=$1 folder=$1 run
  shift
  if [ "$preset" = windows ]; then step "start wine" start_wine; fi
  run=(env -C "$root" ctest --preset "$preset")
  if [ "${1-}" = -B ]; then
    folder=$2
    shift 2
    run=(ctest --test-dir "$root/build/$folder" --output-on-failure --no-tests=error)
  fi
  run+=(--parallel "$(getconf _NPROCESSORS_ONLN)" "$@")
  if [ "${show_all-}" ]; then
    say "==> test $folder"
    "${run[@]}"
  else
    step "test $folder" "${run[@]}"
    say "    $(grep 'tests passed,' "$root/build/logs/test_${folder//[^a-zA-Z0-9]/_}.txt")"
  fi
}

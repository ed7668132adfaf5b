# shellcheck shell=bash
# From a fresh clone to a build of one preset. After steps.sh; needs `root`, the
# top of the repository.

# What tests the library itself: its targets for Ninja, its tests' label.
# shellcheck disable=SC2034  # for those who source this
library_tests=(tests/kernels/all tests/library/all)

# build_preset PRESET [-DNAME=VALUE...] [TARGET...]
build_preset() {
  local preset=$1 choice=() options=()
  shift
  while [[ ${1-} == -D* ]]; do
    options+=("$1")
    shift
  done
  if [ $# -gt 0 ]; then choice=(--target "$@"); fi
  # shellcheck disable=SC2154  # root is the caller's
  # Where changes are accepted, warnings are errors; a user's newer compiler may
  # have new ones. And there the times of cpuinfo-bench do not matter.
  step "configure $preset" cmake -S "$root" --preset "$preset" \
    -DHALFSPACE_WERROR="${HALFSPACE_WERROR:-OFF}" \
    -DHALFSPACE_BENCH_UNOPTIMISED="${HALFSPACE_BENCH_UNOPTIMISED:-OFF}" "${options[@]}"
  step "build $preset" cmake --build "$root/build/$preset" "${choice[@]}"
}

# test_preset PRESET [CTEST ARGUMENT...]: ctest's own output is the result.
test_preset() {
  local preset=$1
  shift
  say "==> test $preset"
  (cd "$root" &&
    ctest --preset "$preset" --parallel "$(getconf _NPROCESSORS_ONLN)" "$@")
}

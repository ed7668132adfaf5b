#!/usr/bin/env bash
# Runs the tests against exact arithmetic at full scale, and prints what ran:
# 20 times what test.sh takes, which makes millions of bounds. About ten minutes
# of one core. An argument sets another scale.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

scale=${1:-20}
suites=(fit_test fit_many_test fast_math_caller_test)

prepare_machine
build_preset release -DHALFSPACE_TEST_ONLY_3D=OFF "${suites[@]}"

reports=$(mktemp -d)
trap 'rm -rf "$reports"' EXIT

# total NAME FILE...: the sum of a number that tests recorded.
total() {
  local name=$1
  shift
  { grep -oh "property name=\"$name\" value=\"[0-9]*\"" "$@" || true; } |
    awk -F'"' '{ sum += $4 } END { printf "%d", sum }'
}

# row SUITE TESTS SECONDS FILE...
row() {
  local name=$1 tests=$2 seconds=$3
  shift 3
  printf '| %s | %s | %s | %s |\n' "$name" "$tests" "$(total bounds "$@")" \
    "$seconds"
}

printf 'HALFSPACE_TEST_SCALE=%s, commit %s\n\n' "$scale" \
  "$(git -C "$root" describe --always --dirty 2>/dev/null || echo unknown)"
printf '%s\n' \
  '| suite | tests | bounds | s |' '|---|---|---|---|'
all_tests=0
begin=$SECONDS
for suite in "${suites[@]}"; do
  report=$reports/$suite.xml
  started=$SECONDS
  HALFSPACE_TEST_SCALE=$scale step "run $suite" \
    "$root/build/release/tests/library/$suite" --gtest_brief=1 \
    "--gtest_output=xml:$report"
  tests=$(grep -c '<testcase ' "$report")
  all_tests=$((all_tests + tests))
  row "$suite" "$tests" "$((SECONDS - started))" "$report"
done
row "all" "$all_tests" "$((SECONDS - begin))" "$reports"/*.xml

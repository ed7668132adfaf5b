#!/usr/bin/env bash
# Runs every fuzzer: see usage below. On Debian; builds what is missing.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

usage='usage: tests/fuzz/run.sh [SECONDS]

Runs all fuzzers at once for SECONDS (60 without it). Inputs stay in build/asan/found, from
which the next run begins, and an input that fails in build/asan/wrong.'

seconds=${1:-60}
if ! [[ $seconds =~ ^[1-9][0-9]*$ ]]; then
  say "$usage"
  exit 2
fi

prepare_machine
install_packages clang libclang-rt-dev
build_preset asan fuzzers

build=$root/build/asan
mkdir -p "$build/wrong" "$build/logs"

# fuzz NAME: a line on how it went, or why it failed.
fuzz() {
  local name=$1 log=$build/logs/$1.txt input
  local found=$build/found/$name
  mkdir -p "$found"
  # Past the end of an input all its bytes choose, so long ones say more.
  if "$build/tests/fuzz/$name" -max_total_time="$seconds" -max_len=400 \
    -len_control=0 -reduce_inputs=0 -entropic=0 -timeout=60 \
    -artifact_prefix="$build/wrong/$name-" "$found" >"$log" 2>&1; then
    say "    $name: $(tail -n 1 "$log")"
  else
    grep -vE '^(#[0-9]+\s|INFO:|\s+NEW_FUNC)' "$log" | tail -n 60 >&2
    input=$(sed -n 's/^.*Test unit written to //p' "$log" | tail -n 1)
    say "FAILED: $name. All it said is in $log. To see it again:" \
      "$build/tests/fuzz/$name $input"
    return 1
  fi
}

# All at once: the system shares the time out.
say "==> fuzz"
declare -A pids
for source in "$root"/tests/fuzz/fuzz_*.cc; do
  name=$(basename "$source" .cc)
  fuzz "$name" &
  pids[$name]=$!
done
failed=0
for name in "${!pids[@]}"; do wait "${pids[$name]}" || failed=1; done
exit "$failed"

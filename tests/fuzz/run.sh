#!/usr/bin/env bash
# Runs every fuzzer, from the inputs kept in corpus/ on, all at once for SECONDS,
# a minute unless told otherwise. New inputs stay in the build directory, those
# that fail too. On Debian; builds what is missing.
#
#   tests/fuzz/run.sh [SECONDS]
#
# To keep what a longer run has found: merge it by -set_cover_merge=1 (libFuzzer's
# -help=1) into an empty folder, which takes the inputs that cover most first, and
# commit the first sixty.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

seconds=${1:-60}
if ! [[ $seconds =~ ^[1-9][0-9]*$ ]]; then
  say "Usage: tests/fuzz/run.sh [SECONDS]: expected a whole number of seconds," \
    "got \"$seconds\""
  exit 2
fi

prepare_machine
install_packages clang libclang-rt-dev
build_preset asan fuzzers

build=$root/build/asan
mkdir -p "$build/found" "$build/wrong" "$build/logs"

# fuzz NAME: a line on how it went, or why it failed.
fuzz() {
  local name=$1 log=$build/logs/$1.txt
  mkdir -p "$build/found/$name"
  # Past the end of an input there are only zeros, so long ones say more.
  if "$build/tests/fuzz/$name" -max_total_time="$seconds" -max_len=200 \
    -len_control=0 -reduce_inputs=0 -entropic=0 -timeout=60 \
    -artifact_prefix="$build/wrong/$name-" \
    "$build/found/$name" "$root/tests/fuzz/corpus/$name" >"$log" 2>&1; then
    say "    $name: $(tail -n 1 "$log")"
    return
  fi
  grep -vE '^(#[0-9]+\s|INFO:|\s+NEW_FUNC)' "$log" | tail -n 60 >&2
  say "FAILED: $name. All it said is in $log. To see it again, input and all:" \
    "HALFSPACE_FUZZ_PRINT=1 $build/tests/fuzz/$name" \
    "$(sed -n 's/^.*Test unit written to //p' "$log" | tail -n 1)"
  return 1
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

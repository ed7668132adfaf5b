#!/usr/bin/env bash
# Runs every fuzzer: see usage below. On Debian; builds what is missing.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

usage='usage: tests/fuzz/run.sh [--keep] [SECONDS]

Runs all fuzzers at once for SECONDS (60 without it), each from its inputs in
tests/fuzz/corpus, if it has any. A file there has an input on each line, in hexadecimal
digits.
New inputs stay in build/asan/found, and an input that fails in build/asan/wrong.

  --keep  then writes to tests/fuzz/corpus the inputs that cover most, at most 60
          for each fuzzer. Lines with a comment stay: inputs that once failed'

keep=
if [ "${1-}" = --keep ]; then
  keep=yes
  shift
fi
seconds=${1:-60}
if ! [[ $seconds =~ ^[1-9][0-9]*$ ]]; then
  say "$usage"
  exit 2
fi

prepare_machine
install_packages clang libclang-rt-dev
build_preset asan fuzzers

build=$root/build/asan
corpus=$root/tests/fuzz/corpus
mkdir -p "$corpus" "$build/wrong" "$build/logs"

# hex FILE: its bytes as a line of a corpus.
hex() {
  od -An -v -tx1 "$1" | tr -d ' \n'
  echo
}

# unpack NAME FOLDER: writes the inputs of a corpus, a file for each.
unpack() {
  local line i=0
  rm -rf "$2"
  mkdir -p "$2"
  [ -e "$corpus/$1.txt" ] || return 0
  while read -r line; do
    i=$((i + 1))
    printf '%b' "$line" >"$2/$i"
  done < <(sed 's/ *#.*//; /^$/d; s/../\\x&/g' "$corpus/$1.txt")
}

# pack NAME FOLDER: makes a corpus of the first inputs in the folder, and of the
# lines of the old one that have a comment.
pack() {
  local file
  {
    grep -s '#' "$corpus/$1.txt" || true
    find "$2" -type f -printf '%T@ %p\n' | sort -n | sed 's/^[^ ]* //' | head -n 60 |
      while read -r file; do hex "$file"; done
  } | sort -u >"$build/corpus.$1"
  mv "$build/corpus.$1" "$corpus/$1.txt"
}

# fuzz NAME: a line on how it went, or why it failed.
fuzz() {
  local name=$1 log=$build/logs/$1.txt input
  local inputs=$build/corpus/$name found=$build/found/$name kept=$build/kept/$name
  mkdir -p "$found"
  unpack "$name" "$inputs"
  # Past the end of an input there are only zeros, so long ones say more.
  if "$build/tests/fuzz/$name" -max_total_time="$seconds" -max_len=200 \
    -len_control=0 -reduce_inputs=0 -entropic=0 -timeout=60 \
    -artifact_prefix="$build/wrong/$name-" "$found" "$inputs" >"$log" 2>&1; then
    say "    $name: $(tail -n 1 "$log")"
  else
    grep -vE '^(#[0-9]+\s|INFO:|\s+NEW_FUNC)' "$log" | tail -n 60 >&2
    input=$(sed -n 's/^.*Test unit written to //p' "$log" | tail -n 1)
    say "FAILED: $name. All it said is in $log. To see it again, input and all:" \
      "HALFSPACE_FUZZ_PRINT=1 $build/tests/fuzz/$name $input"
    if [ "$input" ]; then
      say "To keep the input, add this line, with what was wrong, to" \
        "$corpus/$name.txt: $(hex "$input") # ..."
    fi
    return 1
  fi
  if [ "$keep" ]; then
    rm -rf "$kept"
    mkdir -p "$kept"
    # Takes the inputs that cover most first.
    "$build/tests/fuzz/$name" -set_cover_merge=1 -max_len=200 "$kept" "$found" "$inputs" \
      >>"$log" 2>&1
    pack "$name" "$kept"
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

#!/usr/bin/env bash
# usage: tests/mutants/run.sh [check | NAME...]
#
# Breaks the library in one place at a time, all of the lists or those named, and
# runs its tests: each broken library, a mutant, must fail one. README.md has the
# details. `check` builds nothing: it says which mutants fit the sources no more.
#
# The sources are copied to build/mutants (or HALFSPACE_MUTANTS_BUILD), and only
# the copy is changed. Progress goes to stderr, the table of results to stdout.
# Exit code: 0 if all were killed, 1 if one survived or does not compile, 2 if
# the run was impossible: a mutant that fits the sources no more, or tests that
# fail without one.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$root/scripts/steps.sh"

here=$root/tests/mutants
lists=("$here"/*.mutants)
work=${HALFSPACE_MUTANTS_BUILD:-$root/build/mutants}
copy=$work/source
build=$work/build
log=$work/log
jobs=$(getconf _NPROCESSORS_ONLN)
scale=0.02

give_up() {
  say "mutants: $*"
  exit 2
}

# Makes the copy what the work tree is. Files that are the same keep their time,
# so that they are not built again.
copy_sources() {
  local file
  mkdir -p "$copy"
  (cd "$root" && find CMakeLists.txt README.md cmake dispatch include kernels \
    tests -type f -print0) | while IFS= read -r -d '' file; do
    cmp -s "$root/$file" "$copy/$file" && continue
    mkdir -p "$(dirname "$copy/$file")"
    cp "$root/$file" "$copy/$file"
  done
}

# A static library: tests call what a shared one does not export.
configure() {
  cmake -S "$copy" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=None \
    -DCMAKE_CXX_FLAGS=-O1 -DHALFSPACE_BUILD_TESTS=ON -DHALFSPACE_INSTALL=OFF \
    -DHALFSPACE_C=OFF
}

# compile: the library and its tests.
compile() {
  ninja -C "$build" -j "$jobs" tests/library/all >"$log" 2>&1
}

# run_tests SCALE CTEST-ARGUMENT...: true if none fails; the first that does is
# in $log.
run_tests() {
  local scale=$1
  shift
  rm -rf "$build/Testing"
  (cd "$build" && HALFSPACE_TEST_SCALE=$scale ctest -L library --parallel \
    "$jobs" --timeout 100 --stop-on-failure "$@") >"$log" 2>&1
}

# survives FIRST ALSO: runs everything, first what matches FIRST, and a hash,
# which only knows that something is wrong, last. What matches ALSO is run at
# full scale too.
survives() {
  local first=$1 also=$2
  # Headers state the stack of a library with -O3.
  local stack='[.]TakeTheStackThatHeadersState'
  run_tests "$scale" -R "$first" -E "HashTest|$stack" &&
    run_tests "$scale" -E "$first|HashTest|$stack" &&
    run_tests "$scale" -R HashTest && run_tests 1 -R "$also"
}

# The first failed test, without what gtest repeats in its name.
failed_test() {
  sed -n '/^The following tests FAILED:/,${
    s/^\t *[0-9]* - \(.*\) ([A-Za-z ]*)$/\1/
    t name
    b
    :name
    s/  # .*//
    s|<.*/\([^/]*\)\.$| \1|
    p
    q
  }' "$log"
}

# restore FILE...: the copy is as the work tree again.
restore() {
  local file
  for file in "$@"; do cp "$root/$file" "$copy/$file"; done
}

row() {
  printf '| %-34s | %-62s | %4s |\n' "$@"
}

need() {
  local tool
  for tool in "$@"; do
    command -v "$tool" >/dev/null || give_up "needs $tool, which is not here"
  done
}

need perl
perl "$here/mutants.pl" check "$root" "${lists[@]}" || exit 2
if [ "$*" = check ]; then exit 0; fi
need cmake ctest ninja
mkdir -p "$work"
declare -A first=() also=()
all=()
while read -r name first_tests also_tests machine; do
  if [ "$machine" = any ] || [ "$machine" = "$(uname -m)" ]; then
    all+=("$name")
  else
    say "==> $name is left out: it needs $machine"
  fi
  first[$name]=$first_tests
  also[$name]=$also_tests
done < <(perl "$here/mutants.pl" tests "${lists[@]}")
names=("$@")
if [ $# -eq 0 ]; then names=("${all[@]}"); fi
for name in "${names[@]}"; do
  [ -n "${also[$name]+known}" ] || give_up "there is no mutant $name"
done

say "==> copy the sources to $copy, and build them"
copy_sources
configure >"$log" 2>&1 || { cat "$log" >&2; give_up "cmake failed"; }
compile || { cat "$log" >&2; give_up "the sources do not compile"; }
say "==> run the tests without a mutant"
survives none "$(printf '%s\n' "${also[@]}" | sort -u | paste -sd'|')" ||
  { cat "$log" >&2; give_up "the tests fail without a mutant"; }

row mutant "killed by" s
row --- --- ---
count=0
killed=0
for name in "${names[@]}"; do
  say "==> $name ($((++count)) of ${#names[@]}, ${SECONDS} s)"
  start=$SECONDS
  mapfile -t files < <(perl "$here/mutants.pl" apply "$copy" "$name" "${lists[@]}")
  if ! compile; then
    cat "$log" >&2
    result="DOES NOT COMPILE"
  elif survives "${first[$name]}" "${also[$name]}"; then
    result=SURVIVED
  else
    result=$(failed_test)
    if [ -n "$result" ]; then
      killed=$((killed + 1))
    else
      cat "$log" >&2
      result="CTEST FAILED"
    fi
  fi
  restore "${files[@]}"
  row "$name" "$result" $((SECONDS - start))
done
say "==> ${#names[@]} mutants, $killed killed, in $SECONDS s"
[ "$killed" -eq "${#names[@]}" ]

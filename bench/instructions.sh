#!/usr/bin/env bash
# Instructions that flat kernels take for 64 objects and one query, read from
# their machine code, and the cycles that llvm-mca gives them if it is installed:
#
#   bench/instructions.sh [BUILD_DIRECTORY]       (build/release)
#
# Cycles are llvm-mca's block throughput, then what it simulates.
# Prints a table in Markdown. x86 only. Kernels are those for one query and a
# world in cache; those of SSE4 are for aligned planes.
set -euo pipefail
build=${1:-build/release}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

code=$(mktemp -d)
trap 'rm -rf "$code"' EXIT
for source in scan_float_3 scan_float_4; do
  object=$(find "$build" -name "$source.cc.o" | head -n 1)
  if [ -z "$object" ]; then
    echo "$0: no $source.cc.o in $build; build the library there first" >&2
    exit 2
  fi
  objdump --disassemble --demangle --no-show-raw-insn "$object" \
    >"$code/$source"
done

# simulate CPU LOOP TIMES: "block throughput / simulated" for 64 objects.
simulate() {
  if ! command -v llvm-mca >/dev/null; then
    echo "-"
    return
  fi
  llvm-mca -mcpu="$1" -iterations=200 "$2" 2>/dev/null | awk -v times="$3" '
    /^Total Cycles:/ { total = $3 / 200 }
    /^Block RThroughput:/ { block = $3 }
    END {
      if (total == 0) { print "-"; exit }
      printf "%.1f / %.1f\n", block * times, total * times
    }'
}

# row FILE FUNCTION TARGET SHAPE PLANES LANES CPU...
row() {
  local file=$1 function=$2 target=$3 shape=$4 planes=$5 lanes=$6
  shift 6
  local found
  found=$(awk -v function_name="$function" -v planes="$planes" \
    -v lanes="$lanes" -v loop="$code/loop.s" -f "$root/instructions.awk" \
    "$code/$file")
  local instructions=${found% *} times=${found#* } cycles=""
  local cpu
  for cpu in "$@"; do
    cycles+=" $(simulate "$cpu" "$code/loop.s" "$times") |"
  done
  echo "| $target | $shape | $instructions |$cycles"
}

# table TARGET LANES CPU...
table() {
  local target=$1 lanes=$2
  shift 2
  echo
  printf '| target | shape | instructions |'
  printf ' %s |' "$@"
  printf '\n|---|---|---|'
  printf -- '---|%.0s' "$@"
  echo
  local shape planes axes
  while read -r shape planes axes; do
    row "scan_float_$axes" \
      "N_$target::FlatMask<${axes}ul, $((planes - axes))ul, float>" \
      "$target" "$shape" "$planes" "$lanes" "$@"
  done <<<$'simplex 4 4\nAABB 6 3\nAABO 8 4'
}

table SSE4 4 znver3 icelake-server
table AVX2 8 znver3 icelake-server
table AVX3 8 skylake-avx512 icelake-server

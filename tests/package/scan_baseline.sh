#!/bin/sh
# usage: scan_baseline.sh OBJDUMP LIBRARY [everything]
#
# Fails if a function outside Highway's per-target namespaces (N_AVX2 and so on)
# has an instruction above the x86-64 baseline: the linker keeps one copy of an
# inline function, and it must run on every machine. With `everything` the
# per-target functions are not excused.
set -eu

"$1" -d -C --no-show-raw-insn "$2" |
  awk -v everything="${3:-}" -f "$(dirname "$0")/baseline.awk"

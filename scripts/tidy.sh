#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy has the checks) on the sources of the library and of
# cpuinfo-bench that contain no kernels:
#
#   scripts/tidy.sh BUILD_DIRECTORY [FILE...]
#
# The directory is one that clang was configured in: its warnings are found, too.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

build=$1
shift
if [ $# -gt 0 ]; then
  files=("$@")
else
  # What includes Highway is what the compiler was given its folder for, but
  # for a few files that say so in their text.
  mapfile -t files < <(git ls-files 'dispatch/*.cc' 'kernels/*.cc' 'bench/*.cc' |
    xargs grep -L 'hwy/foreach_target.h')
fi
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(getconf _NPROCESSORS_ONLN)" \
  clang-tidy --quiet -p "$build"

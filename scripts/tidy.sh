#!/usr/bin/env bash
# Runs clang-tidy, with the checks of .clang-tidy, on the sources of the library, of
# cpuinfo-bench and of the Python package that were configured for a build and
# contain no kernels:
#
#   scripts/tidy.sh BUILD_DIRECTORY [FILE...]
#
# clang's warnings are errors here, too, if it is the compiler of that build.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

build=$(realpath "$1")
shift
cd "$root"
files=("$@")
if [ "${#files[@]}" -eq 0 ]; then
  # Kernels are the same text, target after target.
  mapfile -t files < <(
    sed -n "s|^ *\"file\": \"$root/\(.*\)\",\{0,1\}\$|\1|p" \
      "$build/compile_commands.json" |
      grep -E '^(bench|c|dispatch|kernels|python)/' | sort -u |
      xargs grep -L 'hwy/foreach_target.h')
fi
# Without the precompiled headers, which only a build makes.
mkdir -p "$build/tidy"
sed 's/ -Winvalid-pch -Xclang -include-pch -Xclang [^ ]* -Xclang -include -Xclang [^ ]*//' \
  "$build/compile_commands.json" >"$build/tidy/compile_commands.json"
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(getconf _NPROCESSORS_ONLN)" clang-tidy --quiet -p "$build/tidy"

#!/bin/sh
# Functions of ours that take Highway's vectors are called without a namespace,
# and C++ then looks into Highway's, too: a name of both may call either, or
# not compile. Lists such names, and fails if there are any.
#
#   highway_names.sh <folder with Highway's folder hwy> <our sources>
set -eu
highway=$1
sources=$2

# Identifiers before one of the given characters, without a namespace or an
# object before them; a single letter is a template parameter.
called() {
  sed 's,//.*,,' | grep -oE "(^|[^A-Za-z0-9_:.>])[A-Z][A-Za-z0-9]+[$1]" |
    tr -cd 'A-Za-z0-9\n' | sort -u
}

ours=$(mktemp)
theirs=$(mktemp)
trap 'rm -f "$ours" "$theirs"' EXIT
for folder in kernels dispatch bench; do
  grep -rlw HWY_NAMESPACE "$sources/$folder"
done | xargs cat | called '(<' >"$ours"
cat "$highway"/hwy/ops/*.h | called '(' >"$theirs"

# That the lists are what they should be.
if ! grep -qx TwoSum "$ours" || ! grep -qx IfThenElse "$theirs"; then
  echo "no functions found in $sources or in $highway" >&2
  exit 1
fi
both=$(comm -12 "$ours" "$theirs")
if [ -n "$both" ]; then
  echo "functions with names of Highway's, in $highway: give them others:" >&2
  echo "$both" >&2
  exit 1
fi

#!/usr/bin/env bash
# Checks that each folder includes only what is below it: kernels are compiled
# once for each target and know nothing of dispatch, and all others are callers.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# A folder, and what its files may include by a path in quotes.
rules='
include    halfspace/|hwy/
kernels    halfspace/|hwy/|kernels/
dispatch   halfspace/|hwy/|kernels/|dispatch/
dispatch/errors  halfspace/|kernels/|dispatch/errors/|dispatch/default_fp_mode\.h
c          halfspace/|c/
python     halfspace/|[a-z_]+\.h
examples   halfspace/|hwy/|(engines/)?[a-z_]+\.h
bench      halfspace/|hwy/|bench/|tests/reference/'
# bench/inner has inner loops of its own, and the tool lists what was compiled.
exceptions='^bench/inner/'

failed=
while read -r folder allowed; do
  [ -n "$folder" ] || continue
  wrong=$(git grep -E '^#include "' -- "$folder/*.h" "$folder/*.c" "$folder/*.cc" "$folder/*.in" |
    grep -vE ":#include \"(@|$allowed)" | grep -vE "$exceptions" || true)
  if [ -n "$wrong" ]; then
    printf '%s may not include these:\n%s\n' "$folder" "$wrong" >&2
    failed=yes
  fi
done <<<"$rules"
[ -z "$failed" ]

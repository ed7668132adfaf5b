#!/bin/sh
# check_size.sh SIZE MOST FILE... [without OBJECT...]: fails if the files, a program,
# an archive or objects, have more than MOST bytes of code, by the program SIZE. The
# code of the objects after `without` does not count.
set -eu
size=$1
most=$2
shift 2
code=0
sign=1
for file in "$@"; do
  if [ "$file" = without ]; then
    sign=-1
    continue
  fi
  if [ ! -f "$file" ]; then
    echo "$file was not built"
    exit 1
  fi
  code=$((code + sign * $("$size" --totals "$file" | awk 'END { print $1 }')))
done
echo "$code bytes of code in $1, of $most at most"
[ "$code" -le "$most" ]

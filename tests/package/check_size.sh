#!/bin/sh
# check_size.sh SIZE FILE MOST: fails if FILE, a program or an archive, has more
# than MOST bytes of code, by the program SIZE.
set -eu
code=$("$1" --totals "$2" | awk 'END { print $1 }')
echo "$code bytes of code in $2, of $3 at most"
[ "$code" -le "$3" ]

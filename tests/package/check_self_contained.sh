#!/bin/sh
# usage: check_self_contained.sh NM LIBRARY [everything]
#
# Fails if the static library needs anything of Highway's. With `everything` a
# symbol of the library's own that one of its objects needs is taken for such.
set -eu

namespace=hwy
if [ "${3:-}" = everything ]; then namespace=halfspace; fi
"$1" --undefined-only --demangle "$2" |
  awk -v namespace="$namespace" -v library="$2" '
    NF { ++symbols }
    index($0, namespace "::") { print "needed by " library ": " $0; ++bad }
    END {
      if (!symbols) print library ": needs nothing at all: this is not it"
      exit bad || !symbols
    }'

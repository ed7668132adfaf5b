#!/bin/sh
# uses_every_function.sh HEADER FILE...: fails if the header declares a function
# that no file names.
set -eu
header=$1
shift
functions=$(sed -n 's/^HALFSPACE_API .*[ *]\(hs_[a-z0-9_]*\)(.*/\1/p' "$header")
[ -n "$functions" ] || { echo "no functions in $header"; exit 1; }
functions="$functions
$(sed -n 's/^static inline .*[ *]\(hs_[a-z0-9_]*\)(.*/\1/p' "$header")"
named=" $(cat "$@" | grep -ow 'hs_[a-z0-9_]*' | sort -u | tr '\n' ' ')"
bad=0
for function in $functions; do
  case $named in
    *" $function "*) ;;
    *)
      echo "not called by a test: $function"
      bad=1
      ;;
  esac
done
exit $bad

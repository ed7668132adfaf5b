#!/bin/sh
# usage: check_exports.sh NM LIBRARY [everything]
#
# Fails if the shared library exports anything but its interface. With
# `everything` all its symbols are taken for exported.
set -eu

symbols=--dynamic
if [ "${3:-}" = everything ]; then symbols=--debug-syms; fi
"$1" "$symbols" --defined-only --demangle "$2" |
  awk -v library="$2" '
    {
      name = $0
      sub(/^[0-9a-f]+ . /, "", name)
      sub(/^void /, "", name)
      if (name ~ /^hs_[a-z0-9_]+$/) next  # in C
      if (name !~ /^halfspace::/ ||
          name ~ /^halfspace::(dispatch|kernels|N_[A-Z0-9_]+)::/) {
        print "exported, but no part of the interface: " name
        ++bad
      }
      # Callers in C++17 could not name it.
      if (name ~ /std::(__1::)?span</) {
        print "exported with a type of C++20: " name
        ++bad
      }
      if (name ~ /^halfspace::SupportedTargets\(\)/) interface = 1
    }
    END {
      if (!interface) print library ": does not export the interface"
      exit bad || !interface
    }'

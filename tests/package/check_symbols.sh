#!/bin/sh
# usage: check_symbols.sh NM CXXFILT READELF LIBRARY LIST refuse_more|accept_more
#                         with_c|without_c
#
# Fails unless the shared library has the SONAME and exports the symbols in LIST, no others
# that are not of its interface, and with refuse_more no others at all. A library without
# the C API has no symbols hs_* but those of c/kernels.h.
# Writes the list of the library to symbols.txt if it differs.
set -eu

nm=$1 cxxfilt=$2 readelf=$3 library=$4 list=$5 more=$6 c=$7
export LC_ALL=C

in=$(mktemp -d)
trap 'rm -rf "$in"' EXIT

"$nm" --dynamic --defined-only "$library" >"$in/symbols"
"$readelf" -d "$library" >"$in/dynamic"
sed 's/^[0-9a-f]* . //' "$in/symbols" | "$cxxfilt" | sort -u >"$in/exported"
{
  sed -n 's/.*(SONAME).*\[\(.*\)\].*/SONAME \1/p' "$in/dynamic"
  cat "$in/exported"
} | sort >"$in/all"

sort -u "$list" >"$in/listed_in_both"
case $c in
  with_c) cp "$in/listed_in_both" "$in/listed" ;;
  without_c) grep -Ev '^hs_' "$in/listed_in_both" >"$in/listed"
    # Kernels are always there (c/kernels.h).
    grep -E '^hs_[a-z]+[234]_masks?(_of_doubles)?$' "$in/listed_in_both" >>"$in/listed"
    sort -o "$in/listed" "$in/listed" ;;
esac
comm -23 "$in/listed" "$in/all" >"$in/gone"
comm -13 "$in/listed" "$in/all" >"$in/new"
if [ "$more" = accept_more ]; then : >"$in/new"; fi
sed 's/^/listed, but not exported: /' "$in/gone"
sed 's/^/exported, but not listed: /' "$in/new"

# Callers in C++17 could not name types of C++20.
if grep -Ev '^(hs_[a-z0-9_]+$|(void )?halfspace::)' "$in/exported" ||
  grep -E '^(void )?halfspace::(dispatch|kernels|N_[A-Z0-9_]+)::|std::(__1::)?span<' \
    "$in/exported"; then
  echo "exported, but no part of the interface"
  exit 1
fi

if [ -s "$in/gone" ] || [ -s "$in/new" ]; then
  cp "$in/all" symbols.txt
  cat <<END

The shared library exports other symbols than $list has.
If the change is not intended, undo it. Otherwise:
- If a symbol of the last release is gone, or means something else now, raise
  HALFSPACE_SOVERSION in CMakeLists.txt. Programs that were linked with that
  release do not run with this library.
- Store the list that gcc for x86-64 makes with HALFSPACE_C=ON:
  cp $PWD/symbols.txt $list
END
  exit 1
fi

#!/bin/sh
# usage: check_symbols.sh NM CXXFILT READELF LIBRARY LIST refuse_more|accept_more
#                         [C_HEADER]
#
# Fails unless the shared library has the SONAME and exports the symbols in LIST,
# and with refuse_more no others. Symbols hs_* are not in LIST: they must be the
# functions that C_HEADER declares. Writes the list of the library to symbols.txt
# if it differs.
set -eu

nm=$1 cxxfilt=$2 readelf=$3 library=$4 list=$5 more=$6 c_header=${7:-}
export LC_ALL=C

in=$(mktemp -d)
trap 'rm -rf "$in"' EXIT

"$nm" --dynamic --defined-only "$library" >"$in/symbols"
"$readelf" -d "$library" >"$in/dynamic"
sed 's/^[0-9a-f]* . //' "$in/symbols" | "$cxxfilt" | sort -u >"$in/exported"
grep '^hs_' "$in/exported" >"$in/exported_in_c" || :
{
  sed -n 's/.*(SONAME).*\[\(.*\)\].*/SONAME \1/p' "$in/dynamic"
  grep -v '^hs_' "$in/exported"
} | sort >"$in/exported_in_cxx"

sort -u "$list" >"$in/listed"
comm -23 "$in/listed" "$in/exported_in_cxx" >"$in/gone"
comm -13 "$in/listed" "$in/exported_in_cxx" >"$in/new"
if [ "$more" = accept_more ]; then : >"$in/new"; fi
sed 's/^/listed, but not exported: /' "$in/gone"
sed 's/^/exported, but not listed: /' "$in/new"

# As in "HALFSPACE_API const char* hs_version(void);", on one line or several.
: >"$in/declared"
if [ "$c_header" ]; then
  sed 's,//.*,,' "$c_header" | tr '\n' ' ' |
    grep -o 'HALFSPACE_API [^;(]*(' | sed 's/ *($//; s/.*[ *]//' |
    sort -u >"$in/declared"
fi
comm -23 "$in/declared" "$in/exported_in_c" >"$in/gone_in_c"
comm -13 "$in/declared" "$in/exported_in_c" >"$in/new_in_c"
sed 's/^/declared in C, but not exported: /' "$in/gone_in_c"
sed 's/^/exported to C, but not declared: /' "$in/new_in_c"

if [ -s "$in/gone" ] || [ -s "$in/new" ]; then
  cp "$in/exported_in_cxx" symbols.txt
  cat <<END

The shared library exports other symbols than $list has.
If the change is not intended, undo it. Otherwise:
- If a symbol of the last release is gone, or means something else now, raise
  HALFSPACE_SOVERSION in CMakeLists.txt. Programs that were linked with that
  release do not run with this library.
- Store the list that gcc for x86-64 makes:
  cp $PWD/symbols.txt $list
END
  exit 1
fi
if [ -s "$in/gone_in_c" ] || [ -s "$in/new_in_c" ]; then
  echo "The library and $c_header have different functions."
  exit 1
fi

#!/bin/sh
# usage: run_tarball.sh TARBALL READELF [misplaced_libraries] -- [EMULATOR...]
#
# Unpacks TARBALL into an empty folder, and runs its cpuinfo-bench there, with
# every library but glibc from the tarball.
set -eu

tarball=$1
readelf=$2
shift 2
misplace=
if [ "$1" = misplaced_libraries ]; then
  misplace=yes
  shift
fi
shift # the "--"; what is left is the emulator

empty=$(mktemp -d)
trap 'rm -rf "$empty"' EXIT
cd "$empty"
tar -xzf "$tarball" --strip-components=1

# Every library that anything in it needs is in it ...
for file in bin/cpuinfo-bench lib/halfspace/*; do
  "$readelf" -d "$file"
done | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | sort -u |
  grep -Ev '^(ld-linux|lib(c|m|dl|rt|pthread)\.so)' >needed
while read -r library; do
  if [ ! -e "lib/halfspace/$library" ]; then
    echo "$library is not in the tarball"
    exit 1
  fi
done <needed

# ... and the loader takes it from there, by its own account.
if [ "$misplace" ]; then mv lib/halfspace lib/misplaced; fi
unset LD_LIBRARY_PATH
if [ $# -gt 0 ]; then
  "$@" -E LD_TRACE_LOADED_OBJECTS=1 "$PWD/bin/cpuinfo-bench"
else
  LD_TRACE_LOADED_OBJECTS=1 bin/cpuinfo-bench
fi >loaded
while read -r library; do
  if ! grep -F "$library => $PWD/" loaded; then
    echo "$library is not loaded from the tarball:"
    cat loaded
    exit 1
  fi
done <needed

# With the licence of each library that is in it, of this one, and the texts that
# they refer to.
doc=share/doc/halfspace
licences=$doc/licences
for file in bin/cpuinfo-bench-report "$doc/LICENSE" "$licences/libbenchmark-dev" "$licences/libcli11-dev" \
  "$licences/nlohmann-json3-dev" \
  "$licences/libstdc++6"* "$licences/libgcc-s1"*; do
  if [ ! -s "$file" ]; then
    echo "$file is not in the tarball"
    exit 1
  fi
done
if [ ! -s "$licences/libhwy-dev" ] && [ ! -s "$licences/highway" ]; then
  echo "the licence of Highway is not in the tarball"
  exit 1
fi
grep -rhoE '/usr/share/common-licenses/[-A-Za-z0-9.]+' "$licences" |
  sed 's,.*/,,; s/[.]$//' | sort -u >referred
while read -r licence; do
  if [ ! -s "$licences/common-licenses/$licence" ]; then
    echo "the licence $licence is not in the tarball"
    exit 1
  fi
done <referred

if [ ! -s share/man/man1/cpuinfo-bench.1 ]; then
  echo "the manual page is not in the tarball"
  exit 1
fi

"$@" bin/cpuinfo-bench --details quality --objects 4096 --queries 2

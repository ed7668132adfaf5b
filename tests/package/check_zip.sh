#!/bin/sh
# usage: check_zip.sh CPACK CONFIG EMULATOR...
#
# Makes the zip for Windows, unpacks it into an empty folder, and runs its cpuinfo-bench
# there.
set -eu
cpack=$1
config=$2
shift 2
empty=$(mktemp -d)
trap 'rm -rf "$empty"' EXIT
cd "$empty"
"$cpack" --config "$config" -B "$empty" -D CPACK_PACKAGE_FILE_NAME=halfspace
cmake -E tar xf halfspace.zip
cd halfspace
doc=share/doc/halfspace
for file in bin/libhalfspace.dll lib/libhalfspace.dll.a include/halfspace/halfspace.h \
  include/halfspace/c/halfspace.h bin/cpuinfo-bench-report "$doc/LICENSE" \
  "$doc/licences/libbenchmark-dev" "$doc/licences/libcli11-dev" \
  "$doc/licences/nlohmann-json3-dev" "$doc/licences/libhwy-dev" \
  "$doc/licences/g++-mingw-w64-x86-64-posix" "$doc/licences/mingw-w64-x86-64-dev"; do
  if [ ! -s "$file" ]; then
    echo "$file is not in the zip"
    exit 1
  fi
done
# Not the whole page: the section `threads` alone takes 4 GiB and most of the time.
"$@" bin/cpuinfo-bench.exe --details machine,verdict,answers --quick --objects 4096 \
  --queries 4 --repetitions 1

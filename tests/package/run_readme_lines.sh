#!/usr/bin/env bash
# run_readme_lines.sh LANGUAGE SOURCES FOLDER EXPECTED [CMAKE OPTION...]: runs the lines
# of readme_lines.sh in FOLDER, except the line of apt. The last one must print EXPECTED.
# For Python, the sources are those of a source distribution (MANIFEST.in), and a wheel is
# installed after the lines.
# For C++, the library is built as a part of another project (subproject), with these CMAKE
# OPTIONs. `cmake --install` writes to FOLDER/root. If EXPECTED is empty, runs only the
# lines of cmake.
set -euo pipefail
language=$1
sources=$2
folder=$3
expected=$4
shift 4

mkdir -p "$folder"
cd "$folder"
lines=$(bash "$sources/tests/package/readme_lines.sh" "$language" "$sources" | tail -n +2)
rm -rf root venv a.out halfspace sdist wheels
if [ "$language" = python ]; then
  python3 -m build --no-isolation --sdist --outdir "$folder/sdist" "$sources" >sdist.log
  mkdir halfspace
  tar -xzf sdist/*.tar.gz -C halfspace --strip-components=1
else
  mkdir halfspace
  cp "$sources/tests/package/subproject/CMakeLists.txt" halfspace
  ln -s "$sources/examples" halfspace
  cmake -S halfspace -B build "$@" "-DHALFSPACE_SOURCES=$sources" -DHALFSPACE_INSTALL=ON
fi
export DESTDIR="$folder/root"
local=$DESTDIR/usr/local
export PKG_CONFIG_PATH="$local/lib/pkgconfig:$local/lib64/pkgconfig"
export LD_LIBRARY_PATH="$local/lib:$local/lib64"
if [ -z "$expected" ]; then lines=$(grep '^cmake ' <<<"$lines"); fi
printf '%s\n' "$lines" >lines
bash -euxo pipefail lines | tee output
if [ "$expected" ] && [ "$(tail -n 1 output)" != "$expected" ]; then
  echo "The last line is not: $expected"
  exit 1
fi
if [ "$language" != python ]; then exit; fi

# A wheel of the build that the lines have left needs neither its sources nor a compiler.
# numpy is the system's.
HALFSPACE_HOMEPAGE=https://halfspace.invalid \
  python3 -m build --no-isolation --wheel --outdir wheels ./halfspace
rm -rf elsewhere
mkdir elsewhere
mv halfspace elsewhere/sources
python3 -m venv --system-site-packages elsewhere/venv
CXX=false CC=false elsewhere/venv/bin/pip install --no-index --find-links wheels halfspace
mv wheels elsewhere/wheels
elsewhere/venv/bin/python "$sources/tests/package/use_wheel.py"

#!/usr/bin/env bash
# Makes the Debian packages, and tries them: see usage below.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

usage='usage: scripts/debs.sh

Makes the Debian packages in build/debian/packages, and checks them with lintian. Then
installs each in an empty Debian of the same release, in a temporary folder, and runs
what it contains there. Runs the lines at the top of the README in another one. Needs
root, and installs what is missing on this machine.'

if [ $# -gt 0 ]; then
  case $1 in
    -h | --help)
      printf '%s\n' "$usage"
      exit 0
      ;;
  esac
  say "scripts/debs.sh: \"$1\" is no argument of it, as there are none."
  exit 2
fi
if [ "$(id -u)" -ne 0 ]; then
  say "This needs root, to change into the empty Debian. Run: sudo scripts/debs.sh"
  exit 1
fi

empty=$(mktemp -d)
# Nothing is mounted in it: --one-file-system is for a mount that somebody else made.
trap 'rm -rf --one-file-system "$empty"' EXIT

prepare_machine dpkg-dev file gzip lintian mmdebstrap \
  pybind11-dev python3-dev python3-numpy
debs=$root/build/debian/packages
rm -rf "$debs"
build_preset debian
step "cpack" cpack --config "$root/build/debian/CPackConfig.cmake" -B "$debs"
# The version was never uploaded to Debian, so it closes no bug there. cpack writes
# scripts that call ldconfig, which the trigger does as well.
step "lintian" lintian --allow-root --fail-on error,warning \
  --suppress-tags initial-upload-closes-no-bugs,maintscript-calls-ldconfig \
  "$debs"/*.deb

step "an empty Debian" mmdebstrap --quiet --variant=apt --mode=root \
  --skip=cleanup/apt/lists --dpkgopt=force-unsafe-io \
  "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$empty/debian"
mkdir "$empty/debian/try"
cp -a "$empty/debian" "$empty/readme"
cp -r "$debs"/*.deb "$root/tests/package/consumer" "$root/examples/quick_start.cc" \
  "$empty/debian/try"

# try NAME [FOLDER]: runs the commands of stdin in the empty Debian. There `install` installs
# packages, or files of packages, with what they depend on.
try() {
  {
    printf '%s\n' 'cd /try' 'install() {' \
      '  apt-get -q -y --no-install-recommends install "$@" >install.log 2>&1 && return' \
      '  cat install.log; return 1' '}'
    cat
  } >"$empty/${2-debian}/try/commands"
  step "$1" chroot "$empty/${2-debian}" /usr/bin/env -i \
    PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    /bin/bash -euo pipefail /try/commands
}

mkdir "$empty/readme/try/halfspace"
tar -C "$root" --exclude=./build --exclude=./.git -c . |
  tar -C "$empty/readme/try/halfspace" -x
for language in c++ python; do
  try "README.md, $language" readme <<<"$(
    bash "$root/tests/package/readme_lines.sh" "$language" "$root")"
done

try "halfspace-tools" <<'END'
install ./halfspace-tools_*.deb
cpuinfo-bench --version
cpuinfo-bench --help | grep -e --mesh
cpuinfo-bench --quick --objects 4096 --queries 4 --repetitions 1 --format json --out run.json
cpuinfo-bench-report run.json >run.html
grep '</html>' run.html | tail -c 100
for page in cpuinfo-bench cpuinfo-bench-report; do
  gzip -t "/usr/share/man/man1/$page.1.gz"
done
END

try "python3-halfspace" <<'END'
install ./python3-halfspace_*.deb
python3 -c '
import halfspace
import numpy
tree = halfspace.BVH(numpy.array([[0, 0, 0, 1, 1, 1], [2, 2, 2, 3, 3, 3]], "float32"))
assert list(tree.query([0.5, 0.5, 0.5, 0.6, 0.6, 0.6])) == [0]'
END

try "libhalfspace0 and libhalfspace-dev" <<'END'
install ./libhalfspace0_*.deb ./libhalfspace-dev_*.deb
ldconfig -p | grep libhalfspace.so.0
install cmake g++ make pkg-config

cmake -S consumer -B by-cmake
cmake --build by-cmake --target usual_flags static
by-cmake/usual_flags
by-cmake/static
ldd by-cmake/usual_flags | grep libhalfspace.so.0
if ldd by-cmake/static | grep libhalfspace; then
  echo "the static library was not linked"
  exit 1
fi

g++ -std=c++17 quick_start.cc -o shared $(pkg-config --cflags --libs halfspace)
./shared
g++ -std=c++17 quick_start.cc -o static -static \
  $(pkg-config --static --cflags --libs halfspace)
./static

gcc -std=c11 consumer/in_c.c -o in_c $(pkg-config --cflags --libs halfspace)
./in_c
gcc -std=c11 consumer/in_c.c -o in_c -static \
  $(pkg-config --static --cflags --libs halfspace)
./in_c
END

try "purge" <<'END'
apt-get -q -y purge '?narrow(?installed, ?name(halfspace))'
left=$(find /usr /etc /var/lib/dpkg/info -name '*halfspace*')
if [ "$left" ]; then
  echo "these are left: $left"
  exit 1
fi
END

say "The packages are in $debs"

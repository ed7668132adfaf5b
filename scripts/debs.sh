#!/usr/bin/env bash
# Makes the Debian packages, and tries them: see usage below.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

usage='usage: scripts/debs.sh [--source [ARCHITECTURE...]]

Makes the Debian packages in build/debian/packages, and checks them with lintian. Then
installs each in an empty Debian of the same release, in a temporary folder, and runs
what it contains there. Runs the lines at the top of the README in another one. Needs
root, and installs what is missing on this machine.

  --source  makes a source package of the commit instead, in build/debian/source. Builds it
            twice in an empty Debian, compares the files, and checks them with lintian. Then
            cross-builds it for each ARCHITECTURE of Debian, as in armhf s390x'

case ${1-} in
  "" | --source) ;;
  -h | --help)
    printf '%s\n' "$usage"
    exit 0
    ;;
  *)
    say "scripts/debs.sh: \"$1\" is no argument of it. $usage"
    exit 2
    ;;
esac
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
# The version was never uploaded to Debian, so it closes no bug there. cpack writes
# scripts that call ldconfig, which the trigger does as well.
check() {
  step "lintian" lintian --allow-root --fail-on error,warning \
    --suppress-tags initial-upload-closes-no-bugs,maintscript-calls-ldconfig "$@"
}
if [ $# -eq 0 ]; then
  rm -rf "$debs"
  build_preset debian
  step "cpack" cpack --config "$root/build/debian/CPackConfig.cmake" -B "$debs"
  check "$debs"/*.deb
fi

release=$(. /etc/os-release && echo "$VERSION_CODENAME")
# Without security updates, which fewer architectures have: a library that is installed for
# two of them has the same version for both.
mirror=()
if [ $# -gt 0 ]; then
  mapfile -t mirror < <(apt-get indextargets --format '$(SITE)' "Codename: $release" | sort -u)
fi
step "an empty Debian" mmdebstrap --quiet --variant=apt --mode=root \
  --skip=cleanup/apt/lists --dpkgopt=force-unsafe-io \
  "$release" "$empty/debian" "${mirror[@]}"
mkdir "$empty/debian/try"

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

if [ $# -gt 0 ]; then
  shift
  native=$(dpkg --print-architecture)
  debs=$root/build/debian/source
  rm -rf "$debs"
  mkdir -p "$debs"
  # The changelog has the time of the commit.
  step "configure debian" env SOURCE_DATE_EPOCH="$(git -C "$root" log -1 --format=%ct)" \
    cmake -S "$root" --preset debian
  written=$root/build/debian/debian/source/debian
  version=$(dpkg-parsechangelog -l "$written/changelog" -S Version)
  archive=$debs/halfspace_${version%-*}.orig.tar.gz
  "$root/packaging/source_archive.py" "$archive"

  # build FOLDER ARCHITECTURE: each folder has another path, which no package may contain.
  # Debian 12 has no packages for riscv64: -d builds the library alone, with the C library
  # of the cross compiler.
  build() {
    local sources=$empty/debian/try/$1/$1 cross=
    mkdir -p "$sources"
    cp "$archive" "$sources/.."
    tar -xzf "$archive" -C "$sources" --strip-components=1
    cp -r "$written" "$sources/debian"
    if [ "$2" != "$native" ]; then cross="-a$2 -Pcross,nocheck"; fi
    try "build $1" <<END
dpkg --add-architecture $2
apt-get -q update
install build-essential
cross='$cross'
if apt-get -q -y --no-install-recommends build-dep \$cross ./$1/$1; then
  [ -z "\$cross" ] || install crossbuild-essential-$2
else
  cross="-d -a$2 -Pstage1,cross,nocheck"
  install cmake debhelper ninja-build g++-$2-linux-gnu
fi
[ -z "\$cross" ] || export DEB_BUILD_OPTIONS=nocheck
cd $1/$1
dpkg-buildpackage -us -uc \${cross:+-b \$cross}
END
  }
  build one "$native"
  build another "$native"
  for file in "$empty/debian/try/one"/*.{deb,dsc,tar.*}; do
    step "compare ${file##*/}" cmp "$file" "$empty/debian/try/another/${file##*/}"
  done
  cp "$empty/debian/try/one"/halfspace*.* "$empty/debian/try/one"/*.deb "$debs"
  for architecture in "$@"; do
    build "$architecture" "$architecture"
    cp "$empty/debian/try/$architecture"/*.{buildinfo,changes,deb} "$debs"
  done
  check "$debs"/*.changes
  say "The source package and its packages are in $debs"
  exit
fi

cp -a "$empty/debian" "$empty/readme"
cp -r "$debs"/*.deb "$root/tests/package/consumer" "$root/examples/quick_start.cc" \
  "$empty/debian/try"
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

# shellcheck shell=bash
# What a build needs, and how to get it. After steps.sh.

# make is for whoever then calls cmake without a preset or -G.
build_packages=(
  binutils cmake g++ make ninja-build pkg-config
  libbenchmark-dev libcli11-dev libgmp-dev libgtest-dev libhwy-dev
  nlohmann-json3-dev)

# What cpuinfo-bench compares the library with, where it is installed.
# shellcheck disable=SC2034  # for those who source this
competitor_packages=(
  libboost-dev libbox2d-dev libbullet-dev libembree-dev libfcl-dev)

# The libraries that examples have adapters for.
# shellcheck disable=SC2034
example_packages=(libbullet-dev libfcl-dev)

# What checks its report.
# shellcheck disable=SC2034
page_test_packages=(python3 python3-jsonschema)

# What builds for Windows, by the preset windows, and runs programs for it.
# shellcheck disable=SC2034
windows_packages=(g++-mingw-w64-x86-64-posix googletest wine64)

# What builds the Python module and tests it, with what the tutorial uses.
# shellcheck disable=SC2034
python_packages=(
  mypy python3-build python3-dev python3-distributed python3-geopandas
  python3-matplotlib python3-numpy python3-pandas python3-pip python3-pybind11
  python3-pytest python3-rtree python3-setuptools python3-shapely python3-venv
  python3-wheel)

# become_root COMMAND: sets `as_root`, to be written before a command that needs root.
# Asks for the password here, as a step would hide the prompt. Ends the script, naming the
# commands to run, if that fails.
become_root() {
  local reason="there is no sudo" before="As root, run"
  as_root=()
  if [ "$(id -u)" -eq 0 ]; then return; fi
  if command -v sudo >/dev/null; then
    as_root=(sudo -n)
    # Not `sudo -v`: that asks for a password also where `sudo true` needs none. Without a
    # terminal it fails rather than asks.
    if "${as_root[@]}" true 2>/dev/null || { [ -t 0 ] && sudo true; }; then return; fi
    reason="sudo failed" before="Run"
    set -- "sudo ${1//"&& "/"&& sudo "}"
  fi
  say "This needs root, and $reason. $before: $1"
  exit 1
}

# True if NAME or NAME:ARCHITECTURE is installed; by itself a name means this
# machine's architecture.
is_installed() {
  local architecture=${1#*:}
  if [ "$architecture" = "$1" ]; then
    architecture=$(dpkg --print-architecture)
  fi
  dpkg-query --show --showformat '${Architecture} ${db:Status-Status}\n' \
    "${1%:*}" 2>/dev/null | grep -xE "($architecture|all) installed" >/dev/null
}

# install_packages PACKAGE...: installs what is missing, and asks nothing.
install_packages() {
  local package missing=()
  for package in "$@"; do
    is_installed "$package" || missing+=("$package")
  done
  if [ "${#missing[@]}" -eq 0 ]; then return; fi

  say "These packages are missing: ${missing[*]}"
  become_root "apt-get update && apt-get install ${missing[*]}"
  # Once for all parts of CI, and again when there is an architecture more.
  local architectures
  architectures=$(dpkg --print-architecture; dpkg --print-foreign-architectures)
  if [ "${apt_lists_of-}" != "$architectures" ]; then
    step "apt-get update" "${as_root[@]}" apt-get -q update
    export apt_lists_of=$architectures
  fi
  step "apt-get install" "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -y --no-install-recommends install "${missing[@]}"
}

# True if the C++ compiler finds the header.
has_header() {
  printf '#if !__has_include(<%s>)\n#error\n#endif\n' "$1" |
    "${CXX:-c++}" -std=c++20 -x c++ -E - >/dev/null 2>&1
}

# True if `cmake` is new enough for the presets.
has_cmake() {
  local version
  version=$(cmake --version 2>/dev/null | sed -n 's/^cmake version //p')
  [ -n "$version" ] &&
    [ "$(printf '3.25\n%s\n' "$version" | sort -V | head -n 1)" = 3.25 ]
}

# Ends the script unless everything a build needs is here, however it came.
require_tools() {
  local tool missing=()
  has_cmake || missing+=("CMake 3.25 or later")
  command -v ninja >/dev/null || missing+=("Ninja")
  if ! has_header span; then
    missing+=("a C++20 compiler (g++ 12 or clang 14, or later; or set CXX)")
  else
    has_header gtest/gtest.h || missing+=("GoogleTest")
    has_header benchmark/benchmark.h || missing+=("Google Benchmark")
    has_header CLI/CLI.hpp || missing+=("CLI11")
    has_header nlohmann/json.hpp || missing+=("nlohmann-json")
    has_header gmpxx.h || missing+=("GMP, with its C++ interface")
  fi
  if [ "${#missing[@]}" -eq 0 ]; then return; fi
  say "The build needs these, and they are not here:"
  for tool in "${missing[@]}"; do say "  - $tool"; done
  say "Install them, then run this again. Highway 1.0.3 or later is used if" \
    "it is installed, and downloaded otherwise."
  exit 1
}

# prepare_machine [PACKAGE...]: makes the machine ready for a build, by apt-get
# where there is one, which installs these packages too.
prepare_machine() {
  if command -v apt-get >/dev/null; then
    install_packages "${build_packages[@]}" "$@"
  fi
  require_tools
}

#!/usr/bin/env bash
# scripts.sh SOURCES: what the scripts say to somebody who is not root, where there is no
# sudo and a package is missing, and that they refuse a wrong argument before they install.
set -euo pipefail
sources=$1

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# The programs that the scripts call before they install, and apt-get.
for program in bash cat dirname grep printf; do
  ln -s "$(command -v "$program")" "$folder/$program"
done
program() {
  printf '#!/bin/sh\n%s\n' "$2" >"$folder/$1"
  chmod +x "$folder/$1"
}
program id 'echo 1000'
program dpkg 'echo amd64'
program dpkg-query 'exit 1'
program apt-get 'echo apt-get was called; exit 1'

# check NAME PATTERN COMMAND...: the command fails, installs nothing, and says PATTERN.
check() {
  local name=$1 pattern=$2 output
  shift 2
  if output=$(PATH=$folder "$@" 2>&1 </dev/null) ||
    ! grep -q -e "$pattern" <<<"$output" ||
    grep -q -e "will be installed" -e "apt-get was called" <<<"$output"; then
    echo "$name says:"
    echo "$output"
    exit 1
  fi
}

for script in bench.sh test.sh; do
  check "$script, not as root" "As root, run: apt-get install .*libhwy-dev" \
    "$sources/$script"
done
for argument in --bogus --output-on-failures --repeater=2 -Z; do
  check "test.sh $argument" "\"$argument\" is no option" "$sources/test.sh" "$argument"
done
check "test.sh with options of ctest" "As root, run:" \
  "$sources/test.sh" --output-on-failure -R Range --repeat until-fail:2 -j2 --timeout=9

#!/usr/bin/env bash
# scripts.sh SOURCES: what the scripts say to somebody who is not root, with and without
# sudo, where a package is missing; that they refuse a wrong argument, and sources that they
# cannot write to, before they install; and what a terminal shows meanwhile.
set -euo pipefail
sources=$1

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# The programs that the scripts call before they install, and apt-get.
for program in bash cat dirname env grep mkdir printf sed sleep tail tr true wc; do
  ln -s "$(command -v "$program")" "$folder/$program"
done
program() {
  printf '#!/bin/sh\n%s\n' "$2" >"$folder/$1"
  chmod +x "$folder/$1"
}
program id 'echo 1000'
program dpkg 'echo amd64'
program dpkg-query 'exit 1'
program apt-get ": >$folder/called; exit 1"

# check NAME PATTERN COMMAND...: the command fails, installs nothing, and says PATTERN.
check() {
  local name=$1 pattern=$2 output
  shift 2
  if output=$(PATH=$folder "$@" 2>&1 </dev/null) ||
    ! grep -qE -e "$pattern" <<<"$output" ||
    [ -e "$folder/called" ]; then
    echo "$name says:"
    echo "$output"
    exit 1
  fi
}

for script in bench.sh test.sh; do
  check "$script, not as root" \
    "As root, run: apt-get update && apt-get install .*libhwy-dev" "$sources/$script"
done
for argument in --bogus --output-on-failures --repeater=2 -Z; do
  check "test.sh $argument" "\"$argument\" is no option" "$sources/test.sh" "$argument"
done
check "test.sh with options of ctest" "As root, run:" \
  "$sources/test.sh" --output-on-failure -R Range --repeat until-fail:2 -j2 --timeout=9
for argument in --qick --quic --objects-=9 -q -1; do
  check "bench.sh $argument" "\"$argument\" is no option" "$sources/bench.sh" "$argument"
done
check "bench.sh with its options" "As root, run:" \
  "$sources/bench.sh" --quick --mesh a.obj --query-size=1 --paper --strict

# With a sudo that refuses.
program sudo 'exit 1'
for script in bench.sh test.sh; do
  check "$script, sudo fails" \
    "Run: sudo apt-get update && sudo apt-get install .*libhwy-dev" "$sources/$script"
done

# A copy of the scripts, as they write logs.
copy=$folder/copy
mkdir -p "$copy/scripts"
cp "$sources/test.sh" "$copy"
cp "$sources"/scripts/*.sh "$copy/scripts"

# Sources that cannot be written to, also not by root.
program id 'echo 0'
: >"$copy/build"
check "test.sh in a folder that is not the caller's" "cannot write to that folder" \
  "$copy/test.sh"
rm "$copy/build"

# A sudo that asks for a password, once, and an apt-get that fails to install.
program id 'echo 1000'
program sudo "
if [ ! -e $folder/is_typed ]; then
  [ \"\$1\" != -n ] || exit 1
  printf 'password: ' >/dev/tty
  sleep 1
  echo typed >/dev/tty
  : >$folder/is_typed
fi
[ \"\$1\" != -n ] || shift
exec \"\$@\""
program apt-get '
case $* in
  *install*)
    echo "Setting up make (4.3-4.1) ..."
    sleep 2
    exit 100
    ;;
esac'
shown=$(PATH=$folder:/usr/bin SHELL=/bin/sh script -qec "$copy/test.sh" /dev/null </dev/null) || true
for text in "password: typed" "apt-get install, 1 s: Setting up make" \
  "The command was: sudo env DEBIAN_FRONTEND=noninteractive apt-get .*libhwy-dev"; do
  if ! grep -q -e "$text" <<<"$shown"; then
    echo "A terminal does not show \"$text\", but:"
    echo "$shown"
    exit 1
  fi
done

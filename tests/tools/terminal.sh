#!/bin/sh
# usage: terminal.sh COMMAND...
#
# COMMAND draws its progress on a terminal with escape sequences, without colours
# if NO_COLOR is set, and with none at all if TERM is "dumb" or not set. Exits with
# 77 if there is no script(1), which makes the terminal.
set -eu

if ! script --version 2>/dev/null | grep -q util-linux; then exit 77; fi
command="$* --details machine"
unset NO_COLOR

# expect PROGRESS ENV_ARGUMENT...: PROGRESS is the escape sequences, with @, and the
# line in place of them.
expect() {
  expected=$1
  shift
  found=$(env "$@" script -qec "$command" /dev/null </dev/null | tr '\033' '@' |
    grep -oE '@\[[0-9]*[A-Za-z]|^cpuinfo-bench: machine' | LC_ALL=C sort -u |
    tr '\n' ' ')
  if [ "$found" != "$expected " ]; then
    echo "env $*: \"$found\" in place of \"$expected\""
    exit 1
  fi
}

expect '@[0m @[1m @[K' TERM=xterm
expect '@[K' TERM=xterm NO_COLOR=1
expect 'cpuinfo-bench: machine' TERM=dumb
expect 'cpuinfo-bench: machine' -u TERM

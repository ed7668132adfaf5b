# shellcheck shell=bash
# Says what a script is doing, on stderr: stdout belongs to the results.

say() {
  printf '%s\n' "$*" >&2
}

# step NAME COMMAND...: runs the command with its output on stderr, and ends the
# script if it fails.
step() {
  local name=$1 status=0
  shift
  say "==> $name"
  "$@" >&2 || status=$?
  if [ "$status" -ne 0 ]; then
    say "FAILED: $name (exit code $status). The command was: $*"
    exit "$status"
  fi
}

# shellcheck shell=bash
# Says what a script is doing, on stderr: stdout belongs to the results. Needs `root`,
# the top of the repository.

say() {
  printf '%s\n' "$*" >&2
}

# follow NAME LOG: until it is killed, shows for how many seconds the step runs, and how far
# it is. Ninja writes [12/340] into its log, ctest 12/340 Test, and apt-get the packages.
follow() {
  local progress started=$SECONDS
  while kill -0 $$ 2>/dev/null; do
    progress=$(tail -c 4000 "$2" 2>/dev/null | tr '\r' '\n' | sed -nE \
      -e 's,^ *\[?([0-9]+/[0-9]+)(\] .*| Test +#.*)$,: \1,p' \
      -e 's,^(Get:[0-9]+|(Unpacking|Setting up) [^ ]+) .*$,: \1,p' | tail -n 1)
    printf '\r==> %s, %d s%s\033[K' "$1" $((SECONDS - started)) "$progress" >&2
    sleep 0.5
  done
}

# step NAME COMMAND...: runs the command with its output in a log. If the command
# fails, shows what failed and ends the script.
step() {
  local name=$1 status=0 started=$SECONDS command log follower=
  shift
  command=$*
  # shellcheck disable=SC2154  # root is the caller's
  log=$root/build/logs/${name//[^a-zA-Z0-9]/_}.txt
  if ! { mkdir -p "$root/build/logs" && : >"$log"; }; then
    say "The scripts build in $root/build and cannot write to that folder. Copy the sources" \
      "to a folder of your own, and run the copy there."
    exit 1
  fi
  if [ -t 2 ]; then
    follow "$name" "$log" &
    follower=$!
  else
    say "==> $name"
  fi
  "$@" >"$log" 2>&1 || status=$?
  if [ "$follower" ]; then
    kill "$follower" 2>/dev/null || true
    wait "$follower" 2>/dev/null || true
    printf '\r==> %s: %d s\033[K\n' "$name" $((SECONDS - started)) >&2
  fi
  if [ "$status" -ne 0 ]; then
    show_failure "$log" >&2
    say "FAILED: $name (exit code $status). All it said is in $log. The command was:" \
      "${command/#sudo -n /sudo }"
    exit "$status"
  fi
}

# show_failure LOG: the first failure that Ninja or ctest reports, and the end.
show_failure() {
  local lines
  lines=$(wc -l <"$1")
  if [ "$lines" -gt 80 ]; then
    awk 'NR > last - 30 { exit }
         /^FAILED: |\*\*\*(Failed|Exception|Timeout|Not Run)/ { shown = 1 }
         shown && ++count <= 50' last="$lines" "$1"
    tail -n 30 "$1"
  else
    cat "$1"
  fi
}

#!/bin/sh
# little_memory.sh PROGRAM: runs cpuinfo-bench with a little less address space than it
# needs, in steps. Each run is complete, or ends with one line that says why. Only the
# loader, which runs before it, may end it otherwise.
set -eu
program=$1

# run KIBIBYTES: the status of the run; its messages are in $error.
run() {
  status=0
  error=$(prlimit --as=$(($1 * 1024)) "$program" --details machine 2>&1 >/dev/null) ||
    status=$?
}

low=1024
high=4194304
run $high
if [ $status -ne 0 ]; then echo "does not run in $high KiB: $error"; exit 1; fi
while [ $((high - low)) -gt 128 ]; do
  middle=$(((low + high) / 2))
  run $middle
  if [ $status -eq 0 ]; then high=$middle; else low=$middle; fi
done

refused=0
for step in $(seq 1 24); do
  run $((high - 128 * step))
  # In a few KiB glibc's loader does not refuse but faults (init_tls). It still
  # refuses in a little more.
  if [ $status -eq 139 ]; then run $((high - 128 * step + 16)); fi
  case "$status $error" in
    0* | 127*) ;;
    [24]*"cpuinfo-bench: not enough memory"*) refused=$((refused + 1)) ;;
    *) echo "$((high - 128 * step)) KiB: status $status: $error"; exit 1 ;;
  esac
done
echo "runs in $high KiB, and was refused $refused times in less"

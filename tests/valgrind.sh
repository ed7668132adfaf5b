#!/usr/bin/env bash
# The library's tests of the release build under valgrind's memcheck, on AVX2
# (which valgrind has, unlike AVX-512). On x86-64 Debian; builds what is missing.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

prepare_machine
install_packages valgrind
build_preset release

export HALFSPACE_TARGET=AVX2
export HALFSPACE_TEST_SCALE=0.02  # leaves out the huge world, too

left_out=(
  # valgrind ignores the bits of MXCSR that flush subnormals, and these notice
  # that nothing is flushed.
  '*.ModesAreLeftAsTheyWere'
  '*.SubnormalMistakesAreRefused'
  '*.NothingMoreIsRejectedWithSubnormalsFlushed'
  # Its operator new cannot throw, and ends the process instead.
  '*.MemoryThatCannotBeHadIsBadAlloc'
  # Faults on purpose, which memcheck reports.
  '*DeathTest.*')

# codes_memory_test brings its own operator new, which valgrind must leave alone
# (nouserintercepts); the memory below it is valgrind's all the same.
#
# A vector that is loaded beyond the end of a block is an error to us, even one
# that stays within an aligned word (--partial-loads-ok).
for test in "$root"/build/release/tests/library/*_test; do
  step "memcheck ${test##*/}" \
    valgrind -q --error-exitcode=99 --partial-loads-ok=no \
    --soname-synonyms=somalloc=nouserintercepts \
    --leak-check=full --errors-for-leak-kinds=definite \
    "$test" --gtest_brief=1 --gtest_filter="-$(IFS=:; echo "${left_out[*]}")"
done

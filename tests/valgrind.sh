#!/usr/bin/env bash
# Tests of the release build under valgrind's memcheck, on AVX2 (valgrind has no
# AVX-512). On x86-64 Debian; builds what is missing.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/scripts/steps.sh"
source "$root/scripts/packages.sh"
source "$root/scripts/build.sh"

prepare_machine
install_packages valgrind
# Results that depend on uninitialised memory, and leaks: one test of each kind of memory
# that the library reads. The others read the same memory with more values.
# Those that take long are first.
tests=(quantized_test broad_phase_test bvh_test bvh_changes_test reject_test fit_many_test
  fit_test kernels_test memory_test worlds_test)
# Where test.sh --full has built them with all dimensions, nothing is built again.
built=$root/build/release
only_3d=ON
if [ -e "$built/tests/library/${tests[0]}" ] &&
  grep -q '^HALFSPACE_TEST_ONLY_3D:[A-Z]*=OFF' "$built/CMakeCache.txt"; then
  only_3d=OFF
fi
build_preset release -DHALFSPACE_TEST_ONLY_3D=$only_3d "${tests[@]}"

export HALFSPACE_TARGET=AVX2
export HALFSPACE_TEST_SCALE=0.02  # leaves out the huge world, too

left_out=(
  # valgrind ignores the bits of MXCSR that flush subnormals or unmask exceptions,
  # and these notice that they are not kept.
  '*.DistancesOfAllSizesInAllFloatingPointModes*'
  'RoundOutwardTest.IsTheNextFloatInEveryMode'
  # It rounds to nearest in every mode, and then a half-space can lose what touches it.
  # HalfSpacesTest.SeveralFrustaAreRows reads the same memory.
  '*.NeverRejectsWhatTouchesAShape*' 'HalfSpacesTest.EachTargetKeepsTheSame'
  'HalfSpacesTest.OfSpheres'
  # Its operator new cannot throw, and ends the process instead.
  '*.MemoryThatCannotBeHadIsBadAlloc*'
  # Reads a thread's stack below what is in use.
  '*.TakeTheStackThatHeadersState*'
  # Faults on purpose, which memcheck reports.
  '*DeathTest.*'
  # Long histories, and large worlds, that only count nodes, bytes and survivors:
  # AnyHistoryIsThatOfTheModel makes every change.
  '*.AWorldSortsItselfAsItChanges*' '*.MemoryFollowsTheObjects*'
  '*.RebuildsMendWhatDecayed*' '*.LevelsStayAsTightAsAfterARefit*'
  '*.OrderedObjectsAreToldApartToo*' '*.FewMoreSurviveThanOfFloats*'
  # The same calls as AnswersInWorldsOfEverySize, and builds that are written past the
  # caches: each took as long as half of all other tests.
  '*.AnswersInWorldsOfEveryScene*' '*.AreTheSameAsSmallOnes*'
  # Exact arithmetic of thousands of special shapes: minutes. FitExactTest makes the same
  # calls, of shapes that are empty or without bounds as well.
  '*.NumbersThatCannotBeBounded*'
  # 3 dimensions only: minutes, for the same code. Boxes only in scans, whose stages they
  # alone have: elsewhere they are octahedra without one axis.
  '*/2D*' '*/4D*' '*/Simplex2*' '*/Simplex4*' '*/Aabb2*' '*/Aabb4*' '*/Aabo2*' '*/Aabo4*'
  '*/Bound*2*' '*/Bound*4*'
  '*Bvh*/Aabb3' '*BroadPhase*/Aabb3' '*Quantized*/*Aabb3Uint*')

filter="-$(IFS=:; echo "${left_out[*]}")"
logs=$root/build/memcheck
mkdir -p "$logs"
export filter logs

# memcheck TEST: a line on how it went, or why it failed.
#
# memory_test brings its own operator new, which valgrind must leave alone
# (nouserintercepts); the memory below it is valgrind's all the same.
#
# A vector that is loaded beyond the end of a block is an error to us, even one
# that stays within an aligned word (--partial-loads-ok).
memcheck() {
  local name=${1##*/} started=$SECONDS
  if valgrind -q --error-exitcode=99 --partial-loads-ok=no \
    --soname-synonyms=somalloc=nouserintercepts \
    --leak-check=full --errors-for-leak-kinds=definite \
    "$1" --gtest_brief=1 --gtest_filter="$filter" >"$logs/$name.txt" 2>&1; then
    echo "    $name: passed in $((SECONDS - started)) s" >&2
    return
  fi
  tail -n 60 "$logs/$name.txt" >&2
  echo "FAILED: memcheck $name. All it said is in $logs/$name.txt" >&2
  return 1
}
export -f memcheck

# One test a core: each is single-threaded.
say "==> memcheck"
printf '%s\0' "${tests[@]/#/$root/build/release/tests/library/}" |
  xargs -0 -n 1 -P "$(getconf _NPROCESSORS_ONLN)" bash -c 'memcheck "$1"' memcheck

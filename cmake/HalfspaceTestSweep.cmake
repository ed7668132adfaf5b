# Registers GoogleTest executables with ctest, for whatever machine runs them.

# The emulated machines: one run per target and vector length in bits. Native
# machines have one vector length per target, and a test runs all targets.
if(EMSCRIPTEN)
  set(HALFSPACE_SWEEP WASM:128)
  set(HALFSPACE_SWEEP_EACH WASM:128)
  set(HALFSPACE_SWEEP_FEW WASM:128)
elseif(HALFSPACE_ONLY_SCALAR OR NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  set(HALFSPACE_SWEEP "")
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # SVE and SVE2 are one source: each length once, and a short and a long one of
  # each.
  set(HALFSPACE_SWEEP
      SVE:128 SVE:512 SVE2:256 SVE2:2048
      SVE_256:256 SVE2_128:128 NEON:128)
  set(HALFSPACE_SWEEP_EACH
      SVE:512 SVE2:256 SVE_256:256 SVE2_128:128 NEON:128)
  set(HALFSPACE_SWEEP_FEW NEON:128 SVE2:2048)
  set(HALFSPACE_SWEEP_ONE NEON:128)
else()
  set(HALFSPACE_SWEEP NEON:128)
  set(HALFSPACE_SWEEP_EACH NEON:128)
  set(HALFSPACE_SWEEP_FEW NEON:128)
  set(HALFSPACE_SWEEP_ONE NEON:128)
endif()
set(HALFSPACE_SWEEP_NONE "")
# Highway's plain fall-back has another name, and width, by compiler. A module of
# WebAssembly has none.
set(fall_back "")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(fall_back SCALAR:32)
elseif(NOT EMSCRIPTEN)
  set(fall_back EMU128:128)
endif()
list(APPEND HALFSPACE_SWEEP ${fall_back})
list(APPEND HALFSPACE_SWEEP_EACH ${fall_back})

# Registers the tests of `target`: each with all of its rows, or, under an emulator, the
# whole executable as TARGET.HIGHWAY_TARGET.BITS for emulated machines: all of
# them, or, with EACH (target once), FEW or ONE as the second argument, a choice,
# for tests of what differs less between machines than it takes time. NONE, which
# is not even built then, is for what machines have in common: errors, ownership,
# memory; and for exact bounds, of which hash_test knows that they are the same.
function(halfspace_sweep_test target)
  # All targets in one process, or in two for two cores.
  if(HALFSPACE_QEMU)
    foreach(half RANGE 1)
      add_test(NAME ${target}.${half} COMMAND ${target})
      set_tests_properties(${target}.${half} PROPERTIES
        LABELS library
        ENVIRONMENT "GTEST_TOTAL_SHARDS=2;GTEST_SHARD_INDEX=${half}")
    endforeach()
    return()
  endif()
  # Each start of wine takes a second.
  if(WIN32 AND CMAKE_CROSSCOMPILING_EMULATOR)
    add_test(NAME ${target} COMMAND ${target})
    set_tests_properties(${target} PROPERTIES LABELS library)
    return()
  endif()
  if(NOT CMAKE_CROSSCOMPILING_EMULATOR)
    set(script "${CMAKE_CURRENT_BINARY_DIR}/${target}_tests.cmake")
    file(GENERATE OUTPUT "${script}" CONTENT
"set(target ${target})
set(program \"$<TARGET_FILE:${target}>\")
include(\"${PROJECT_SOURCE_DIR}/cmake/HalfspaceListTests.cmake\")
")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${script}")
    return()
  endif()
  set(sweep HALFSPACE_SWEEP)
  if(ARGC GREATER 1)
    set(sweep HALFSPACE_SWEEP_${ARGV1})
  endif()
  if(NOT ${sweep})
    set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
  foreach(machine IN LISTS ${sweep})
    string(REPLACE ":" ";" machine "${machine}")
    list(GET machine 0 highway_target)
    list(GET machine 1 bits)
    if(highway_target IN_LIST HALFSPACE_LEAVE_OUT_TARGETS)
      continue()
    endif()
    if(highway_target MATCHES "^SVE")
      math(EXPR quads "${bits} / 128")
      math(EXPR bytes "${bits} / 8")
      set(cpu "max,sve-max-vq=${quads},sve-default-vector-length=${bytes}")
    elseif(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
      set(cpu "max,sve=off")
    else()
      set(cpu "max")
    endif()
    set(name "${target}.${highway_target}.${bits}")
    add_test(NAME ${name} COMMAND ${target})
    set_tests_properties(${name} PROPERTIES
      LABELS library
      ENVIRONMENT "QEMU_CPU=${cpu};HALFSPACE_TARGET=${highway_target}")
  endforeach()
endfunction()

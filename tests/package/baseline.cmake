# No instruction above the x86-64 baseline outside per-target code.

if(NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64" OR HALFSPACE_ONLY_SCALAR)
  return()
endif()
if(CMAKE_CXX_FLAGS MATCHES "-m" OR HALFSPACE_ONLY_NATIVE)
  message(STATUS "halfspace: no scan of the binary, "
                 "as its flags may raise the baseline")
  return()
endif()

function(add_baseline_test name target)
  add_test(NAME ${name}
    COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/scan_baseline.sh"
            "${CMAKE_OBJDUMP}" $<TARGET_FILE:${target}> ${ARGN})
  set_tests_properties(${name} PROPERTIES LABELS package)
endfunction()

add_baseline_test(package.baseline halfspace)
# The ceilings of cpuinfo-bench and the experiments of the paper are per-target code as
# well.
foreach(name IN ITEMS bench paper)
  if(TARGET halfspace_${name})
    add_baseline_test(package.baseline.${name} halfspace_${name})
  endif()
endforeach()
# The scan must find something when nothing is excused.
if(TARGET one_call)
  add_baseline_test(package.baseline.control one_call everything)
  set_tests_properties(package.baseline.control PROPERTIES
    PASS_REGULAR_EXPRESSION "N_AVX2.*above the baseline")
endif()

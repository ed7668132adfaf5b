# HALFSPACE_TARGET, once with each value that says something different. It is
# read when a process starts, so each value is a test of its own.

set(names
  AVX3_SPR AVX3_ZEN4 AVX3_DL AVX3 AVX2 SSE4 SSSE3 SSE2
  SVE2_128 SVE_256 SVE2 SVE NEON_BF16 NEON NEON_WITHOUT_AES
  EMU128 SCALAR)

halfspace_add_library_test_executable(environment_test targets/environment_test.cc)
list(JOIN names "\",\"" quoted)
target_compile_definitions(environment_test
  PRIVATE "HALFSPACE_TRIED_NAMES=\"${quoted}\""
          "HALFSPACE_TEST_DATA=\"${CMAKE_CURRENT_SOURCE_DIR}/bvh/data\"")

function(halfspace_add_environment_test name change)
  add_test(NAME environment_test.${name} COMMAND environment_test)
  set_tests_properties(environment_test.${name} PROPERTIES
    LABELS library
    ENVIRONMENT_MODIFICATION "HALFSPACE_TARGET=${change}")
endfunction()

foreach(name IN LISTS names)
  halfspace_add_environment_test(${name} "set:${name}")
endforeach()
halfspace_add_environment_test(not_set "unset:")
halfspace_add_environment_test(empty "set:")
# Longer than what a string keeps in itself.
halfspace_add_environment_test(unknown "set:nonsense, and more of it")
# One of the two is the plain fall-back of every build.
halfspace_add_environment_test(lower_case_scalar "set:scalar")
halfspace_add_environment_test(lower_case_emu128 "set:emu128")

# CPUs and virtual machines that lack AES or PCLMULQDQ, which Highway's own detection asks for.
find_program(HALFSPACE_QEMU_X86_64 qemu-x86_64)
if(HALFSPACE_QEMU_X86_64 AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$" AND
   NOT WIN32 AND NOT HALFSPACE_ONLY_NATIVE AND NOT HALFSPACE_ONLY_SCALAR)
  foreach(row "Haswell,-aes AVX2" "Haswell,-pclmulqdq AVX2" "EPYC,-aes AVX2" "Dhyana AVX2"
              "Nehalem SSE4")
    string(REPLACE " " ";" row "${row}")
    list(GET row 0 cpu)
    list(GET row 1 expected)
    add_test(NAME environment_test.cpu.${cpu}
      COMMAND "${HALFSPACE_QEMU_X86_64}" -cpu ${cpu} $<TARGET_FILE:environment_test>
              --gtest_filter=*CpuHasTheTargetThatItCanRun)
    set_tests_properties(environment_test.cpu.${cpu} PROPERTIES
      LABELS library ENVIRONMENT_MODIFICATION
      "HALFSPACE_TARGET=unset:;HALFSPACE_TEST_TARGET_OF_CPU=set:${expected}")
  endforeach()
endif()

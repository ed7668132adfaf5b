# cpuinfo-bench as its users call it: exit codes and messages.

set(inputs "${CMAKE_CURRENT_BINARY_DIR}/inputs")
file(WRITE "${inputs}/quad.obj" "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
file(WRITE "${inputs}/bad.obj" "v 0 0 0\nv 1 0 0\nv 1 1 zero\nf 1 2 3\n")
file(WRITE "${inputs}/boxes.csv" "0,0,0,1,1,1\n2,2,2,3,3,3\n")
file(WRITE "${inputs}/bad.csv" "0,0,0,1,1,1\n0,0,0,nan,1,1\n")

# halfspace_command_line_test(<name> CODE n [STDOUT regex] [STDERR regex]
#                             ARGUMENTS ...)
function(halfspace_command_line_test name)
  cmake_parse_arguments(arg "" "CODE;STDOUT;STDERR" "ARGUMENTS" ${ARGN})
  set(command ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:cpuinfo-bench>
              ${arg_ARGUMENTS})
  string(REPLACE ";" "|" command "${command}")
  add_test(NAME cpuinfo-bench.${name}
    COMMAND "${CMAKE_COMMAND}" "-DCOMMAND=${command}"
            "-DEXPECTED_CODE=${arg_CODE}" "-DSTDOUT=${arg_STDOUT}"
            "-DSTDERR=${arg_STDERR}"
            -P "${CMAKE_CURRENT_SOURCE_DIR}/command_line_test.cmake")
  set_tests_properties(cpuinfo-bench.${name} PROPERTIES LABELS tools)
endfunction()

halfspace_command_line_test(version CODE 0 ARGUMENTS --version
  STDOUT "cpuinfo-bench ${PROJECT_VERSION}")
halfspace_command_line_test(list CODE 0 ARGUMENTS --list
  STDOUT "machine\ncheck\ntable1\ncrossover\nkernels\nbuild\nthroughput\nquality\nsegments\nverdict")
halfspace_command_line_test(help CODE 0 ARGUMENTS --help STDOUT "--mesh")
halfspace_command_line_test(unknown_option CODE 2 ARGUMENTS --fast
  STDERR "--fast")
halfspace_command_line_test(unknown_section CODE 2 ARGUMENTS --only speed
  STDERR "speed")
halfspace_command_line_test(unknown_target CODE 2 ARGUMENTS --target MMX
  STDERR "MMX.*choose one of")
halfspace_command_line_test(two_inputs CODE 2
  ARGUMENTS --mesh a.obj --bounds b.csv STDERR "excludes")
halfspace_command_line_test(zero_repetitions CODE 2
  ARGUMENTS --repetitions 0 STDERR "repetitions")
halfspace_command_line_test(unwritable_output CODE 2
  ARGUMENTS --only machine --out "${inputs}/none/x" STDERR "cannot be written")
halfspace_command_line_test(mesh CODE 0
  ARGUMENTS --only quality --mesh "${inputs}/quad.obj"
  STDOUT "2 objects, 2 queries")
halfspace_command_line_test(bounds CODE 0
  ARGUMENTS --only check,quality --bounds "${inputs}/boxes.csv"
  STDOUT "aabb +2 +1.00")
halfspace_command_line_test(bad_mesh CODE 3
  ARGUMENTS --only quality --mesh "${inputs}/bad.obj" STDERR "bad.obj:3: ")
halfspace_command_line_test(bad_bounds CODE 3
  ARGUMENTS --only quality --bounds "${inputs}/bad.csv" STDERR "bad.csv:2: ")
halfspace_command_line_test(missing_mesh CODE 3
  ARGUMENTS --mesh "${inputs}/none.obj" STDERR "none.obj: ")
halfspace_command_line_test(json CODE 0
  ARGUMENTS --only machine,table1 --objects 4096 --queries 2 --format json
  STDOUT "\"half_spaces\"")

# Every message of a bad environment reaches the user too.
halfspace_command_line_test(bad_environment CODE 2 ARGUMENTS --only machine
  STDERR "HALFSPACE_TARGET.*MMX")
set_tests_properties(cpuinfo-bench.bad_environment PROPERTIES
  ENVIRONMENT HALFSPACE_TARGET=MMX)

# cpuinfo-bench as its users call it: exit codes and messages.

set(inputs "${CMAKE_CURRENT_BINARY_DIR}/inputs")
file(WRITE "${inputs}/quad.obj" "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
file(WRITE "${inputs}/bad.obj" "v 0 0 0\nv 1 0 0\nv 1 1 zero\nf 1 2 3\n")
file(WRITE "${inputs}/boxes.csv" "0,0,0,1,1,1\n2,2,2,3,3,3\n")
file(WRITE "${inputs}/far.obj" "v 3e38 0 0\nv 0 3e38 0\nv 0 0 3e38\nf 1 2 3\n")
file(WRITE "${inputs}/far.csv" "2e38,2e38,2e38,3e38,3e38,3e38\n")
file(WRITE "${inputs}/far_out.csv" "0,0,0,1,1,1\n1e13,1e13,1e13,2e13,2e13,2e13\n")
file(WRITE "${inputs}/bad.csv" "0,0,0,1,1,1\n0,0,0,nan,1,1\n")

# halfspace_command_line_test(<name> CODE n [STDOUT regex] [STDERR regex]
#                             [MOST_LINES n] [STDOUT_FILE file] [OUT regex]
#                             #                             [BEFORE command ...] [ENVIRONMENT variable=value ...]
#                             ARGUMENTS ...)
# With OUT, there is a file for --out, which matches afterwards. BEFORE is what runs the tool. Among arguments, <EMPTY> is none and
# <ESC> a control character.
function(halfspace_command_line_test name)
  cmake_parse_arguments(arg "" "CODE;STDOUT;MOST_LINES;STDERR;STDOUT_FILE;OUT"
                        "BEFORE;ENVIRONMENT;ARGUMENTS" ${ARGN})
  set(out "")
  if(arg_OUT)
    set(out "${inputs}/${name}.out")
    list(APPEND arg_ARGUMENTS --out "${out}")
  endif()
  set(command ${arg_BEFORE} ${CMAKE_CROSSCOMPILING_EMULATOR}
              $<TARGET_FILE:cpuinfo-bench> ${arg_ARGUMENTS})
  string(REPLACE ";" "|" command "${command}")
  add_test(NAME cpuinfo-bench.${name}
    COMMAND "${CMAKE_COMMAND}" "-DCOMMAND=${command}"
            "-DEXPECTED_CODE=${arg_CODE}" "-DSTDOUT=${arg_STDOUT}"
            "-DMOST_LINES=${arg_MOST_LINES}"
            "-DSTDERR=${arg_STDERR}" "-DSTDOUT_FILE=${arg_STDOUT_FILE}"
            "-DOUT=${out}" "-DEXPECTED_OUT=${arg_OUT}"
            -P "${CMAKE_CURRENT_SOURCE_DIR}/command_line_test.cmake")
  set_tests_properties(cpuinfo-bench.${name} PROPERTIES
    LABELS tools ENVIRONMENT "${arg_ENVIRONMENT}")
endfunction()

halfspace_command_line_test(version CODE 0 ARGUMENTS --version
  STDOUT "cpuinfo-bench ${PROJECT_VERSION}")
halfspace_command_line_test(list CODE 0 ARGUMENTS --list
  STDOUT "^verdict\nanswers\nwidth\nmachine\ncheck\ntable1\ngate\nmodel\nkernels\ntier\nbuild\nthroughput\nbvh\nbroad_phase\nquality\nvolumes\ndual\naxes\nsegments\nsweep\nthreads\nnoise\n$")
halfspace_command_line_test(help CODE 0 ARGUMENTS --help STDOUT "--mesh")
halfspace_command_line_test(progress CODE 0
  ARGUMENTS --details machine,quality --objects 4096
  STDERR "^cpuinfo-bench: machine +0 %\ncpuinfo-bench: quality +9 %.*\n$")
add_test(NAME cpuinfo-bench.terminal
  COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/terminal.sh"
          ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:cpuinfo-bench>)
set_tests_properties(cpuinfo-bench.terminal PROPERTIES
  LABELS tools SKIP_RETURN_CODE 77)
add_test(NAME cpuinfo-bench.man_page
  COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/man_page.sh"
          "${PROJECT_SOURCE_DIR}/docs/cpuinfo-bench.1"
          ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:cpuinfo-bench>)
add_test(NAME cpuinfo-bench-report.man_page
  COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/man_page.sh"
          "${PROJECT_SOURCE_DIR}/docs/cpuinfo-bench-report.1"
          /usr/bin/python3 "${PROJECT_SOURCE_DIR}/bench/cpuinfo-bench-report")
set_tests_properties(cpuinfo-bench.man_page cpuinfo-bench-report.man_page
  PROPERTIES LABELS tools)
halfspace_command_line_test(unknown_option CODE 2 ARGUMENTS --fast
  STDERR "--fast")
halfspace_command_line_test(unknown_section CODE 2 ARGUMENTS --details speed
  STDERR "speed")
halfspace_command_line_test(unknown_target CODE 2 ARGUMENTS --target MMX
  STDERR "MMX.*choose one of")
halfspace_command_line_test(two_inputs CODE 2
  ARGUMENTS --mesh a.obj --bounds b.csv STDERR "excludes")
halfspace_command_line_test(two_kinds_of_queries CODE 2
  ARGUMENTS --mesh a.obj --query-bounds b.csv --query-size 1 STDERR "excludes")
halfspace_command_line_test(queries_without_a_file CODE 2
  ARGUMENTS --details machine --query-size 1 STDERR "give --mesh or --bounds")
foreach(size 0 -1 101 nan 1x)
  halfspace_command_line_test(query_size_${size} CODE 2
    ARGUMENTS --bounds b.csv --query-size ${size} STDERR "not a number above 0")
endforeach()
halfspace_command_line_test(zero_repetitions CODE 2
  ARGUMENTS --repetitions 0 STDERR "repetitions")
halfspace_command_line_test(unwritable_output CODE 2
  ARGUMENTS --details machine --out "${inputs}/none/x" STDERR "cannot be written")
halfspace_command_line_test(mesh CODE 0
  ARGUMENTS --details quality --mesh "${inputs}/quad.obj"
  STDOUT "2 objects, 2 queries")
halfspace_command_line_test(axes_mesh CODE 0
  ARGUMENTS --details axes --quick --mesh "${inputs}/quad.obj"
  STDOUT "quad.obj +regular")
halfspace_command_line_test(bvh_mesh CODE 0
  ARGUMENTS --details bvh --objects 64 --quick --mesh "${inputs}/quad.obj"
  STDOUT "file, 2 boxes: a query finds 2.0")
halfspace_command_line_test(bvh_far_bounds CODE 0
  ARGUMENTS --details bvh --objects 64 --quick --bounds "${inputs}/far_out.csv"
  STDOUT "Not measured: the boxes of a file: coordinates")
file(WRITE "${inputs}/far_apart.csv" "0,0,0,1,1,1\n1e20,1e20,1e20,2e20,2e20,2e20\n")
halfspace_command_line_test(volumes_of_far_bounds CODE 0
  ARGUMENTS --details volumes --objects 64 --quick
            --bounds "${inputs}/far_apart.csv" STDOUT "sphere")
foreach(ns nan 0 -1 1x)
  halfspace_command_line_test(exact_ns_${ns} CODE 2
    ARGUMENTS --details machine --exact-ns ${ns} STDERR "not a number above 0")
endforeach()
# Whether the run is noisy, nobody knows; that it is asked, the report tells.
halfspace_command_line_test(strict CODE "[04]"
  ARGUMENTS --strict --quick --details machine --objects 4096
  STDOUT "a kernel timed against itself")
halfspace_command_line_test(bounds CODE 0
  ARGUMENTS --details check,quality --bounds "${inputs}/boxes.csv"
  STDOUT "AABB +2 +1.00")
# Of the two boxes, the first is touched by one of both queries.
file(WRITE "${inputs}/queries.csv" "0,0,0,1,1,1\n5,5,5,6,6,6\n")
halfspace_command_line_test(query_bounds CODE 0
  ARGUMENTS --details quality --bounds "${inputs}/boxes.csv"
            --query-bounds "${inputs}/queries.csv"
  STDOUT "AABB +1 +0.50 +1.00.*2 objects, 2 queries")
halfspace_command_line_test(query_size CODE 0
  ARGUMENTS --details quality --bounds "${inputs}/boxes.csv" --query-size 100
            --queries 3
  STDOUT "AABB +6 +2.00 +1.00.*2 objects, 3 queries")
halfspace_command_line_test(bad_query_bounds CODE 3
  ARGUMENTS --details quality --bounds "${inputs}/boxes.csv"
            --query-bounds "${inputs}/bad.csv"
  STDERR "bad.csv:2: ")
halfspace_command_line_test(bad_mesh CODE 3
  ARGUMENTS --details quality --mesh "${inputs}/bad.obj" STDERR "bad.obj:3: ")
halfspace_command_line_test(bad_bounds CODE 3
  ARGUMENTS --details quality --bounds "${inputs}/bad.csv" STDERR "bad.csv:2: ")
halfspace_command_line_test(missing_mesh CODE 3
  ARGUMENTS --mesh "${inputs}/none.obj" STDERR "none.obj: ")
# What is compared, report_test tests.
file(WRITE "${inputs}/other.json" "{\"schema\": 4, \"context\": {\"model\": \"none\", \"caches\": \"none\", \"scope\": \"\"}, \"tables\": []}")
halfspace_command_line_test(against_another_machine CODE 2
  ARGUMENTS --details machine --against "${inputs}/other.json"
  STDERR "other.json: it is of none, none, and this is .*same machine")
file(WRITE "${inputs}/old.json" "{\"schema\": 3}")
halfspace_command_line_test(against_an_old_report CODE 3
  ARGUMENTS --details machine --against "${inputs}/old.json"
  STDERR "old.json: no JSON report of this version; give")
# Ratios of the same program minutes apart. Whether one is worse, nobody knows.
halfspace_command_line_test(against_stored CODE 0
  ARGUMENTS --details quality,axes --quick --target SCALAR --repetitions 1
            --bounds "${inputs}/boxes.csv" --format json
            --out "${inputs}/stored.json")
set_tests_properties(cpuinfo-bench.against_stored PROPERTIES
  FIXTURES_SETUP against)
halfspace_command_line_test(against_without_values CODE 2
  ARGUMENTS --details quality --quick --bounds "${inputs}/boxes.csv"
            --against "${inputs}/stored.json"
  STDOUT "^$" STDERR "^cpuinfo-bench: --against .*: no value is in both runs")
set_tests_properties(cpuinfo-bench.against_without_values PROPERTIES
  FIXTURES_REQUIRED against)
# Values that seem to be compared until the run is complete.
add_test(NAME cpuinfo-bench.against_changed
  COMMAND sh -c "sed 's/\"name\":\"over AABB\"/&,\"better\":\"higher\"/' stored.json >changed.json"
  WORKING_DIRECTORY "${inputs}")
set_tests_properties(cpuinfo-bench.against_changed PROPERTIES
  LABELS tools FIXTURES_REQUIRED against FIXTURES_SETUP against_changed)
halfspace_command_line_test(against_other_values CODE 2
  ARGUMENTS --details quality --quick --bounds "${inputs}/boxes.csv"
            --against "${inputs}/changed.json"
  STDOUT "^$" STDERR "no value is in both runs")
halfspace_command_line_test(against_other_values_out CODE 2
  ARGUMENTS --details quality --quick --bounds "${inputs}/boxes.csv"
            --against "${inputs}/changed.json"
  OUT "^what was there$" STDERR "no value is in both runs")
set_tests_properties(cpuinfo-bench.against_other_values
  cpuinfo-bench.against_other_values_out PROPERTIES FIXTURES_REQUIRED against_changed)
halfspace_command_line_test(against_no_report CODE 3
  ARGUMENTS --details machine --against "${inputs}/boxes.csv"
  STDERR "boxes.csv: no JSON report of this version; give")
halfspace_command_line_test(against_no_file CODE 3
  ARGUMENTS --details machine --against "${inputs}/none.json"
  STDERR "none.json: cannot be read: .*; give")

halfspace_command_line_test(target_of_builds CODE 0
  ARGUMENTS --details machine --target SCALAR STDOUT "chosen +scalar, which")
# A page of one target that programs would not get.
halfspace_command_line_test(page_of_one_target CODE 0
  ARGUMENTS --quick --objects 4096 --queries 4 --repetitions 1 --target SCALAR
  STDOUT "^The simplex scan is faster[^\n]*\n  scalar  " MOST_LINES 100)
# Files that are read are not written, whatever they are called.
file(MAKE_DIRECTORY "${inputs}/folder")
file(CREATE_LINK "${inputs}/against_link.out" "${inputs}/link.json" SYMBOLIC)
foreach(pair "mesh|../inputs/mesh_over.out" "bounds|./bounds_over.out"
             "against|folder/../against_over.out")
  string(REGEX MATCH "^([a-z]+)[|](.*)" pair "${pair}")
  halfspace_command_line_test(${CMAKE_MATCH_1}_over CODE 2
    ARGUMENTS --${CMAKE_MATCH_1} "${inputs}/${CMAKE_MATCH_2}"
    OUT "^what was there$"
    STDERR "--out .* would overwrite the file of --${CMAKE_MATCH_1} .*; name another")
endforeach()
halfspace_command_line_test(query_bounds_over CODE 2
  ARGUMENTS --bounds "${inputs}/boxes.csv"
            --query-bounds "${inputs}/query_bounds_over.out"
  OUT "^what was there$" STDERR "would overwrite the file of --query-bounds .*; name another")
halfspace_command_line_test(against_link CODE 2
  ARGUMENTS --details machine --against "${inputs}/link.json"
  OUT "^what was there$" STDERR "would overwrite the file of --against .*link.json; name another")
halfspace_command_line_test(json CODE 0
  ARGUMENTS --details machine,table1 --objects 4096 --queries 2 --format json
  STDOUT "\"name\":\"table1\"")

# Every message of a bad environment reaches the user too.
halfspace_command_line_test(bad_environment CODE 2 ARGUMENTS --details machine
  STDERR "HALFSPACE_TARGET.*MMX" ENVIRONMENT HALFSPACE_TARGET=MMX)
string(ASCII 27 escape)
halfspace_command_line_test(control_character_in_environment CODE 2
  ARGUMENTS --details machine STDERR "x1bc"
  ENVIRONMENT "HALFSPACE_TARGET=${escape}c")
halfspace_command_line_test(control_character_in_file_name CODE 3
  ARGUMENTS --mesh "<ESC>[31m" STDERR "x1b\\[31m: ")

# Google Benchmark complains of its own variables before main().
halfspace_command_line_test(benchmark_environment CODE 0
  ARGUMENTS --details machine
  ENVIRONMENT BENCHMARK_REPETITIONS=x BENCHMARK_CONTEXT=x
              BENCHMARK_MIN_WARMUP_TIME=x V=x)

foreach(seed -1 18446744073709551616 0x10 1e16 0.5 <EMPTY>)
  halfspace_command_line_test(seed_${seed} CODE 2
    ARGUMENTS --details machine --seed ${seed} STDERR "not a whole number from 0 to")
endforeach()
halfspace_command_line_test(decimal_seed CODE 0
  ARGUMENTS --details segments --objects 64 --quick --seed 010 STDOUT "; seed 10; ")
halfspace_command_line_test(exponents CODE 0
  ARGUMENTS --details quality --objects 1.5e3 --queries 1e0 --seed 1e6
  STDOUT "1 500 objects, 1 queries")
foreach(option --mesh --bounds --out --against)
  halfspace_command_line_test(empty${option} CODE 2
    ARGUMENTS --details machine ${option} <EMPTY> STDERR "empty file name")
endforeach()
foreach(sections "quality," ",quality" "quality,,check" "<EMPTY>")
  halfspace_command_line_test(empty_section_${sections} CODE 2
    ARGUMENTS --details "${sections}" STDERR "not a section")
endforeach()

if(EXISTS /dev/full)
  foreach(option --list --help --version)
    halfspace_command_line_test(full${option} CODE 4 ARGUMENTS ${option}
      STDOUT_FILE /dev/full STDERR "standard output")
  endforeach()
  halfspace_command_line_test(full_run CODE 4 ARGUMENTS --details machine
    STDOUT_FILE /dev/full STDERR "standard output")
  halfspace_command_line_test(full_out CODE 4
    ARGUMENTS --details machine --out /dev/full STDERR "/dev/full: ")
endif()
halfspace_command_line_test(out CODE 0 ARGUMENTS --details machine
  OUT "^cpuinfo-bench [0-9.]+ --details machine.*; seed 1; [^\n]*\n[^\n]*\n\nmachine: ")
halfspace_command_line_test(out_of_a_failed_run CODE 3
  ARGUMENTS --details machine --mesh "${inputs}/none.obj"
  OUT "^what was there$")
halfspace_command_line_test(out_of_an_interrupted_run CODE 124
  BEFORE timeout 1 ARGUMENTS --details gate --objects 4096
  OUT "^what was there$")

# 32 GiB, where that cannot be had; the machine is told first.
file(STRINGS /proc/meminfo available REGEX "MemAvailable")
if(available MATCHES "([0-9]+) kB" AND CMAKE_MATCH_1 LESS 30000000)
  halfspace_command_line_test(too_many_objects CODE 2
    ARGUMENTS --objects 1073741824 STDERR "32768 MiB.*fewer --objects")
endif()
halfspace_command_line_test(objects_that_are_not_needed CODE 0
  ARGUMENTS --details machine --objects 1073741824)
if(NOT CMAKE_CROSSCOMPILING AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
  halfspace_command_line_test(no_memory_for_the_scene CODE 2
    BEFORE prlimit --as=200000000 ARGUMENTS --details quality --objects 8388608
    STDOUT "^$" STDERR "256 MiB.*fewer --objects")
  add_test(NAME cpuinfo-bench.little_memory
    COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/little_memory.sh" $<TARGET_FILE:cpuinfo-bench>)
  set_tests_properties(cpuinfo-bench.little_memory PROPERTIES LABELS tools)
endif()
halfspace_command_line_test(far_mesh CODE 3
  ARGUMENTS --details quality --mesh "${inputs}/far.obj" STDERR "Everything")
halfspace_command_line_test(far_bounds CODE 3
  ARGUMENTS --details quality --bounds "${inputs}/far.csv" STDERR "Everything")

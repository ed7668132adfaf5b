# cpuinfo-bench as its users call it: exit codes and messages, and its manuals.

foreach(group IN ITEMS messages runs)
  add_test(NAME cpuinfo-bench.${group}
    COMMAND /usr/bin/python3 "${CMAKE_CURRENT_SOURCE_DIR}/command_line_test.py" ${group}
            "${CMAKE_CURRENT_BINARY_DIR}/${group}"
            ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:cpuinfo-bench>)
endforeach()
add_test(NAME cpuinfo-bench.man_page
  COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/man_page.sh"
          "${PROJECT_SOURCE_DIR}/docs/cpuinfo-bench.1"
          ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:cpuinfo-bench>)
add_test(NAME cpuinfo-bench-report.man_page
  COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/man_page.sh"
          "${PROJECT_SOURCE_DIR}/docs/cpuinfo-bench-report.1"
          /usr/bin/python3 "${PROJECT_SOURCE_DIR}/bench/cpuinfo-bench-report")
set_tests_properties(cpuinfo-bench.messages cpuinfo-bench.runs
  cpuinfo-bench.man_page cpuinfo-bench-report.man_page
  PROPERTIES LABELS tools SKIP_RETURN_CODE 77)

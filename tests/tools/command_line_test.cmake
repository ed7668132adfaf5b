# Runs cpuinfo-bench and checks its exit code and what it printed:
#   cmake -DCOMMAND=<program and arguments, with |> -DEXPECTED_CODE=N
#         [-DSTDOUT=<regex>] [-DSTDERR=<regex>] -P command_line_test.cmake
cmake_policy(VERSION 3.25)

string(REPLACE "|" ";" command "${COMMAND}")
execute_process(COMMAND ${command} RESULT_VARIABLE code OUTPUT_VARIABLE out
                ERROR_VARIABLE err)
if(NOT code STREQUAL "${EXPECTED_CODE}")
  message(FATAL_ERROR "exit code ${code}, expected ${EXPECTED_CODE}\n"
                      "stdout: ${out}\nstderr: ${err}")
endif()
function(expect_match stream text expected)
  if(expected AND NOT text MATCHES "${expected}")
    message(FATAL_ERROR "${stream} does not match ${expected}:\n${text}")
  endif()
endfunction()
expect_match(stdout "${out}" "${STDOUT}")
expect_match(stderr "${err}" "${STDERR}")
# Progress is for terminals; a pipe gets none.
if(code STREQUAL "0" AND NOT err STREQUAL "")
  message(FATAL_ERROR "a successful run wrote to stderr:\n${err}")
endif()

# Runs cpuinfo-bench and checks its exit code and what it printed:
#   cmake -DCOMMAND=<program and arguments, with |> -DEXPECTED_CODE=<regex>
#         [-DSTDOUT=<regex>] [-DMOST_LINES=N] [-DSTDERR=<regex>]
#         [-DSTDOUT_FILE=<file>]
#         [-DOUT=<file of --out>] [-DEXPECTED_OUT=<regex>]
#         -P command_line_test.cmake
cmake_policy(VERSION 3.25)

# What a list cannot carry: an empty argument, and a control character.
string(REPLACE "|" ";" command "${COMMAND}")
string(ASCII 27 escape)
string(REPLACE "<ESC>" "${escape}" command "${command}")
set(arguments "")
foreach(argument IN LISTS command)
  if(argument STREQUAL "<EMPTY>")
    set(argument "")
  endif()
  string(APPEND arguments " [==[${argument}]==]")
endforeach()
if(OUT)
  file(WRITE "${OUT}" "what was there")
endif()
set(to_stdout OUTPUT_VARIABLE out)
if(STDOUT_FILE)
  set(to_stdout OUTPUT_FILE "${STDOUT_FILE}")
endif()
cmake_language(EVAL CODE "execute_process(COMMAND ${arguments}
  RESULT_VARIABLE code ERROR_VARIABLE err ${to_stdout})")
if(NOT code MATCHES "^(${EXPECTED_CODE})$")
  message(FATAL_ERROR "exit code ${code}, expected ${EXPECTED_CODE}\n"
                      "stdout: ${out}\nstderr: ${err}")
endif()
function(expect_match stream text expected)
  if(expected AND NOT text MATCHES "${expected}")
    message(FATAL_ERROR "${stream} does not match ${expected}:\n${text}")
  endif()
endfunction()
expect_match(stdout "${out}" "${STDOUT}")
string(REGEX MATCHALL "\n" ends "${out}")
list(LENGTH ends lines)
if(MOST_LINES AND lines GREATER MOST_LINES)
  message(FATAL_ERROR "${lines} lines, more than ${MOST_LINES}:\n${out}")
endif()
expect_match(stderr "${err}" "${STDERR}")
if(OUT)
  file(READ "${OUT}" written)
  expect_match("${OUT}" "${written}" "${EXPECTED_OUT}")
  file(GLOB parts "${OUT}.*")
  if(parts)
    message(FATAL_ERROR "left behind: ${parts}")
  endif()
endif()
# Without a terminal, a line for each section, and no escape sequences.
string(REGEX REPLACE "cpuinfo-bench: [a-z0-9]+ +[0-9]+ %(, [0-9:]+ left)?\n" ""
       err "${err}")
# An error of the tool's own is one line, whatever is in it.
if(code MATCHES "^[1-9]$" AND NOT err MATCHES "^cpuinfo-bench: [^\n${escape}]+\n$")
  message(FATAL_ERROR "not one line, of this program:\n${err}")
endif()
if(code STREQUAL "0" AND NOT err STREQUAL "")
  message(FATAL_ERROR "a successful run wrote to stderr:\n${err}")
endif()

# Compiles HEADER alone (twice in a row, as its guard allows) with COMPILER and
# the INCLUDES, in each language it is written in, and fails on any warning, or if
# Highway came along.

set(source "${OUTPUT}.cc")
set(dependencies "${OUTPUT}.d")
file(WRITE "${source}" "#include \"${HEADER}\"\n#include \"${HEADER}\"\n")
list(REMOVE_ITEM INCLUDES "")
list(TRANSFORM INCLUDES PREPEND "-I")

# What compiles alone as C++17, and as C++20 by halfspace.h, which includes all headers
# but these, compiles alone as C++20.
set(standards c++17)
if(HEADER MATCHES "^halfspace/(halfspace|error|c/.*)[.]h$")
  list(APPEND standards c++20)
endif()
if(HEADER MATCHES "^halfspace/c/")
  list(PREPEND standards c11 c++11)
endif()
foreach(standard IN LISTS standards)
  set(language c++)
  if(standard STREQUAL "c11")
    set(language c)
  endif()
  execute_process(
    COMMAND ${COMPILER} ${INCLUDES} -x ${language} "${source}" -std=${standard}
            -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Werror
            -fsyntax-only -MD -MF "${dependencies}"
    RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "${HEADER} does not compile alone as ${standard}")
  endif()
endforeach()

# As C++14 it compiles, or the compiler says what it needs and stops.
execute_process(
  COMMAND ${COMPILER} ${INCLUDES} "${source}" -std=c++14 -fsyntax-only
  RESULT_VARIABLE result ERROR_VARIABLE said)
string(REGEX MATCHALL "error: " errors "${said}")
list(LENGTH errors count)
if(result AND (NOT said MATCHES "halfspace needs C[+][+]17 or later" OR count GREATER 2))
  message(FATAL_ERROR "${HEADER}, compiled as C++14: ${said}")
endif()

file(READ "${dependencies}" files)
string(FIND "${files}" "${HEADER}" found)
if(found EQUAL -1)
  message(FATAL_ERROR "${dependencies} does not list ${HEADER} itself")
endif()
if(files MATCHES "[^ \n]*/hwy/[^ \n]*")
  message(FATAL_ERROR "${HEADER} includes Highway: ${CMAKE_MATCH_0}")
endif()

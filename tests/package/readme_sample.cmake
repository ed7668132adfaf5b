# The README's program in C++ is examples/quick_start.cc, which the tests compile and run.
# Each program of docs/porting.md, docs/design.md and docs/kernels.md is a part of an
# example. cmake -DROOT=<repository> -P readme_sample.cmake
cmake_policy(VERSION 3.25)

# check_page(<page> <fence> <example>...): each program of the page after the fence is a
# part of one of the examples. The last one is in `sample` then.
function(check_page name fence)
  file(READ "${ROOT}/${name}" page)
  set(examples "")
  foreach(file IN LISTS ARGN)
    file(READ "${ROOT}/examples/${file}" example)
    string(APPEND examples "${example}")
  endforeach()
  string(APPEND fence "\n")
  string(LENGTH "${fence}" length)
  set(samples 0)
  while(TRUE)
    string(FIND "${page}" "${fence}" begin)
    if(begin EQUAL -1)
      break()
    endif()
    math(EXPR begin "${begin} + ${length}")
    string(SUBSTRING "${page}" ${begin} -1 page)
    string(FIND "${page}" "```" end)
    string(SUBSTRING "${page}" 0 ${end} sample)
    string(FIND "${examples}" "${sample}" found)
    if(found EQUAL -1)
      message(FATAL_ERROR "This program of ${name} is not in ${ARGN}: "
                          "copy one to the other\n${sample}")
    endif()
    math(EXPR end "${end} + 3")
    string(SUBSTRING "${page}" ${end} -1 page)
    math(EXPR samples "${samples} + 1")
  endwhile()
  if(samples EQUAL 0)
    message(FATAL_ERROR "${name} has no program after ${fence}")
  endif()
  set(sample "${sample}" PARENT_SCOPE)
endfunction()
check_page(docs/porting.md "```cpp" porting.cc engines/jolt_broad_phase.h
           engines/box2d_dynamic_tree.cc)
check_page(docs/design.md "```cpp" porting.cc)
check_page(docs/kernels.md "```cpp" kernels.cc kernels_inline.cc culling.cc)
check_page(docs/kernels.md "```c" kernels.c)

# That of the README is the whole example but for its first line, which says what it is.
check_page(README.md "```cpp" quick_start.cc)
file(READ "${ROOT}/examples/quick_start.cc" example)
if(NOT example MATCHES "^// [^\n]*\n(.*)$" OR NOT sample STREQUAL CMAKE_MATCH_1)
  message(FATAL_ERROR "README.md's program is not examples/quick_start.cc: copy one to the other")
endif()

# The README's first program is examples/quick_start.cc, which the tests compile
# and run: cmake -DROOT=<repository> -P readme_sample.cmake
cmake_policy(VERSION 3.25)

file(READ "${ROOT}/README.md" readme)
file(READ "${ROOT}/examples/quick_start.cc" example)
string(FIND "${readme}" "```cpp\n" begin)
if(begin EQUAL -1)
  message(FATAL_ERROR "README.md has no C++ program")
endif()
math(EXPR begin "${begin} + 7")
string(SUBSTRING "${readme}" ${begin} -1 sample)
string(FIND "${sample}" "```" end)
string(SUBSTRING "${sample}" 0 ${end} sample)
# The file says what it is in its first line.
string(FIND "${example}" "\n" first_line)
math(EXPR first_line "${first_line} + 1")
string(SUBSTRING "${example}" ${first_line} -1 example)
if(NOT sample STREQUAL example)
  message(FATAL_ERROR "README.md's program is not examples/quick_start.cc: "
                      "copy one to the other")
endif()

# The README's first programs in C++ and in C are examples/quick_start.cc and .c, which
# the tests compile and run: cmake -DROOT=<repository> -P readme_sample.cmake
cmake_policy(VERSION 3.25)

file(READ "${ROOT}/README.md" readme)
foreach(language_and_file "cpp quick_start.cc" "c quick_start.c")
  separate_arguments(words UNIX_COMMAND "${language_and_file}")
  list(GET words 0 language)
  list(GET words 1 file)
  file(READ "${ROOT}/examples/${file}" example)
  set(fence "```${language}\n")
  string(FIND "${readme}" "${fence}" begin)
  if(begin EQUAL -1)
    message(FATAL_ERROR "README.md has no program after ```${language}")
  endif()
  string(LENGTH "${fence}" length)
  math(EXPR begin "${begin} + ${length}")
  string(SUBSTRING "${readme}" ${begin} -1 sample)
  string(FIND "${sample}" "```" end)
  string(SUBSTRING "${sample}" 0 ${end} sample)
  # The file says what it is in its first line.
  string(FIND "${example}" "\n" first_line)
  math(EXPR first_line "${first_line} + 1")
  string(SUBSTRING "${example}" ${first_line} -1 example)
  if(NOT sample STREQUAL example)
    message(FATAL_ERROR "README.md's program is not examples/${file}: "
                        "copy one to the other")
  endif()
endforeach()

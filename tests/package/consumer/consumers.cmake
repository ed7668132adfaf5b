# The same program with several flags. In C++17, which the library needs; its one file
# in C++20 is a library of its own.

function(add_consumer name library)
  add_library(${name}_cxx20 STATIC "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/cxx20.cc")
  set_target_properties(${name}_cxx20 PROPERTIES CXX_STANDARD 20)
  add_executable(${name} "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/main.cc")
  set_target_properties(${name} PROPERTIES CXX_STANDARD 17)
  target_link_libraries(${name} PRIVATE ${name}_cxx20)
  foreach(target IN ITEMS ${name}_cxx20 ${name})
    target_link_libraries(${target} PRIVATE ${library})
    target_compile_options(${target} PRIVATE -Wall -Wextra -Werror ${ARGN})
  endforeach()
  add_test(NAME ${name} COMMAND ${name})
endfunction()

# With flags that change the standard library's types, or how much of it is inlined:
# none of them may matter to the library.
function(add_consumers_of_other_flags library)
  add_consumer(no_exceptions_no_rtti ${library} -fno-exceptions -fno-rtti)
  add_consumer(debug_containers ${library} -O0 -D_GLIBCXX_DEBUG)
  add_consumer(assertions ${library} -O3 -D_GLIBCXX_ASSERTIONS)
  add_consumer(old_strings ${library} -O1 -D_GLIBCXX_USE_CXX11_ABI=0)
endfunction()

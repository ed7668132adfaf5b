# The same program with several flags. In C++17, which the library needs; its one file
# in C++20 is a library of its own.

function(add_consumer name library)
  if(NOT TARGET cxx20)
    add_library(cxx20 STATIC "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/cxx20.cc")
    set_target_properties(cxx20 PROPERTIES CXX_STANDARD 20)
    target_link_libraries(cxx20 PRIVATE ${library})
    target_compile_options(cxx20 PRIVATE -Wall -Wextra -Werror)
  endif()
  add_executable(${name} "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/main.cc")
  set_target_properties(${name} PROPERTIES CXX_STANDARD 17)
  target_link_libraries(${name} PRIVATE cxx20 ${library})
  target_compile_options(${name} PRIVATE -Wall -Wextra -Werror ${ARGN})
  add_test(NAME ${name} COMMAND ${name})
endfunction()

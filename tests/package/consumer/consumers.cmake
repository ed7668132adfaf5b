# The same program as it comes, and without exceptions and RTTI.

function(add_consumer name library)
  add_executable(${name} "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/main.cc")
  target_link_libraries(${name} PRIVATE ${library})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_compile_options(${name} PRIVATE -Wall -Wextra -Werror ${ARGN})
  add_test(NAME ${name} COMMAND ${name})
endfunction()

function(add_consumers library)
  add_consumer(usual_flags ${library})
  add_consumer(no_exceptions_no_rtti ${library} -fno-exceptions -fno-rtti)
endfunction()

# And with flags that change the standard library's types, or how much of it is
# inlined: none of them may matter to the library.
function(add_consumers_of_other_flags library)
  add_consumer(debug_containers ${library} -O0 -D_GLIBCXX_DEBUG)
  add_consumer(assertions ${library} -O3 -D_GLIBCXX_ASSERTIONS)
  add_consumer(old_strings ${library} -O1 -D_GLIBCXX_USE_CXX11_ABI=0)
endfunction()

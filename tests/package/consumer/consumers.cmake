# The same program twice: as it comes, and without exceptions and RTTI.

function(add_consumers library)
  set(program "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/main.cc")
  foreach(consumer usual_flags no_exceptions_no_rtti)
    add_executable(${consumer} "${program}")
    target_link_libraries(${consumer} PRIVATE ${library})
    target_compile_features(${consumer} PRIVATE cxx_std_20)
    target_compile_options(${consumer} PRIVATE -Wall -Wextra -Werror)
    add_test(NAME ${consumer} COMMAND ${consumer})
  endforeach()
  target_compile_options(no_exceptions_no_rtti
                         PRIVATE -fno-exceptions -fno-rtti)
endfunction()

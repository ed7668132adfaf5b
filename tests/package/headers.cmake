# Every public header compiles alone, as C++17 and as C++20, pedantically, without
# Highway. Those in its style (-inl.h) are compiled by an example.

set(public_includes "${PROJECT_SOURCE_DIR}/include")
file(GLOB_RECURSE public_headers CONFIGURE_DEPENDS
     RELATIVE "${public_includes}" "${public_includes}/*.h")
list(FILTER public_headers EXCLUDE REGEX "-inl[.]h$")

set(header_compiler "${CMAKE_CXX_COMPILER}")
if(CMAKE_CXX_COMPILER_TARGET)
  list(APPEND header_compiler "--target=${CMAKE_CXX_COMPILER_TARGET}")
endif()

function(add_header_test name header)
  add_test(NAME ${name}
    COMMAND ${CMAKE_COMMAND}
      "-DCOMPILER=${header_compiler}" "-DINCLUDES=${public_includes};${ARGN}"
      "-DHEADER=${header}" "-DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/${name}"
      -P "${CMAKE_CURRENT_SOURCE_DIR}/compile_header.cmake")
  set_tests_properties(${name} PROPERTIES LABELS package)
endfunction()

foreach(header IN LISTS public_headers)
  string(REPLACE "/" "." name "package.header.${header}")
  add_header_test(${name} "${header}")
endforeach()

# What it costs to include a header, in preprocessed lines. The limits are for the
# standard library of gcc 12: another version has other counts.
set(header_lines
  halfspace.h 30000
  kernels.h 1000
  reject.h 20000
  world.h 18000
  bvh.h 22000
  broad_phase.h 23000
  quantized.h 19000
  span.h 15000)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION MATCHES "^12\\.")
  while(header_lines)
    list(POP_FRONT header_lines header limit)
    set(name "package.header_lines.${header}")
    add_test(NAME ${name}
      COMMAND ${CMAKE_COMMAND}
        "-DCOMPILER=${header_compiler}" "-DINCLUDES=${public_includes}"
        "-DHEADER=halfspace/${header}" "-DLIMIT=${limit}"
        "-DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/${name}"
        -P "${CMAKE_CURRENT_SOURCE_DIR}/count_lines.cmake")
    set_tests_properties(${name} PROPERTIES LABELS package)
  endwhile()
endif()

# The text is gcc's and clang's.
add_test(NAME package.refused_types
  COMMAND ${CMAKE_COMMAND}
    "-DCOMPILER=${header_compiler}" "-DINCLUDES=${public_includes}"
    "-DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/refused_types"
    -P "${CMAKE_CURRENT_SOURCE_DIR}/refused.cmake")
set_tests_properties(package.refused_types PROPERTIES LABELS package)

# The check must see Highway where it is.
add_header_test(package.header.control highway_user.h
  "${CMAKE_CURRENT_SOURCE_DIR}/control"
  "${HALFSPACE_HIGHWAY_INCLUDE}")
set_tests_properties(package.header.control PROPERTIES
  PASS_REGULAR_EXPRESSION "highway_user.h includes Highway")

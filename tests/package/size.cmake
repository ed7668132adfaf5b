# How much code a program links: of a static release build by gcc for x86-64.

if(NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64" OR HALFSPACE_SHARED OR
   HALFSPACE_EXTRA_TARGETS OR NOT CMAKE_BUILD_TYPE STREQUAL "Release" OR
   NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  return()
endif()
find_program(HALFSPACE_SIZE size REQUIRED)

# Other arguments are those of check_size.sh.
function(add_size_test name file most)
  if(TARGET ${file})
    set(file $<TARGET_FILE:${file}>)
  endif()
  add_test(NAME package.size.${name}
    COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/check_size.sh"
            "${HALFSPACE_SIZE}" ${most} ${file} ${ARGN}
    COMMAND_EXPAND_LISTS)
  set_tests_properties(package.size.${name} PROPERTIES LABELS package)
endfunction()

if(HALFSPACE_C)
  # No other member of the library is in a folder of this name.
  set(c_objects "$<FILTER:$<TARGET_OBJECTS:halfspace>,INCLUDE,/c/[^/]*$>")
  add_size_test(archive halfspace 3190000 without ${c_objects})
  add_size_test(c ${c_objects} 158000)
else()
  add_size_test(archive halfspace 3190000)
endif()
# Builders and a scan of octahedra, and a broad phase with a query by a sphere.
if(TARGET example_quick_start)
  add_size_test(moving_body example_moving_body 500000)
  add_size_test(quick_start example_quick_start 820000)
endif()
# Box queries of a BVH, without its other searches.
if(TARGET example_many_boxes)
  add_size_test(many_boxes example_many_boxes 322000)
endif()
# One call of a scan; and one kernel in C, as which C++ calls it, and inline.
add_executable(one_call one_call.cc)
set(programs one_call)
if(TARGET hwy::hwy)
  add_executable(one_kernel_inline one_kernel_inline.cc)
  # foreach_target.h includes the file again.
  target_include_directories(one_kernel_inline PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}")
  target_link_libraries(one_kernel_inline PRIVATE hwy::hwy)
  list(APPEND programs one_kernel_inline)
endif()
foreach(program IN LISTS programs)
  target_link_libraries(${program} PRIVATE halfspace::halfspace)
  halfspace_configure_target(${program})
endforeach()
add_size_test(one_call one_call 250000)
if(TARGET example_kernels_c)
  add_size_test(one_kernel example_kernels_c 190000)
endif()
if(TARGET one_kernel_inline)
  add_size_test(one_kernel.inline one_kernel_inline 10000)
endif()
# The check must notice a program that is too large.
add_size_test(control one_call 1000)
set_tests_properties(package.size.control PROPERTIES WILL_FAIL ON)

# How much code a program links: what README promises of a static release build
# by gcc for x86-64.

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
  add_size_test(archive halfspace 3000000 without ${c_objects})
  add_size_test(c ${c_objects} 120000)
else()
  add_size_test(archive halfspace 3000000)
endif()
if(TARGET example_quick_start)
  add_size_test(quick_start example_quick_start 500000)
endif()
# Box queries of a BVH, without its other searches.
if(TARGET example_many_boxes)
  add_size_test(many_boxes example_many_boxes 260000)
endif()
foreach(program one_call one_kernel)
  add_executable(${program} ${program}.cc)
  target_link_libraries(${program} PRIVATE halfspace::halfspace)
  halfspace_configure_target(${program})
  add_size_test(${program} ${program} 250000)
endforeach()
# The check must notice a program that is too large.
add_size_test(control one_call 1000)
set_tests_properties(package.size.control PROPERTIES WILL_FAIL ON)

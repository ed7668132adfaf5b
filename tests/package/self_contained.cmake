# The static library stands alone: nothing of Highway's is linked.

if(HALFSPACE_SHARED)
  return()
endif()

set(check_self_contained sh
    "${CMAKE_CURRENT_SOURCE_DIR}/check_self_contained.sh" "${CMAKE_NM}"
    $<TARGET_FILE:halfspace>)
add_test(NAME package.self_contained COMMAND ${check_self_contained})
# The check must find something when it looks for what is there.
add_test(NAME package.self_contained.control
         COMMAND ${check_self_contained} everything)
set_tests_properties(package.self_contained.control PROPERTIES
  PASS_REGULAR_EXPRESSION "needed by .*halfspace::N_")
set_tests_properties(package.self_contained package.self_contained.control
  PROPERTIES LABELS package)

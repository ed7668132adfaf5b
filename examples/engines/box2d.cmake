# Builds Box2D's unit tests with box2d_dynamic_tree.cc. It changes no file of Box2D: CMake
# includes this file after Box2D's project(). The test example.engines.box2d does this:
#
#   cmake -S box2d -B build/box2d
#         -DCMAKE_PROJECT_box2d_INCLUDE=<halfspace>/examples/engines/box2d.cmake
#   cmake --build build/box2d --target test
#   build/box2d/bin/test
set(BOX2D_SAMPLES OFF)
set(HALFSPACE_DIMS 2 CACHE STRING "")
add_subdirectory("${CMAKE_CURRENT_LIST_DIR}/../.." halfspace EXCLUDE_FROM_ALL)

# The order of contacts is another one, so the test of determinism expects another hash. It
# is one hash for any number of threads.
function(use_box2d_dynamic_tree)
  get_target_property(sources box2d SOURCES)
  list(REMOVE_ITEM sources dynamic_tree.c)
  list(APPEND sources "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/box2d_dynamic_tree.cc")
  set_target_properties(box2d PROPERTIES SOURCES "${sources}" CXX_STANDARD 20)
  target_link_libraries(box2d PRIVATE "$<BUILD_INTERFACE:halfspace::halfspace>")

  file(READ test/test_determinism.c text)
  string(REPLACE "STEP 274\n#define EXPECTED_HASH 0xE86690F4"
                 "STEP 300\n#define EXPECTED_HASH 0x7CD3DAC9" text "${text}")
  file(CONFIGURE OUTPUT test_determinism.c CONTENT "${text}" @ONLY)
  get_target_property(sources test SOURCES)
  list(REMOVE_ITEM sources test_determinism.c)
  list(APPEND sources "${CMAKE_CURRENT_BINARY_DIR}/test_determinism.c")
  set_target_properties(test PROPERTIES SOURCES "${sources}")
  target_include_directories(test PRIVATE test)
endfunction()
cmake_language(DEFER CALL use_box2d_dynamic_tree)

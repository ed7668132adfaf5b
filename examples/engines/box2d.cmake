# Builds Box2D's unit tests with box2d_dynamic_tree.cc. It changes no file of Box2D: CMake
# includes this file after Box2D's project().
#
#   cmake -S box2d -B build/box2d -DBOX2D_SAMPLES=OFF
#         -DCMAKE_PROJECT_box2d_INCLUDE=<halfspace>/examples/engines/box2d.cmake
#   cmake --build build/box2d --target test
#   build/box2d/bin/test
set(HALFSPACE_DIMS 2 CACHE STRING "")
add_subdirectory("${CMAKE_CURRENT_LIST_DIR}/../.." halfspace EXCLUDE_FROM_ALL)

function(use_box2d_dynamic_tree)
  get_target_property(sources box2d SOURCES)
  list(REMOVE_ITEM sources dynamic_tree.c)
  set_target_properties(box2d PROPERTIES
    SOURCES "${sources};${CMAKE_CURRENT_FUNCTION_LIST_DIR}/box2d_dynamic_tree.cc" CXX_STANDARD 20)
  target_link_libraries(box2d PRIVATE halfspace::halfspace)
endfunction()
cmake_language(DEFER CALL use_box2d_dynamic_tree)

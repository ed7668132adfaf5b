# Builds Jolt's unit tests with jolt_broad_phase.h. It changes no file of Jolt: CMake includes
# this file after Jolt's project(). The test example.engines.jolt does this:
#
#   cmake -S JoltPhysics/Build -B build/jolt
#         -DCMAKE_PROJECT_JoltPhysics_INCLUDE=<halfspace>/examples/engines/jolt.cmake
#   cmake --build build/jolt --target UnitTests
#   build/jolt/UnitTests
set(TARGET_SAMPLES OFF)
set(TARGET_VIEWER OFF)
set(ENABLE_INSTALL OFF)
set(INTERPROCEDURAL_OPTIMIZATION OFF)
set(ENABLE_ALL_WARNINGS OFF)  # gcc 12 warns of Jolt's own code
set(HALFSPACE_DIMS 3 CACHE STRING "")
add_subdirectory("${CMAKE_CURRENT_LIST_DIR}/../.." halfspace EXCLUDE_FROM_ALL)

# PhysicsSystem.cpp names the broad phase in its #include and in `#define BROAD_PHASE`.
function(use_jolt_broad_phase)
  set(system Physics/PhysicsSystem.cpp)
  set(copy "${CMAKE_CURRENT_BINARY_DIR}/PhysicsSystem.cpp")
  get_target_property(sources Jolt SOURCES)
  set(original "${sources}")
  list(FILTER original INCLUDE REGEX "${system}$")
  file(READ "${original}" text)
  string(REPLACE "Jolt/Physics/Collision/BroadPhase/BroadPhaseQuadTree.h" "jolt_broad_phase.h"
         text "${text}")
  string(REPLACE "BROAD_PHASE BroadPhaseQuadTree" "BROAD_PHASE BroadPhaseHalfspace" text "${text}")
  file(CONFIGURE OUTPUT "${copy}" CONTENT "${text}" @ONLY)
  list(REMOVE_ITEM sources "${original}")
  set_target_properties(Jolt PROPERTIES SOURCES "${sources};${copy}")
  target_include_directories(Jolt PRIVATE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
  target_link_libraries(Jolt PRIVATE "$<BUILD_INTERFACE:halfspace::halfspace>")
endfunction()
cmake_language(DEFER CALL use_jolt_broad_phase)

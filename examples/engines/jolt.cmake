# Builds Jolt's unit tests with jolt_broad_phase.h. It changes no file of Jolt: CMake includes
# this file after Jolt's project().
#
#   cmake -S JoltPhysics/Build -B build/jolt -DTARGET_SAMPLES=OFF -DTARGET_VIEWER=OFF
#         -DCMAKE_PROJECT_JoltPhysics_INCLUDE=<halfspace>/examples/engines/jolt.cmake
#   cmake --build build/jolt --target UnitTests
#   build/jolt/UnitTests
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
  target_link_libraries(Jolt PRIVATE halfspace::halfspace)
endfunction()
cmake_language(DEFER CALL use_jolt_broad_phase)

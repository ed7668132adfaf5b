# The C API: functions over the C++ interface, in the same library.

foreach(dims 2 3)
  if(NOT dims IN_LIST HALFSPACE_DIMS)
    message(FATAL_ERROR
      "halfspace: HALFSPACE_C and HALFSPACE_PYTHON need 2 and 3 dimensions, and "
      "HALFSPACE_DIMS is \"${HALFSPACE_DIMS}\": pass -DHALFSPACE_DIMS=\"2;3\", or turn "
      "them off.")
  endif()
endforeach()
target_sources(halfspace
  PRIVATE
    c/bounds.cc
    c/broad_phase.cc
    c/builder.cc
    c/bvh.cc
    c/bvh_files.cc
    c/files.cc
    c/pair_events.cc
    c/queries.cc
    c/call.cc
    c/columns.cc
    c/scan.cc)
# As fast as with -O3, in four fifths of the code.
if(NOT MSVC AND NOT HALFSPACE_UNITY)
  set_property(SOURCE c/bounds.cc c/broad_phase.cc c/builder.cc c/bvh.cc c/bvh_files.cc c/files.cc
    c/pair_events.cc c/queries.cc c/call.cc c/columns.cc c/scan.cc
    APPEND PROPERTY COMPILE_OPTIONS $<$<CONFIG:Release>:-O2>)
endif()

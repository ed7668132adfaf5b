# The C API: functions over the C++ interface, in the same library.

foreach(dims 2 3)
  if(NOT dims IN_LIST HALFSPACE_DIMS)
    message(FATAL_ERROR
      "halfspace: HALFSPACE_C and HALFSPACE_PYTHON need 2 and 3 dimensions, and "
      "HALFSPACE_DIMS is \"${HALFSPACE_DIMS}\": pass -DHALFSPACE_DIMS=\"2;3\", or turn "
      "them off.")
  endif()
endforeach()
set(sources bounds broad_phase builder bvh bvh_files call columns files mesh pair_events
  pairs queries scan)
list(TRANSFORM sources REPLACE "(.+)" "c/\\1.cc")
target_sources(halfspace PRIVATE ${sources})
# As fast as with -O3, in four fifths of the code.
if(NOT MSVC AND NOT HALFSPACE_UNITY)
  set_property(SOURCE ${sources}
    APPEND PROPERTY COMPILE_OPTIONS $<$<CONFIG:Release>:-O2>)
endif()

# Highway: the system's package first, else a pinned release.
#
# By hand from a local checkout:
#   cmake -DCMAKE_DISABLE_FIND_PACKAGE_highway=ON \
#         -DFETCHCONTENT_SOURCE_DIR_HIGHWAY=<checkout of 1.4.0> ...

include(FetchContent)

# A subproject in our build must not bring its tests, nor install itself.
foreach(option TESTS EXAMPLES CONTRIB INSTALL)
  set(HWY_ENABLE_${option} OFF CACHE BOOL "" FORCE)
endforeach()

FetchContent_Declare(highway
  GIT_REPOSITORY https://github.com/google/highway.git
  GIT_TAG 2607d3b5b0113992fe84d3848859eae13b3b52c1  # 1.4.0
  FIND_PACKAGE_ARGS 1.0.3 NAMES hwy CONFIG)
FetchContent_MakeAvailable(highway)

if(highway_FOUND)
  set(HALFSPACE_BUNDLES_HIGHWAY OFF)
  message(STATUS "halfspace: Highway ${highway_VERSION} of the system; "
                 "the bundled release is skipped")
else()
  set(HALFSPACE_BUNDLES_HIGHWAY ON)
  set_target_properties(hwy PROPERTIES POSITION_INDEPENDENT_CODE ON)
  message(STATUS "halfspace: Highway is not installed; bundling 1.4.0")
endif()

# For every target that contains per-target code: all must see the same list of
# targets.
function(halfspace_use_highway target)
  if(HALFSPACE_ONLY_SCALAR)
    target_compile_definitions(${target} PRIVATE HWY_COMPILE_ONLY_SCALAR)
  else()
    # Every target the compiler can make, so that a test can run each of them.
    target_compile_definitions(${target} PRIVATE
      HWY_COMPILE_ALL_ATTAINABLE HWY_WANT_AVX3_DL)
  endif()
  if(HALFSPACE_BUNDLES_HIGHWAY)
    # Its objects become ours: one self-contained archive.
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:hwy>)
    get_target_property(type ${target} TYPE)
    if(type STREQUAL "STATIC_LIBRARY")
      target_sources(${target} PRIVATE $<TARGET_OBJECTS:hwy>)
    endif()
  else()
    target_link_libraries(${target} PRIVATE hwy::hwy)
  endif()
endfunction()

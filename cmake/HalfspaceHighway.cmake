# Highway: the system's package first, else a pinned release.
#
# By hand from a local checkout:
#   cmake -DFETCHCONTENT_SOURCE_DIR_HIGHWAY=<checkout of 1.4.0> ...

include(FetchContent)

FetchContent_Declare(highway
  GIT_REPOSITORY https://github.com/google/highway.git
  GIT_TAG 2607d3b5b0113992fe84d3848859eae13b3b52c1  # 1.4.0
  FIND_PACKAGE_ARGS 1.0.3 NAMES hwy CONFIG)

# A bundled Highway brings neither tests nor install rules, and is static. Its
# options are ordinary variables of this block, which the two policies make it
# honour: the cache belongs to the user and to other users of Highway.
block(PROPAGATE highway_VERSION)
  set(CMAKE_POLICY_DEFAULT_CMP0077 NEW)
  set(CMAKE_POLICY_DEFAULT_CMP0126 NEW)
  foreach(option TESTS EXAMPLES CONTRIB INSTALL)
    set(HWY_ENABLE_${option} OFF)
  endforeach()
  set(HWY_FORCE_STATIC_LIBS ON)
  set(BUILD_TESTING OFF)
  FetchContent_MakeAvailable(highway)
endblock()

if(TARGET hwy)
  set(HALFSPACE_BUNDLES_HIGHWAY ON)
  set_target_properties(hwy PROPERTIES
    POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)
  get_target_property(highway_sources hwy SOURCE_DIR)
  set_property(DIRECTORY "${highway_sources}" PROPERTY EXCLUDE_FROM_ALL ON)
  message(STATUS "halfspace: bundling Highway from ${highway_sources}")
else()
  set(HALFSPACE_BUNDLES_HIGHWAY OFF)
  message(STATUS "halfspace: Highway ${highway_VERSION} of the system; "
                 "the bundled release is skipped")
endif()

# Targets whose kernels are no faster than those of the next one below them, or
# that no machine of the last fifteen years needs. Each costs as much time and
# code as any other. Only names that this Highway knows may be disabled.
if(HALFSPACE_BUNDLES_HIGHWAY)
  set(HALFSPACE_HIGHWAY_INCLUDE "${highway_sources}")
else()
  get_target_property(HALFSPACE_HIGHWAY_INCLUDE
                      hwy::hwy INTERFACE_INCLUDE_DIRECTORIES)
endif()
list(GET HALFSPACE_HIGHWAY_INCLUDE 0 HALFSPACE_HIGHWAY_INCLUDE)
file(STRINGS "${HALFSPACE_HIGHWAY_INCLUDE}/hwy/detect_targets.h" known_targets
     REGEX "^#define HWY_[A-Z0-9_]+ \\(1LL")
set(HALFSPACE_DISABLED_TARGETS "")
foreach(name SSE2 SSSE3 AVX3_DL AVX3_ZEN4 AVX3_SPR AVX10_2 NEON_BF16)
  if(known_targets MATCHES "HWY_${name} ")
    list(APPEND HALFSPACE_DISABLED_TARGETS "HWY_${name}")
  endif()
endforeach()
list(JOIN HALFSPACE_DISABLED_TARGETS "|" HALFSPACE_DISABLED_TARGETS)

# For every target that contains per-target code: all must see the same list of
# targets.
function(halfspace_use_highway target)
  if(HALFSPACE_ONLY_SCALAR)
    target_compile_definitions(${target} PRIVATE HWY_COMPILE_ONLY_SCALAR)
  elseif(HALFSPACE_EXTRA_TARGETS)
    target_compile_definitions(${target} PRIVATE
      HWY_COMPILE_ALL_ATTAINABLE HWY_WANT_AVX3_DL)
  else()
    # Every other target the compiler can make, so that a test can run each.
    target_compile_definitions(${target} PRIVATE HWY_COMPILE_ALL_ATTAINABLE
      "HWY_DISABLED_TARGETS=(${HALFSPACE_DISABLED_TARGETS})")
  endif()
  if(HALFSPACE_BUNDLES_HIGHWAY)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:hwy>)
  else()
    target_link_libraries(${target} PRIVATE hwy::hwy)
  endif()
endfunction()

# For a static library that is installed: the objects of a bundled Highway
# become its own, and make it one self-contained archive.
function(halfspace_embed_highway target)
  if(HALFSPACE_BUNDLES_HIGHWAY)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:hwy>)
  endif()
endfunction()

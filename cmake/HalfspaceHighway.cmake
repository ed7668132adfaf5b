# Highway, of which only the headers are used: the system's package first, else a
# pinned release. Its library would be one more thing to link and to match, and
# costs a process milliseconds at its start.
#
# By hand from a local checkout:
#   cmake -DFETCHCONTENT_SOURCE_DIR_HIGHWAY=<checkout of 1.4.0> ...

include(FetchContent)

# A source archive has the headers (packaging/source_archive.py).
set(packed "${CMAKE_CURRENT_LIST_DIR}/../third_party/highway")
if(NOT FETCHCONTENT_SOURCE_DIR_HIGHWAY AND EXISTS "${packed}/hwy/highway.h")
  set(FETCHCONTENT_SOURCE_DIR_HIGHWAY "${packed}")
endif()

set(highway_repository https://github.com/google/highway.git)
# With FIND_PACKAGE_ARGS, a declaration of the project around this one counts first.
set(of_the_system)
if(NOT CMAKE_VERSION VERSION_LESS 3.24)
  set(of_the_system FIND_PACKAGE_ARGS 1.0.3 NAMES hwy CONFIG)
endif()
FetchContent_Declare(highway
  GIT_REPOSITORY ${highway_repository}
  GIT_TAG 2607d3b5b0113992fe84d3848859eae13b3b52c1  # 1.4.0
  SOURCE_SUBDIR none  # a folder without CMakeLists.txt, so that nothing is built
  ${of_the_system})

function(halfspace_stop_without_highway why)
  message(FATAL_ERROR
    "halfspace needs the headers of Highway 1.0.3 or later.\n"
    "  ${why}\n"
    "Do one of these:\n"
    "  - install it: libhwy-dev on Debian and Ubuntu, highway of brew and vcpkg\n"
    "  - add -DFETCHCONTENT_SOURCE_DIR_HIGHWAY=<checkout of Highway 1.4.0>")
endfunction()

# A download that fails ends in errors of CMake's own, which name no package.
FetchContent_GetProperties(highway)
if(NOT highway_POPULATED AND NOT FETCHCONTENT_SOURCE_DIR_HIGHWAY)
  find_package(highway 1.0.3 QUIET NAMES hwy CONFIG)
  if(NOT highway_FOUND AND
     NOT EXISTS "${FETCHCONTENT_BASE_DIR}/highway-src/hwy/highway.h")
    set(found "It is not installed")
    if(highway_CONSIDERED_VERSIONS)
      set(found "Only ${highway_CONSIDERED_VERSIONS} is installed")
    endif()
    find_package(Git QUIET)
    if(NOT Git_FOUND)
      halfspace_stop_without_highway(
        "${found}, and there is no git to download it with.")
    endif()
    execute_process(COMMAND "${GIT_EXECUTABLE}" ls-remote ${highway_repository} HEAD
                    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE error)
    if(failed)
      string(STRIP "${error}" error)
      halfspace_stop_without_highway(
        "${found}, and git cannot download it: ${error}")
    endif()
  endif()
endif()

if(of_the_system OR NOT highway_FOUND)
  FetchContent_MakeAvailable(highway)
endif()

if(highway_SOURCE_DIR)
  set(HALFSPACE_BUNDLES_HIGHWAY ON)
  set(HALFSPACE_HIGHWAY_INCLUDE "${highway_SOURCE_DIR}")
  message(STATUS "halfspace: Highway's headers from ${highway_SOURCE_DIR}")
else()
  set(HALFSPACE_BUNDLES_HIGHWAY OFF)
  get_target_property(HALFSPACE_HIGHWAY_INCLUDE
                      hwy::hwy INTERFACE_INCLUDE_DIRECTORIES)
  list(GET HALFSPACE_HIGHWAY_INCLUDE 0 HALFSPACE_HIGHWAY_INCLUDE)
  message(STATUS "halfspace: Highway ${highway_VERSION} of the system; "
                 "the bundled release is skipped")
endif()

if(NOT EXISTS "${HALFSPACE_HIGHWAY_INCLUDE}/hwy/highway.h")
  halfspace_stop_without_highway(
    "There is no hwy/highway.h in ${HALFSPACE_HIGHWAY_INCLUDE}.")
endif()

# Left out: targets whose kernels are no faster than those of the next one below
# them, or that no machine of the last fifteen years needs, as each costs as much
# time and code as any other; and those in HALFSPACE_LEAVE_OUT_TARGETS. With
# HALFSPACE_EXTRA_TARGETS none is. Only names that this Highway knows may be
# disabled.
set(HALFSPACE_LEAVE_OUT_TARGETS "" CACHE STRING
    "Targets not to compile besides, as in SSE4;AVX2")
file(STRINGS "${HALFSPACE_HIGHWAY_INCLUDE}/hwy/detect_targets.h" known_targets
     REGEX "^#define HWY_[A-Z0-9_]+ \\(1LL")
set(left_out SSE2 SSSE3 AVX3_DL AVX3_ZEN4 AVX3_SPR AVX10_2 NEON_BF16)
# NEON of 32-bit ARM flushes subnormals in every mode, so a bound might not enclose its
# shape. It has no doubles either.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(arm|aarch64)" AND CMAKE_SIZEOF_VOID_P EQUAL 4)
  list(APPEND left_out NEON NEON_WITHOUT_AES)
endif()
set(HALFSPACE_DISABLED_TARGETS "")
foreach(name ${left_out} ${HALFSPACE_LEAVE_OUT_TARGETS})
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
  # Highway's assertions, in debug builds, are functions of its library. And on x86 its SSE4
  # and AVX2 need AES and PCLMULQDQ, which no kernel uses and virtual machines may mask.
  target_compile_definitions(${target} PRIVATE
    HWY_IS_DEBUG_BUILD=0 HWY_DISABLE_PCLMUL_AES)
  target_include_directories(${target} SYSTEM
                             PRIVATE "${HALFSPACE_HIGHWAY_INCLUDE}")
endfunction()

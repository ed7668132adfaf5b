# Consumers of the library, built and run in every way there is to get at it:
# an installed tree that was moved, static and shared, by find_package and by
# pkg-config; and the sources as a subproject.

if(NOT HALFSPACE_INSTALL)
  message(STATUS "halfspace: no tests of consumers without HALFSPACE_INSTALL")
  return()
endif()
include(GNUInstallDirs)
find_program(HALFSPACE_PKG_CONFIG NAMES pkg-config pkgconf)
if(NOT HALFSPACE_PKG_CONFIG)
  message(STATUS "halfspace: no tests of the pkg-config file, as there is no "
                 "pkg-config here")
endif()

# How this build was configured, for builds inside the tests.
set(nested_options
  "-DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}"
  "-DCMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS}")
if(CMAKE_TOOLCHAIN_FILE)
  # A preset names it relative to these sources, which a build of others is not in.
  get_filename_component(toolchain "${CMAKE_TOOLCHAIN_FILE}" ABSOLUTE
    BASE_DIR "${CMAKE_SOURCE_DIR}")
  list(APPEND nested_options "-DCMAKE_TOOLCHAIN_FILE=${toolchain}")
else()
  list(APPEND nested_options "-DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}")
endif()
# The library once more, as quickly as it can be had: its code is tested
# elsewhere.
set(nested_library_options
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DHALFSPACE_ONLY_SCALAR=ON
  -DHALFSPACE_UNITY=ON
  "-DHALFSPACE_WERROR=${HALFSPACE_WERROR}")
if(HALFSPACE_BUNDLES_HIGHWAY)
  list(APPEND nested_library_options
    "-DFETCHCONTENT_SOURCE_DIR_HIGHWAY=${HALFSPACE_HIGHWAY_INCLUDE}")
endif()

set(nested_ctest ${CMAKE_CTEST_COMMAND} --output-on-failure --no-tests=error)

# Configures and builds `source`, or TARGET in it, in a directory of its own, then
# runs COMMAND. Afresh: what an earlier run found must not hide what is missing now.
function(add_nested_build_test name source)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "TARGET" "OPTIONS;COMMAND")
  set(target "")
  if(arg_TARGET)
    set(target --build-target "${arg_TARGET}")
  endif()
  add_test(NAME ${name}
    COMMAND ${CMAKE_CTEST_COMMAND}
      --build-and-test "${source}" "${CMAKE_CURRENT_BINARY_DIR}/${name}"
      --build-generator "${CMAKE_GENERATOR}" ${target}
      --build-options --fresh ${nested_options} ${arg_OPTIONS}
      --test-command ${arg_COMMAND})
  set_tests_properties(${name} PROPERTIES LABELS package)
endfunction()

# Consumers of the tree at `prefix`, which fixture `tree` leaves there. None needs
# a Highway. Other arguments are options of the consumer that find_package() serves.
function(add_consumer_tests tree prefix)
  add_nested_build_test(${tree}.find_package
    "${CMAKE_CURRENT_SOURCE_DIR}/consumer"
    OPTIONS "-DCMAKE_PREFIX_PATH=${prefix}" -DCMAKE_DISABLE_FIND_PACKAGE_hwy=ON
      "-DCONSUMER_C=${HALFSPACE_C}" ${ARGN}
    COMMAND ${nested_ctest})
  set_tests_properties(${tree}.find_package PROPERTIES
    FIXTURES_REQUIRED ${tree})
  if(HALFSPACE_PKG_CONFIG)
    add_nested_build_test(${tree}.pkg_config
      "${CMAKE_CURRENT_SOURCE_DIR}/consumer"
      OPTIONS "-DCONSUMER_PKG_CONFIG=${prefix}/${CMAKE_INSTALL_LIBDIR}/pkgconfig"
        "-DCONSUMER_C=${HALFSPACE_C}"
      COMMAND ${nested_ctest})
    set_tests_properties(${tree}.pkg_config PROPERTIES
      FIXTURES_REQUIRED ${tree})
  endif()
endfunction()

# The command that installs `build`, and moves what it installed to `prefix`.
function(install_command result build prefix)
  set(${result}
    ${CMAKE_COMMAND} "-DBUILD=${build}" "-DPREFIX=${prefix}"
    "-DHEADERS=${PROJECT_SOURCE_DIR}/include" "-DPAGES=${CMAKE_INSTALL_DOCDIR}"
    "-DHAS_C=${HALFSPACE_C}"
    -P "${CMAKE_CURRENT_SOURCE_DIR}/install_and_move.cmake" PARENT_SCOPE)
endfunction()

# This very build.
set(prefix "${CMAKE_CURRENT_BINARY_DIR}/installed")
install_command(install "${PROJECT_BINARY_DIR}" "${prefix}")
add_test(NAME package.install COMMAND ${install})
set_tests_properties(package.install PROPERTIES
  LABELS package FIXTURES_SETUP package.installed)
add_consumer_tests(package.installed "${prefix}" -DCONSUMER_OTHER_FLAGS=ON)

# Its shared sibling, built by the README's lines.
set(folder "${CMAKE_CURRENT_BINARY_DIR}/readme")
set(expected "body 1 is near\nobject 0 may be touched")
if(CMAKE_CROSSCOMPILING OR NOT HALFSPACE_C)
  set(expected "")  # The lines compile the programs for this machine, one of them in C.
endif()
add_test(NAME package.readme
  COMMAND bash "${CMAKE_CURRENT_SOURCE_DIR}/run_readme_lines.sh" c++
    "${PROJECT_SOURCE_DIR}" "${folder}" "${expected}"
    --fresh -G "${CMAKE_GENERATOR}" ${nested_options} ${nested_library_options}
    -DHALFSPACE_SHARED=ON "-DHALFSPACE_C=${HALFSPACE_C}")
set_tests_properties(package.readme PROPERTIES
  LABELS package FIXTURES_SETUP package.readme)
set(prefix "${CMAKE_CURRENT_BINARY_DIR}/shared")
install_command(install "${folder}/build" "${prefix}")
add_test(NAME package.install_shared COMMAND ${install})
set_tests_properties(package.install_shared PROPERTIES
  LABELS package FIXTURES_REQUIRED package.readme FIXTURES_SETUP package.shared)
add_consumer_tests(package.shared "${prefix}")
# This build has no SIMD, so it refuses the name of a target that has. The program aborts,
# which ctest would not forgive without `cmake -E`.
add_test(NAME package.shared.without_simd
  COMMAND ${CMAKE_COMMAND} -E env HALFSPACE_TARGET=AVX2 ${CMAKE_CROSSCOMPILING_EMULATOR}
    "${CMAKE_CURRENT_BINARY_DIR}/package.shared.find_package/usual_flags")
set_tests_properties(package.shared.find_package PROPERTIES
  FIXTURES_SETUP package.shared.program)
set_tests_properties(package.shared.without_simd PROPERTIES
  LABELS package FIXTURES_REQUIRED package.shared.program
  PASS_REGULAR_EXPRESSION "HALFSPACE_TARGET.*expected one of (SCALAR|EMU128), got .AVX2")

set(shared_library "${prefix}/${CMAKE_INSTALL_LIBDIR}/libhalfspace.so")
# The interface, and nothing but what is listed. Another compiler, or one for another
# machine, may export more of the interface, such as destructors that gcc inlines.
find_program(HALFSPACE_CXXFILT c++filt REQUIRED)
set(more accept_more)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND
   CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  set(more refuse_more)
endif()
set(c without_c)
if(HALFSPACE_C)
  set(c with_c)
endif()
function(add_symbols_test name list)
  add_test(NAME ${name}
    COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/check_symbols.sh" "${CMAKE_NM}"
            "${HALFSPACE_CXXFILT}" "${CMAKE_READELF}" "${shared_library}" "${list}"
            ${more} ${c})
endfunction()
add_symbols_test(package.shared.symbols "${CMAKE_CURRENT_SOURCE_DIR}/symbols.txt")
# The check must notice a symbol that is gone, and one that is new.
set(other_list "${CMAKE_CURRENT_BINARY_DIR}/other_symbols.txt")
file(WRITE "${other_list}" "halfspace::Gone()\n")
add_symbols_test(package.shared.symbols.control "${other_list}")
set(noticed "not exported: halfspace::Gone")
if(more STREQUAL "refuse_more")
  string(APPEND noticed ".*not listed: SONAME libhalfspace.*not listed: halfspace::")
endif()
set_tests_properties(package.shared.symbols.control PROPERTIES
  PASS_REGULAR_EXPRESSION "${noticed}")
set_tests_properties(package.shared.symbols package.shared.symbols.control
  PROPERTIES LABELS package FIXTURES_REQUIRED package.shared)

# A project that includes the sources. The README's lines build it.
add_nested_build_test(package.subproject
  "${CMAKE_CURRENT_SOURCE_DIR}/subproject"
  OPTIONS ${nested_library_options} "-DHALFSPACE_SOURCES=${PROJECT_SOURCE_DIR}"
  TARGET help
  COMMAND ${nested_ctest})

# Without an option there is only the library, which needs nothing but Highway.
set(nothing_else "")
foreach(package benchmark CLI11 GTest nlohmann_json Threads)
  list(APPEND nothing_else -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
add_nested_build_test(package.alone "${PROJECT_SOURCE_DIR}"
  OPTIONS ${nested_library_options} ${nothing_else}
  TARGET help
  COMMAND ${CMAKE_COMMAND} -N -L .)
set_tests_properties(package.alone PROPERTIES
  PASS_REGULAR_EXPRESSION "HALFSPACE_C:BOOL=ON"
  FAIL_REGULAR_EXPRESSION "cpuinfo-bench|example_quick_start|hash_test")
# The C API is in it, unless it lacks a dimension that the C API needs.
add_nested_build_test(package.alone_3d "${PROJECT_SOURCE_DIR}"
  OPTIONS ${nested_library_options} -DHALFSPACE_DIMS=3
  TARGET help
  COMMAND ${CMAKE_COMMAND} -N -L .)
set_tests_properties(package.alone_3d PROPERTIES
  PASS_REGULAR_EXPRESSION "HALFSPACE_C:BOOL=OFF")

# Folders of the installation that are absolute. CMake refuses one for headers in the
# sources; nothing is written there.
set(folder "${CMAKE_CURRENT_BINARY_DIR}/absolute")
add_nested_build_test(package.absolute_folders "${PROJECT_SOURCE_DIR}"
  OPTIONS ${nested_library_options} "-DHALFSPACE_BUILD_TOOLS=${HALFSPACE_BUILD_TOOLS}"
    -DHALFSPACE_BENCH_COMPETITORS=OFF -DCMAKE_SKIP_RPATH=ON
    "-DCMAKE_INSTALL_BINDIR=${folder}/bin" "-DCMAKE_INSTALL_LIBDIR=${folder}/lib"
    -DCMAKE_INSTALL_INCLUDEDIR=/opt/halfspace/include
    "-DCMAKE_INSTALL_MANDIR=${folder}/man"
  TARGET help
  COMMAND ${CMAKE_COMMAND} "-DFOLDER=${folder}" "-DPKG_CONFIG=${HALFSPACE_PKG_CONFIG}"
    "-DHAS_TOOL=${HALFSPACE_BUILD_TOOLS}"
    -P "${CMAKE_CURRENT_SOURCE_DIR}/absolute_folders.cmake")

# Without Highway either, the error says what to install.
add_nested_build_test(package.without_highway "${PROJECT_SOURCE_DIR}"
  OPTIONS -DCMAKE_DISABLE_FIND_PACKAGE_highway=ON
    -DCMAKE_DISABLE_FIND_PACKAGE_Git=ON
  COMMAND ${CMAKE_COMMAND} -E true)
set_tests_properties(package.without_highway PROPERTIES
  PASS_REGULAR_EXPRESSION "not installed, and there is no git.*libhwy-dev")

# Nor are others of CMake's own messages the last word.
add_nested_build_test(package.without_gtest "${PROJECT_SOURCE_DIR}"
  OPTIONS ${nested_library_options} -DHALFSPACE_BUILD_TESTS=ON
    -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON
  COMMAND ${CMAKE_COMMAND} -E true)
set_tests_properties(package.without_gtest PROPERTIES
  PASS_REGULAR_EXPRESSION "HALFSPACE_BUILD_TESTS needs GTest.*libgtest-dev")
add_test(NAME package.without_ninja
  COMMAND ${CMAKE_COMMAND} -E env --unset=CMAKE_MAKE_PROGRAM PATH=/nonexistent
    ${CMAKE_COMMAND} --preset release -B "${CMAKE_CURRENT_BINARY_DIR}/without_ninja"
  WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
set_tests_properties(package.without_ninja PROPERTIES LABELS package
  PASS_REGULAR_EXPRESSION "halfspace: .* Ninja.*apt install ninja-build")

# A project in C that enables no C++.
add_nested_build_test(package.c_only.subproject "${CMAKE_CURRENT_SOURCE_DIR}/c_only"
  OPTIONS ${nested_library_options} "-DHALFSPACE_SOURCES=${PROJECT_SOURCE_DIR}"
  COMMAND ${CMAKE_COMMAND} -E true)
set_tests_properties(package.c_only.subproject PROPERTIES
  PASS_REGULAR_EXPRESSION "has to enable C\\+\\+.*LANGUAGES C CXX")
# Of the static library, which needs the C++ runtime. `consumer` links the shared one
# in C.
if(HALFSPACE_C)
  add_nested_build_test(package.installed.c_only "${CMAKE_CURRENT_SOURCE_DIR}/c_only"
    OPTIONS "-DCMAKE_PREFIX_PATH=${CMAKE_CURRENT_BINARY_DIR}/installed"
    COMMAND ${CMAKE_CROSSCOMPILING_EMULATOR} ./in_c)
  set_tests_properties(package.installed.c_only PROPERTIES
    FIXTURES_REQUIRED package.installed)
endif()

add_test(NAME package.scripts
  COMMAND bash "${CMAKE_CURRENT_SOURCE_DIR}/scripts.sh" "${PROJECT_SOURCE_DIR}")
set_tests_properties(package.scripts PROPERTIES LABELS package)

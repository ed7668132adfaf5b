# cpuinfo-bench as part of an installation, and `cpack`: one relocatable tarball
# per architecture, to unpack and run on a machine that has nothing but glibc, or
# Debian packages.

foreach(name BINDIR DOCDIR LIBDIR MANDIR)
  halfspace_folder_in(HALFSPACE_INSTALL_${name} "\${CMAKE_INSTALL_PREFIX}" ${name})
endforeach()

if(TARGET cpuinfo-bench)
  # Whoever built the library alone installs it alone.
  install(TARGETS cpuinfo-bench OPTIONAL COMPONENT halfspace_tools)
  install(CODE "if(EXISTS \"$<TARGET_FILE:cpuinfo-bench>\")
  file(INSTALL \"${PROJECT_SOURCE_DIR}/docs/cpuinfo-bench.1\"
       \"${PROJECT_SOURCE_DIR}/docs/cpuinfo-bench-report.1\"
       DESTINATION \"${HALFSPACE_INSTALL_MANDIR}/man1\")
  file(INSTALL \"${PROJECT_SOURCE_DIR}/bench/cpuinfo-bench-report\"
       DESTINATION \"${HALFSPACE_INSTALL_BINDIR}\"
       USE_SOURCE_PERMISSIONS)
endif()" COMPONENT halfspace_tools)

  # What is compiled into it, by a header of each library.
  set(HALFSPACE_LICENSED_HEADERS
    "*/include/benchmark/benchmark.h" "*/include/CLI/CLI.hpp"
    "*/include/nlohmann/json.hpp")
  if(NOT HALFSPACE_BUNDLES_HIGHWAY)
    list(APPEND HALFSPACE_LICENSED_HEADERS "*/include/hwy/highway.h")
  endif()
  set(header_of_BOOST boost/version.hpp)
  set(header_of_BOX2D box2d/box2d.h)
  set(header_of_BULLET bullet/btBulletCollisionCommon.h)
  set(header_of_EMBREE embree3/rtcore.h)
  set(header_of_FCL fcl/fcl.h eigen3/Eigen/Core)
  get_property(competitors GLOBAL PROPERTY HALFSPACE_BENCH_COMPETITORS_BUILT)
  foreach(name IN LISTS competitors)
    if(NOT DEFINED header_of_${name})
      message(FATAL_ERROR "halfspace: a package would lack the licence of the "
        "competitor ${name}: name a header of it in ${CMAKE_CURRENT_LIST_FILE}")
    endif()
    list(TRANSFORM header_of_${name} PREPEND "*/include/")
    list(APPEND HALFSPACE_LICENSED_HEADERS ${header_of_${name}})
  endforeach()
endif()

if(HALFSPACE_DEBIAN)
  include(HalfspaceDebian)
  return()
endif()

# Windows looks for libraries beside a program, and there all but the DLL are static.
if(TARGET cpuinfo-bench AND NOT WIN32)
  # RPATH, not RUNPATH, so that the libraries beside it find each other too.
  file(RELATIVE_PATH bin_to_libraries "${CMAKE_INSTALL_FULL_BINDIR}"
       "${CMAKE_INSTALL_FULL_LIBDIR}/halfspace")
  set_target_properties(cpuinfo-bench PROPERTIES
    INSTALL_RPATH "$ORIGIN/${bin_to_libraries}")
  target_link_options(cpuinfo-bench PRIVATE
    $<$<PLATFORM_ID:Linux>:LINKER:--disable-new-dtags>)

  list(TRANSFORM HALFSPACE_LICENSED_HEADERS REPLACE "(.+)" "\"\\1\"")
  list(JOIN HALFSPACE_LICENSED_HEADERS " " HALFSPACE_LICENSED_HEADERS)

  # Only the tarball carries libraries; an installation uses the system's.
  configure_file("${CMAKE_CURRENT_LIST_DIR}/HalfspaceBundle.cmake.in"
                 HalfspaceBundle.cmake.in @ONLY)
  file(GENERATE OUTPUT HalfspaceBundle.cmake
       INPUT "${CMAKE_CURRENT_BINARY_DIR}/HalfspaceBundle.cmake.in")
  install(SCRIPT "${CMAKE_CURRENT_BINARY_DIR}/HalfspaceBundle.cmake"
          COMPONENT bundle EXCLUDE_FROM_ALL)
endif()

# The DLL has the runtime of gcc in it, and Highway's code.
if(MINGW AND CMAKE_CROSSCOMPILING)
  list(APPEND HALFSPACE_LICENSED_HEADERS "*/include/hwy/highway.h" "*-posix/libstdc++.a"
       "*/x86_64-w64-mingw32/lib/libwinpthread.a")
  install(CODE "include(\"${CMAKE_CURRENT_LIST_DIR}/HalfspaceLicences.cmake\")
set(files \"${HALFSPACE_LICENSED_HEADERS}\")
halfspace_install_licences(\"${HALFSPACE_INSTALL_DOCDIR}/licences\" \${files})"
    COMPONENT bundle EXCLUDE_FROM_ALL)
endif()

string(TOLOWER "${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}" system)
set(CPACK_GENERATOR TGZ)
if(WIN32)
  set(CPACK_GENERATOR ZIP)
endif()
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_FILE_NAME "${PROJECT_NAME}-${PROJECT_VERSION}-${system}")
set(CPACK_INSTALL_CMAKE_PROJECTS
    "${CMAKE_BINARY_DIR}" "${PROJECT_NAME}" ALL /)
if(TARGET cpuinfo-bench OR (MINGW AND CMAKE_CROSSCOMPILING))
  list(APPEND CPACK_INSTALL_CMAKE_PROJECTS
       "${CMAKE_BINARY_DIR}" "${PROJECT_NAME}" bundle /)
endif()
include(CPack)

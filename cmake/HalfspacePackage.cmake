# cpuinfo-bench as part of an installation, and `cpack`: one relocatable tarball
# per architecture, to unpack and run on a machine that has nothing but glibc.

if(TARGET cpuinfo-bench)
  # RPATH, not RUNPATH, so that the libraries beside it find each other too.
  file(RELATIVE_PATH bin_to_libraries "/${CMAKE_INSTALL_BINDIR}"
       "/${CMAKE_INSTALL_LIBDIR}/halfspace")
  set_target_properties(cpuinfo-bench PROPERTIES
    INSTALL_RPATH "$ORIGIN/${bin_to_libraries}")
  target_link_options(cpuinfo-bench PRIVATE
    $<$<PLATFORM_ID:Linux>:LINKER:--disable-new-dtags>)
  # Whoever built the library alone installs it alone.
  install(TARGETS cpuinfo-bench OPTIONAL)

  # Only the tarball carries libraries; an installation uses the system's.
  configure_file("${CMAKE_CURRENT_LIST_DIR}/HalfspaceBundle.cmake.in"
                 HalfspaceBundle.cmake.in @ONLY)
  file(GENERATE OUTPUT HalfspaceBundle.cmake
       INPUT "${CMAKE_CURRENT_BINARY_DIR}/HalfspaceBundle.cmake.in")
  install(SCRIPT "${CMAKE_CURRENT_BINARY_DIR}/HalfspaceBundle.cmake"
          COMPONENT bundle EXCLUDE_FROM_ALL)
endif()

string(TOLOWER "${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}" system)
set(CPACK_GENERATOR TGZ)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_FILE_NAME "${PROJECT_NAME}-${PROJECT_VERSION}-${system}")
set(CPACK_INSTALL_CMAKE_PROJECTS
    "${CMAKE_BINARY_DIR}" "${PROJECT_NAME}" ALL /)
if(TARGET cpuinfo-bench)
  list(APPEND CPACK_INSTALL_CMAKE_PROJECTS
       "${CMAKE_BINARY_DIR}" "${PROJECT_NAME}" bundle /)
endif()
include(CPack)

# What `cmake --install` installs: the library, its headers and pages, the packages
# for CMake and pkg-config, and cpuinfo-bench if it was built. The tree can be
# moved. Each Debian package is a component (HalfspaceDebian.cmake).

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# halfspace_folder_in(<result> <prefix> <name>): the folder CMAKE_INSTALL_<name>, which
# is absolute or in the prefix.
function(halfspace_folder_in result prefix name)
  cmake_path(APPEND prefix "${CMAKE_INSTALL_${name}}" OUTPUT_VARIABLE folder)
  set(${result} "${folder}" PARENT_SCOPE)
endfunction()

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/halfspace")

# What a C compiler does not link by itself, and the static library needs.
set(HALFSPACE_CXX_RUNTIME "${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES}")
list(FILTER HALFSPACE_CXX_RUNTIME INCLUDE REGEX "^(stdc\\+\\+|c\\+\\+|c\\+\\+abi|m)$")
list(REMOVE_DUPLICATES HALFSPACE_CXX_RUNTIME)
list(TRANSFORM HALFSPACE_CXX_RUNTIME PREPEND " -l" OUTPUT_VARIABLE HALFSPACE_PC_PRIVATE_LIBS)
list(JOIN HALFSPACE_PC_PRIVATE_LIBS "" HALFSPACE_PC_PRIVATE_LIBS)

set(HALFSPACE_PC_DEFINITIONS "")
set(HALFSPACE_PC_LIBS "")
get_target_property(library_type halfspace TYPE)
if(library_type STREQUAL "SHARED_LIBRARY")
  set(HALFSPACE_PC_DEFINITIONS " -DHALFSPACE_SHARED")
else()
  # Without --static, too: there is no other library than the static one.
  set(HALFSPACE_PC_LIBS "${HALFSPACE_PC_PRIVATE_LIBS}")
  set(HALFSPACE_PC_PRIVATE_LIBS "")
endif()

install(TARGETS halfspace EXPORT halfspaceTargets
  RUNTIME COMPONENT halfspace_runtime
  LIBRARY COMPONENT halfspace_runtime NAMELINK_COMPONENT halfspace_development
  ARCHIVE COMPONENT halfspace_development
  INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
set(not_installed "")
if(NOT HALFSPACE_C)
  set(not_installed PATTERN c/halfspace.h EXCLUDE)
endif()
install(DIRECTORY include/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
        COMPONENT halfspace_development FILES_MATCHING PATTERN "*.h" ${not_installed})
if(TARGET halfspace_static)
  install(TARGETS halfspace_static EXPORT halfspaceTargets
    ARCHIVE COMPONENT halfspace_development
    INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
endif()
install(EXPORT halfspaceTargets NAMESPACE halfspace::
        DESTINATION "${package_dir}" COMPONENT halfspace_development)

configure_package_config_file(
  "${CMAKE_CURRENT_LIST_DIR}/HalfspaceConfig.cmake.in" halfspaceConfig.cmake
  INSTALL_DESTINATION "${package_dir}"
  NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may break what the one before offered.
write_basic_package_version_file(halfspaceConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${CMAKE_CURRENT_BINARY_DIR}/halfspaceConfig.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/halfspaceConfigVersion.cmake"
  DESTINATION "${package_dir}" COMPONENT halfspace_development)

# Relative to the file itself, so that the tree can be moved. An absolute folder stays
# where it is.
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  set(HALFSPACE_PC_PREFIX "${CMAKE_INSTALL_PREFIX}")
else()
  file(RELATIVE_PATH HALFSPACE_PC_PREFIX
       "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")
  string(REGEX REPLACE "/$" "" HALFSPACE_PC_PREFIX "${HALFSPACE_PC_PREFIX}")
  string(PREPEND HALFSPACE_PC_PREFIX "\${pcfiledir}/")
endif()
halfspace_folder_in(HALFSPACE_PC_LIBDIR "\${prefix}" LIBDIR)
halfspace_folder_in(HALFSPACE_PC_INCLUDEDIR "\${prefix}" INCLUDEDIR)
configure_file("${CMAKE_CURRENT_LIST_DIR}/halfspace.pc.in" halfspace.pc @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/halfspace.pc"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
        COMPONENT halfspace_development)

# The headers name pages of docs/, which show pictures, and have links to headers, to
# examples and to other sources. The last are not installed, so their link becomes text.
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
file(RELATIVE_PATH doc_to_include
     "${CMAKE_INSTALL_FULL_DOCDIR}" "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
file(GLOB pages CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/docs/*.md")
foreach(page IN LISTS pages)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${page}")
  cmake_path(GET page FILENAME name)
  file(READ "${page}" text)
  string(REPLACE "](../include/" "](${doc_to_include}/" text "${text}")
  string(REPLACE "](../examples/" "](examples/" text "${text}")
  string(REGEX REPLACE "\\[([^]]*)\\]\\(\\.\\./([A-Za-z][^)]*)\\)"
         "\\1 (\\2 in the sources)" text "${text}")
  file(CONFIGURE OUTPUT "installed_docs/${name}" CONTENT "${text}" @ONLY)
endforeach()
install(DIRECTORY docs/ "${CMAKE_CURRENT_BINARY_DIR}/installed_docs/"
        DESTINATION "${CMAKE_INSTALL_DOCDIR}"
        COMPONENT halfspace_development
        FILES_MATCHING PATTERN "*.png" PATTERN "*.svg" PATTERN "*.json"
        REGEX "/installed_docs/.*[.]md$")
install(DIRECTORY examples/ DESTINATION "${CMAKE_INSTALL_DOCDIR}/examples"
        COMPONENT halfspace_development PATTERN CMakeLists.txt EXCLUDE)

if(PROJECT_IS_TOP_LEVEL)
  include(HalfspacePackage)
endif()

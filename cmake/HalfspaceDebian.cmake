# `cpack` of a build by the preset debian: a Debian package for each component, as
# Debian's own are named and divided. scripts/debs.sh makes them, checks them and
# tries them in an empty Debian. The variables of cpack also make the source package
# (HalfspaceDebianSource.cmake).

foreach(program dpkg dpkg-shlibdeps gzip)
  string(MAKE_C_IDENTIFIER "HALFSPACE_${program}" variable)
  string(TOUPPER "${variable}" variable)
  find_program(${variable} ${program})
  if(NOT ${variable})
    message(FATAL_ERROR "halfspace: HALFSPACE_DEBIAN needs ${program}, which is "
      "not here: apt-get install dpkg-dev gzip")
  endif()
endforeach()
if(NOT HALFSPACE_SHARED_AND_STATIC OR NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  message(FATAL_ERROR "halfspace: HALFSPACE_DEBIAN needs both libraries, and the "
    "prefix /usr: use the preset debian, or add "
    "-DHALFSPACE_SHARED_AND_STATIC=ON -DCMAKE_INSTALL_PREFIX=/usr")
endif()

include(HalfspaceLicences)

# Of who makes the packages, as other tools of Debian find it.
set(maintainer "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
if("$ENV{DEBFULLNAME}" STREQUAL "" OR "$ENV{DEBEMAIL}" STREQUAL "")
  set(maintainer "The halfspace authors <nobody@halfspace.invalid>")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_NAME halfspace)
# Each package has a summary of its own, which cpack would not use.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${maintainer}")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENTS_ALL "")

# What every package has in its folder of /usr/share/doc.
set(debian_folder "${PROJECT_BINARY_DIR}/debian")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
set(changelog
"halfspace (${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Version ${PROJECT_VERSION}. CHANGELOG.md of the sources lists the changes.

 -- ${maintainer}  ${date}
")
file(WRITE "${debian_folder}/changelog" "${changelog}")
# Without a name and a time, so that the same sources make the same file.
execute_process(COMMAND "${HALFSPACE_GZIP}" -9nf "${debian_folder}/changelog"
                COMMAND_ERROR_IS_FATAL ANY)

# halfspace_add_deb(<component> <package> <section> <summary> <description>
#   LICENCES <header of a library whose code is in the package>...)
function(halfspace_add_deb component package section summary description)
  cmake_parse_arguments(PARSE_ARGV 5 arg "" "" "LICENCES")
  file(READ "${PROJECT_SOURCE_DIR}/LICENSE" text)
  string(PREPEND text "halfspace ${PROJECT_VERSION}\n\n")
  set(libraries "")
  set(files "")
  if(arg_LICENCES)
    halfspace_find_licences(libraries files ${arg_LICENCES})
  endif()
  foreach(library file IN ZIP_LISTS libraries files)
    file(READ "${file}" licence)
    string(APPEND text "\n\nThis package contains code of ${library}, whose "
      "copyright file is:\n\n${licence}")
  endforeach()
  if(HALFSPACE_BUNDLES_HIGHWAY)
    file(READ "${HALFSPACE_HIGHWAY_INCLUDE}/LICENSE" licence)
    string(APPEND text
      "\n\nThis package contains code of Highway, whose licence is:\n\n${licence}")
  endif()
  file(WRITE "${debian_folder}/${package}/copyright" "${text}")
  install(FILES "${debian_folder}/${package}/copyright"
          DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}"
          COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES "${debian_folder}/changelog.gz"
          DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}"
          RENAME changelog.Debian.gz
          COMPONENT ${component} EXCLUDE_FROM_ALL)

  string(TOUPPER "${component}" id)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_COMPONENTS_ALL "${CPACK_COMPONENTS_ALL}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${id}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${id}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${id}_DESCRIPTION "${summary}\n${description}" PARENT_SCOPE)
endfunction()

set(highway "")
if(NOT HALFSPACE_BUNDLES_HIGHWAY)
  set(highway "*/include/hwy/highway.h")
endif()

set(library libhalfspace${HALFSPACE_SOVERSION})
set(about "halfspace answers which of many stored bounds a query could touch: a broad
phase, a culling pass, a ray cast or a spatial join. It tests boxes and other
bounding volumes with SIMD instructions, one by one or by a BVH, and never
leaves out an object that touches the query.")

halfspace_add_deb(halfspace_runtime ${library} libs
  "SIMD rejection tests over stored bounding volumes"
  "${about}\n\nThis package has the shared library."
  LICENCES ${highway})
# By hand, as cpack writes none of them for one component alone.
file(WRITE "${debian_folder}/triggers" "activate-noawait ldconfig\n")
file(WRITE "${debian_folder}/shlibs"
     "libhalfspace ${HALFSPACE_SOVERSION} ${library} (>= ${PROJECT_VERSION})\n")
set(CPACK_DEBIAN_HALFSPACE_RUNTIME_PACKAGE_CONTROL_EXTRA
    "${debian_folder}/triggers" "${debian_folder}/shlibs")

halfspace_add_deb(halfspace_development libhalfspace-dev libdevel
  "SIMD rejection tests over stored bounding volumes (development files)"
  "${about}\n\nThis package has the headers, the static library, the pages of the
manual, and what CMake and pkg-config need."
  LICENCES ${highway})
set(version "${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")
set(CPACK_DEBIAN_HALFSPACE_DEVELOPMENT_PACKAGE_DEPENDS "${library} (= ${version})")

if(TARGET cpuinfo-bench)
  halfspace_add_deb(halfspace_tools halfspace-tools utils
    "measure whether bounding simplices or boxes reject faster"
    "cpuinfo-bench measures on this machine what queries of boxes, bounding
simplices and octahedra cost, and where each of them wins.
cpuinfo-bench-report draws its reports as a page of HTML."
    LICENCES ${HALFSPACE_LICENSED_HEADERS})
  set(CPACK_DEBIAN_HALFSPACE_TOOLS_PACKAGE_DEPENDS "python3:any")
  # Debian has pages of the manual compressed, and one Python.
  install(CODE "
    file(GLOB pages \"\$ENV{DESTDIR}${HALFSPACE_INSTALL_MANDIR}/man1/*.1\")
    execute_process(COMMAND \"${HALFSPACE_GZIP}\" -9nf \${pages}
                    COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND sed -i \"1s|.*|#!/usr/bin/python3|\"
                            \"\$ENV{DESTDIR}${HALFSPACE_INSTALL_BINDIR}/cpuinfo-bench-report\"
                    COMMAND_ERROR_IS_FATAL ANY)"
    COMPONENT halfspace_tools EXCLUDE_FROM_ALL)
endif()

if(TARGET halfspace_python)
  # The extension is for one version of Python.
  find_package(Python REQUIRED COMPONENTS Interpreter)
  set(python "${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}")
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  halfspace_add_deb(python3_halfspace python3-halfspace python
    "SIMD rejection tests over stored bounding volumes (Python)"
    "${about}\n\nThis package has the module for Python 3, which works on arrays of
NumPy."
    LICENCES ${highway} "*/include/pybind11/pybind11.h")
  set(CPACK_DEBIAN_PYTHON3_HALFSPACE_PACKAGE_DEPENDS
    "python3-numpy, python3 (>= ${python}), python3 (<< ${Python_VERSION_MAJOR}.${next})")
  set(CPACK_DEBIAN_PYTHON3_HALFSPACE_PACKAGE_SUGGESTS "python3-distributed")
  # The compiled files of Python, as Debian's packages make and remove them.
  file(WRITE "${debian_folder}/postinst" "#!/bin/sh
set -e
if [ \"$1\" = configure ]; then py3compile -p python3-halfspace; fi
")
  file(WRITE "${debian_folder}/prerm" "#!/bin/sh
set -e
py3clean -p python3-halfspace
")
  set(CPACK_DEBIAN_PYTHON3_HALFSPACE_PACKAGE_CONTROL_EXTRA
      "${debian_folder}/postinst" "${debian_folder}/prerm")
  set(folder lib/python3/dist-packages/halfspace)
  install(TARGETS halfspace_python LIBRARY DESTINATION "${folder}"
          COMPONENT python3_halfspace EXCLUDE_FROM_ALL)
  install(DIRECTORY python/halfspace/ DESTINATION "${folder}"
          COMPONENT python3_halfspace EXCLUDE_FROM_ALL
          FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN py.typed)
endif()

include(HalfspaceDebianSource)
include(CPack)

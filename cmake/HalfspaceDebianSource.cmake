# The folder debian/ of a source package, in debian/source of the build. It makes the same
# packages as cpack, by packaging/debian/rules. scripts/debs.sh --source builds them.

set(folder "${debian_folder}/source/debian")
# The profile stage1 needs neither the packages nor the libraries that have <!stage1>.
set(control "Source: halfspace
Section: libs
Priority: optional
Maintainer: ${maintainer}
Build-Depends:
 cmake (>= 3.25),
 debhelper-compat (= 13),
 dh-sequence-python3 <!stage1>,
 libbenchmark-dev <!stage1>,
 libcli11-dev <!stage1>,
 libpython3-dev <!stage1>,
 ninja-build,
 nlohmann-json3-dev <!stage1>,
 pybind11-dev <!stage1>,
 python3-dev:any <!stage1>
Standards-Version: 4.6.2
Rules-Requires-Root: no
")
# Debian's i386 and armel have older CPUs, too (toolchains/armel.cmake).
set(baseline "sse2-support [i386]" "armv6k-support [armel]" "vfpv2-support [armel]")
set(components "")
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER "CPACK_DEBIAN_${component}" id)
  set(depends "${${id}_PACKAGE_DEPENDS}")
  # dh knows these versions when it builds.
  string(REPLACE "(= ${version})" "(= \${binary:Version})" depends "${depends}")
  string(REGEX REPLACE "python3 [(].*" "\${python3:Depends}" depends "${depends}")
  string(JOIN ", " depends "\${misc:Depends}" "\${shlibs:Depends}" ${baseline} ${depends})
  string(APPEND control "
Package: ${${id}_PACKAGE_NAME}
Architecture: any
Section: ${${id}_PACKAGE_SECTION}
Depends: ${depends}\n")
  if(${id}_PACKAGE_SUGGESTS)
    string(APPEND control "Suggests: ${${id}_PACKAGE_SUGGESTS}\n")
  endif()
  if(component MATCHES "tools|python")
    string(APPEND control "Build-Profiles: <!stage1>\n")
  endif()
  string(REPLACE "\n" "\n " description "${${id}_DESCRIPTION}")
  string(REPLACE "\n \n" "\n .\n" description "${description}")
  string(APPEND control "Description: ${description}\n")
  string(APPEND components "${${id}_PACKAGE_NAME} ${component}\n")
endforeach()
file(WRITE "${folder}/control" "${control}")
file(WRITE "${folder}/components" "${components}")
file(WRITE "${folder}/changelog" "${changelog}")
file(WRITE "${folder}/source/format" "3.0 (quilt)\n")
configure_file("${debian_folder}/${library}/copyright" "${folder}/copyright" COPYONLY)
configure_file("${PROJECT_SOURCE_DIR}/packaging/debian/rules" "${folder}/rules" COPYONLY)

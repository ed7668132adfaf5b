# Installs BUILD, moves the tree to PREFIX, and checks what is in it. A tree
# that refers to where it was installed is then of no use to a consumer.

set(installed "${PREFIX}.before_the_move")
file(REMOVE_RECURSE "${installed}" "${PREFIX}")
execute_process(
  COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --prefix "${installed}"
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(RENAME "${installed}" "${PREFIX}")

file(GLOB_RECURSE expected RELATIVE "${HEADERS}" "${HEADERS}/*")
if(NOT HAS_C)
  list(FILTER expected EXCLUDE REGEX "^halfspace/c/")
endif()
file(GLOB_RECURSE headers RELATIVE "${PREFIX}/include" "${PREFIX}/include/*")
if(NOT headers STREQUAL expected)
  message(FATAL_ERROR "The headers installed are not those of ${HEADERS}.\n"
                      "Installed: ${headers}\nExpected: ${expected}")
endif()

# Every page that a header names is there.
foreach(header IN LISTS headers)
  file(READ "${PREFIX}/include/${header}" text)
  string(REGEX MATCHALL "docs/[A-Za-z0-9_-]+\\.md" pages "${text}")
  foreach(page IN LISTS pages)
    get_filename_component(name "${page}" NAME)
    if(NOT EXISTS "${PREFIX}/${PAGES}/${name}")
      message(FATAL_ERROR "${header} names ${page}, which is not installed in "
                          "${PREFIX}/${PAGES}: see cmake/HalfspaceInstall.cmake")
    endif()
    set(named TRUE)
  endforeach()
endforeach()
if(NOT named)
  message(FATAL_ERROR "No header names a page of docs/: nothing was checked")
endif()

# So is every picture of a page.
file(GLOB pages "${PREFIX}/${PAGES}/*.md")
foreach(page IN LISTS pages)
  file(READ "${page}" text)
  string(REGEX MATCHALL "\\([A-Za-z0-9_-]+\\.(png|svg)\\)" pictures "${text}")
  foreach(picture IN LISTS pictures)
    string(REGEX REPLACE "[()]" "" picture "${picture}")
    if(NOT EXISTS "${PREFIX}/${PAGES}/${picture}")
      message(FATAL_ERROR "${page} shows ${picture}, which is not installed")
    endif()
  endforeach()
endforeach()

file(GLOB_RECURSE packages
     "${PREFIX}/*/halfspace*.cmake" "${PREFIX}/*/halfspace.pc")
if(NOT packages)
  message(FATAL_ERROR "${PREFIX} has neither CMake nor pkg-config files")
endif()
foreach(package IN LISTS packages)
  file(READ "${package}" text)
  string(FIND "${text}" "${installed}" found)
  if(NOT found EQUAL -1)
    message(FATAL_ERROR "${package} names the folder of the installation")
  endif()
  if(text MATCHES "[^\n]*hwy[^\n]*")
    message(FATAL_ERROR "${package} asks for Highway, which only the compiler "
                        "of the library needs: ${CMAKE_MATCH_0}")
  endif()
endforeach()

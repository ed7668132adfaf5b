# Headers from Debian's packages for the machine that compiles: they are the same for every
# machine. By links, as /usr/include has headers of other packages, too. The CMake packages
# of these headers, and of Google Benchmark, are those of the folder `packages`.
set(HALFSPACE_PACKAGES_OF_HOST ON)
set(headers "${CMAKE_BINARY_DIR}/headers")
foreach(name hwy CLI nlohmann)
  if(EXISTS "/usr/include/${name}")
    file(MAKE_DIRECTORY "${headers}")
    file(CREATE_LINK "/usr/include/${name}" "${headers}/${name}" SYMBOLIC)
  endif()
endforeach()
if(NOT DEFINED FETCHCONTENT_SOURCE_DIR_HIGHWAY AND EXISTS "${headers}/hwy/highway.h")
  set(FETCHCONTENT_SOURCE_DIR_HIGHWAY "${headers}" CACHE PATH "Highway's headers")
endif()
foreach(package benchmark CLI11 nlohmann_json)
  set(${package}_DIR "${CMAKE_CURRENT_LIST_DIR}/packages" CACHE PATH "For another system")
endforeach()

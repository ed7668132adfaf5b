# Highway's headers, from Debian's package for the machine that compiles: they are the same
# for every machine. By a link, as /usr/include has headers of other packages, too.
if(NOT DEFINED FETCHCONTENT_SOURCE_DIR_HIGHWAY AND EXISTS /usr/include/hwy/highway.h)
  file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/highway")
  file(CREATE_LINK /usr/include/hwy "${CMAKE_BINARY_DIR}/highway/hwy" SYMBOLIC)
  set(FETCHCONTENT_SOURCE_DIR_HIGHWAY "${CMAKE_BINARY_DIR}/highway" CACHE PATH
      "Highway's headers")
endif()

# The target `docs`: pages of the headers in docs/html of the build, by Doxygen. Its
# warnings are errors.

find_package(Doxygen 1.9 QUIET)
find_program(HALFSPACE_PYTHON3 NAMES /usr/bin/python3 python3)
if(NOT DOXYGEN_FOUND OR NOT HALFSPACE_PYTHON3)
  message(STATUS "halfspace: no target docs, which needs Doxygen 1.9 and Python 3")
  return()
endif()

set(headers "${PROJECT_SOURCE_DIR}/include")
set(DOXYGEN_PROJECT_NAME halfspace)
set(DOXYGEN_PROJECT_NUMBER ${PROJECT_VERSION})
set(DOXYGEN_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/docs")
set(DOXYGEN_INPUT_FILTER
    "${HALFSPACE_PYTHON3} ${PROJECT_SOURCE_DIR}/scripts/doxygen_filter.py")
set(DOXYGEN_STRIP_FROM_PATH "${headers}")
set(DOXYGEN_STRIP_FROM_INC_PATH "${headers}")
set(DOXYGEN_INCLUDE_PATH "${headers}")
set(DOXYGEN_EXCLUDE "${headers}/halfspace/detail")
set(DOXYGEN_EXCLUDE_SYMBOLS halfspace::detail)
set(DOXYGEN_EXTRACT_ALL YES)
set(DOXYGEN_HIDE_FRIEND_COMPOUNDS YES)
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
# The filter escapes what would have a meaning.
set(DOXYGEN_MARKDOWN_SUPPORT NO)
set(DOXYGEN_MACRO_EXPANSION YES)
set(DOXYGEN_EXPAND_ONLY_PREDEF YES)
set(DOXYGEN_PREDEFINED "HALFSPACE_API=" "HALFSPACE_INT=" "__cplusplus=201703L")
set(DOXYGEN_SORT_MEMBER_DOCS NO)
set(DOXYGEN_SHOW_INCLUDE_FILES NO)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_GENERATE_LATEX NO)
set(DOXYGEN_QUIET YES)
# The comments describe a call, and not each parameter by itself.
set(DOXYGEN_WARN_IF_INCOMPLETE_DOC NO)
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
doxygen_add_docs(docs "${headers}/halfspace")

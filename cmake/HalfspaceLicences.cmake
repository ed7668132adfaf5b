# The licence texts of what a package contains, as the Debian packages that it came
# from have them.

# halfspace_find_licence(<package> <text> <file pattern>): sets the variables
# <package> and <text> to the name and the copyright file of the Debian package
# that has a file of such a path.
function(halfspace_find_licence result_package result_text pattern)
  set(owner "")
  find_program(HALFSPACE_DPKG_QUERY dpkg-query)
  if(HALFSPACE_DPKG_QUERY)
    execute_process(COMMAND "${HALFSPACE_DPKG_QUERY}" --search "${pattern}"
                    OUTPUT_VARIABLE owner ERROR_QUIET)
  endif()
  string(REGEX MATCH "^[^:, \n]+" package "${owner}")
  set(text "/usr/share/doc/${package}/copyright")
  if(NOT package OR NOT EXISTS "${text}")
    message(FATAL_ERROR
      "no licence text of ${pattern}, which the package contains: no Debian "
      "package with a /usr/share/doc/<package>/copyright has this file; install "
      "it from one")
  endif()
  set(${result_package} "${package}" PARENT_SCOPE)
  set(${result_text} "${text}" PARENT_SCOPE)
endfunction()

# halfspace_install_licences(<folder> <file pattern>...): copies the copyright file
# of each package that has a file of such a path, as <folder>/<package>, and the
# licences that these refer to. For install scripts.
function(halfspace_install_licences folder)
  set(texts "")
  foreach(pattern IN LISTS ARGN)
    halfspace_find_licence(package text "${pattern}")
    list(APPEND texts "${text}")
    file(INSTALL "${text}" DESTINATION "${folder}" RENAME "${package}"
         FOLLOW_SYMLINK_CHAIN)
  endforeach()
  foreach(text IN LISTS texts)
    file(STRINGS "${text}" lines REGEX "common-licenses/")
    string(REGEX MATCHALL "/usr/share/common-licenses/[-A-Za-z0-9.]+" licences
           "${lines}")
    list(REMOVE_DUPLICATES licences)
    foreach(licence IN LISTS licences)
      string(REGEX REPLACE "[.]$" "" licence "${licence}")
      get_filename_component(name "${licence}" NAME)
      file(REAL_PATH "${licence}" file)
      file(INSTALL "${file}" DESTINATION "${folder}/common-licenses"
           RENAME "${name}")
    endforeach()
  endforeach()
endfunction()

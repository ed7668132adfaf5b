# The licence texts of what a package contains, as the Debian packages that it came
# from have them.

# halfspace_find_licences(<packages> <texts> <file pattern>...): sets the variables
# <packages> and <texts> to the names and the copyright files of the Debian packages that
# have files of such paths. A pattern has one "*", which comes first.
function(halfspace_find_licences result_packages result_texts)
  # Of all at once: a search reads the lists of all packages.
  set(owners "")
  find_program(HALFSPACE_DPKG_QUERY dpkg-query)
  if(HALFSPACE_DPKG_QUERY)
    execute_process(COMMAND "${HALFSPACE_DPKG_QUERY}" --search ${ARGN}
                    OUTPUT_VARIABLE owners ERROR_QUIET)
    string(REPLACE "\n" ";" owners "${owners}")
  endif()
  set(packages "")
  set(texts "")
  foreach(pattern IN LISTS ARGN)
    string(SUBSTRING "${pattern}" 1 -1 end)
    string(LENGTH "${end}" length)
    set(package "")
    foreach(line IN LISTS owners)
      string(LENGTH "${line}" at)
      math(EXPR at "${at} - ${length}")
      string(FIND "${line}" "${end}" found REVERSE)
      if(found GREATER 0 AND found EQUAL at)
        string(REGEX MATCH "^[^:, ]+" package "${line}")
        break()
      endif()
    endforeach()
    set(text "/usr/share/doc/${package}/copyright")
    if(NOT package OR NOT EXISTS "${text}")
      message(FATAL_ERROR
        "no licence text of ${pattern}, which the package contains: no Debian "
        "package with a /usr/share/doc/<package>/copyright has this file; install "
        "it from one")
    endif()
    list(APPEND packages "${package}")
    list(APPEND texts "${text}")
  endforeach()
  set(${result_packages} "${packages}" PARENT_SCOPE)
  set(${result_texts} "${texts}" PARENT_SCOPE)
endfunction()

# halfspace_install_licences(<folder> <file pattern>...): copies the copyright file
# of each package that has a file of such a path, as <folder>/<package>, and the
# licences that these refer to. For install scripts.
function(halfspace_install_licences folder)
  halfspace_find_licences(packages texts ${ARGN})
  foreach(package text IN ZIP_LISTS packages texts)
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

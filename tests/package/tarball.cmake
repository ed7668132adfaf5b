# What `cpack` makes, unpacked into an empty folder and run from there.

set(folder "${CMAKE_CURRENT_BINARY_DIR}/tarball")
add_test(NAME package.tarball.make
  COMMAND ${CMAKE_CPACK_COMMAND} --config "${PROJECT_BINARY_DIR}/CPackConfig.cmake"
          -B "${folder}" -D CPACK_PACKAGE_FILE_NAME=halfspace)
set_tests_properties(package.tarball.make PROPERTIES
  FIXTURES_SETUP package.tarball)

function(add_tarball_test name)
  add_test(NAME ${name}
    COMMAND sh "${CMAKE_CURRENT_SOURCE_DIR}/run_tarball.sh" "${folder}/halfspace.tar.gz"
            "${CMAKE_READELF}" ${ARGN} -- ${CMAKE_CROSSCOMPILING_EMULATOR})
  set_tests_properties(${name} PROPERTIES FIXTURES_REQUIRED package.tarball)
endfunction()

add_tarball_test(package.tarball)
# With its libraries elsewhere it must not pass, even if the system has them.
add_tarball_test(package.tarball.control misplaced_libraries)
set_tests_properties(package.tarball.control PROPERTIES
  PASS_REGULAR_EXPRESSION "is not loaded from the tarball")
set_tests_properties(
  package.tarball.make package.tarball package.tarball.control PROPERTIES
  LABELS package)

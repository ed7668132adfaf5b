# Run in a build that was configured with absolute folders, which are in FOLDER: the
# pkg-config file names them, and the tool is installed there, with its pages and its
# script, if it was built.
# PKG_CONFIG and HAS_TOOL say what there is to check.
cmake_policy(VERSION 3.25)

if(PKG_CONFIG)
  set(ENV{PKG_CONFIG_LIBDIR} .)
  foreach(variable_and_value "prefix /usr/local" "libdir ${FOLDER}/lib"
                             "includedir /opt/halfspace/include")
    separate_arguments(words UNIX_COMMAND "${variable_and_value}")
    list(POP_FRONT words variable)
    execute_process(
      COMMAND "${PKG_CONFIG}" --variable=${variable} halfspace
      OUTPUT_VARIABLE value OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    if(NOT value STREQUAL words)
      message(SEND_ERROR "halfspace.pc has ${variable}=${value}, and not ${words}")
    endif()
  endforeach()
endif()

if(HAS_TOOL)
  set(install_tool ${CMAKE_COMMAND} --install . --prefix prefix --component halfspace_tools)
  file(REMOVE_RECURSE bench/cpuinfo-bench "${FOLDER}")
  execute_process(COMMAND ${install_tool} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB_RECURSE installed "${FOLDER}/*")
  if(installed)
    message(SEND_ERROR "The tool was not built, and these are installed: ${installed}")
  endif()
  # A file in the place of the tool.
  file(WRITE bench/cpuinfo-bench "")
  execute_process(COMMAND ${install_tool} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  foreach(file bin/cpuinfo-bench bin/cpuinfo-bench-report man/man1/cpuinfo-bench.1
               man/man1/cpuinfo-bench-report.1)
    if(NOT EXISTS "${FOLDER}/${file}")
      message(SEND_ERROR "${file} is not installed in ${FOLDER}")
    endif()
  endforeach()
endif()

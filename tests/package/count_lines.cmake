# Fails if HEADER has more than LIMIT preprocessed lines, in C++17 or in C++20, with
# COMPILER and the INCLUDES.

set(source "${OUTPUT}.cc")
file(WRITE "${source}" "#include \"${HEADER}\"\n")
foreach(standard c++17 c++20)
  execute_process(COMMAND ${COMPILER} "-I${INCLUDES}" "${source}" -std=${standard}
                          -E -o "${OUTPUT}.ii"
                  COMMAND_ERROR_IS_FATAL ANY)
  file(READ "${OUTPUT}.ii" text)
  string(REGEX REPLACE "[^\n]+" "" text "${text}")
  string(LENGTH "${text}" lines)
  message("${HEADER} has ${lines} preprocessed lines in ${standard}")
  if(lines GREATER LIMIT)
    message(SEND_ERROR
      "${HEADER} has ${lines} preprocessed lines in ${standard}, expected at most ${LIMIT}. "
      "`${COMPILER} -std=${standard} -H` lists the headers that it includes. "
      "docs/design.md says what the standard headers cost.")
  endif()
endforeach()

# What the compiler says of calls with a wrong type: one error, which says what fits.
# COMPILER with the INCLUDES compiles each of these lines of a function.

set(flat "AaboWorld3 world")
set(refused
  "${flat}; (void)CountSurvivors(world, Sphere3{})" "a flat world takes queries of its own type"
  "${flat}; std::uint32_t i[1]; (void)Survivors(world, Sphere3{}, i)"
  "a flat world takes queries of its own type"
  "QuantizedWorld<AabbView3> world; const HalfSpace3 front[6] = {}; (void)AnySurvivor(world, front)"
  "a flat world takes queries of its own type"
  "struct Foreign {}; (void)Merge(Foreign(), Foreign())" "IfBoundOfFloats")

set(source "${OUTPUT}.cc")
while(refused)
  list(POP_FRONT refused line expected)
  file(WRITE "${source}" "#include <halfspace/halfspace.h>\n"
    "using namespace halfspace;\nvoid Call() { ${line}; }\n")
  execute_process(COMMAND ${COMPILER} "-I${INCLUDES}" "${source}" -std=c++17 -fsyntax-only
                  RESULT_VARIABLE result ERROR_VARIABLE said)
  string(REGEX MATCHALL "error: " errors "${said}")
  list(LENGTH errors count)
  if(result EQUAL 0 OR NOT said MATCHES "${expected}" OR count GREATER 2)
    message(SEND_ERROR "${line}: expected an error that says \"${expected}\", got: ${said}")
  endif()
endwhile()

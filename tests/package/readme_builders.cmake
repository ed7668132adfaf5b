# The calls of the table of builders in docs/choosing.md compile, for the worlds that it names.
# cmake -DROOT=<repository> -DCOMPILER=<compiler> -DOUTPUT=<file> -P readme_builders.cmake
cmake_policy(VERSION 3.25)

file(STRINGS "${ROOT}/docs/choosing.md" rows REGEX "^[|].*[|].*(Bound|Sweep)[A-Za-z]*[(].*[|]$")
list(LENGTH rows count)
if(count LESS 5)
  message(FATAL_ERROR "docs/choosing.md has no table of builders")
endif()
set(program "#include <halfspace/halfspace.h>\n\nnamespace halfspace {\n")
foreach(kind Aabo Aabb)
  string(APPEND program "void ${kind}s(${kind}World3& world, ${kind}Bvh3& bvh,\n"
    "  ${kind}BroadPhase3& bodies, const ${kind}3& bound, const Aabb3& box,\n"
    "  const Sphere3& sphere, const Points3& points, const Point3& motion,\n"
    "  const Spheres3& spheres) {\n")
  foreach(row IN LISTS rows)
    string(REGEX REPLACE "^[|][^|]*[|] `([^`]*)` [|] (.*) [|]$" "\\1" call "${row}")
    set(other "${CMAKE_MATCH_2}")
    if(kind STREQUAL "Aabb" AND other MATCHES "`(.*)`")
      set(call "${CMAKE_MATCH_1}")
    endif()
    if(call MATCHES "planes")
      string(APPEND program "  ${call};\n")
    else()
      string(APPEND program
        "  world.Push(${call});\n  bvh.Insert(${call});\n  bodies.Insert(0, ${call});\n")
    endif()
  endforeach()
  string(APPEND program "}\n")
endforeach()
string(APPEND program "}  // namespace halfspace\n")
file(WRITE "${OUTPUT}" "${program}")
execute_process(
  COMMAND ${COMPILER} -std=c++17 -fsyntax-only "-I${ROOT}/include" "${OUTPUT}"
  COMMAND_ERROR_IS_FATAL ANY)

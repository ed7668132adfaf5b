# What the compiler says of calls with a wrong type: one error, which says what fits.
# COMPILER with the INCLUDES compiles each of these calls.

set(own_type "a flat world takes queries of its own type")
set(of_bvh "a Bvh takes queries of its own type")
set(answer "must return nothing, a bool or a Visit")
set(refused
  "(void)CountSurvivors(flat, Sphere3{})" "${own_type}"
  "(void)Survivors(flat, Sphere3{}, ids)" "${own_type}"
  "(void)AnySurvivor(quantized, front)" "${own_type}"
  "(void)CountSurvivors(bvh, Triangle3{})" "${of_bvh}"
  "(void)SurvivorsOfEach(bvh, Span<const Aabo3>(), ids, offsets)" "${of_bvh}"
  "ForEachSurvivor(bodies, Sphere2{}, ignore)" "${of_bvh}"
  "(void)Merge(Foreign(), Foreign())" "BoundOfFloats|no type named 'Scalar'"
  "ForEachSurvivor(flat, Aabo3(), number)" "${answer}"
  "ForEachPair(bvh, number)" "${answer}"
  "ForEachNearest(bvh, {}, 1, number)" "${answer}"
  "AaboView<3, double> doubles" "wrong number of template arguments|too many template arguments")

# Builders and bounds of bounds return floats.
foreach(call "Merge(doubles, doubles)" "Inflate(doubles, 1)" "InflateByBox(doubles, 1)"
             "Translate(doubles, {})" "TranslateVertices(doubles, {})" "Scale(doubles, 2)"
             "Sweep(doubles, {})" "BoundBoxes(Boxes3(), wide)"
             "BoundSpheres(Spheres3(), wide)"
             "BoundTriangles(Points3(), ids, wide)" "BoundPointSets(Points3(), offsets, wide)")
  list(APPEND refused "(void)${call}" "no matching function")
endforeach()

# Most of the time goes into the headers: they are compiled once.
set(header "${OUTPUT}.h")
file(WRITE "${header}" "#include <halfspace/halfspace.h>
using namespace halfspace;
struct Foreign {};
struct Number {
  template <typename... Found> int operator()(const Found&...) const;
};
struct Ignore {
  template <typename... Found> void operator()(const Found&...) const;
};
")
set(compile ${COMPILER} "-I${INCLUDES}" -std=c++17)
execute_process(COMMAND ${compile} -x c++-header "${header}" -o "${header}.gch"
                COMMAND_ERROR_IS_FATAL ANY)

set(source "${OUTPUT}.cc")
while(refused)
  list(POP_FRONT refused call expected)
  file(WRITE "${source}"
"void Call(const AaboWorld3& flat, const QuantizedWorld<AabbView3>& quantized,
          const AabbBvh3& bvh, const AabbBroadPhase3& bodies,
          Span<const HalfSpace3> front, Span<std::uint32_t> ids,
          Span<std::size_t> offsets, Number number, Ignore ignore,
          const Aabb<3, double>& doubles, const AabbPlanes<3, double>& wide) {
  ${call};
}
")
  execute_process(COMMAND ${compile} -include "${header}" "${source}" -fsyntax-only
                  RESULT_VARIABLE result ERROR_VARIABLE said)
  string(REGEX MATCHALL "error: " errors "${said}")
  list(LENGTH errors count)
  if(result EQUAL 0 OR NOT said MATCHES "${expected}" OR count GREATER 2)
    message(SEND_ERROR "${call}: expected an error that says \"${expected}\", got: ${said}")
  endif()
endwhile()

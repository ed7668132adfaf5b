// What the library may answer for any shape. This is one property of all
// builders: tests try it on seeded shapes, and a fuzzer on its bytes.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_EXACT_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_EXACT_ANSWERS_H_

#include <gtest/gtest.h>

#include <string>

#include "halfspace/fit_status.h"
#include "tests/library/fit/builders.h"

namespace halfspace::testing {

struct Outcome {
  bool is_refused = false;
  std::string message;  // of the error
  Planes planes{};
  FitStatus status{};
};

Outcome Try(const Builder& builder, const Shape& shape);

// The outcome is an error, Empty(), Everything() or a bound, as it must be. A
// bound encloses the exact shape, and is as tight as the header says. All rows,
// but TranslateVertices() only with numbers that are not finite.
::testing::AssertionResult IsExact(const Builder& builder, const Shape& shape,
                                   const Outcome& outcome);
inline ::testing::AssertionResult IsExact(const Builder& builder,
                                          const Shape& shape) {
  return IsExact(builder, shape, Try(builder, shape));
}

// Of TranslateVertices(): makes the planes of `shape` a bound of the vertices,
// which are the numbers of a triangle.
void SetPlanesOfVertices(const Builder& builder, const Shape& vertices,
                         Shape& shape);

// Then the outcome encloses the vertices that are really moved, and rounded,
// and is tight.
::testing::AssertionResult EnclosesMovedVertices(const Builder& builder,
                                                 const Shape& vertices,
                                                 const Shape& shape,
                                                 const Outcome& outcome);

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_EXACT_ANSWERS_H_

// Reads axis-aligned boxes from a comma-separated file.
//
// Each row is a box: minx,miny,minz,maxx,maxy,maxz. Blanks around numbers,
// empty lines and lines that start with # are allowed. The first row may be the
// six names. Anything else is an error.
#ifndef HALFSPACE_BENCH_INPUT_BOUNDS_READER_H_
#define HALFSPACE_BENCH_INPUT_BOUNDS_READER_H_

#include <string>
#include <vector>

#include "halfspace/bounds.h"

namespace halfspace::bench {

// Returns the boxes of the file, in order. There is at least one, and all are
// finite with min <= max. Throws InputError.
std::vector<Aabb3> ReadBounds(const std::string& path);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_BOUNDS_READER_H_

// Reads axis-aligned boxes from a comma-separated file.
//
// One box a row: minx,miny,minz,maxx,maxy,maxz. Blanks around numbers, empty
// lines and lines that start with # are allowed, and those six names as the
// first row. Nothing else is: what cannot be understood is an error, never a
// guess.
#ifndef HALFSPACE_BENCH_INPUT_BOUNDS_READER_H_
#define HALFSPACE_BENCH_INPUT_BOUNDS_READER_H_

#include <string>
#include <vector>

#include "halfspace/bounds.h"

namespace halfspace::bench {

// The boxes of the file, in order; at least one, all finite, none inverted.
// Throws InputError.
std::vector<Aabb3> ReadBounds(const std::string& path);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_BOUNDS_READER_H_

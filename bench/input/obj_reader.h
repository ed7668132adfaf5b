// Reads the triangles of a Wavefront OBJ file.
//
// Only `v` and `f` are read, and strictly: what cannot be understood is an
// error, never a guess, because one vertex that is dropped or read as zero
// moves every triangle after it. The other statements of the format are
// skipped; no other file is ever opened.
//
//   v x y z [w | r g b]         w and the colour are checked, then ignored
//   f corner corner corner ...  a corner is v, v/vt, v//vn or v/vt/vn; v counts
//                               from 1, or back from -1, the last vertex so far
//
// Polygons are fanned: corners (0, i, i + 1). A face may name vertices that
// come after it. Lines may end in LF or CR LF; a backslash at the end of a
// line that is no comment continues it; # starts a comment.
#ifndef HALFSPACE_BENCH_INPUT_OBJ_READER_H_
#define HALFSPACE_BENCH_INPUT_OBJ_READER_H_

#include <string>

#include "bench/input/mesh.h"

namespace halfspace::bench {

// What ReadMesh promises, of a file at `path` with this content.
Mesh ReadObj(const std::string& path, std::string content,
             const MeshLimits& limits);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_OBJ_READER_H_

// Spheres around points, for the sphere tests of loops.h.
#ifndef HALFSPACE_BENCH_PAPER_BOUNDING_SPHERE_H_
#define HALFSPACE_BENCH_PAPER_BOUNDING_SPHERE_H_

#include <span>

#include "halfspace/shapes.h"

namespace halfspace::bench {

// A sphere around points, x y z each, at least one. It is at most a
// few percent larger than the smallest one, and for a segment or a box as small
// as it: the radius encloses the points, rounded up.
Sphere<3> SphereAround(std::span<const float> points);

// The sphere, for a test that rounds and must never reject spheres that touch:
// the radius is larger by 2^-20 of it and by 2^-60.
//
// A test compares float sums: d2, of the squares of the differences of the
// centers, with s2, the square of the sum of the radii. Each operation has a
// relative error of at most u = 2^-24, and of a difference that is relative to
// the difference itself: d2 <= |c - q|^2 (1 + u)^5, s2 >= (r + R)^2 (1 - u)^3.
// Where the spheres touch, |c - q| <= r + R; so d2 <= s2 if both radii are
// larger by 5 u of it, and 2^-20 is 16 u. 2^-60 keeps s2 so large that what
// underflows does not count; and what overflows, to infinity on both sides, is
// kept.
Sphere<3> Inflated(const Sphere<3>& sphere);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_BOUNDING_SPHERE_H_

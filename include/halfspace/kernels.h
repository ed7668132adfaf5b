// Kernels: which of n bounds in the caller's memory could touch a query? The
// fastest calls of the library. They check nothing.
//
//   const float* planes[] = {min_x, min_y, min_z, max_x, max_y, max_z};
//   const float query[] = {0, 0, 0, 1, 1, 1};  // min x y z, max x y z
//   std::vector<std::uint64_t> mask((n + 63) / 64);
//   halfspace::SurvivorsOfBoxes3(planes, n, query, mask.data());
//
// The functions, for d = 2, 3 and 4 dimensions:
//
//   name                  planes, and the values of a query
//   SurvivorsOfBoxes      d minima, then d maxima. In 3D: min x y z, max x y z
//   SurvivorsOfSimplices  d + 1 minima: min x y z D. A query: max x y z D
//   SurvivorsOfOctahedra  d + 1 minima, then d + 1 maxima: min x y z D,
//                         max x y z D
//
// D is -(x + y + z) (bounds.h). Each function has two overloads, for one query
// and for several. Those of boxes exist for doubles, too. Boxes, octahedra and
// spheres also have one for half-spaces, below.
//
//   planes  planes[p][i] is the value of plane p of object i. The call reads
//           values 0 ... n - 1 of each plane, and nothing else. A plane needs
//           the alignment of its elements.
//   n       objects, any number. If it is 0, nothing is read or written, and
//           any pointer may be null
//   query   the values of one query in the order of the table. queries:
//           `count` of them, one after another
//   mask    (n + 63) / 64 words. Object i is bit i % 64 of word i / 64: 1 if
//           it survives. Bits past the last object are 0. masks: a mask for
//           each query, one after another
//
// An object survives unless a plane separates it from the query. Bounds that
// only touch survive. A NaN never rejects (reject.h). The results are those of
// reject.h, bit for bit, on every target.
//
// The caller's duty: no pointer is null or misaligned, and a mask overlaps
// neither planes nor queries. A library that was built without NDEBUG asserts
// the first two. reject.h has the same calls with checks, options and worlds.
//
// Cost: two jumps through pointers, and the loop. Objects are tested as by
// Schedule::kAuto (reject.h). Several queries share the loads of planes.
// `./bench.sh --details tier` compares the calls with loops by hand.
//
// Errors: none. The first call chooses the target (targets.h). If the
// environment variable HALFSPACE_TARGET names none of this machine, the process
// ends by std::terminate(). Call ChosenTarget() before to get an error.
//
// Thread safety: reentrant. No call throws. Only the first ones allocate and
// lock, to detect the CPU; call ChosenTarget() before if they must not. Stack:
// up to 8 KiB. Floating-point mode: as reject.h.
//
// c/kernels.h has these functions for C. kernels-inl.h has the test of 64
// objects for loops of your own. docs/kernels.md shows all three in use.
//
// Source: "The Bounding Simplex: A SIMD-Era Rejection Primitive".
#ifndef HALFSPACE_KERNELS_H_
#define HALFSPACE_KERNELS_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/c/kernels.h"
#include "halfspace/export.h"
#include "halfspace/target.h"

namespace halfspace {

template <int kDims, typename Scalar>
struct HalfSpace;  // shapes.h

#define HALFSPACE_DEFINE_SURVIVORS_OF(name, bound)                         \
  inline void SurvivorsOf##name(const float* const* planes, std::size_t n, \
                                const float* query,                        \
                                std::uint64_t* mask) noexcept {            \
    bound##_mask(planes, n, query, mask);                                  \
  }                                                                        \
  inline void SurvivorsOf##name(const float* const* planes, std::size_t n, \
                                const float* queries, std::size_t count,   \
                                std::uint64_t* masks) noexcept {           \
    bound##_masks(planes, n, queries, count, masks);                       \
  }
#define HALFSPACE_DEFINE_SURVIVORS_OF_DOUBLES(name, bound)                  \
  HALFSPACE_DEFINE_SURVIVORS_OF(name, bound)                                \
  inline void SurvivorsOf##name(const double* const* planes, std::size_t n, \
                                const double* query,                        \
                                std::uint64_t* mask) noexcept {             \
    bound##_mask_of_doubles(planes, n, query, mask);                        \
  }                                                                         \
  inline void SurvivorsOf##name(const double* const* planes, std::size_t n, \
                                const double* queries, std::size_t count,   \
                                std::uint64_t* masks) noexcept {            \
    bound##_masks_of_doubles(planes, n, queries, count, masks);             \
  }

HALFSPACE_DEFINE_SURVIVORS_OF_DOUBLES(Boxes2, hs_box2)
HALFSPACE_DEFINE_SURVIVORS_OF_DOUBLES(Boxes3, hs_box3)
HALFSPACE_DEFINE_SURVIVORS_OF_DOUBLES(Boxes4, hs_box4)
HALFSPACE_DEFINE_SURVIVORS_OF(Simplices2, hs_simplex2)
HALFSPACE_DEFINE_SURVIVORS_OF(Simplices3, hs_simplex3)
HALFSPACE_DEFINE_SURVIVORS_OF(Simplices4, hs_simplex4)
HALFSPACE_DEFINE_SURVIVORS_OF(Octahedra2, hs_octahedron2)
HALFSPACE_DEFINE_SURVIVORS_OF(Octahedra3, hs_octahedron3)
HALFSPACE_DEFINE_SURVIVORS_OF(Octahedra4, hs_octahedron4)
#undef HALFSPACE_DEFINE_SURVIVORS_OF_DOUBLES
#undef HALFSPACE_DEFINE_SURVIVORS_OF

// The objects in front of all half-spaces, such as a frustum (frustum.h).
// `count` must be at most 64, which is asserted, but not checked. Planes of
// boxes and octahedra as above; of spheres d coordinates of the center, and the
// radius, which must not be negative. reject_shapes.h says which objects
// survive, and what it costs. Stack: 10 KiB.
#define HALFSPACE_DEFINE_SURVIVORS_IN_FRONT(name, bound, dims)                \
  inline void SurvivorsOf##name(const float* const* planes, std::size_t n,    \
                                const HalfSpace<dims, float>* half_spaces,    \
                                std::size_t count,                            \
                                std::uint64_t* mask) noexcept {               \
    bound##_half_space_mask(                                                  \
        planes, n, reinterpret_cast<const float*>(half_spaces), count, mask); \
  }
HALFSPACE_DEFINE_SURVIVORS_IN_FRONT(Boxes2, hs_box2, 2)
HALFSPACE_DEFINE_SURVIVORS_IN_FRONT(Boxes3, hs_box3, 3)
HALFSPACE_DEFINE_SURVIVORS_IN_FRONT(Octahedra2, hs_octahedron2, 2)
HALFSPACE_DEFINE_SURVIVORS_IN_FRONT(Octahedra3, hs_octahedron3, 3)
HALFSPACE_DEFINE_SURVIVORS_IN_FRONT(Spheres2, hs_sphere2, 2)
HALFSPACE_DEFINE_SURVIVORS_IN_FRONT(Spheres3, hs_sphere3, 3)
#undef HALFSPACE_DEFINE_SURVIVORS_IN_FRONT

// The functions on planes of floats or doubles for one target, such as those
// that a program compares, or that it keeps where it must not read what the
// library chose.
template <typename T>
struct BoxKernels {
  // As SurvivorsOf...(planes, n, query, mask), and for several queries.
  struct OfBound {
    void (*one)(const T* const* planes, std::size_t n, const T* query,
                std::uint64_t* mask) noexcept;
    void (*several)(const T* const* planes, std::size_t n, const T* queries,
                    std::size_t count, std::uint64_t* masks) noexcept;
  };
  OfBound boxes2, boxes3, boxes4;
};

template <typename T>
struct Kernels : BoxKernels<T> {};
template <>
struct Kernels<float> : BoxKernels<float> {
  OfBound simplices2, simplices3, simplices4;
  OfBound octahedra2, octahedra3, octahedra4;
};

// Returns the kernels of a target (targets.h), by default of the chosen one. If
// the library was built with fewer dimensions (HALFSPACE_DIMS), the pointers of
// bounds that it lacks are null. The functions above do not link then. The
// reference is always valid.
//
//   const auto& avx2 = halfspace::KernelsOf(halfspace::TargetByName("AVX2"));
//   avx2.boxes3.one(planes, n, query, mask.data());
//
// Errors: throws (error.h) if the target is not supported here, or if
// HALFSPACE_TARGET is not. Cost: a program that calls it links the kernels of
// all bounds of floats, or of all boxes of doubles.
template <typename T = float>
const Kernels<T>& KernelsOf(Target target = {});
template <>
HALFSPACE_API const Kernels<float>& KernelsOf<float>(Target target);
template <>
HALFSPACE_API const Kernels<double>& KernelsOf<double>(Target target);

}  // namespace halfspace

#endif  // HALFSPACE_KERNELS_H_

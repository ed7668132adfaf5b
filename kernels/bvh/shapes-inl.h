// The tests of shapes on the floats of 64 objects or nodes.
//
// Answers are the same on every target: each result is that of one operation in
// IEEE's arithmetic, in one order, and a NaN is passed over by a compare, as
// minima and maxima of it differ between targets. All results grow with the
// planes of a bound, or fall, so what rejects a node rejects its objects.
#if defined(HALFSPACE_KERNELS_BVH_SHAPES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_SHAPES_INL_H_
#undef HALFSPACE_KERNELS_BVH_SHAPES_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_SHAPES_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hwy/highway.h"
#include "kernels/bvh/block.h"
#include "kernels/bvh/front-inl.h"
#include "kernels/bvh/shape.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// a < b ? a : b: b if one is no number.
template <class V>
HWY_INLINE V LesserOf(V a, V b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
  return hn::Min(a, b);
#else
  return hn::IfThenElse(hn::Lt(a, b), a, b);
#endif
}

// The squared distances of the bounds of a block from i on: never a NaN, and
// never -0.
template <class D>
HWY_INLINE hn::Vec<D> SquaredDistance(D d, const detail::BvhLevel& level,
                                      size_t block, size_t i,
                                      const detail::Ball& ball) {
  auto sum = hn::Zero(d);
  for (size_t k = 0; k < ball.dims; ++k) {
    const auto c = hn::Set(d, ball.center[k]);
    auto gap = GreaterOf(hn::Sub(hn::LoadU(d, level.Plane(block, k) + i), c),
                         hn::Zero(d));
    if (ball.max_plane != 0) {
      const float* const maxima = level.Plane(block, ball.max_plane + k);
      gap = GreaterOf(hn::Sub(c, hn::LoadU(d, maxima + i)), gap);
    }
    sum = hn::Add(sum, hn::Mul(gap, gap));
  }
  return sum;
}

// Where the line enters bounds from i on: 0 or more. Beyond exit, it does not.
template <class D>
HWY_INLINE hn::Vec<D> EntryOf(D d, const detail::BvhLevel& level, size_t block,
                              size_t i, const detail::Line& line,
                              hn::Vec<D>& exit) {
  const auto at = [&](size_t p) HWY_ATTR {
    const detail::LinePlane& plane = line.plane[p];
    return hn::Mul(hn::Sub(hn::LoadU(d, level.Plane(block, plane.plane) + i),
                           hn::Set(d, plane.offset)),
                   hn::Set(d, plane.inverse));
  };
  auto enter = hn::Zero(d);
  exit = hn::Set(d, line.max_t);
  size_t p = 0;
  for (; p < line.entering; ++p) enter = GreaterOf(at(p), enter);
  for (; p < line.planes; ++p) exit = LesserOf(at(p), exit);
  exit = hn::Add(exit, hn::Set(d, detail::kApartOnLine));
  return enter;
}

// Of the candidates among 64 those for which `rejects` is false, a vector at a
// time where there are any.
template <class Rejects>
HWY_INLINE uint64_t NotRejected(uint64_t candidates, const Rejects& rejects) {
  const WordTag<float> d;
  const size_t lanes = hn::Lanes(d);
  const uint64_t all = ~uint64_t{0} >> (detail::kBlockObjects - lanes);
  for (size_t i = 0; i < detail::kBlockObjects; i += lanes) {
    if ((candidates & all << i) == 0) continue;
    candidates &= ~(LaneBits(d, rejects(d, i)) << i);
  }
  return candidates;
}

inline uint64_t BallBits(const detail::WalkShape& shape,
                         const detail::BvhLevel& level, size_t block,
                         uint64_t candidates) {
  return NotRejected(candidates, [&](auto d, size_t i) HWY_ATTR {
    return hn::Gt(SquaredDistance(d, level, block, i, shape.ball),
                  hn::Set(d, shape.ball.limit));
  });
}

// By their farthest corners. The squares of their objects' distances, as
// computed, are no greater.
inline uint64_t InBallBits(const detail::WalkShape& shape,
                           const detail::BvhLevel& level, size_t block,
                           uint64_t candidates) {
  return NotRejected(candidates, [&](auto d, size_t i) HWY_ATTR {
    auto sum = hn::Zero(d);
    for (size_t k = 0; k < shape.ball.dims; ++k) {
      const auto c = hn::Set(d, shape.ball.center[k]);
      const float* const minima = level.Plane(block, k);
      const float* const maxima = level.Plane(block, shape.ball.max_plane + k);
      const auto gap = GreaterOf(hn::Sub(hn::LoadU(d, maxima + i), c),
                                 hn::Sub(c, hn::LoadU(d, minima + i)));
      sum = hn::Add(sum, hn::Mul(gap, gap));
    }
    return hn::Not(hn::Le(sum, hn::Set(d, shape.ball.limit)));
  });
}

inline uint64_t LineBits(const detail::WalkShape& shape,
                         const detail::BvhLevel& level, size_t block,
                         uint64_t candidates) {
  return NotRejected(candidates, [&](auto d, size_t i) HWY_ATTR {
    auto exit = hn::Zero(d);
    const auto enter = EntryOf(d, level, block, i, shape.line, exit);
    return hn::Gt(enter, exit);
  });
}

// Those whose farthest corners, or nearest, are in front of all.
template <bool kIsNearest>
uint64_t FrontBits(const detail::WalkShape& shape,
                   const detail::BvhLevel& level, size_t block,
                   uint64_t candidates) {
  for (size_t f = 0; f < shape.front_count && candidates != 0; ++f) {
    const detail::Front& front = shape.fronts[f];
    candidates = NotRejected(candidates, [&](auto d, size_t i) HWY_ATTR {
      const auto sum =
          FrontSum(d, front, [&](const detail::Front::Term& term) HWY_ATTR {
            const size_t plane = kIsNearest ? term.opposite : term.plane;
            return hn::LoadU(d, level.Plane(block, plane) + i);
          });
      const auto is_behind = hn::Lt(sum, hn::Zero(d));
      return kIsNearest ? hn::Or(is_behind, hn::Ne(sum, sum)) : is_behind;
    });
  }
  return candidates;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_SHAPES_INL_H_

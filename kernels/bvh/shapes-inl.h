// Tests 64 objects or nodes by their floats against a query shape.
//
// Results are the same on every target (half_space_sum-inl.h). All computed
// values are monotone in the planes of a bound, so a shape that rejects a node
// rejects all objects in it.
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
#include "kernels/bvh/half_space_sum-inl.h"
#include "kernels/bvh/kernel_table.h"
#include "kernels/bvh/shape_query.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The squared distances of one vector of bounds, whose minima of the first axis
// are at `floats`. They are never NaN and never -0. kDims is the number of
// dimensions of bounds with maxima, or 0 for any bounds.
template <size_t kDims = 0, class D>
HWY_INLINE hn::Vec<D> SquaredDistance(D d, const float* floats,
                                      const detail::NearBox& box) {
  const float* const maxima = floats + box.max_plane * detail::kBlockObjects;
  auto sum = hn::Zero(d);
  for (size_t k = 0; k < (kDims == 0 ? box.dims : kDims); ++k) {
    const size_t plane = k * detail::kBlockObjects;
    auto gap = GreaterOf(
        hn::Sub(hn::LoadU(d, floats + plane), hn::Set(d, box.high[k])),
        hn::Zero(d));
    if (kDims != 0 || box.max_plane != 0) {
      gap = GreaterOf(
          hn::Sub(hn::Set(d, box.low[k]), hn::LoadU(d, maxima + plane)), gap);
    }
    sum = hn::Add(sum, hn::Mul(gap, gap));
  }
  return sum;
}

// Where the line enters one vector of bounds, from bound i on: 0 or more. The
// line misses a bound if this is above `exit`. Before the call, `exit` has the
// limit of t. kAxes is the number of axes of a line with maxima, or 0 for other
// lines.
template <size_t kAxes = 0, class D>
HWY_INLINE hn::Vec<D> EntryOf(D d, const detail::BvhLevel& level, size_t block,
                              size_t i, const detail::Line& line,
                              hn::Vec<D>& exit) {
  const float* const floats = level.Plane(block, 0) + i;
  const auto at = [&](size_t p) HWY_ATTR {
    const detail::LinePlane& plane = line.plane[p];
    const float* const values = floats + plane.plane * detail::kBlockObjects;
    return hn::Mul(hn::Sub(hn::LoadU(d, values), hn::Set(d, plane.offset)),
                   hn::Set(d, plane.inverse));
  };
  const size_t entering = kAxes == 0 ? line.entering : kAxes;
  const size_t planes = kAxes == 0 ? line.planes : 2 * kAxes;
  auto enter = hn::Zero(d);
  size_t p = 0;
  for (; p < entering; ++p) enter = GreaterOf(at(p), enter);
  for (; p < planes; ++p) exit = LesserOf(at(p), exit);
  exit = hn::Add(exit, hn::Set(d, detail::kApartOnLine));
  return enter;
}

// The candidates for which rejects() is false. Vectors without a candidate are
// not tested.
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

// All tests of a block are calls of TestApart().
template <class Shape>
class ShapeQuery {
 public:
  static constexpr bool kHasCodes = false;

  uint64_t Test(size_t query, const detail::BvhLevel& level,
                size_t block) const {
    return static_cast<const Shape*>(this)->TestApart(query, level, block);
  }
  uint64_t TestOnlyLeaf(size_t query, const detail::BvhLevel& level) const {
    return Test(query, level, 0);
  }
  // Calls function() in the floating-point mode of the caller.
  template <typename Function>
  static bool Outside(const Function& function) {
    return function();
  }
};

// The bounds that a sphere or a rounded box may touch.
class BallQuery : public ShapeQuery<BallQuery> {
 public:
  static constexpr bool kFindsInside = true;

  explicit BallQuery(const void* ball)
      : ball_(*static_cast<const detail::Ball*>(ball)) {}

  HWY_NOINLINE uint64_t TestApart(size_t, const detail::BvhLevel& level,
                                  size_t block) const {
    return NotRejected(level.present[block], [&](auto d, size_t i) HWY_ATTR {
      const float* const floats = level.Plane(block, 0) + i;
      auto rejects = hn::Gt(SquaredDistance(d, floats, ball_.center),
                            hn::Set(d, ball_.limit));
      if (ball_.d_axis != 0) {
        const auto min = hn::LoadU(d, level.Plane(block, ball_.d_axis) + i);
        rejects = hn::Or(rejects, hn::Gt(min, hn::Set(d, ball_.d_max)));
        if (ball_.center.max_plane != 0) {
          const auto max = hn::LoadU(
              d, level.Plane(block, ball_.center.max_plane + ball_.d_axis) + i);
          rejects = hn::Or(rejects, hn::Lt(max, hn::Set(d, ball_.d_min)));
        }
      }
      return rejects;
    });
  }

  // Tests the farthest corners of nodes. The computed squared distances of
  // their objects are not greater.
  HWY_NOINLINE uint64_t Inside(size_t, const detail::BvhLevel& level,
                               size_t block, uint64_t kept) const {
    return NotRejected(kept, [&](auto d, size_t i) HWY_ATTR {
      const auto min = [&](size_t k) HWY_ATTR {
        return hn::LoadU(d, level.Plane(block, k) + i);
      };
      const auto max = [&](size_t k) HWY_ATTR {
        return hn::LoadU(d, level.Plane(block, ball_.center.max_plane + k) + i);
      };
      auto sum = hn::Zero(d);
      for (size_t k = 0; k < ball_.center.dims; ++k) {
        const auto gap = GreaterOf(
            GreaterOf(hn::Sub(max(k), hn::Set(d, ball_.center.high[k])),
                      hn::Sub(hn::Set(d, ball_.center.low[k]), min(k))),
            hn::Zero(d));
        sum = hn::Add(sum, hn::Mul(gap, gap));
      }
      auto is_inside = hn::Le(sum, hn::Set(d, ball_.limit));
      if (ball_.d_axis != 0) {
        is_inside = hn::And(
            is_inside,
            hn::And(hn::Le(max(ball_.d_axis), hn::Set(d, ball_.d_max)),
                    hn::Ge(min(ball_.d_axis), hn::Set(d, ball_.d_min))));
      }
      return hn::Not(is_inside);
    });
  }

 private:
  const detail::Ball& ball_;
};

// The bounds that a line enters.
class LineQuery : public ShapeQuery<LineQuery> {
 public:
  static constexpr bool kFindsInside = false;

  explicit LineQuery(const void* line)
      : line_(*static_cast<const detail::Line*>(line)) {}

  HWY_NOINLINE uint64_t TestApart(size_t, const detail::BvhLevel& level,
                                  size_t block) const {
    return NotRejected(level.present[block], [&](auto d, size_t i) HWY_ATTR {
      auto exit = hn::Set(d, line_.max_t);
      const auto enter = EntryOf(d, level, block, i, line_, exit);
      return hn::Gt(enter, exit);
    });
  }

 private:
  const detail::Line& line_;
};

// The bounds that are not behind a half-space.
class HalfSpacesQuery : public ShapeQuery<HalfSpacesQuery> {
 public:
  static constexpr bool kFindsInside = true;

  explicit HalfSpacesQuery(const void* half_spaces)
      : half_spaces_(*static_cast<const detail::HalfSpaceTests*>(half_spaces)) {
  }

  HWY_NOINLINE uint64_t TestApart(size_t, const detail::BvhLevel& level,
                                  size_t block) const {
    return half_spaces_.max_plane == 0
               ? Bits<false, true>(level, block, level.present[block])
               : Bits<false, false>(level, block, level.present[block]);
  }
  template <typename Function>
  bool Outside(const Function& function) {
    return mode_.Outside(function);
  }
  HWY_NOINLINE uint64_t Inside(size_t, const detail::BvhLevel& level,
                               size_t block, uint64_t kept) const {
    return Bits<true, false>(level, block, kept);
  }

 private:
  // The bounds whose farthest corners are in front of all half-spaces, or, with
  // kIsNearest, their nearest corners.
  template <bool kIsNearest, bool kIsSimplex>
  HWY_NOINLINE uint64_t Bits(const detail::BvhLevel& level, size_t block,
                             uint64_t candidates) const {
    const float* const floats = level.Plane(block, 0);
    if (half_spaces_.box_dims != 0) {
      candidates = NotRejected(candidates, [&](auto d, size_t i) HWY_ATTR {
        return IsOutside<kIsNearest>(d, floats + i);
      });
    }
    const WordTag<float> d;
    const size_t lanes = hn::Lanes(d);
    const uint64_t all = ~uint64_t{0} >> (detail::kBlockObjects - lanes);
    for (size_t i = 0; i < detail::kBlockObjects; i += lanes) {
      for (size_t f = 0; f < half_spaces_.count && (candidates & all << i) != 0;
           ++f) {
        const detail::HalfSpaceTest& test = half_spaces_.test[f];
        const auto sum = HalfSpaceSum<kIsSimplex>(
            d, test, test.terms,
            [&](const detail::HalfSpaceTest::Term& term) HWY_ATTR {
              const size_t plane = kIsNearest ? term.opposite : term.plane;
              return hn::LoadU(d, floats + plane * detail::kBlockObjects + i);
            });
        // Not Ne(sum, sum), which is false for a NaN on some targets.
        const uint64_t out = kIsNearest
                                 ? ~LaneBits(d, hn::Ge(sum, hn::Zero(d))) & all
                                 : LaneBits(d, hn::Lt(sum, hn::Zero(d)));
        candidates &= ~(out << i);
      }
    }
    return candidates;
  }

  // Whether bounds are outside of the box.
  template <bool kIsNearest, class D>
  HWY_INLINE hn::Mask<D> IsOutside(D d, const float* floats) const {
    const float* const maxima =
        floats + half_spaces_.max_plane * detail::kBlockObjects;
    auto is_outside = hn::Lt(hn::Zero(d), hn::Zero(d));
    for (size_t k = 0; k < half_spaces_.box_dims; ++k) {
      const auto min = hn::LoadU(d, floats + k * detail::kBlockObjects);
      const auto max = hn::LoadU(d, maxima + k * detail::kBlockObjects);
      const auto low = hn::Set(d, half_spaces_.low[k]);
      const auto high = hn::Set(d, half_spaces_.high[k]);
      if constexpr (kIsNearest) {
        const auto is_inside = hn::And(hn::Ge(min, low), hn::Le(max, high));
        is_outside = hn::Or(is_outside, hn::Not(is_inside));
      } else {
        is_outside =
            hn::Or(is_outside, hn::Or(hn::Gt(min, high), hn::Lt(max, low)));
      }
    }
    return is_outside;
  }

  const detail::HalfSpaceTests& half_spaces_;
  // During the whole walk, whose other steps compute no floats.
  UpwardFpMode mode_;
};

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_SHAPES_INL_H_

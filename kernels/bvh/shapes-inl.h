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
#include "kernels/bvh/shape.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// What a stored code of 0 is more than the first code of a value, less the
// margin.
inline constexpr float kFirstCode =
    detail::kCodeBias - 1 - 2 * detail::kCodeMargin;

// a > b ? a : b, and a < b ? a : b: b if one is no number.
template <class V>
HWY_INLINE V GreaterOf(V a, V b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
  return hn::Max(a, b);
#else
  return hn::IfThenElse(hn::Gt(a, b), a, b);
#endif
}
template <class V>
HWY_INLINE V LesserOf(V a, V b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
  return hn::Min(a, b);
#else
  return hn::IfThenElse(hn::Lt(a, b), a, b);
#endif
}

// The squared distances of bounds from i on: never a NaN, and never -0.
template <class D>
HWY_INLINE hn::Vec<D> SquaredDistance(D d, const detail::BvhLevel& level,
                                      size_t i, const detail::Ball& ball) {
  auto sum = hn::Zero(d);
  for (size_t k = 0; k < ball.dims; ++k) {
    const auto c = hn::Set(d, ball.center[k]);
    auto gap =
        GreaterOf(hn::Sub(hn::LoadU(d, level.planes[k] + i), c), hn::Zero(d));
    if (ball.max_plane != 0) {
      const float* const maxima = level.planes[ball.max_plane + k];
      gap = GreaterOf(hn::Sub(c, hn::LoadU(d, maxima + i)), gap);
    }
    sum = hn::Add(sum, hn::Mul(gap, gap));
  }
  return sum;
}

// Where the line enters bounds from i on: 0 or more. Beyond exit, it does not.
template <class D>
HWY_INLINE hn::Vec<D> EntryOf(D d, const detail::BvhLevel& level, size_t i,
                              const detail::Line& line, hn::Vec<D>& exit) {
  const auto at = [&](size_t p) HWY_ATTR {
    const detail::LinePlane& plane = line.plane[p];
    return hn::Mul(hn::Sub(hn::LoadU(d, level.planes[plane.plane] + i),
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
                         const detail::BvhLevel& level, size_t first,
                         uint64_t candidates) {
  return NotRejected(candidates, [&](auto d, size_t i) HWY_ATTR {
    return hn::Gt(SquaredDistance(d, level, first + i, shape.ball),
                  hn::Set(d, shape.ball.limit));
  });
}

// By their farthest corners. The squares of their objects' distances, as
// computed, are no greater.
inline uint64_t InBallBits(const detail::WalkShape& shape,
                           const detail::BvhLevel& level, size_t first,
                           uint64_t candidates) {
  return NotRejected(candidates, [&](auto d, size_t i) HWY_ATTR {
    auto sum = hn::Zero(d);
    for (size_t k = 0; k < shape.ball.dims; ++k) {
      const auto c = hn::Set(d, shape.ball.center[k]);
      const float* const minima = level.planes[k] + first;
      const float* const maxima =
          level.planes[shape.ball.max_plane + k] + first;
      const auto gap = GreaterOf(hn::Sub(hn::LoadU(d, maxima + i), c),
                                 hn::Sub(c, hn::LoadU(d, minima + i)));
      sum = hn::Add(sum, hn::Mul(gap, gap));
    }
    return hn::Not(hn::Le(sum, hn::Set(d, shape.ball.limit)));
  });
}

inline uint64_t LineBits(const detail::WalkShape& shape,
                         const detail::BvhLevel& level, size_t first,
                         uint64_t candidates) {
  return NotRejected(candidates, [&](auto d, size_t i) HWY_ATTR {
    auto exit = hn::Zero(d);
    const auto enter = EntryOf(d, level, first + i, shape.line, exit);
    return hn::Gt(enter, exit);
  });
}

// As LineBits, with what codes say of the floats. A code c says that the stored
// value, which is that of a minimum or the negated one of a maximum, is at
// least base + (c - 1 - margin) / scale: so t is at least slope * c + t_of_0 if
// the line enters by the plane, and at most that if it leaves. What is added to
// t_of_0 is more than all rounding here and in EntryOf, so that answers are not
// those of codes.
inline uint64_t LineCodeBits(const detail::WalkShape& shape,
                             const detail::BvhLevel& level, size_t first,
                             uint64_t candidates) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const detail::Line& line = shape.line;
  const std::byte* const block =
      level.blocks + first / detail::kBlockObjects * line.block_bytes;
  const auto& scale = *reinterpret_cast<const detail::BlockScale*>(block);
  const auto* const codes =
      reinterpret_cast<const int8_t*>(block + sizeof(scale));
  // Of all planes at once.
  HWY_ALIGN float slopes[8];
  HWY_ALIGN float t_of_0[8];
  const hn::CappedTag<float, 8> d8;
  for (size_t l = 0; l < 8; l += hn::Lanes(d8)) {
    const auto factor = hn::Load(d8, line.codes.factor + l);
    const auto slope = hn::Div(factor, hn::LoadU(d8, scale.scale + l));
    const auto base = hn::Mul(hn::Sub(hn::LoadU(d8, scale.base + l),
                                      hn::Load(d8, line.codes.offset + l)),
                              factor);
    const auto size =
        hn::Add(hn::Abs(base), hn::Mul(hn::Abs(slope), hn::Set(d8, 256.0f)));
    const auto error = hn::Mul(size, hn::Load(d8, line.codes.outward + l));
    const auto t = hn::Add(
        hn::Add(hn::Add(base, hn::Mul(slope, hn::Set(d8, kFirstCode))), error),
        hn::Load(d8, line.codes.more + l));
    // An overflow is no infinity in all modes.
    const auto is_sure = hn::Lt(size, hn::Set(d8, 0x1p100f));
    hn::Store(hn::IfThenElseZero(is_sure, slope), d8, slopes + l);
    hn::Store(hn::IfThenElse(is_sure, t,
                             hn::Mul(hn::Load(d8, line.codes.outward + l),
                                     hn::Set(d8, kInf))),
              d8, t_of_0 + l);
  }
  const hn::CappedTag<float, detail::kBlockObjects / 4> d;
  const hn::Rebind<int32_t, decltype(d)> di;
  const hn::Rebind<int8_t, decltype(d)> d_codes;
  // Four vectors at a time, of which a plane's factors are read once.
  const size_t lanes = hn::Lanes(d);
  uint64_t rejected = 0;
  for (size_t i = 0; i < detail::kBlockObjects; i += 4 * lanes) {
    auto enter0 = hn::Zero(d);
    auto enter1 = enter0;
    auto enter2 = enter0;
    auto enter3 = enter0;
    auto exit0 = hn::Set(d, line.max_t);
    auto exit1 = exit0;
    auto exit2 = exit0;
    auto exit3 = exit0;
    for (size_t p = 0; p < line.planes; ++p) {
      const detail::LinePlane& plane = line.plane[p];
      const auto slope = hn::Set(d, slopes[plane.lane]);
      const auto of_0 = hn::Set(d, t_of_0[plane.lane]);
      const int8_t* const from =
          codes + plane.plane * detail::kBlockObjects + i;
      const auto at = [&](size_t v) HWY_ATTR {
        const auto code = hn::ConvertTo(
            d, hn::PromoteTo(di, hn::LoadU(d_codes, from + v * lanes)));
        return hn::MulAdd(code, slope, of_0);
      };
      if (p < line.entering) {
        enter0 = GreaterOf(at(0), enter0);
        enter1 = GreaterOf(at(1), enter1);
        enter2 = GreaterOf(at(2), enter2);
        enter3 = GreaterOf(at(3), enter3);
      } else {
        exit0 = LesserOf(at(0), exit0);
        exit1 = LesserOf(at(1), exit1);
        exit2 = LesserOf(at(2), exit2);
        exit3 = LesserOf(at(3), exit3);
      }
    }
    const auto apart = hn::Set(d, 2 * detail::kApartOnLine);
    const auto bits = [&](hn::Vec<decltype(d)> enter,
                          hn::Vec<decltype(d)> exit) HWY_ATTR {
      return LaneBits(d, hn::Gt(enter, hn::Add(exit, apart)));
    };
    rejected |=
        (bits(enter0, exit0) | bits(enter1, exit1) << lanes |
         bits(enter2, exit2) << 2 * lanes | bits(enter3, exit3) << 3 * lanes)
        << i;
  }
  candidates &= ~rejected;
  // Code 0 may stand for anything that is less.
  const WordTag<int8_t> d_bytes;
  const auto zero = hn::Set(d_bytes, static_cast<int8_t>(-detail::kCodeBias));
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d_bytes)) {
    auto least = hn::Set(d_bytes, int8_t{127});
    for (size_t p = 0; p < line.planes; ++p) {
      least = hn::Min(
          least,
          hn::LoadU(d_bytes,
                    codes + line.plane[p].plane * detail::kBlockObjects + i));
    }
    candidates |= LaneBits(d_bytes, hn::Eq(least, zero)) << i;
  }
  return candidates;
}

// Those whose farthest corners, or nearest, are in front of all.
template <bool kIsNearest>
uint64_t FrontBits(const detail::WalkShape& shape,
                   const detail::BvhLevel& level, size_t first,
                   uint64_t candidates) {
  for (size_t f = 0; f < shape.front_count && candidates != 0; ++f) {
    const detail::Front& front = shape.fronts[f];
    candidates = NotRejected(candidates, [&](auto d, size_t i) HWY_ATTR {
      auto sum = hn::Set(d, front.offset);
      for (size_t t = 0; t < front.terms; ++t) {
        const detail::Front::Term& term = front.term[t];
        const float* const plane =
            level.planes[kIsNearest ? term.opposite : term.plane];
        const auto value = hn::LoadU(d, plane + first + i);
        sum = hn::Add(sum, GreaterOf(hn::Mul(value, hn::Set(d, term.more)),
                                     hn::Mul(value, hn::Set(d, term.less))));
      }
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

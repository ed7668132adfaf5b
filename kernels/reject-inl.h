// THE loop: load, compare, OR, staged early-out, tail. Shapes are data
// (planes.h), what happens to the words is a sink (sinks-inl.h), the lane type
// a template parameter.
//
// Query planes travel as a parameter pack of vectors: an SVE vector cannot be
// an array element or a member.
#if defined(HALFSPACE_KERNELS_REJECT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_REJECT_INL_H_
#undef HALFSPACE_KERNELS_REJECT_INL_H_
#else
#define HALFSPACE_KERNELS_REJECT_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <utility>

#include "hwy/highway.h"
#include "kernels/lane_bits-inl.h"
#include "kernels/planes.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr size_t kWordObjects = 64;

// 64 lanes are one word, so a longer vector (uint8 on 2048-bit SVE) is capped.
template <typename T>
using WordTag = hn::CappedTag<T, kWordObjects>;

// Loads a full vector.
struct LoadAll {
  template <class D, typename T>
  HWY_INLINE hn::Vec<D> operator()(D d, const T* from) const {
    return hn::LoadU(d, from);
  }
};

// Loads the first `count` lanes and reads nothing past them; the others are
// unspecified. 0 < count < lanes.
struct LoadFirst {
  size_t count;

  template <class D, typename T>
  HWY_INLINE hn::Vec<D> operator()(D d, const T* from) const {
#if HWY_MEM_OPS_MIGHT_FAULT
    HWY_ALIGN T copy[HWY_MAX_BYTES / sizeof(T)];
    for (size_t i = 0; i < count; ++i) copy[i] = from[i];
    for (size_t i = count; i < hn::Lanes(d); ++i) copy[i] = T{};
    return hn::Load(d, copy);
#else
    return hn::MaskedLoad(hn::FirstN(d, count), d, from);
#endif
  }
};

// Lanes that one plane rejects. The compare is strict and ordered: touching
// and NaN are kept.
template <kernels::Plane kPlane, class D, class V>
HWY_INLINE hn::Mask<D> PlaneRejects(D /*d*/, V object, V query) {
  if constexpr (kPlane.is_min) {
    return hn::Gt(object, query);
  } else {
    return hn::Lt(object, query);
  }
}

// Lanes of objects i, i + 1, ... that planes [kBegin, kEnd) reject.
template <class Shape, size_t kBegin, size_t kEnd, size_t kNow = 0, class D,
          class Load, typename T, class V, class... Rest>
HWY_INLINE hn::Mask<D> LanesRejected(D d, Load load, const T* const* planes,
                                     size_t i, V query, Rest... rest) {
  if constexpr (kNow < kBegin) {
    return LanesRejected<Shape, kBegin, kEnd, kNow + 1>(d, load, planes, i,
                                                        rest...);
  } else {
    constexpr kernels::Plane kPlane = Shape::kOrder.planes[kNow];
    const hn::Mask<D> rejected =
        PlaneRejects<kPlane>(d, load(d, planes[kPlane.object] + i), query);
    if constexpr (kNow + 1 == kEnd) {
      return rejected;
    } else {
      return hn::Or(rejected, LanesRejected<Shape, kNow + 1, kEnd, kNow + 1>(
                                  d, load, planes, i, rest...));
    }
  }
}

// Bits of objects i ... i + kObjects - 1 that planes [kBegin, kEnd) reject.
template <class Shape, size_t kObjects, size_t kBegin, size_t kEnd, class D,
          typename T, class... V>
HWY_INLINE uint64_t BitsRejected(D d, const T* const* planes, size_t i,
                                 V... query) {
  const size_t lanes = hn::Lanes(d);
  uint64_t bits = 0;
  for (size_t l = 0; l < kObjects; l += lanes) {
    bits |= LaneBits(d, LanesRejected<Shape, kBegin, kEnd>(d, LoadAll(), planes,
                                                           i + l, query...))
            << l;
  }
  return bits;
}

// The same through the stages from kStage on: a group whose objects are all
// rejected skips the rest.
template <class Shape, size_t kObjects, size_t kStage = 0, class D, typename T,
          class... V>
HWY_INLINE uint64_t BitsRejectedStaged(D d, const T* const* planes, size_t i,
                                       V... query) {
  constexpr size_t kBegin =
      kStage == 0 ? 0 : Shape::kOrder.stage_ends[kStage == 0 ? 0 : kStage - 1];
  constexpr size_t kEnd = Shape::kOrder.stage_ends[kStage];
  const uint64_t bits =
      BitsRejected<Shape, kObjects, kBegin, kEnd>(d, planes, i, query...);
  if constexpr (kStage + 1 == Shape::kOrder.stage_ends.size()) {
    return bits;
  } else {
    if (bits == (~uint64_t{0} >> (64 - kObjects))) return bits;
    return bits | BitsRejectedStaged<Shape, kObjects, kStage + 1>(d, planes, i,
                                                                  query...);
  }
}

// One word: objects i ... i + 63.
template <class Shape, class D, typename T, class... V>
HWY_INLINE uint64_t WordRejected(D d, const T* const* planes, size_t i,
                                 V... query) {
  constexpr bool kFlat = Shape::kOrder.stage_ends.size() == 1;
  // A gate sees one vector, but not fewer than 16 objects.
  constexpr size_t kGate = kFlat ? kWordObjects : 16;
  const size_t gate = HWY_MAX(kGate, hn::Lanes(d));
  uint64_t word = 0;
  if (gate == kGate) {
    for (size_t l = 0; l < kWordObjects; l += kGate) {
      word |= BitsRejectedStaged<Shape, kGate>(d, planes, i + l, query...) << l;
    }
  } else {
    word = BitsRejectedStaged<Shape, kWordObjects>(d, planes, i, query...);
  }
  return word;
}

// The last word: `count` objects from i on, 0 < count < 64, with nothing read
// past them. Bits past `count` are 1: nothing past the end survives.
template <class Shape, class D, typename T, class... V>
HWY_INLINE uint64_t TailRejected(D d, const T* const* planes, size_t i,
                                 size_t count, V... query) {
  constexpr size_t kPlanes = Shape::kOrder.planes.size();
  const size_t lanes = hn::Lanes(d);
  uint64_t word = 0;
  size_t l = 0;
  for (; l + lanes <= count; l += lanes) {
    word |= LaneBits(d, LanesRejected<Shape, 0, kPlanes>(d, LoadAll(), planes,
                                                         i + l, query...))
            << l;
  }
  if (l < count) {
    const LoadFirst load{count - l};
    word |= LaneBits(d, LanesRejected<Shape, 0, kPlanes>(d, load, planes, i + l,
                                                         query...))
            << l;
  }
  return word | (~uint64_t{0} << count);
}

template <class Shape, class Sink, typename T, class... V>
HWY_INLINE void ScanWith(const T* const* planes, size_t size, Sink& sink,
                         V... query) {
  const WordTag<T> d;
  size_t i = 0;
  for (; i + kWordObjects <= size; i += kWordObjects) {
    if (!sink.Take(i, WordRejected<Shape>(d, planes, i, query...))) return;
  }
  if (i < size) {
    sink.Take(i, TailRejected<Shape>(d, planes, i, size - i, query...));
  }
}

template <class Shape, class Sink, typename T, size_t... kPlane>
HWY_INLINE void ScanUnpacked(const T* const* planes, const T* query,
                             size_t size, Sink& sink,
                             std::index_sequence<kPlane...>) {
  const WordTag<T> d;
  // A local copy: the sink's stores must not make the compiler reload them.
  const T* local[] = {planes[kPlane]...};
  ScanWith<Shape>(local, size, sink,
                  hn::Set(d, query[Shape::kOrder.planes[kPlane].query])...);
}

// Scans a world of `size` objects with one query and gives each word of
// rejections, in order, to the sink, until it has enough. `planes` and `query`
// are in the order of planes.h.
template <class Shape, class Sink, typename T>
HWY_INLINE void ScanWorld(const T* const* planes, const T* query, size_t size,
                          Sink& sink) {
  ScanUnpacked<Shape>(planes, query, size, sink,
                      std::make_index_sequence<Shape::kOrder.planes.size()>());
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_REJECT_INL_H_

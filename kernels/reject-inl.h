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

// Bits of the lanes of vectors 0, 1, ... after object i.
template <class Shape, size_t kBegin, size_t kEnd, size_t... kVector, class D,
          typename T, class... V>
HWY_INLINE uint64_t VectorsRejected(std::index_sequence<kVector...>, D d,
                                    const T* const* planes, size_t i,
                                    V... query) {
  const size_t lanes = hn::Lanes(d);
  return (... |
          (LaneBits(d, LanesRejected<Shape, kBegin, kEnd>(
                           d, LoadAll(), planes, i + kVector * lanes, query...))
           << (kVector * lanes)));
}

// Bits of objects i ... i + kObjects - 1 that planes [kBegin, kEnd) reject.
template <class Shape, size_t kObjects, size_t kBegin, size_t kEnd, class D,
          typename T, class... V>
HWY_INLINE uint64_t BitsRejected(D d, const T* const* planes, size_t i,
                                 V... query) {
#if HWY_HAVE_SCALABLE
  constexpr size_t kUnroll = 1;
#else
  // Constant shifts, and compares that overlap the packing of bits; more than
  // four vectors only grow the code.
  constexpr size_t kUnroll = HWY_MIN(size_t{4}, kObjects / hn::MaxLanes(D()));
#endif
  const size_t step = kUnroll * hn::Lanes(d);
  uint64_t bits = 0;
  for (size_t l = 0; l < kObjects; l += step) {
    bits |= VectorsRejected<Shape, kBegin, kEnd>(
                std::make_index_sequence<kUnroll>(), d, planes, i + l, query...)
            << l;
  }
  return bits;
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

// Every plane for every object: words go to the sink as they are made. Returns
// false when the sink has enough.
template <class Shape, class Sink, class D, typename T, class... V>
HWY_INLINE bool ScanWordsFlat(D d, const T* const* planes, size_t words,
                              Sink& sink, V... query) {
  constexpr size_t kPlanes = Shape::kOrder.planes.size();
  for (size_t w = 0; w < words; ++w) {
    const size_t i = w * kWordObjects;
    if (!sink.Take(i, BitsRejected<Shape, kWordObjects, 0, kPlanes>(
                          d, planes, i, query...))) {
      return false;
    }
  }
  return true;
}

// The groups of a tile that are not yet all rejected, by offset of their first
// object, and the rejections so far.
struct Tile {
  // 4096 objects: the list and the words stay in L1, and the branches that end
  // the loops over them cost little per object.
  static constexpr size_t kWords = 64;
  static constexpr size_t kSmallestGroup = 16;

  uint64_t words[kWords];
  uint16_t live[kWords * kWordObjects / kSmallestGroup];
  size_t live_count = 0;

  // Keeps a group on the list iff one of its objects is left. No branch: which
  // groups survive cannot be predicted, and a mispredicted branch costs more
  // than a whole vector's test (measured: 3 times slower than flat).
  template <size_t kGroup>
  HWY_INLINE void AppendIfLive(size_t offset) {
    static_assert(kGroup >= kSmallestGroup, "the list would be too short");
    constexpr uint64_t kAll = ~uint64_t{0} >> (kWordObjects - kGroup);
    const uint64_t word = words[offset / kWordObjects];
    live[live_count] = static_cast<uint16_t>(offset);
    live_count += ((word >> (offset % kWordObjects)) & kAll) != kAll;
  }
};

// Stage kStage and those after it, for the live groups only.
template <class Shape, size_t kGroup, size_t kStage, class D, typename T,
          class... V>
HWY_INLINE void TestLiveGroups(D d, const T* const* planes, size_t first,
                               Tile& tile, V... query) {
  constexpr size_t kBegin = Shape::kOrder.stage_ends[kStage - 1];
  constexpr size_t kEnd = Shape::kOrder.stage_ends[kStage];
  constexpr bool kLast = kStage + 1 == Shape::kOrder.stage_ends.size();
  const size_t count = tile.live_count;
  tile.live_count = 0;
  for (size_t j = 0; j < count; ++j) {
    const size_t offset = tile.live[j];
    tile.words[offset / kWordObjects] |=
        BitsRejected<Shape, kGroup, kBegin, kEnd>(d, planes, first + offset,
                                                  query...)
        << (offset % kWordObjects);
    if constexpr (!kLast) tile.AppendIfLive<kGroup>(offset);
  }
  if constexpr (!kLast) {
    TestLiveGroups<Shape, kGroup, kStage + 1>(d, planes, first, tile, query...);
  }
}

// Stage after stage over a tile of words; a stage sees only the groups that the
// stages before it left.
template <class Shape, class Sink, class D, typename T, class... V>
HWY_INLINE bool ScanWordsStaged(D d, const T* const* planes, size_t words,
                                Sink& sink, V... query) {
#if HWY_HAVE_SCALABLE
  // A group must hold a whole vector, whose length is not known here.
  constexpr size_t kGroup = kWordObjects;
#else
  constexpr size_t kGroup = HWY_MAX(Shape::kGroup, hn::MaxLanes(D()));
#endif
  Tile tile;
  for (size_t begin = 0; begin < words; begin += Tile::kWords) {
    const size_t tile_words = HWY_MIN(Tile::kWords, words - begin);
    const size_t first = begin * kWordObjects;
    tile.live_count = 0;
    for (size_t w = 0; w < tile_words; ++w) {
      tile.words[w] =
          BitsRejected<Shape, kWordObjects, 0, Shape::kOrder.stage_ends[0]>(
              d, planes, first + w * kWordObjects, query...);
      for (size_t g = 0; g < kWordObjects; g += kGroup) {
        tile.AppendIfLive<kGroup>(w * kWordObjects + g);
      }
    }
    TestLiveGroups<Shape, kGroup, 1>(d, planes, first, tile, query...);
    for (size_t w = 0; w < tile_words; ++w) {
      if (!sink.Take(first + w * kWordObjects, tile.words[w])) return false;
    }
  }
  return true;
}

template <class Shape, class Sink, typename T, class... V>
HWY_INLINE void ScanWith(const T* const* planes, size_t size, Sink& sink,
                         V... query) {
  const WordTag<T> d;
  const size_t words = size / kWordObjects;
  bool more;
  if constexpr (Shape::kOrder.stage_ends.size() == 1) {
    more = ScanWordsFlat<Shape>(d, planes, words, sink, query...);
  } else {
    more = ScanWordsStaged<Shape>(d, planes, words, sink, query...);
  }
  const size_t i = words * kWordObjects;
  if (more && i < size) {
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
                  hn::Set(d, query[kernels::kQueryIndex<Shape, kPlane>])...);
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

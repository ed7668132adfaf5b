// The scans of the paper's experiments: part of loops.cc.
#include "halfspace/detail/word-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// A bit for each of the objects i ... i + kObjects - 1: whether it survives the
// planes kFirst, kFirst + 1, ... of an order. The minima among them come first.
template <const auto& kOrder, size_t kFirst, size_t kObjects, size_t... kPlane,
          class D>
HWY_INLINE uint64_t StageBits(std::index_sequence<kPlane...>, D d,
                              const float* const* planes, const float* query,
                              size_t i) {
  const float* tested[] = {
      planes[bench::kPlaneOf<kOrder, kFirst + kPlane>.object]...};
  constexpr size_t kMins =
      (... + (bench::kPlaneOf<kOrder, kFirst + kPlane>.is_min ? 1 : 0));
  return KeptBits<kMins, kObjects>(
      d, LoadAll(), tested, i,
      hn::Set(d, query[bench::kPlaneOf<kOrder, kFirst + kPlane>.query])...);
}

// ---- The paper's schedule.

// The objects of one step: a vector, the same for all widths.
constexpr size_t kStep = HWY_HAVE_SCALABLE ? 4 : hn::MaxLanes(WordTag<float>());

// One plane over the vectors of a batch; true if all its objects are rejected
// after it.
template <const auto& kOrder, size_t kPlane>
HWY_INLINE bool PlaneOverBatch(const float* const* planes, const float* query,
                               size_t i, size_t steps, uint16_t* rejected) {
  constexpr uint64_t kAll = kLowBits<kStep>;
  uint64_t all = kAll;
  for (size_t s = 0; s < steps; ++s) {
    uint64_t bits = StageBits<kOrder, kPlane, kStep>(std::index_sequence<0>(),
                                                     WordTag<float>(), planes,
                                                     query, i + s * kStep) ^
                    kAll;
    if constexpr (kPlane != 0) bits |= rejected[s];
    rejected[s] = static_cast<uint16_t>(bits);
    all &= bits;
  }
  return all == kAll;
}

template <const auto& kOrder, size_t... kPlane>
void ScanBatches(std::index_sequence<kPlane...>, size_t width,
                 const float* const* planes, const float* query, size_t size,
                 uint64_t* mask) {
  uint16_t rejected[bench::kWidestGate / kStep];
  const size_t steps = width / kStep;
  uint64_t word = 0;
  for (size_t i = 0; i < size; i += width) {
    (void)(PlaneOverBatch<kOrder, kPlane>(planes, query, i, steps, rejected) ||
           ...);
    for (size_t s = 0; s < steps; ++s) {
      const size_t object = i + s * kStep;
      word |= uint64_t{rejected[s]} << object % kWordObjects;
      if ((object + kStep) % kWordObjects != 0) continue;
      mask[object / kWordObjects] = word;
      word = 0;
    }
  }
}

void ScanGated(bench::ShapeKind shape, size_t width, const float* const* planes,
               const float* query, size_t size, uint64_t* mask) {
  switch (shape) {
    case bench::ShapeKind::kSimplex:
      return ScanBatches<bench::kSimplexOrder>(
          std::make_index_sequence<4>(), width, planes, query, size, mask);
    case bench::ShapeKind::kAabb:
      return ScanBatches<bench::kAabbOrder>(std::make_index_sequence<6>(),
                                            width, planes, query, size, mask);
    case bench::ShapeKind::kAabo:
      return ScanBatches<bench::kAaboOrder>(std::make_index_sequence<8>(),
                                            width, planes, query, size, mask);
  }
}

// ---- Stages of groups, with branches or lists, and flat.

constexpr size_t kGroup = 16;
constexpr size_t kTile = 4096;

// The survivors of one group after all stages, or none as soon as a stage
// leaves none.
template <const auto& kOrder, size_t kPlanes, size_t... kStage, class D>
HWY_INLINE uint64_t GroupByBranches(std::index_sequence<kStage...>, D d,
                                    const float* const* planes,
                                    const float* query, size_t i) {
  uint64_t kept = kLowBits<kGroup>;
  (void)(... && ((kept &= StageBits<kOrder, kStage * kPlanes, kGroup>(
                      std::make_index_sequence<kPlanes>(), d, planes, query,
                      i)) != 0));
  return kept;
}

// One stage of a tile: of the listed groups, or of all groups if it is the
// first stage. Returns how many groups are left in the list, by the offset of
// their first object. Nothing branches on a survivor: which groups survive
// cannot be predicted, and a mispredicted branch costs more than the test of a
// whole vector.
template <const auto& kOrder, size_t kPlanes, size_t kStage, class D>
HWY_INLINE size_t StageOfTile(D d, const float* const* planes,
                              const float* query, size_t first, size_t groups,
                              uint16_t* list, uint64_t* mask) {
  size_t left = 0;
  for (size_t g = 0; g < groups; ++g) {
    const size_t offset = kStage == 0 ? g * kGroup : list[g];
    const size_t shift = offset % kWordObjects;
    uint64_t& word = mask[(first + offset) / kWordObjects];
    const uint64_t kept = StageBits<kOrder, kStage * kPlanes, kGroup>(
        std::make_index_sequence<kPlanes>(), d, planes, query, first + offset);
    // A mask of rejected objects, which begins with none.
    if (kStage == 0 && shift == 0) word = 0;
    word |= (kept ^ kLowBits<kGroup>) << shift;
    list[left] = static_cast<uint16_t>(offset);
    left += (~word >> shift & kLowBits<kGroup>) != 0;
  }
  return left;
}

template <const auto& kOrder, size_t kPlanes, size_t... kStage, class D>
HWY_INLINE void ScanStages(std::index_sequence<kStage...> stages, D d,
                           bench::Way way, const float* const* planes,
                           const float* query, size_t size, uint64_t* mask) {
  if (way == bench::Way::kBranches) {
    for (size_t i = 0; i < size; i += kWordObjects) {
      uint64_t word = 0;
      for (size_t g = 0; g < kWordObjects; g += kGroup) {
        word |=
            GroupByBranches<kOrder, kPlanes>(stages, d, planes, query, i + g)
            << g;
      }
      mask[i / kWordObjects] = ~word;
    }
    return;
  }
  uint16_t list[kTile / kGroup];
  for (size_t i = 0; i < size; i += kTile) {
    size_t groups = HWY_MIN(kTile, size - i) / kGroup;
    ((groups = StageOfTile<kOrder, kPlanes, kStage>(d, planes, query, i, groups,
                                                    list, mask)),
     ...);
  }
}

template <const auto& kOrder, const auto& kFlatOrder, size_t kPlanes, class D>
void ScanShape(D d, bench::Way way, size_t planes_of_stage,
               const float* const* planes, const float* query, size_t size,
               uint64_t* mask) {
  if (way == bench::Way::kFlat) {
    for (size_t i = 0; i < size; i += kWordObjects) {
      mask[i / kWordObjects] = ~StageBits<kFlatOrder, 0, kWordObjects>(
          std::make_index_sequence<kPlanes>(), d, planes, query, i);
    }
  } else if (planes_of_stage == 1) {
    ScanStages<kOrder, 1>(std::make_index_sequence<kPlanes>(), d, way, planes,
                          query, size, mask);
  } else {
    ScanStages<kOrder, 2>(std::make_index_sequence<kPlanes / 2>(), d, way,
                          planes, query, size, mask);
  }
}

void ScanStaged(bench::ShapeKind shape, bench::Way way, size_t planes_of_stage,
                const float* const* planes, const float* query, size_t size,
                uint64_t* mask) {
  const OneTag<float> d;
  if (shape == bench::ShapeKind::kSimplex) {
    ScanShape<bench::kSimplexOrder, bench::kSimplexOrder, 4>(
        d, way, planes_of_stage, planes, query, size, mask);
  } else {
    ScanShape<bench::kAabbOrder, bench::kFlatAabbOrder, 6>(
        d, way, planes_of_stage, planes, query, size, mask);
  }
}

// ---- Spheres.

template <class D, class V>
HWY_INLINE uint64_t SphereBits(D d, const float* const* planes, size_t i, V x,
                               V y, V z, V radius) {
  const V dx = hn::Sub(hn::Load(d, planes[0] + i), x);
  const V dy = hn::Sub(hn::Load(d, planes[1] + i), y);
  const V dz = hn::Sub(hn::Load(d, planes[2] + i), z);
  const V reach = hn::Add(hn::Load(d, planes[3] + i), radius);
  const V square = hn::MulAdd(dz, dz, hn::MulAdd(dy, dy, hn::Mul(dx, dx)));
  // As in the library's verdicts, what is above is rejected.
  return VerdictBits(d, FirstVerdict<true>(d, square, hn::Mul(reach, reach)));
}

// Unrolled as KeptBits is.
template <size_t... kVector, class D, class... V>
HWY_INLINE uint64_t SphereVectors(std::index_sequence<kVector...>, D d,
                                  const float* const* planes, size_t i,
                                  V... query) {
  const size_t lanes = hn::Lanes(d);
  return (... | (SphereBits(d, planes, i + kVector * lanes, query...)
                 << (kVector * lanes)));
}

void ScanSpheres(const float* const* planes, const float* query, size_t size,
                 uint64_t* mask) {
  using D = OneTag<float>;
#if HWY_HAVE_SCALABLE
  constexpr size_t kUnroll = 1;
#else
  constexpr size_t kUnroll =
      HWY_MIN(size_t{4}, kWordObjects / hn::MaxLanes(D()));
#endif
  const D d;
  const auto x = hn::Set(d, query[0]);
  const auto y = hn::Set(d, query[1]);
  const auto z = hn::Set(d, query[2]);
  const auto radius = hn::Set(d, query[3]);
  const size_t step = kUnroll * hn::Lanes(d);
  for (size_t i = 0; i < size; i += kWordObjects) {
    uint64_t bits = 0;
    for (size_t l = 0; l < kWordObjects; l += step) {
      bits |= SphereVectors(std::make_index_sequence<kUnroll>(), d, planes,
                            i + l, x, y, z, radius)
              << l;
    }
    mask[i / kWordObjects] = kVerdictIsKept<D> ? bits : ~bits;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

// The scans of the paper's experiments: part of loops.cc.
#include "halfspace/detail/word-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

struct Scan {
  const float* const* planes;
  const float* query;
  size_t size;
  uint64_t* mask;
};

// Returns a bit for each of the objects i ... i + kObjects - 1: whether it
// survives the planes kFirst + kPlane... of an order (loops.h). The minima
// among them must come first.
template <const auto& kOrder, size_t kFirst, size_t kObjects, size_t... kPlane,
          class D>
HWY_INLINE uint64_t StageBits(std::index_sequence<kPlane...>, D d,
                              const Scan& scan, size_t i) {
  const float* tested[] = {
      scan.planes[bench::kPlaneOf<kOrder, kFirst + kPlane>.object]...};
  constexpr size_t kMins =
      (... + (bench::kPlaneOf<kOrder, kFirst + kPlane>.is_min ? 1 : 0));
  return KeptBits<kMins, kObjects>(
      d, LoadAll(), tested, i,
      hn::Set(d,
              scan.query[bench::kPlaneOf<kOrder, kFirst + kPlane>.query])...);
}

// ---- The paper's schedule.

// The number of objects of one step, which is one vector.
constexpr size_t kStep = HWY_HAVE_SCALABLE ? 4 : hn::MaxLanes(WordTag<float>());

// Tests one plane on the vectors of a batch, and adds to `rejected`. Returns
// whether all objects of the batch are rejected.
template <const auto& kOrder, size_t kPlane>
HWY_INLINE bool PlaneOverBatch(const Scan& scan, size_t i, size_t steps,
                               uint16_t* rejected) {
  constexpr uint64_t kAll = kLowBits<kStep>;
  uint64_t all = kAll;
  for (size_t s = 0; s < steps; ++s) {
    uint64_t bits =
        StageBits<kOrder, kPlane, kStep>(
            std::index_sequence<0>(), WordTag<float>(), scan, i + s * kStep) ^
        kAll;
    if constexpr (kPlane != 0) bits |= rejected[s];
    rejected[s] = static_cast<uint16_t>(bits);
    all &= bits;
  }
  return all == kAll;
}

template <const auto& kOrder, size_t... kPlane>
void ScanBatches(std::index_sequence<kPlane...>, size_t width, Scan scan) {
  uint16_t rejected[bench::kWidestGate / kStep];
  const size_t steps = width / kStep;
  uint64_t word = 0;
  for (size_t i = 0; i < scan.size; i += width) {
    (void)(PlaneOverBatch<kOrder, kPlane>(scan, i, steps, rejected) || ...);
    for (size_t s = 0; s < steps; ++s) {
      const size_t object = i + s * kStep;
      word |= uint64_t{rejected[s]} << object % kWordObjects;
      if ((object + kStep) % kWordObjects != 0) continue;
      scan.mask[object / kWordObjects] = word;
      word = 0;
    }
  }
}

void ScanGated(bench::ShapeKind shape, size_t width, const float* const* planes,
               const float* query, size_t size, uint64_t* mask) {
  const Scan scan = {planes, query, size, mask};
  switch (shape) {
    case bench::ShapeKind::kSimplex:
      return ScanBatches<bench::kSimplexOrder>(std::make_index_sequence<4>(),
                                               width, scan);
    case bench::ShapeKind::kAabb:
      return ScanBatches<bench::kAabbOrder>(std::make_index_sequence<6>(),
                                            width, scan);
    case bench::ShapeKind::kAabo:
      return ScanBatches<bench::kAaboOrder>(std::make_index_sequence<8>(),
                                            width, scan);
  }
}

// ---- Stages of groups, with branches or lists, and flat.

constexpr size_t kGroup = 16;
constexpr size_t kTile = 4096;

template <const auto& kOrder, size_t kFirst, size_t kPlanes, size_t kObjects>
HWY_INLINE uint64_t BitsOf(const Scan& scan, size_t i) {
  return StageBits<kOrder, kFirst, kObjects>(
      std::make_index_sequence<kPlanes>(), OneTag<float>(), scan, i);
}

// One stage of a tile: of the listed groups, or of all groups if it is the
// first stage. Returns how many groups are left in the list, by the offset of
// their first object. Nothing branches on a survivor: which groups survive
// cannot be predicted, and a mispredicted branch costs more than the test of a
// whole vector.
template <const auto& kOrder, size_t kPlanes, size_t kStage>
HWY_INLINE size_t StageOfTile(const Scan& scan, size_t first, size_t groups,
                              uint16_t* list) {
  size_t left = 0;
  for (size_t g = 0; g < groups; ++g) {
    const size_t offset = kStage == 0 ? g * kGroup : list[g];
    const size_t shift = offset % kWordObjects;
    uint64_t& word = scan.mask[(first + offset) / kWordObjects];
    const uint64_t kept =
        BitsOf<kOrder, kStage * kPlanes, kPlanes, kGroup>(scan, first + offset);
    // A mask of rejected objects, which begins with none.
    if (kStage == 0 && shift == 0) word = 0;
    word |= (kept ^ kLowBits<kGroup>) << shift;
    list[left] = static_cast<uint16_t>(offset);
    left += (~word >> shift & kLowBits<kGroup>) != 0;
  }
  return left;
}

template <const auto& kOrder, size_t kPlanes, size_t... kStage>
HWY_INLINE void ScanStages(std::index_sequence<kStage...>, bench::Way way,
                           const Scan& scan) {
  if (way == bench::Way::kBranches) {
    for (size_t i = 0; i < scan.size; i += kWordObjects) {
      uint64_t word = 0;
      for (size_t g = 0; g < kWordObjects; g += kGroup) {
        // None as soon as a stage leaves none.
        uint64_t kept = kLowBits<kGroup>;
        (void)(... &&
               ((kept &= BitsOf<kOrder, kStage * kPlanes, kPlanes, kGroup>(
                     scan, i + g)) != 0));
        word |= kept << g;
      }
      scan.mask[i / kWordObjects] = ~word;
    }
    return;
  }
  uint16_t list[kTile / kGroup];
  for (size_t i = 0; i < scan.size; i += kTile) {
    size_t groups = HWY_MIN(kTile, scan.size - i) / kGroup;
    ((groups = StageOfTile<kOrder, kPlanes, kStage>(scan, i, groups, list)),
     ...);
  }
}

template <const auto& kOrder, const auto& kFlatOrder, size_t kPlanes>
void ScanShape(bench::Way way, size_t planes_of_stage, Scan scan) {
  if (way == bench::Way::kFlat) {
    for (size_t i = 0; i < scan.size; i += kWordObjects) {
      scan.mask[i / kWordObjects] =
          ~BitsOf<kFlatOrder, 0, kPlanes, kWordObjects>(scan, i);
    }
  } else if (planes_of_stage == 1) {
    ScanStages<kOrder, 1>(std::make_index_sequence<kPlanes>(), way, scan);
  } else {
    ScanStages<kOrder, 2>(std::make_index_sequence<kPlanes / 2>(), way, scan);
  }
}

void ScanStaged(bench::ShapeKind shape, bench::Way way, size_t planes_of_stage,
                const float* const* planes, const float* query, size_t size,
                uint64_t* mask) {
  const Scan scan = {planes, query, size, mask};
  if (shape == bench::ShapeKind::kSimplex) {
    ScanShape<bench::kSimplexOrder, bench::kSimplexOrder, 4>(
        way, planes_of_stage, scan);
  } else {
    ScanShape<bench::kAabbOrder, bench::kFlatAabbOrder, 6>(way, planes_of_stage,
                                                           scan);
  }
}

// ---- Spheres.

void ScanSpheres(const float* const* planes, const float* query, size_t size,
                 uint64_t* mask) {
  const OneTag<float> d;
  const auto x = hn::Set(d, query[0]);
  const auto y = hn::Set(d, query[1]);
  const auto z = hn::Set(d, query[2]);
  const auto radius = hn::Set(d, query[3]);
  for (size_t i = 0; i < size; i += kWordObjects) {
    uint64_t bits = 0;
    for (size_t l = 0; l < kWordObjects; l += hn::Lanes(d)) {
      const auto dx = hn::Sub(hn::Load(d, planes[0] + i + l), x);
      const auto dy = hn::Sub(hn::Load(d, planes[1] + i + l), y);
      const auto dz = hn::Sub(hn::Load(d, planes[2] + i + l), z);
      const auto reach = hn::Add(hn::Load(d, planes[3] + i + l), radius);
      const auto square =
          hn::MulAdd(dz, dz, hn::MulAdd(dy, dy, hn::Mul(dx, dx)));
      // As in the library's verdicts, what is above is rejected.
      bits |= VerdictBits(
                  d, FirstVerdict<true, true>(d, square, hn::Mul(reach, reach)))
              << l;
    }
    mask[i / kWordObjects] = kVerdictIsKept<OneTag<float>> ? bits : ~bits;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

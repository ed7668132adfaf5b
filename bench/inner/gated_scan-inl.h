// The paper's schedule, the same stages with and without branches, and what the
// work is counted in: part of target_loops.cc.

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// The objects of one step: a vector, the same for all widths.
constexpr size_t kStep = HWY_HAVE_SCALABLE ? 4 : hn::MaxLanes(WordTag<float>());
constexpr uint64_t kAllRejected = kLowBits<kStep>;

// One plane over the vectors of a batch; true if all its objects are rejected
// after it.
template <const auto& kOrder, size_t kPlane, class D, class V>
HWY_INLINE bool PlaneOverBatch(D d, const float* const* planes, size_t i,
                               size_t steps, uint16_t* rejected, V query) {
  constexpr bench::Plane kTest = bench::kPlaneOf<kOrder, kPlane>;
  constexpr size_t kMins = kTest.is_min ? 1 : 0;
  uint64_t all = kAllRejected;
  for (size_t s = 0; s < steps; ++s) {
    uint64_t bits = KeptBits<kMins, kStep>(d, LoadAll(), planes + kTest.object,
                                           i + s * kStep, query) ^
                    kAllRejected;
    if constexpr (kPlane != 0) bits |= rejected[s];
    rejected[s] = static_cast<uint16_t>(bits);
    all &= bits;
  }
  return all == kAllRejected;
}

template <const auto& kOrder, size_t... kPlane, class D, class... V>
HWY_INLINE void ScanBatches(std::index_sequence<kPlane...>, D d, size_t width,
                            const float* const* planes, size_t size,
                            uint64_t* mask, V... query) {
  uint16_t rejected[bench::kWidestGate / kStep];
  const size_t steps = width / kStep;
  uint64_t word = 0;
  for (size_t i = 0; i < size; i += width) {
    (void)(PlaneOverBatch<kOrder, kPlane>(d, planes, i, steps, rejected,
                                          query) ||
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

template <const auto& kOrder, size_t... kPlane>
void ScanShape(std::index_sequence<kPlane...> all_planes, size_t width,
               const float* const* planes, const float* query, size_t size,
               uint64_t* mask) {
  const WordTag<float> d;
  ScanBatches<kOrder>(
      all_planes, d, width, planes, size, mask,
      hn::Set(d, query[bench::kPlaneOf<kOrder, kPlane>.query])...);
}

template <const auto& kOrder>
void ScanShape(size_t width, const float* const* planes, const float* query,
               size_t size, uint64_t* mask) {
  constexpr std::make_index_sequence<kOrder.size()> kPlanes{};
  ScanShape<kOrder>(kPlanes, width, planes, query, size, mask);
}

void ScanGated(bench::ShapeKind shape, size_t width, const float* const* planes,
               const float* query, size_t size, uint64_t* mask) {
  switch (shape) {
    case bench::ShapeKind::kSimplex:
      return ScanShape<bench::kSimplexOrder>(width, planes, query, size, mask);
    case bench::ShapeKind::kAabb:
      return ScanShape<bench::kAabbOrder>(width, planes, query, size, mask);
    case bench::ShapeKind::kAabo:
      return ScanShape<bench::kAaboOrder>(width, planes, query, size, mask);
  }
}

// ---- Stages of groups, with branches or lists.

// The groups of a tile that still have a survivor, by the offset of their first
// object.
struct GroupList {
  uint16_t groups[kTileWords * kWordGroups];

  // Appends a group to a list of `count` if it has a survivor, and returns the
  // new count; the group's bits of `survivors` begin at the lowest. There is no
  // branch, because which groups survive cannot be predicted, and a
  // mispredicted branch costs more than the test of a whole vector (measured: a
  // staged box took three times as long as a flat one).
  template <size_t kGroup>
  HWY_INLINE size_t AppendIfLeft(size_t count, size_t offset,
                                 uint64_t survivors) {
    static_assert(kGroup >= kGroupObjects, "the list would be too short");
    groups[count] = static_cast<uint16_t>(offset);
    return count + ((survivors & kLowBits<kGroup>) != 0);
  }
};

// Planes [kFirst, kFirst + kPlanes) of an order. The minima among them come
// first.
template <const auto& kOrder, size_t kFirst, size_t... kPlane>
HWY_INLINE uint64_t StageBits(std::index_sequence<kPlane...>,
                              const float* const* planes, const float* query,
                              size_t i) {
  const OneTag<float> d;
  const float* tested[] = {
      planes[bench::kPlaneOf<kOrder, kFirst + kPlane>.object]...};
  constexpr size_t kMins =
      (... + (bench::kPlaneOf<kOrder, kFirst + kPlane>.is_min ? 1 : 0));
  return KeptBits<kMins, kGroupObjects>(
      d, LoadAll(), tested, i,
      hn::Set(d, query[bench::kPlaneOf<kOrder, kFirst + kPlane>.query])...);
}

// The survivors of one group after all stages, or none as soon as a stage
// leaves none.
template <const auto& kOrder, size_t kPlanes, size_t... kStage>
HWY_INLINE uint64_t GroupByBranches(std::index_sequence<kStage...>,
                                    const float* const* planes,
                                    const float* query, size_t i) {
  uint64_t kept = kLowBits<kGroupObjects>;
  (void)(... &&
         ((kept &= StageBits<kOrder, kStage * kPlanes>(
               std::make_index_sequence<kPlanes>(), planes, query, i)) != 0));
  return kept;
}

// One stage of a tile: of the listed groups, or of all groups if it is the
// first stage. Returns how many groups are left in the list.
template <const auto& kOrder, size_t kPlanes, size_t kStage>
HWY_INLINE size_t StageOfTile(const float* const* planes, const float* query,
                              size_t first, size_t groups, GroupList& list,
                              uint64_t* mask) {
  size_t left = 0;
  for (size_t g = 0; g < groups; ++g) {
    const size_t offset = kStage == 0 ? g * kGroupObjects : list.groups[g];
    const size_t shift = offset % kWordObjects;
    uint64_t& word = mask[(first + offset) / kWordObjects];
    const uint64_t kept = StageBits<kOrder, kStage * kPlanes>(
        std::make_index_sequence<kPlanes>(), planes, query, first + offset);
    // A mask of rejected objects, which begins with none.
    if (kStage == 0 && shift == 0) word = 0;
    word |= (kept ^ kLowBits<kGroupObjects>) << shift;
    left =
        list.template AppendIfLeft<kGroupObjects>(left, offset, ~word >> shift);
  }
  return left;
}

template <const auto& kOrder, size_t kPlanes, size_t... kStage>
HWY_INLINE void TileByLists(std::index_sequence<kStage...>,
                            const float* const* planes, const float* query,
                            size_t first, size_t objects, uint64_t* mask) {
  GroupList list;
  size_t groups = objects / kGroupObjects;
  ((groups = StageOfTile<kOrder, kPlanes, kStage>(planes, query, first, groups,
                                                  list, mask)),
   ...);
}

template <const auto& kOrder, size_t kPlanes>
void ScanStages(bench::StageWay way, const float* const* planes,
                const float* query, size_t size, uint64_t* mask) {
  constexpr std::make_index_sequence<kOrder.size() / kPlanes> kStages{};
  if (way == bench::StageWay::kBranches) {
    for (size_t i = 0; i < size; i += kWordObjects) {
      uint64_t word = 0;
      for (size_t g = 0; g < kWordObjects; g += kGroupObjects) {
        word |= GroupByBranches<kOrder, kPlanes>(kStages, planes, query, i + g)
                << g;
      }
      mask[i / kWordObjects] = ~word;
    }
    return;
  }
  for (size_t i = 0; i < size; i += kTileWords * kWordObjects) {
    TileByLists<kOrder, kPlanes>(kStages, planes, query, i,
                                 HWY_MIN(kTileWords * kWordObjects, size - i),
                                 mask);
  }
}

template <const auto& kOrder>
void ScanStages(bench::StageWay way, size_t planes_of_stage,
                const float* const* planes, const float* query, size_t size,
                uint64_t* mask) {
  if (planes_of_stage == 1) {
    ScanStages<kOrder, 1>(way, planes, query, size, mask);
  } else {
    ScanStages<kOrder, 2>(way, planes, query, size, mask);
  }
}

void ScanStaged(bench::ShapeKind shape, bench::StageWay way,
                size_t planes_of_stage, const float* const* planes,
                const float* query, size_t size, uint64_t* mask) {
  switch (shape) {
    case bench::ShapeKind::kSimplex:
      return ScanStages<bench::kSimplexOrder>(way, planes_of_stage, planes,
                                              query, size, mask);
    case bench::ShapeKind::kAabb:
      return ScanStages<bench::kAabbOrder>(way, planes_of_stage, planes, query,
                                           size, mask);
    case bench::ShapeKind::kAabo:
      return ScanStages<bench::kAaboOrder>(way, planes_of_stage, planes, query,
                                           size, mask);
  }
}

template <size_t... kPlane>
HWY_INLINE void FillWord(std::index_sequence<kPlane...>,
                         const float* const* planes, const float* query,
                         size_t i, bench::PlaneWords& out) {
  const WordTag<float> d;
  constexpr size_t kMinima = sizeof...(kPlane) / 2;
  ((out[kPlane] = ~KeptBits<(kPlane < kMinima ? 1 : 0)>(
        d, LoadAll(), planes + kPlane, i,
        hn::Set(d, query[(kPlane + kMinima) % sizeof...(kPlane)]))),
   ...);
}

void FillPlaneWords(const float* const* planes, const float* query,
                    size_t words, bench::PlaneWords* out) {
  constexpr std::make_index_sequence<bench::kPlaneWordsPlanes> kPlanes{};
  for (size_t w = 0; w < words; ++w) {
    FillWord(kPlanes, planes, query, w * kWordObjects, out[w]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

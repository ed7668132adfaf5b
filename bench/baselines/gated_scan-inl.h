// The paper's schedule and what its work is counted in: part of
// target_loops.cc.

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

// One kernel with vectors of several widths: part of target_loops.cc.

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

size_t OneQueryLanes() { return hn::Lanes(OneTag<float>()); }

// As KeptBits. With AVX-512 the kernels have no verdicts on 128 bits.
template <size_t kMins, size_t kObjects = kWordObjects, class D, class... V>
HWY_INLINE uint64_t BitsOfWidth(D d, const float* const* planes, size_t i,
                                V... query) {
#if HALFSPACE_MASKED_COMPARES
  if constexpr (hn::MaxLanes(D()) < 8) {
    uint64_t bits = 0;
    for (size_t l = 0; l < kObjects; l += hn::MaxLanes(D())) {
      hn::Mask<D> rejected = hn::MaskFromVec(hn::Zero(d));
      size_t k = 0;
      const auto test = [&](hn::Vec<D> value) HWY_ATTR {
        const auto object = hn::LoadU(d, planes[k] + i + l);
        rejected = hn::Or(rejected, k < kMins ? hn::Gt(object, value)
                                              : hn::Lt(object, value));
        ++k;
      };
      (test(query), ...);
      bits |= LaneBits(d, rejected) << l;
    }
    return bits ^ kLowBits<kObjects>;
  } else  // NOLINT(readability-misleading-indentation)
#endif
    return KeptBits<kMins, kObjects>(d, LoadAll(), planes, i, query...);
}

// All planes at once. `planes` are the shape's, the first kMins of them minima;
// plane k is compared with the query's value number kQuery.
template <size_t kLanes, size_t kMins, size_t... kPlane, size_t... kQuery>
HWY_INLINE void FlatOfWidth(std::index_sequence<kPlane...>,
                            std::index_sequence<kQuery...>,
                            const float* const* planes, const float* query,
                            size_t size, uint64_t* mask) {
  const hn::CappedTag<float, kLanes> d;
  for (size_t i = 0; i < size; i += kWordObjects) {
    mask[i / kWordObjects] =
        ~BitsOfWidth<kMins>(d, planes, i, hn::Set(d, query[kQuery])...);
  }
}

// Two planes for all objects of a tile, then two more for the groups of 16
// objects that still have a survivor, and so on. Pair p are the planes
// planes[pairs[p][0]] and planes[pairs[p][1]], the first kMins of them minima.
struct PlanePair {
  size_t planes[2];
  size_t values[2];
};
template <size_t kLanes, size_t kMins, size_t kPairs>
HWY_INLINE void StagedOfWidth(const PlanePair (&pairs)[kPairs],
                              const float* const* planes, const float* query,
                              size_t size, uint64_t* mask) {
  constexpr size_t kGroup = HWY_MAX(size_t{16}, kLanes);
  constexpr size_t kTile = 4096;
  const hn::CappedTag<float, kLanes> d;
  uint16_t groups[kTile / kGroup];
  for (size_t begin = 0; begin < size; begin += kTile) {
    const size_t objects = HWY_MIN(kTile, size - begin);
    uint64_t* HWY_RESTRICT row = mask + begin / kWordObjects;
    size_t left = 0;
    for (size_t p = 0; p < kPairs; ++p) {
      const float* pair[] = {planes[pairs[p].planes[0]] + begin,
                             planes[pairs[p].planes[1]] + begin};
      const auto a = hn::Set(d, query[pairs[p].values[0]]);
      const auto b = hn::Set(d, query[pairs[p].values[1]]);
      if (p == 0) {
        for (size_t i = 0; i < objects; i += kWordObjects) {
          const uint64_t kept = BitsOfWidth<kMins>(d, pair, i, a, b);
          row[i / kWordObjects] = ~kept;
          for (size_t g = 0; g < kWordObjects; g += kGroup) {
            groups[left] = static_cast<uint16_t>(i + g);
            left += (kept >> g & kLowBits<kGroup>) != 0;
          }
        }
        continue;
      }
      const size_t count = left;
      left = 0;
      for (size_t j = 0; j < count; ++j) {
        const size_t i = groups[j];
        const size_t shift = i % kWordObjects;
        const uint64_t rejected =
            BitsOfWidth<kMins, kGroup>(d, pair, i, a, b) ^ kLowBits<kGroup>;
        const uint64_t word = row[i / kWordObjects] | rejected << shift;
        row[i / kWordObjects] = word;
        groups[left] = static_cast<uint16_t>(i);
        left += (~word >> shift & kLowBits<kGroup>) != 0;
      }
    }
  }
}

template <size_t kLanes>
void SimplexFlat(const float* const* planes, const float* query, size_t size,
                 uint64_t* mask) {
  FlatOfWidth<kLanes, 4>(std::index_sequence<0, 1, 2, 3>(),
                         std::index_sequence<0, 1, 2, 3>(), planes, query, size,
                         mask);
}

template <size_t kLanes>
void BoxFlat(const float* const* planes, const float* query, size_t size,
             uint64_t* mask) {
  FlatOfWidth<kLanes, 3>(std::index_sequence<0, 1, 2, 3, 4, 5>(),
                         std::index_sequence<3, 4, 5, 0, 1, 2>(), planes, query,
                         size, mask);
}

template <size_t kLanes>
void SimplexStaged(const float* const* planes, const float* query, size_t size,
                   uint64_t* mask) {
  constexpr PlanePair kPairs[] = {{{0, 1}, {0, 1}}, {{2, 3}, {2, 3}}};
  StagedOfWidth<kLanes, 2>(kPairs, planes, query, size, mask);
}

template <size_t kLanes>
void BoxStaged(const float* const* planes, const float* query, size_t size,
               uint64_t* mask) {
  constexpr PlanePair kPairs[] = {
      {{0, 3}, {3, 0}}, {{1, 4}, {4, 1}}, {{2, 5}, {5, 2}}};
  StagedOfWidth<kLanes, 1>(kPairs, planes, query, size, mask);
}

// Without loops if this target's vectors are not so long, or may be shorter
// than they seem.
template <size_t kLanes>
bench::WidthLoops LoopsOfWidth() {
#if !HWY_HAVE_SCALABLE
  // One lane of a wide target is code that nobody runs.
  constexpr size_t kMost = hn::MaxLanes(hn::ScalableTag<float>());
  if constexpr (kLanes <= kMost && (kLanes > 1 || kMost == 1)) {
    return {kLanes, &SimplexFlat<kLanes>, &SimplexStaged<kLanes>,
            &BoxFlat<kLanes>, &BoxStaged<kLanes>};
  }
#endif
  return {};
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

// The seven-sided box and the sphere: part of target_loops.cc.

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

inline constexpr size_t kRecordBytes = 7 * sizeof(float);

// The functions below have names of their own: a kernel that was instantiated
// here again might replace that of the library when the tool is linked.

// Tests the minima of a tile in cache.
HWY_INLINE void TestMinimaOfBoxes(const float* const* planes,
                                  const float* query, size_t word, size_t count,
                                  uint64_t* mask) {
  using LoadPlane = std::conditional_t<kAlignedLoadsPay, LoadAligned, LoadAll>;
  const OneTag<float> d;
  const auto x = hn::Set(d, query[0]);
  const auto y = hn::Set(d, query[1]);
  const auto z = hn::Set(d, query[2]);
  const auto last = hn::Set(d, query[3]);
  for (size_t w = word; w < word + count; ++w) {
    mask[w] =
        KeptBits<4>(d, LoadPlane(), planes, w * kWordObjects, x, y, z, last);
  }
}

// Tests the maxima of those words of a tile that are nonzero.
HWY_INLINE void TestMaximaOfBoxes(const float* const* planes,
                                  const float* query, size_t word,
                                  uint64_t nonzero, uint64_t* mask) {
  const OneTag<float> d;
  const auto x = hn::Set(d, query[4]);
  const auto y = hn::Set(d, query[5]);
  const auto z = hn::Set(d, query[6]);
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    const size_t w = word + hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero);
    mask[w] &= KeptBits<0>(d, LoadAll(), planes + 4, w * kWordObjects, x, y, z);
  }
}

void ScanSevenSided(const float* const* planes, const float* query, size_t size,
                    uint64_t* mask) {
  const float* local[] = {planes[0], planes[1], planes[2], planes[3],
                          planes[4], planes[5], planes[6]};
  // What streams and prefetches takes scans: minima from plane 0 on, and maxima
  // of three axes from plane 3 on.
  detail::Scan minima{};
  detail::Scan maxima{};
  detail::ScanType four_axes{};
  four_axes.axes = 4;
  minima.type = &four_axes;
  minima.planes = local;
  maxima.planes = local + 1;
  const bool is_streaming = dispatch::StreamingPays() &&
                            size * kRecordBytes > dispatch::kInCacheBytes;
  const size_t words = size / kWordObjects;
  const detail::Chunk all = {.first_query = 0,
                             .query_count = 1,
                             .queries = query,
                             .begin = 0,
                             .end = size,
                             .rows = mask,
                             .stride = 0};
  // A tile is finished after the minima of the next one, when its maxima have
  // arrived.
  size_t last = 0;
  uint64_t last_nonzero = 0;
  for (size_t begin = 0; begin < words; begin += kTileWords) {
    const size_t count = HWY_MIN(kTileWords, words - begin);
    const detail::Chunk tile =
        ChunkFrom(all, begin, (begin + count) * kWordObjects);
    if (is_streaming && kPagesPay) {
      StreamPages<false, float>(LoadAll(), minima, tile);
    } else {
      TestMinimaOfBoxes(local, query, begin, count, mask);
    }
    const uint64_t nonzero = NonzeroWords(mask + begin, count);
    if (is_streaming) {
      PrefetchMaxima<3, float>(maxima, begin * kWordObjects, nonzero);
    }
    TestMaximaOfBoxes(local, query, last, last_nonzero, mask);
    last = begin;
    last_nonzero = nonzero;
  }
  TestMaximaOfBoxes(local, query, last, last_nonzero, mask);
}

// The tests of a vector of spheres. As in the library's verdicts, what is above
// is rejected.
struct TestAlongX {
  template <class D, class V>
  HWY_INLINE VerdictOf<D> operator()(D d, const float* const* planes, size_t i,
                                     V x, V /*y*/, V /*z*/, V radius) const {
    const V along = hn::Abs(hn::Sub(hn::Load(d, planes[0] + i), x));
    return FirstVerdict<true>(d, along,
                              hn::Add(hn::Load(d, planes[3] + i), radius));
  }
};

struct TestDistance {
  template <class D, class V>
  HWY_INLINE VerdictOf<D> operator()(D d, const float* const* planes, size_t i,
                                     V x, V y, V z, V radius) const {
    const V dx = hn::Sub(hn::Load(d, planes[0] + i), x);
    const V dy = hn::Sub(hn::Load(d, planes[1] + i), y);
    const V dz = hn::Sub(hn::Load(d, planes[2] + i), z);
    const V reach = hn::Add(hn::Load(d, planes[3] + i), radius);
    const V square = hn::MulAdd(dz, dz, hn::MulAdd(dy, dy, hn::Mul(dx, dx)));
    return FirstVerdict<true>(d, square, hn::Mul(reach, reach));
  }
};

template <size_t... kVector, class D, class Test, class... V>
HWY_INLINE uint64_t SphereVectors(std::index_sequence<kVector...>, D d,
                                  Test test, const float* const* planes,
                                  size_t i, V... query) {
  const size_t lanes = hn::Lanes(d);
  return (... | (VerdictBits(d, test(d, planes, i + kVector * lanes, query...))
                 << (kVector * lanes)));
}

// The bits of those of objects i ... i + kObjects - 1 that survive; unrolled as
// KeptBits is.
template <size_t kObjects, class D, class Test, class... V>
HWY_INLINE uint64_t SphereBits(D d, Test test, const float* const* planes,
                               size_t i, V... query) {
#if HWY_HAVE_SCALABLE
  constexpr size_t kUnroll = 1;
#else
  constexpr size_t kUnroll = HWY_MIN(size_t{4}, kObjects / hn::MaxLanes(D()));
#endif
  const size_t step = kUnroll * hn::Lanes(d);
  uint64_t bits = 0;
  for (size_t l = 0; l < kObjects; l += step) {
    bits |= SphereVectors(std::make_index_sequence<kUnroll>(), d, test, planes,
                          i + l, query...)
            << l;
  }
  return kVerdictIsKept<D> ? bits : bits ^ kLowBits<kObjects>;
}

void ScanSpheres(const float* const* planes, const float* query, size_t size,
                 uint64_t* mask) {
  const OneTag<float> d;
  const float* local[] = {planes[0], planes[1], planes[2], planes[3]};
  const auto x = hn::Set(d, query[0]);
  const auto y = hn::Set(d, query[1]);
  const auto z = hn::Set(d, query[2]);
  const auto radius = hn::Set(d, query[3]);
  for (size_t w = 0; w < size / kWordObjects; ++w) {
    mask[w] = SphereBits<kWordObjects>(d, TestDistance(), local,
                                       w * kWordObjects, x, y, z, radius);
  }
}

void ScanSpheresByAxis(const float* const* planes, const float* query,
                       size_t size, uint64_t* mask) {
  const OneTag<float> d;
  const auto x = hn::Set(d, query[0]);
  const auto y = hn::Set(d, query[1]);
  const auto z = hn::Set(d, query[2]);
  const auto radius = hn::Set(d, query[3]);
  GroupList list;
  const size_t words = size / kWordObjects;
  for (size_t begin = 0; begin < words; begin += kTileWords) {
    const size_t first = begin * kWordObjects;
    const float* tile[] = {planes[0] + first, planes[1] + first,
                           planes[2] + first, planes[3] + first};
    uint64_t* row = mask + begin;
    size_t left = 0;
    for (size_t w = 0; w < HWY_MIN(kTileWords, words - begin); ++w) {
      row[w] = SphereBits<kWordObjects>(d, TestAlongX(), tile, w * kWordObjects,
                                        x, y, z, radius);
      for (size_t g = 0; g < kWordObjects; g += kGroupObjects) {
        left = list.template AppendIfLeft<kGroupObjects>(
            left, w * kWordObjects + g, row[w] >> g);
      }
    }
    for (size_t j = 0; j < left; ++j) {
      const size_t offset = list.groups[j];
      const uint64_t rejected =
          SphereBits<kGroupObjects>(d, TestDistance(), tile, offset, x, y, z,
                                    radius) ^
          kLowBits<kGroupObjects>;
      row[offset / kWordObjects] &= ~(rejected << (offset % kWordObjects));
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

// Reading and copying, and nothing else: part of target_loops.cc.

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

using MemoryTag = hn::CappedTag<uint32_t, 64>;
using MemoryVector = hn::Vec<MemoryTag>;
using bench::kReadBytes;

HWY_INLINE MemoryVector OrAt(MemoryVector before, const uint8_t* from) {
  const MemoryTag d;
  return hn::Or(before, hn::LoadU(d, reinterpret_cast<const uint32_t*>(from)));
}

// Four ORs in turn, so that they are no chain.
HWY_INLINE void ReadChunk(const uint8_t* from, MemoryVector& a, MemoryVector& b,
                          MemoryVector& c, MemoryVector& e) {
  const size_t vector = 4 * hn::Lanes(MemoryTag());
  size_t l = 0;
  for (; l + 4 * vector <= kReadBytes; l += 4 * vector) {
    a = OrAt(a, from + l);
    b = OrAt(b, from + l + vector);
    c = OrAt(c, from + l + 2 * vector);
    e = OrAt(e, from + l + 3 * vector);
  }
  for (; l < kReadBytes; l += vector) a = OrAt(a, from + l);
}

HWY_INLINE MemoryVector Joined(MemoryVector a, MemoryVector b, MemoryVector c,
                               MemoryVector e) {
  return hn::Or(hn::Or(a, b), hn::Or(c, e));
}

uint32_t ReadPlanes(bench::ReadWay way, const uint8_t* const* planes,
                    size_t plane_count, size_t bytes) {
  const MemoryTag d;
  auto a = hn::Zero(d);
  auto b = a;
  auto c = a;
  auto e = a;
  // The second half of a plane is a stream of its own.
  const size_t half = way == bench::ReadWay::kByHalves
                          ? bytes / (2 * kReadBytes) * kReadBytes
                          : 0;
  const size_t turn = way == bench::ReadWay::kByWord ? kReadBytes : bytes;
  for (size_t begin = 0; begin < bytes; begin += turn) {
    for (size_t p = 0; p < plane_count; ++p) {
      for (size_t i = 0; i < half; i += kReadBytes) {
        ReadChunk(planes[p] + i, a, b, c, e);
        ReadChunk(planes[p] + half + i, a, b, c, e);
      }
      for (size_t i = begin + 2 * half; i < begin + turn; i += kReadBytes) {
        ReadChunk(planes[p] + i, a, b, c, e);
      }
    }
  }
  HWY_ALIGN uint32_t words[kReadBytes / 4];
  hn::Store(Joined(a, b, c, e), d, words);
  uint32_t folded = 0;
  for (size_t l = 0; l < hn::Lanes(d); ++l) folded |= words[l];
  return folded;
}

template <bool kStreamed>
void CopyParts(const bench::CopyJob& job, size_t part) {
  const MemoryTag d;
  auto a = hn::Zero(d);
  auto b = a;
  auto c = a;
  auto e = a;
  for (size_t first = 0; first < job.objects; first += part) {
    const size_t count = HWY_MIN(part, job.objects - first);
    for (const auto& stream : job.reads) {
      const uint8_t* const from = stream.begin + first * stream.object_bytes;
      for (size_t i = 0; i < count * stream.object_bytes; i += kReadBytes) {
        ReadChunk(from + i, a, b, c, e);
      }
    }
    const auto all = Joined(a, b, c, e);
    for (const auto& stream : job.writes) {
      uint32_t* const to = reinterpret_cast<uint32_t*>(
          stream.begin + first * stream.object_bytes);
      const size_t words = count * stream.object_bytes / sizeof(uint32_t);
      for (size_t i = 0; i < words; i += hn::Lanes(d)) {
        if constexpr (kStreamed) {
          hn::Stream(all, d, to + i);
        } else {
          hn::StoreU(all, d, to + i);
        }
      }
    }
  }
  if constexpr (kStreamed) hwy::FlushStream();
}

void CopyStreams(bench::CopyWay way, const bench::CopyJob& job) {
  const size_t part = bench::ObjectsAtOnce(way);
  if (bench::IsStreamed(way)) {
    CopyParts<true>(job, part);
  } else {
    CopyParts<false>(job, part);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

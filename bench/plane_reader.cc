#include "bench/plane_reader.h"

#include "bench/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/plane_reader.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using ReadTag = hn::CappedTag<uint32_t, 64>;

template <class D>
HWY_INLINE hn::Vec<D> ReadAt(D d, const float* plane, size_t i) {
  return hn::LoadU(d, reinterpret_cast<const uint32_t*>(plane) + i);
}

template <class D>
HWY_INLINE uint32_t Fold(D d, hn::Vec<D> v) {
  return hn::GetLane(hn::SumOfLanes(d, v));
}

// Four sums, so that the adds are no chain.
uint32_t ReadOnePlane(const float* plane, size_t size) {
  const ReadTag d;
  const size_t lanes = hn::Lanes(d);
  auto a = hn::Zero(d);
  auto b = hn::Zero(d);
  auto c = hn::Zero(d);
  auto e = hn::Zero(d);
  size_t i = 0;
  for (; i + 4 * lanes <= size; i += 4 * lanes) {
    a = hn::Add(a, ReadAt(d, plane, i));
    b = hn::Add(b, ReadAt(d, plane, i + lanes));
    c = hn::Add(c, ReadAt(d, plane, i + 2 * lanes));
    e = hn::Add(e, ReadAt(d, plane, i + 3 * lanes));
  }
  for (; i < size; i += lanes) a = hn::Add(a, ReadAt(d, plane, i));
  return Fold(d, hn::Add(hn::Add(a, b), hn::Add(c, e)));
}

// 64 floats of each plane in turn, as a flat kernel reads them.
uint32_t ReadByWord(const float* const* planes, size_t plane_count,
                    size_t size) {
  constexpr size_t kWord = 64;
  const ReadTag d;
  const size_t lanes = hn::Lanes(d);
  auto a = hn::Zero(d);
  auto b = hn::Zero(d);
  for (size_t i = 0; i < size; i += kWord) {
    for (size_t p = 0; p < plane_count; ++p) {
      size_t l = 0;
      for (; l + 2 * lanes <= kWord; l += 2 * lanes) {
        a = hn::Add(a, ReadAt(d, planes[p], i + l));
        b = hn::Add(b, ReadAt(d, planes[p], i + l + lanes));
      }
      for (; l < kWord; l += lanes) a = hn::Add(a, ReadAt(d, planes[p], i + l));
    }
  }
  return Fold(d, hn::Add(a, b));
}

uint32_t ReadPlanes(bench::ReadOrder order, const float* const* planes,
                    size_t plane_count, size_t size) {
  if (order == bench::ReadOrder::kPlaneByPlane) {
    uint32_t sum = 0;
    for (size_t p = 0; p < plane_count; ++p)
      sum += ReadOnePlane(planes[p], size);
    return sum;
  }
  return ReadByWord(planes, plane_count, size);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

namespace halfspace::bench {

template <std::int64_t kTarget>
PlaneReader PlaneReaderOf();

template <>
PlaneReader PlaneReaderOf<HWY_TARGET>() {
  return &HWY_NAMESPACE::ReadPlanes;
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {

PlaneReader PlaneReaderFor(Target target) {
  return FunctionOf<PlaneReader>(target,
                                 [](auto t) { return PlaneReaderOf<t()>(); });
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE

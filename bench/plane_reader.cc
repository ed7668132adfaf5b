#include "bench/plane_reader.h"

#include <utility>

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

template <class D, size_t... kPlane>
HWY_INLINE hn::Vec<D> ReadAllAt(std::index_sequence<kPlane...>, D d,
                                const float* const* planes, size_t i) {
  hn::Vec<D> sum = hn::Zero(d);
  ((sum = hn::Add(sum, ReadAt(d, planes[kPlane], i))), ...);
  return sum;
}

template <size_t kPlanes>
uint32_t ReadAll(const float* const* planes, size_t size) {
  const ReadTag d;
  const size_t lanes = hn::Lanes(d);
  constexpr std::make_index_sequence<kPlanes> kAll;
  auto a = hn::Zero(d);
  auto b = hn::Zero(d);
  size_t i = 0;
  for (; i + 2 * lanes <= size; i += 2 * lanes) {
    a = hn::Add(a, ReadAllAt(kAll, d, planes, i));
    b = hn::Add(b, ReadAllAt(kAll, d, planes, i + lanes));
  }
  for (; i < size; i += lanes) a = hn::Add(a, ReadAllAt(kAll, d, planes, i));
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
  switch (plane_count) {
    case 4:
      return ReadAll<4>(planes, size);
    case 6:
      return ReadAll<6>(planes, size);
    default:
      return ReadAll<8>(planes, size);
  }
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

// The calls of kernels.h, for one type of planes: from the caller's pointers to
// a kernel in two jumps.
#ifndef HALFSPACE_DISPATCH_SCAN_UNCHECKED_H_
#define HALFSPACE_DISPATCH_SCAN_UNCHECKED_H_

#include <array>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "dispatch/scan/prepare.h"
#include "dispatch/targets/chosen_target.h"
#include "halfspace/detail/scan.h"
#include "halfspace/kernels.h"
#include "kernels/compiled_targets.h"
#include "kernels/compiler.h"
#include "kernels/scan/kernel_table.h"

namespace halfspace::dispatch {

// The calls for more objects than a MaskKernel takes: of one query, and of
// several.
void WriteManyObjects(detail::Scan& scan, std::uint64_t* mask);
void WriteEachQuery(detail::Scan& scan, std::uint64_t* masks);

template <typename View>
class Unchecked {
 public:
  using T = typename View::Query::Scalar;
  using OfBound = typename Kernels<T>::OfBound;

  // The calls on each compiled target, best first.
  static const std::array<OfBound, kernels::kCompiledTargets> kOnTarget;

  // The calls on the chosen target.
  static const OfBound& Chosen() {
    return *chosen_.load(std::memory_order_relaxed);
  }

 private:
  static constexpr std::size_t kPlanes =
      detail::kPlaneCount<typename View::Bound>;

  static bool AreValid(const T* const* planes, std::size_t n, const void* query,
                       const std::uint64_t* mask) {
    if (n == 0) return true;
    const auto is_valid = [](const void* pointer, std::size_t alignment) {
      return pointer != nullptr &&
             reinterpret_cast<std::uintptr_t>(pointer) % alignment == 0;
    };
    bool are_valid = is_valid(planes, alignof(T*)) &&
                     is_valid(query, alignof(T)) &&
                     is_valid(mask, alignof(std::uint64_t));
    for (std::size_t p = 0; are_valid && p < kPlanes; ++p) {
      are_valid = is_valid(planes[p], alignof(T));
    }
    return are_valid;
  }

  static detail::Scan ScanOf(const detail::TargetKernels* kernels,
                             const T* const* planes, std::size_t n,
                             const T* queries, std::size_t count) {
    detail::Scan scan;
    scan.type = detail::ScanTypeOf<View, T>();
    scan.planes = planes;
    scan.addresses =
        detail::AddressesOf(planes, std::make_index_sequence<kPlanes>());
    scan.size = n;
    scan.queries = queries;
    scan.query_count = count;
    scan.kernels = kernels;
    scan.is_wide = WideVectorsPay();
    scan.begin = 0;
    scan.end = n;
    return scan;
  }

  // The long paths of One() and Several() on all targets. Functions of their
  // own, so that the short path of One() needs no stack.
  HALFSPACE_NOINLINE static void WriteOne(
      const T* const* planes, std::size_t n, const T* query,
      std::uint64_t* mask, const detail::TargetKernels* kernels) noexcept {
    if (n == 0) return;
    detail::Scan scan = ScanOf(kernels, planes, n, query, 1);
    WriteManyObjects(scan, mask);
  }
  HALFSPACE_NOINLINE static void WriteSeveral(
      const T* const* planes, std::size_t n, const T* queries,
      std::size_t count, std::uint64_t* masks,
      const detail::TargetKernels* kernels) noexcept {
    if (n == 0 || count == 0) return;
    assert(AreValid(planes, n, queries, masks));
    detail::Scan scan = ScanOf(kernels, planes, n, queries, count);
    WriteEachQuery(scan, masks);
  }

  template <std::size_t kTarget>
  static void One(const T* const* planes, std::size_t n, const T* query,
                  std::uint64_t* mask) noexcept {
    assert(AreValid(planes, n, query, mask));
    constexpr bool kHasMax = detail::HasMax<typename View::Bound>;
    const detail::TargetKernels& kernels =
        detail::ScanKernelsOf<View::Bound::kAxes, T>::kTargets[kTarget];
    if (n - 1 < FewObjects(detail::kLayoutOf<typename View::Bound>, sizeof(T),
                           kernels)) [[likely]] {
      (kHasMax ? kernels.mask_of_all
               : kernels.mask_of_minima)[WideVectorsPay()](planes, 0, n, query,
                                                           mask);
      return;
    }
    WriteOne(planes, n, query, mask, &kernels);
  }

  template <std::size_t kTarget>
  static void Several(const T* const* planes, std::size_t n, const T* queries,
                      std::size_t count, std::uint64_t* masks) noexcept {
    WriteSeveral(
        planes, n, queries, count, masks,
        detail::ScanKernelsOf<View::Bound::kAxes, T>::kTargets + kTarget);
  }

  static const OfBound& Choose() {
    const OfBound* const chosen = &kOnTarget[IndexOf({}, "SurvivorsOf")];
    chosen_.store(chosen, std::memory_order_relaxed);
    return *chosen;
  }
  static void ChooseAndRunOne(const T* const* planes, std::size_t n,
                              const T* query, std::uint64_t* mask) noexcept {
    Choose().one(planes, n, query, mask);
  }
  static void ChooseAndRunSeveral(const T* const* planes, std::size_t n,
                                  const T* queries, std::size_t count,
                                  std::uint64_t* masks) noexcept {
    Choose().several(planes, n, queries, count, masks);
  }

  template <std::size_t... kTarget>
  static constexpr std::array<OfBound, kernels::kCompiledTargets> OnEach(
      std::index_sequence<kTarget...>) {
    return {OfBound{&One<kTarget>, &Several<kTarget>}...};
  }

  static constexpr OfBound kUnknown{&ChooseAndRunOne, &ChooseAndRunSeveral};
  static std::atomic<const OfBound*> chosen_;
};

template <typename View>
const std::array<typename Unchecked<View>::OfBound, kernels::kCompiledTargets>
    Unchecked<View>::kOnTarget =
        OnEach(std::make_index_sequence<kernels::kCompiledTargets>());

template <typename View>
std::atomic<const typename Unchecked<View>::OfBound*> Unchecked<View>::chosen_{
    &kUnknown};

// Instantiated by unchecked_of_axes.cc.in alone.
#define HALFSPACE_DECLARE_UNCHECKED(kDims)                  \
  extern template class Unchecked<AabbView<kDims>>;         \
  extern template class Unchecked<AabbView<kDims, double>>; \
  extern template class Unchecked<SimplexView<kDims>>;      \
  extern template class Unchecked<AaboView<kDims>>
HALFSPACE_DECLARE_UNCHECKED(2);
HALFSPACE_DECLARE_UNCHECKED(3);
HALFSPACE_DECLARE_UNCHECKED(4);
#undef HALFSPACE_DECLARE_UNCHECKED

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_SCAN_UNCHECKED_H_

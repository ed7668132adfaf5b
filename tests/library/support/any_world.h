// A world and its queries after their types are gone, as the library's own
// calls take them (detail/scan.h). Tests of answers and errors are compiled
// once for every kind of world, instead of once for each.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_ANY_WORLD_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_ANY_WORLD_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "halfspace/detail/scan.h"
#include "halfspace/kernels.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"
#include "tests/library/support/cases.h"
#include "tests/reference/reference.h"

namespace halfspace::testing {

// The pointers to the planes of a view: all minima, then all maxima.
using PlanePointers = std::array<const void*, 10>;

// Records of a world's type of query, one after another.
struct AnyQueries {
  AnyQueries() = default;
  AnyQueries(const void* its_records, std::size_t its_count)
      : records(its_records), count(its_count) {}
  template <typename Query>
  explicit AnyQueries(std::span<const Query> queries)
      : AnyQueries(queries.data(), queries.size()) {}

  const void* records = nullptr;
  std::size_t count = 0;
};

namespace internal {

// The one of 2, 3 and 4 dimensions.
template <int kDims, typename Entry>
const Entry& OfDims(const Entry& of2, const Entry& of3, const Entry& of4) {
  return kDims == 2 ? of2 : kDims == 3 ? of3 : of4;
}

template <int kDims, typename T>
const auto& KernelsFor(const Kernels<T>& kernels, const AabbView<kDims, T>&) {
  return OfDims<kDims>(kernels.boxes2, kernels.boxes3, kernels.boxes4);
}
template <int kDims>
const auto& KernelsFor(const Kernels<float>& kernels,
                       const SimplexView<kDims>&) {
  return OfDims<kDims>(kernels.simplices2, kernels.simplices3,
                       kernels.simplices4);
}
template <int kDims>
const auto& KernelsFor(const Kernels<float>& kernels, const AaboView<kDims>&) {
  return OfDims<kDims>(kernels.octahedra2, kernels.octahedra3,
                       kernels.octahedra4);
}

// A view of floats or doubles: kernels.h and the reference have calls for it.
template <typename View>
concept IsPlain = requires(const View& view) {
  KernelsFor(Kernels<ScalarOf<View>>(), view);
};

template <typename View>
void ReferenceMask(const PlanePointers& planes, std::size_t size,
                   const void* query, std::uint64_t* mask) {
  View view;
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    PlaneOf(view, p) = static_cast<const ScalarOf<View>*>(planes[p]);
  }
  view.size = size;
  reference::RejectMask(view, *static_cast<const typename View::Query*>(query),
                        mask);
}

template <typename View>
void UncheckedMasks(const PlanePointers& planes, std::size_t size,
                    const AnyQueries& queries, bool is_one, std::uint64_t* rows,
                    Target target) {
  using Scalar = ScalarOf<View>;
  std::array<const Scalar*, kPlanes<View>> pointers;
  for (std::size_t p = 0; p < pointers.size(); ++p) {
    pointers[p] = static_cast<const Scalar*>(planes[p]);
  }
  const auto* const values = static_cast<const Scalar*>(queries.records);
  const auto& kernels = KernelsFor(KernelsOf<Scalar>(target), View());
  if (is_one) {
    kernels.one(pointers.data(), size, values, rows);
  } else {
    kernels.several(pointers.data(), size, values, queries.count, rows);
  }
}

}  // namespace internal

// The planes must outlive it; the view need not.
class AnyWorld {
 public:
  template <typename World>
  explicit AnyWorld(const World& world) {
    const auto view = world.view();
    using View = std::remove_const_t<decltype(view)>;
    const typename View::Query* const none = nullptr;
    scan_ = detail::ScanOf(view, none, 0);
    std::memcpy(planes_.data(), scan_.planes,
                scan_.type->plane_count * sizeof(planes_[0]));
    if constexpr (internal::IsPlain<View>) {
      reference_mask_ = &internal::ReferenceMask<View>;
      unchecked_masks_ = &internal::UncheckedMasks<View>;
    }
  }

  std::size_t size() const { return scan_.size; }
  const detail::ScanType& type() const { return *scan_.type; }

  // What a call takes.
  detail::Scan Asked(const AnyQueries& queries) const {
    detail::Scan scan = scan_;
    scan.planes = planes_.data();
    scan.queries = queries.records;
    scan.query_count = queries.count;
    return scan;
  }

  // Query q alone.
  AnyQueries One(const AnyQueries& queries, std::size_t q = 0) const {
    return {static_cast<const std::byte*>(queries.records) +
                q * type().query_record_bytes,
            1};
  }

  // The oracle's answer, of a world of floats or doubles.
  void ReferenceMask(const AnyQueries& query,
                     std::span<std::uint64_t> mask) const {
    reference_mask_(planes_, size(), query.records, mask.data());
  }

  // By kernels.h: the function for one query, or the one for several.
  bool HasUnchecked() const { return unchecked_masks_ != nullptr; }
  void UncheckedMasks(const AnyQueries& queries, bool is_one,
                      std::span<std::uint64_t> rows, Target target) const {
    unchecked_masks_(planes_, size(), queries, is_one, rows.data(), target);
  }

 private:
  detail::Scan scan_;
  PlanePointers planes_{};
  void (*reference_mask_)(const PlanePointers&, std::size_t, const void*,
                          std::uint64_t*) = nullptr;
  void (*unchecked_masks_)(const PlanePointers&, std::size_t, const AnyQueries&,
                           bool, std::uint64_t*, Target) = nullptr;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_ANY_WORLD_H_

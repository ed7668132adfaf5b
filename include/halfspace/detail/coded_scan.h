// Internal. Codes as worlds for the calls. Not part of the interface.
#ifndef HALFSPACE_DETAIL_CODED_SCAN_H_
#define HALFSPACE_DETAIL_CODED_SCAN_H_

#include <cstddef>
#include <span>
#include <type_traits>

#include "halfspace/detail/code_book.h"
#include "halfspace/detail/scan.h"

namespace halfspace::detail {

template <typename View, typename Pointers>
void ListPlanes(const View& view, Pointers& planes) {
  std::size_t p = 0;
  for (const auto* plane : view.min) planes[p++] = plane;
  if constexpr (HasMax<View>) {
    for (const auto* plane : view.max) planes[p++] = plane;
  }
}

template <typename View>
FloatColumns ColumnsOf(const View& floats) {
  FloatColumns columns;
  columns.size = floats.size;
  columns.stride = 1;
  ListPlanes(floats, columns.planes);
  return columns;
}

template <typename Bound>
FloatColumns ColumnsOf(std::span<const Bound> records) {
  constexpr std::size_t kValues = kPlaneCount<Bound>;
  static_assert(std::is_standard_layout_v<Bound> &&
                    sizeof(Bound) == kValues * sizeof(float),
                "a bound is read as a list of its values");
  FloatColumns columns;
  columns.size = records.size();
  columns.stride = kValues;
  const auto* values = reinterpret_cast<const float*>(records.data());
  for (std::size_t p = 0; p < kValues; ++p) {
    columns.planes[p] = values == nullptr ? nullptr : values + p;
  }
  return columns;
}

template <typename FloatView, typename Code>
class CodedView {
 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;

  explicit CodedView(const CodedPlanes<StoredCode<Code>>& planes)
      : planes_(&planes) {}

  const CodedView& view() const { return *this; }
  const CodedPlanes<StoredCode<Code>>& planes() const { return *planes_; }

 private:
  const CodedPlanes<StoredCode<Code>>* planes_;
};

// Floats is a view of planes, or a list of records.
template <typename FloatView, typename Code, typename Floats>
struct ConfirmedView {
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;

  CodedView<FloatView, Code> codes;
  Floats floats;

  const ConfirmedView& view() const { return *this; }
};

template <typename Stored>
void EncodeQueries(const Scan& scan, std::size_t first, std::size_t count,
                   void* codes) {
  const float* values =
      static_cast<const float*>(scan.queries) + first * scan.plane_count;
  auto* to = static_cast<Stored*>(codes);
  for (std::size_t q = 0; q < count; ++q) {
    scan.book->CodeQuery(values, to);
    values += scan.plane_count;
    to += scan.plane_count;
  }
}

template <typename FloatView, typename Code>
Scan MakeScan(const CodedView<FloatView, Code>& view,
              std::span<const typename FloatView::Query> queries) {
  using Bound = typename FloatView::Bound;
  Scan scan = ScanOfQueries<FloatView>(queries);
  const auto& coded = view.planes();
  scan.all_kernels = KernelsOf<Bound::kAxes, StoredCode<Code>>::kTargets;
  scan.element_bytes = sizeof(Code);
  scan.record_bytes = kPlaneCount<Bound> * sizeof(Code);
  scan.size = coded.size();
  AddPlanes(
      std::make_index_sequence<kPlaneCount<Bound>>(),
      [&coded](auto plane) { return coded.planes().plane(plane()); }, scan);
  scan.book = &coded.book();
  scan.encode = &EncodeQueries<StoredCode<Code>>;
  return scan;
}

template <typename FloatView, typename Code, typename Floats>
Scan MakeScan(const ConfirmedView<FloatView, Code, Floats>& view,
              std::span<const typename FloatView::Query> queries) {
  Scan scan = MakeScan(view.codes, queries);
  scan.is_refined = true;
  scan.floats = ColumnsOf(view.floats);
  return scan;
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_CODED_SCAN_H_

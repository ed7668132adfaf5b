// Internal. Quantized bounds as worlds for the calls. Not part of the
// interface.
#ifndef HALFSPACE_DETAIL_QUANTIZED_SCAN_H_
#define HALFSPACE_DETAIL_QUANTIZED_SCAN_H_

#include <cstddef>
#include <type_traits>

#include "halfspace/detail/quantizer.h"
#include "halfspace/detail/scan.h"
#include "halfspace/span.h"

namespace halfspace::detail {

template <typename FloatView, typename Element>
class QuantizedView {
 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;

  explicit QuantizedView(const QuantizedPlanes<StoredElement<Element>>& planes)
      : planes_(&planes) {}

  const QuantizedView& view() const { return *this; }
  const QuantizedPlanes<StoredElement<Element>>& planes() const {
    return *planes_;
  }

 private:
  const QuantizedPlanes<StoredElement<Element>>* planes_;
};

// Floats is a view of planes, or a list of records.
template <typename FloatView, typename Element, typename Floats>
struct RefinedView {
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;

  QuantizedView<FloatView, Element> quantized;
  Floats floats;

  const RefinedView& view() const { return *this; }
};

template <typename Stored>
void EncodeQueries(const Scan& scan, std::size_t first, std::size_t count,
                   void* quantized) {
  const float* values =
      static_cast<const float*>(scan.queries) + first * scan.plane_count;
  auto* to = static_cast<Stored*>(quantized);
  for (std::size_t q = 0; q < count; ++q) {
    scan.quantizer->EncodeQuery(values, to);
    values += scan.plane_count;
    to += scan.plane_count;
  }
}

template <typename FloatView, typename Element>
Scan MakeScan(const QuantizedView<FloatView, Element>& view,
              Span<const typename FloatView::Query> queries) {
  using Bound = typename FloatView::Bound;
  Scan scan = ScanOfQueries<FloatView>(queries);
  const auto& quantized = view.planes();
  scan.all_kernels = KernelsOf<Bound::kAxes, StoredElement<Element>>::kTargets;
  scan.element_bytes = sizeof(Element);
  scan.record_bytes = kPlaneCount<Bound> * sizeof(Element);
  scan.size = quantized.size();
  AddPlanes(
      std::make_index_sequence<kPlaneCount<Bound>>(),
      [&quantized](auto plane) { return quantized.planes().plane(plane()); },
      scan);
  scan.quantizer = &quantized.quantizer();
  scan.encode = &EncodeQueries<StoredElement<Element>>;
  return scan;
}

template <typename FloatView, typename Element, typename Floats>
Scan MakeScan(const RefinedView<FloatView, Element, Floats>& view,
              Span<const typename FloatView::Query> queries) {
  Scan scan = MakeScan(view.quantized, queries);
  scan.is_refined = true;
  scan.floats = ColumnsOf(view.floats);
  return scan;
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_QUANTIZED_SCAN_H_

// Internal. Quantized bounds as worlds for the calls. Not part of the
// interface.
#ifndef HALFSPACE_DETAIL_QUANTIZED_SCAN_H_
#define HALFSPACE_DETAIL_QUANTIZED_SCAN_H_

#include <array>
#include <cstddef>

#include "halfspace/detail/quantizer.h"
#include "halfspace/detail/scan.h"
#include "halfspace/span.h"

namespace halfspace::detail {

template <typename FloatView, typename Element>
struct QuantizedView {
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Stored = StoredElement<Element>;

  explicit QuantizedView(const QuantizedPlanes<Stored>& quantized)
      : size(quantized.size()), quantizer(&quantized.quantizer()) {
    for (std::size_t p = 0; p < planes.size(); ++p) {
      planes[p] = quantized.planes().plane(p);
    }
  }

  const QuantizedView& view() const { return *this; }

  std::array<const Stored*, kPlaneCount<Bound>> planes;
  std::size_t size;
  const Quantizer* quantizer;
};

// Floats is a view of planes, or a list of records.
template <typename FloatView, typename Element, typename Floats>
struct RefinedView : QuantizedView<FloatView, Element> {
  RefinedView(const QuantizedView<FloatView, Element>& quantized,
              const Floats& of_floats)
      : QuantizedView<FloatView, Element>(quantized), floats(of_floats) {}

  const RefinedView& view() const { return *this; }

  Floats floats;
};

template <typename Stored>
void EncodeQueries(const Scan& scan, std::size_t first, std::size_t count,
                   void* quantized) {
  const std::size_t values = scan.type->plane_count;
  const float* from = static_cast<const float*>(scan.queries) + first * values;
  auto* to = static_cast<Stored*>(quantized);
  for (std::size_t q = 0; q < count; ++q) {
    scan.quantizer->EncodeQuery(from, to);
    from += values;
    to += values;
  }
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_QUANTIZED_SCAN_H_

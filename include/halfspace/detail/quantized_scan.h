// Internal. Quantized bounds as worlds for the calls. Not part of the
// interface.
#ifndef HALFSPACE_DETAIL_QUANTIZED_SCAN_H_
#define HALFSPACE_DETAIL_QUANTIZED_SCAN_H_

#include <array>
#include <cstddef>
#include <utility>

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
      : QuantizedView(quantized,
                      std::make_index_sequence<kPlaneCount<Bound>>()) {}

  const QuantizedView& view() const { return *this; }

  std::array<const Stored*, kPlaneCount<Bound>> planes;
  std::size_t size;
  const Quantizer* quantizer;

 private:
  // Without a loop, so that compilers copy no array.
  template <std::size_t... kPlane>
  QuantizedView(const QuantizedPlanes<Stored>& quantized,
                std::index_sequence<kPlane...>)
      : planes{quantized.planes().plane(kPlane)...},
        size(quantized.size()),
        quantizer(&quantized.quantizer()) {}
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

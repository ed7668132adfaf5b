// Internal. Codes as worlds for the calls. Not part of the interface.
#ifndef HALFSPACE_DETAIL_CODED_SCAN_H_
#define HALFSPACE_DETAIL_CODED_SCAN_H_

#include <cstddef>
#include <span>

#include "halfspace/detail/code_book.h"
#include "halfspace/detail/scan.h"

namespace halfspace::detail {

template <typename FloatView, typename Code>
class CodedView {
 public:
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;

  explicit CodedView(const CodedPlanes<StoredCode<Code>>& planes)
      : planes_(&planes) {}

  CodedView view() const { return *this; }
  const CodedPlanes<StoredCode<Code>>& planes() const { return *planes_; }

 private:
  const CodedPlanes<StoredCode<Code>>* planes_;
};

template <typename FloatView, typename Code>
struct ConfirmedView {
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;

  CodedView<FloatView, Code> codes;
  FloatView floats;

  ConfirmedView view() const { return *this; }
};

template <typename FloatView, typename Code>
Scan MakeScan(const CodedView<FloatView, Code>& view,
              std::span<const typename FloatView::Query> queries) {
  using Bound = typename FloatView::Bound;
  Scan scan = MakeScan(FloatView(), queries);
  const auto& coded = view.planes();
  scan.element = kElementOf<StoredCode<Code>>;
  scan.size = coded.size();
  for (std::size_t p = 0; p < kPlaneCount<Bound>; ++p) {
    scan.planes[p] = coded.planes().plane(p);
  }
  scan.book = &coded.book();
  return scan;
}

template <typename FloatView, typename Code>
Scan MakeScan(const ConfirmedView<FloatView, Code>& view,
              std::span<const typename FloatView::Query> queries) {
  Scan scan = MakeScan(view.codes, queries);
  scan.is_confirmed = true;
  scan.confirming_size = view.floats.size;
  ListPlanes(view.floats, scan.confirming);
  return scan;
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_CODED_SCAN_H_

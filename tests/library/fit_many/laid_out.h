// Rows of floats in memory, laid out in the ways that the bulk builders take.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_MANY_LAID_OUT_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_MANY_LAID_OUT_H_

#include <array>
#include <cstddef>
#include <vector>

namespace halfspace::testing {

template <std::size_t kColumns>
using Rows = std::vector<std::array<float, kColumns>>;

// Packed, with gaps between the rows, or by columns.
enum class Layout { kPacked, kGaps, kColumns };

inline constexpr std::array kLayouts = {Layout::kPacked, Layout::kGaps,
                                        Layout::kColumns};

// Value c of row i is column(c)[i * stride()].
template <std::size_t kColumns>
class LaidOut {
 public:
  LaidOut(const Rows<kColumns>& rows, Layout layout)
      : column_step_(layout == Layout::kColumns ? rows.size() : 1) {
    if (layout == Layout::kPacked) stride_ = kColumns;
    if (layout == Layout::kGaps) stride_ = kColumns + 2;
    floats_.resize(rows.size() * (kColumns + 2));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t c = 0; c < kColumns; ++c) {
        floats_[i * stride_ + c * column_step_] = rows[i][c];
      }
    }
  }

  const float* column(std::size_t c) const {
    return floats_.data() + c * column_step_;
  }
  std::size_t stride() const { return stride_; }

 private:
  std::size_t column_step_;
  std::size_t stride_ = 1;
  std::vector<float> floats_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_MANY_LAID_OUT_H_

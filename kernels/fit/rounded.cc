// Bounds of doubles as bounds of floats.
#include <cstddef>

#include "halfspace/transform.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/exact/outward.h"

namespace halfspace::detail {

void RoundOutward(Span<const double> values, std::size_t minima,
                  std::size_t planes, float* rounded) {
  kernels::InDefaultFpMode([&] {
    for (std::size_t i = 0; i < values.size(); i += planes) {
      for (std::size_t p = 0; p < planes; ++p) {
        const kernels::ExactSum value = {values[i + p], 0.0};
        rounded[i + p] =
            p < minima ? kernels::RoundDown(value) : kernels::RoundUp(value);
      }
    }
  });
}

}  // namespace halfspace::detail

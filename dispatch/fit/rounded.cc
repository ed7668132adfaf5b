// Records as rows of floats, and doubles rounded outward.
#include <cstddef>

#include "dispatch/default_fp_mode.h"
#include "dispatch/outward.h"
#include "halfspace/detail/plane_arrays.h"

namespace halfspace::detail {

void ReadRecords(const Columns& columns, std::size_t values, std::size_t minima,
                 std::size_t begin, std::size_t count, float* records) {
  const std::size_t first = begin * columns.stride;
  if (!columns.is_double) {
    for (std::size_t v = 0; v < values; ++v) {
      const float* const from = columns.floats(v) + first;
      for (std::size_t i = 0; i < count; ++i) {
        records[i * values + v] = from[i * columns.stride];
      }
    }
    return;
  }
  dispatch::InDefaultFpMode([&] {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t v = 0; v < values; ++v) {
        const double value = columns.doubles(v)[first + i * columns.stride];
        records[i * values + v] =
            v < minima ? dispatch::RoundDown(value) : dispatch::RoundUp(value);
      }
    }
  });
}

}  // namespace halfspace::detail

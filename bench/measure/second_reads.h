// How often batches of a mask have a survivor: what an early-out between two
// stages goes on with.
#ifndef HALFSPACE_BENCH_MEASURE_SECOND_READS_H_
#define HALFSPACE_BENCH_MEASURE_SECOND_READS_H_

#include <cstddef>
#include <cstdint>
#include <span>

namespace halfspace::bench {

// The batches of `width` objects, a power of two up to 64, of whose bits one is
// set; of all batches of whole words.
inline std::size_t BatchesWithSurvivor(std::span<const std::uint64_t> mask,
                                       std::size_t width) {
  const std::uint64_t batch = ~std::uint64_t{0} >> (64 - width);
  std::size_t count = 0;
  for (std::uint64_t word : mask) {
    if (word == 0) continue;
    for (std::size_t l = 0; l < 64; l += width) {
      count += (word >> l & batch) != 0 ? 1 : 0;
    }
  }
  return count;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_SECOND_READS_H_

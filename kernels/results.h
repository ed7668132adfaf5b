// Where kernels write ids or pairs.
#ifndef HALFSPACE_KERNELS_RESULTS_H_
#define HALFSPACE_KERNELS_RESULTS_H_

#include <cstddef>

namespace halfspace::detail {

// The most results that are written without a look at `full`.
inline constexpr std::size_t kMostAtOnce = 64;

// There is room for kMostAtOnce items at `next`, unless it has reached `full`:
// then flush() is due, which makes room, and returns whether to go on.
template <typename Item>
struct Results {
  Item* begin;  // of those since the last flush()
  Item* next;
  Item* full;
  bool (*flush)(Results& results);
  std::size_t flushed;  // items

  std::size_t Total() const {
    return flushed + static_cast<std::size_t>(next - begin);
  }
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_RESULTS_H_

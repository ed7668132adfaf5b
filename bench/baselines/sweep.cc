#include <algorithm>
#include <cstring>
#include <numeric>

#include "bench/baselines/box_tree.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kBlock = 256;
constexpr std::size_t kVector = 32;  // boxes that the loop tests at once

// Minima and maxima of two axes, in the order of the third.
struct Planes {
  const float* min[2];
  const float* max[2];
};

// Which of so many boxes touch box i on these two axes.
void TestBlock(const Planes& planes, std::size_t i, std::size_t begin,
               std::size_t count, unsigned char* __restrict touches) {
  const float min0 = planes.min[0][i], min1 = planes.min[1][i];
  const float max0 = planes.max[0][i], max1 = planes.max[1][i];
  const float* mins0 = planes.min[0] + begin;
  const float* mins1 = planes.min[1] + begin;
  const float* maxs0 = planes.max[0] + begin;
  const float* maxs1 = planes.max[1] + begin;
  for (std::size_t j = 0; j < count; ++j) {
    touches[j] =
        static_cast<unsigned char>((mins0[j] <= max0) & (maxs0[j] >= min0) &
                                   (mins1[j] <= max1) & (maxs1[j] >= min1));
  }
}

// The axis on which the boxes' world is longest.
std::size_t LongestAxis(std::span<const Aabb3> boxes) {
  Aabb3 world = Aabb3::Empty();
  for (const Aabb3& box : boxes) {
    for (std::size_t k = 0; k < 3; ++k) {
      world.min[k] = std::min(world.min[k], box.min[k]);
      world.max[k] = std::max(world.max[k], box.max[k]);
    }
  }
  std::size_t longest = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (world.max[k] - world.min[k] > world.max[longest] - world.min[longest]) {
      longest = k;
    }
  }
  return longest;
}

class Sweep : public PairFinder {
 public:
  explicit Sweep(std::span<const Aabb3> boxes) : order_(boxes.size()) {
    const std::size_t axis = LongestAxis(boxes);
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(),
              [&](std::uint32_t a, std::uint32_t b) {
                return boxes[a].min[axis] < boxes[b].min[axis];
              });
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::uint32_t index : order_) {
        const std::size_t from = (axis + k) % 3;
        min_[k].push_back(boxes[index].min[from]);
        max_[k].push_back(boxes[index].max[from]);
      }
      // Tested with the last ones.
      min_[k].resize(boxes.size() + kVector);
      max_[k].resize(boxes.size() + kVector);
    }
  }

  void Pairs(std::vector<IndexPair>& found) override {
    found.clear();
    const Planes planes{{min_[1].data(), min_[2].data()},
                        {max_[1].data(), max_[2].data()}};
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const auto first = min_[0].begin();
      const auto bvh_end = first + static_cast<std::ptrdiff_t>(order_.size());
      const auto end = static_cast<std::size_t>(
          std::upper_bound(first + static_cast<std::ptrdiff_t>(i), bvh_end,
                           max_[0][i]) -
          first);
      for (std::size_t begin = i + 1; begin < end; begin += kBlock) {
        const std::size_t count = std::min(kBlock, end - begin);
        // Whole vectors, as the rest of a loop is slow.
        TestBlock(planes, i, begin, (count + kVector - 1) / kVector * kVector,
                  touches_);
        Take(i, begin, count, found);
      }
    }
  }

 private:
  void Take(std::size_t i, std::size_t begin, std::size_t count,
            std::vector<IndexPair>& found) const {
    constexpr std::size_t kAtOnce = sizeof(std::uint64_t);
    for (std::size_t j = 0; j < count; j += kAtOnce) {
      std::uint64_t some;
      std::memcpy(&some, touches_ + j, kAtOnce);
      if (some == 0) continue;
      const std::size_t last = std::min(j + kAtOnce, count);
      for (std::size_t t = j; t < last; ++t) {
        if (touches_[t]) found.push_back({order_[i], order_[begin + t]});
      }
    }
  }

  std::vector<std::uint32_t> order_;
  std::array<std::vector<float>, 3> min_;  // first that of the order
  std::array<std::vector<float>, 3> max_;
  unsigned char touches_[kBlock];
};

}  // namespace

std::unique_ptr<PairFinder> MakeSweep(std::span<const Aabb3> boxes) {
  return std::make_unique<Sweep>(boxes);
}

}  // namespace halfspace::bench

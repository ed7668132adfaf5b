#include "bench/paper/work_count.h"

#include <bit>
#include <span>

#include "bench/paper/loops.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kWordObjects = 64;

// The first widths are parts of a word; of the others, in words.
constexpr std::size_t kNarrowWidths = 4;
constexpr std::array<std::size_t, 3> kWideWords = {4, 16, 64};

std::span<const Plane> OrderOf(ShapeKind shape) {
  switch (shape) {
    case ShapeKind::kAabb:
      return kAabbOrder;
    case ShapeKind::kSimplex:
      return kSimplexOrder;
    case ShapeKind::kAabo:
      break;
  }
  return kAaboOrder;
}

// Which of 64 objects a half-space rejects by itself.
template <bool kIsMin>
std::uint64_t RejectedBy(const float* plane, float value) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < kWordObjects; ++i) {
    const bool is_rejected = kIsMin ? plane[i] > value : plane[i] < value;
    bits |= std::uint64_t{is_rejected} << i;
  }
  return bits;
}

std::uint64_t CountBits(std::uint64_t bits) {
  return static_cast<std::uint64_t>(std::popcount(bits));
}

}  // namespace

void WorkCounter::Add(const Aabo3& query) {
  const std::size_t words = objects_.size / kWordObjects;
  for (std::size_t s = 0; s < kShapes.size(); ++s) {
    const std::span<const Plane> order = OrderOf(kShapes[s]);
    const std::vector<const float*> planes = PlanesOf(kShapes[s], objects_);
    const std::vector<float> values = QueryOf(kShapes[s], query);
    // Per half-space and wide width: whether the batch reaches it.
    std::array<std::array<bool, kWideWords.size()>, 8> is_reached{};
    for (std::size_t w = 0; w < words; ++w) {
      std::uint64_t kept = ~std::uint64_t{0};
      for (std::size_t k = 0; k < order.size() && kept != 0; ++k) {
        // Bit i of `any` says whether one of 8 objects from i on is left.
        std::uint64_t any = kept;
        for (int shift : {1, 2, 4}) any |= any >> shift;
        ByWidth& reached = reached_[s][k];
        reached[0] += CountBits(kept);
        reached[1] += CountBits(any & 0x0101010101010101);
        reached[2] += CountBits((any | any >> 8) & 0x0001000100010001);
        reached[3] += 1;
        is_reached[k].fill(true);
        const float* plane = planes[order[k].object] + w * kWordObjects;
        const float value = values[order[k].query];
        kept &= ~(order[k].is_min ? RejectedBy<true>(plane, value)
                                  : RejectedBy<false>(plane, value));
      }
      for (std::size_t b = 0; b < kWideWords.size(); ++b) {
        if ((w + 1) % kWideWords[b] != 0 && w + 1 != words) continue;
        for (std::size_t k = 0; k < order.size(); ++k) {
          reached_[s][k][kNarrowWidths + b] += is_reached[k][b] ? 1 : 0;
          is_reached[k][b] = false;
        }
      }
    }
  }
  ++queries_;
}

WorkCount WorkCounter::Average() const {
  WorkCount average;
  const std::size_t objects = objects_.size / kWordObjects * kWordObjects;
  for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
    const std::size_t batches =
        (objects + kWorkWidths[i] - 1) / kWorkWidths[i] * queries_;
    if (batches == 0) continue;
    const auto average_of = [&](ShapeKind shape) {
      std::uint64_t evaluated = 0;
      for (const ByWidth& reached : reached_[static_cast<std::size_t>(shape)]) {
        evaluated += reached[i];
      }
      return static_cast<double>(evaluated) / static_cast<double>(batches);
    };
    average.aabb[i] = average_of(ShapeKind::kAabb);
    average.simplex[i] = average_of(ShapeKind::kSimplex);
    average.aabo[i] = average_of(ShapeKind::kAabo);
  }
  return average;
}

std::vector<double> WorkCounter::Reached(ShapeKind shape) const {
  const std::size_t tested = objects_.size - objects_.size % kWordObjects;
  const auto pairs = static_cast<double>(tested * queries_);
  std::vector<double> shares;
  for (std::size_t k = 0; k < PlaneCountOf(shape); ++k) {
    shares.push_back(
        static_cast<double>(reached_[static_cast<std::size_t>(shape)][k][0]) /
        pairs);
  }
  return shares;
}

}  // namespace halfspace::bench

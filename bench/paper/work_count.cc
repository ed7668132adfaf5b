#include "bench/paper/work_count.h"

#include <algorithm>
#include <bit>

#include "bench/paper/loops.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kWordObjects = 64;

// The order in which the planes of each shape are tested.
constexpr std::array<std::span<const Plane>, 3> kOrders = {
    kAabbOrder, kSimplexOrder, kAaboOrder};

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

}  // namespace

std::size_t BatchesLeft(std::span<const std::uint64_t> kept,
                        std::size_t width) {
  const std::size_t words = std::max<std::size_t>(1, width / kWordObjects);
  // The first bit of each batch of less than a word.
  const std::uint64_t firsts =
      width < kWordObjects
          ? ~std::uint64_t{0} / ((std::uint64_t{1} << width) - 1)
          : 1;
  std::size_t batches = 0;
  for (std::size_t w = 0; w < kept.size(); w += words) {
    std::uint64_t any = 0;
    for (std::uint64_t word :
         kept.subspan(w, std::min(words, kept.size() - w))) {
      any |= word;
    }
    // Bit i says whether one of the objects from i on is left.
    for (std::size_t shift = 1; shift < std::min(width, kWordObjects);
         shift *= 2) {
      any |= any >> shift;
    }
    batches += static_cast<std::size_t>(std::popcount(any & firsts));
  }
  return batches;
}

void WorkCounter::Add(const Aabo3& query) {
  std::vector<std::uint64_t> kept(objects_.size / kWordObjects);
  for (ShapeKind shape : kShapes) {
    const auto order = kOrders[static_cast<std::size_t>(shape)];
    const std::vector<const float*> planes = PlanesOf(shape, objects_);
    const std::vector<float> values = QueryOf(shape, query);
    std::fill(kept.begin(), kept.end(), ~std::uint64_t{0});
    for (std::size_t k = 0; k < order.size(); ++k) {
      for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
        reached_.Of(shape)[k][i] += BatchesLeft(kept, kWorkWidths[i]);
      }
      const float value = values[order[k].query];
      for (std::size_t w = 0; w < kept.size(); ++w) {
        if (kept[w] == 0) continue;
        const float* plane = planes[order[k].object] + w * kWordObjects;
        kept[w] &= ~(order[k].is_min ? RejectedBy<true>(plane, value)
                                     : RejectedBy<false>(plane, value));
      }
    }
    survivors_.Of(shape) += BatchesLeft(kept, 1);
  }
  ++queries_;
}

WorkCount WorkCounter::Average() const {
  WorkCount average;
  const std::size_t objects = objects_.size / kWordObjects * kWordObjects;
  for (ShapeKind shape : kShapes) {
    for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
      const std::size_t batches =
          (objects + kWorkWidths[i] - 1) / kWorkWidths[i] * queries_;
      if (batches == 0) continue;
      std::size_t evaluated = 0;
      for (const ByWidth& reached : reached_.Of(shape)) evaluated += reached[i];
      average.Of(shape)[i] =
          static_cast<double>(evaluated) / static_cast<double>(batches);
    }
  }
  return average;
}

std::vector<double> WorkCounter::Reached(ShapeKind shape) const {
  const std::size_t tested = objects_.size - objects_.size % kWordObjects;
  const auto pairs = static_cast<double>(tested * queries_);
  std::vector<double> shares;
  for (std::size_t k = 0; k < PlaneCountOf(shape); ++k) {
    shares.push_back(static_cast<double>(reached_.Of(shape)[k][0]) / pairs);
  }
  return shares;
}

}  // namespace halfspace::bench

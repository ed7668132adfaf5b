#include "bench/paper/work_count.h"

#include <algorithm>
#include <bit>

#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kWordObjects = 64;

// The first widths are parts of a word; of the others, in words.
constexpr std::size_t kNarrowWidths = 4;
constexpr std::array<std::size_t, 3> kWideWords = {4, 16, 64};

// The planes of PlaneWords in the paper's order of evaluation.
constexpr std::array<std::array<std::size_t, 8>, kShapes.size()> kOrders = {
    {{0, 4, 1, 5, 2, 6}, {0, 1, 2, 3}, {0, 1, 2, 3, 4, 5, 6, 7}}};

std::uint64_t CountBits(std::uint64_t bits) {
  return static_cast<std::uint64_t>(std::popcount(bits));
}

// The planes from object `first` on, as the kernels take them.
std::array<const float*, kPlaneWordsPlanes> PlanesFrom(const AaboView3& view,
                                                       std::size_t first) {
  std::array<const float*, kPlaneWordsPlanes> planes{};
  for (std::size_t k = 0; k < 4; ++k) {
    planes[k] = view.min[k] + first;
    planes[4 + k] = view.max[k] + first;
  }
  return planes;
}

}  // namespace

void WorkCounter::Add(const Aabo3& query) {
  constexpr std::size_t kChunk = 64;
  const PlaneWordsFunction fill = LoopsFor(ChosenTarget()).fill_plane_words;
  std::array<float, kPlaneWordsPlanes> values{};
  std::copy(query.min.begin(), query.min.end(), values.begin());
  std::copy(query.max.begin(), query.max.end(), values.begin() + 4);

  // Per shape, half-space and wide width: whether the batch reaches it.
  std::array<std::array<std::array<bool, 3>, kPlaneWordsPlanes>, 3>
      is_reached{};
  std::array<PlaneWords, kChunk> chunk;
  const std::size_t words = objects_.size / kWordObjects;
  for (std::size_t w = 0; w < words; ++w) {
    if (w % kChunk == 0) {
      fill(PlanesFrom(objects_, w * kWordObjects).data(), values.data(),
           std::min(kChunk, words - w), chunk.data());
    }
    for (std::size_t s = 0; s < kOrders.size(); ++s) {
      std::uint64_t kept = ~std::uint64_t{0};
      for (std::size_t k = 0; k < PlaneCountOf(kShapes[s]) && kept != 0; ++k) {
        // Bit i of `any` says whether one of 8 objects from i on is left.
        std::uint64_t any = kept;
        for (int shift : {1, 2, 4}) any |= any >> shift;
        ByWidth& reached = reached_[s][k];
        reached[0] += CountBits(kept);
        reached[1] += CountBits(any & 0x0101010101010101);
        reached[2] += CountBits((any | any >> 8) & 0x0001000100010001);
        reached[3] += 1;
        is_reached[s][k].fill(true);
        kept &= ~chunk[w % kChunk][kOrders[s][k]];
      }
      for (std::size_t b = 0; b < kWideWords.size(); ++b) {
        if ((w + 1) % kWideWords[b] != 0 && w + 1 != words) continue;
        for (std::size_t k = 0; k < kPlaneWordsPlanes; ++k) {
          reached_[s][k][kNarrowWidths + b] += is_reached[s][k][b] ? 1 : 0;
          is_reached[s][k][b] = false;
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
    const auto average_of = [&](std::size_t shape) {
      std::uint64_t evaluated = 0;
      for (const ByWidth& reached : reached_[shape]) evaluated += reached[i];
      return static_cast<double>(evaluated) / static_cast<double>(batches);
    };
    average.aabb[i] = average_of(0);
    average.simplex[i] = average_of(1);
    average.aabo[i] = average_of(2);
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

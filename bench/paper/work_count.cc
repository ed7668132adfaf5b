#include "bench/paper/work_count.h"

#include <algorithm>

#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kWordObjects = 64;

// Widths of more than a word, in words.
constexpr std::array<std::size_t, 3> kWideWords = {4, 16, 64};

// The planes of PlaneWords in the paper's order of evaluation.
constexpr std::array<std::size_t, 6> kAabbOrder = {0, 4, 1, 5, 2, 6};
constexpr std::array<std::size_t, 4> kSimplexOrder = {0, 1, 2, 3};
constexpr std::array<std::size_t, 8> kAaboOrder = {0, 1, 2, 3, 4, 5, 6, 7};

// Set bits among the lowest bits of each 8-bit (or 16-bit) group: a multiply
// adds the groups up in the top one.
std::uint64_t SumOfBytes(std::uint64_t bytes) {
  return (bytes * 0x0101010101010101) >> 56;
}
std::uint64_t SumOf16(std::uint64_t groups) {
  return (groups * 0x0001000100010001) >> 48;
}

// Without the popcnt instruction, which the baseline lacks, std::popcount is a
// call.
std::uint64_t ObjectsIn(std::uint64_t kept) {
  std::uint64_t pairs = kept - ((kept >> 1) & 0x5555555555555555);
  pairs = (pairs & 0x3333333333333333) + ((pairs >> 2) & 0x3333333333333333);
  return SumOfBytes((pairs + (pairs >> 4)) & 0x0F0F0F0F0F0F0F0F);
}

using ByWidth = std::array<std::uint64_t, kWorkWidths.size()>;
using Reached = std::array<ByWidth, kPlaneWordsPlanes>;

// Counts one shape over one query's words.
template <std::size_t kPlanes>
class ShapeCounter {
 public:
  explicit ShapeCounter(const std::array<std::size_t, kPlanes>& order)
      : order_(order) {}

  void AddWord(const PlaneWords& words) {
    std::uint64_t kept = ~std::uint64_t{0};
    for (std::size_t k = 0; k < kPlanes && kept != 0; ++k) {
      std::uint64_t any = kept;
      ByWidth& reached = reached_[k];
      reached[0] += ObjectsIn(kept);
      for (int shift : {1, 2, 4}) any |= any >> shift;
      const std::uint64_t any8 = any & 0x0101010101010101;
      reached[1] += SumOfBytes(any8);
      reached[2] += SumOf16((any8 | (any8 >> 8)) & 0x0001000100010001);
      reached[3] += 1;
      for (std::size_t b = 0; b < kWideWords.size(); ++b) {
        wide_nonzero_[b][k] = true;
      }
      kept &= ~words[order_[k]];
    }
  }

  // After word number `words_done`, from 1; or at the end of the world.
  void CloseBatches(std::size_t words_done, bool is_end) {
    for (std::size_t b = 0; b < kWideWords.size(); ++b) {
      if (words_done % kWideWords[b] != 0 && !is_end) continue;
      for (std::size_t k = 0; k < kPlanes; ++k) {
        reached_[k][4 + b] += wide_nonzero_[b][k] ? 1 : 0;
        wide_nonzero_[b][k] = false;
      }
    }
  }

  void AddTo(Reached& sums) const {
    for (std::size_t k = 0; k < kPlanes; ++k) {
      for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
        sums[k][i] += reached_[k][i];
      }
    }
  }

 private:
  const std::array<std::size_t, kPlanes>& order_;
  Reached reached_{};
  std::array<std::array<bool, kPlaneWordsPlanes>, kWideWords.size()>
      wide_nonzero_{};
};

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

  ShapeCounter<6> aabb(kAabbOrder);
  ShapeCounter<4> simplex(kSimplexOrder);
  ShapeCounter<8> aabo(kAaboOrder);
  std::array<PlaneWords, kChunk> chunk;
  const std::size_t words = objects_.size / kWordObjects;
  for (std::size_t begin = 0; begin < words; begin += kChunk) {
    const std::size_t count = std::min(kChunk, words - begin);
    fill(PlanesFrom(objects_, begin * kWordObjects).data(), values.data(),
         count, chunk.data());
    for (std::size_t w = 0; w < count; ++w) {
      const bool is_end = begin + w + 1 == words;
      aabb.AddWord(chunk[w]);
      simplex.AddWord(chunk[w]);
      aabo.AddWord(chunk[w]);
      aabb.CloseBatches(begin + w + 1, is_end);
      simplex.CloseBatches(begin + w + 1, is_end);
      aabo.CloseBatches(begin + w + 1, is_end);
    }
  }
  aabb.AddTo(reached_[0]);
  simplex.AddTo(reached_[1]);
  aabo.AddTo(reached_[2]);
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

}  // namespace halfspace::bench

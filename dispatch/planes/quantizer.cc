#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "halfspace/detail/quantized.h"
#include "kernels/compiler.h"

namespace halfspace::detail {
namespace {

using Key = std::int32_t;

// Beyond all keys of floats, and below kPad when one is added.
constexpr Key kBelowAll = std::numeric_limits<Key>::min();
constexpr Key kAboveAll = std::numeric_limits<Key>::max() - 1;

// Fills up a plane's thresholds; no value reaches it.
constexpr Key kPad = std::numeric_limits<Key>::max();

// Returns an integer in the order of floats. Both zeros and all subnormals
// become 0.
constexpr Key KeyOf(float value, Key key_of_nan) {
  constexpr std::uint32_t kInfinity = 0x7f800000;
  constexpr std::uint32_t kSmallestNormal = 0x00800000;
  const auto bits = kernels::BitCast<std::uint32_t>(value);
  const std::uint32_t magnitude = bits & 0x7fffffff;
  if (magnitude > kInfinity) return key_of_nan;
  if (magnitude < kSmallestNormal) return 0;
  const auto key = static_cast<Key>(magnitude);
  return bits == magnitude ? key : -key;
}

// How many of each table's thresholds are below each key. The searches are
// interleaved, because each is a chain of loads.
template <std::size_t kLanes>
void CountBelow(const std::array<const Key*, kLanes>& tables,
                std::size_t thresholds, const std::array<Key, kLanes>& keys,
                std::array<std::uint32_t, kLanes>& counts) {
  counts.fill(0);
  for (std::size_t step = (thresholds + 1) / 2; step != 0; step /= 2) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      // A mask, because gcc compiles a conditional to a branch that is
      // mispredicted every second time (an octahedron then takes 230 ns instead
      // of 80).
      const std::uint32_t below =
          tables[l][counts[l] + step - 1] < keys[l] ? ~std::uint32_t{0} : 0;
      counts[l] += static_cast<std::uint32_t>(step) & below;
    }
  }
}

template <typename Stored>
constexpr Stored Stow(std::uint32_t rank, bool is_min) {
  const auto level = static_cast<Stored>(static_cast<std::int32_t>(rank) +
                                         std::numeric_limits<Stored>::min());
  return is_min ? static_cast<Stored>(~level) : level;
}

// A radix sort, byte by byte. It takes a tenth of the time of std::sort for the
// 2^16 keys of a plane, and training consists mostly of sorting.
void Sort(std::span<Key> keys, std::span<Key> spare) {
  constexpr std::size_t kFew = 128;
  if (keys.size() < kFew) {
    std::sort(keys.begin(), keys.end());
    return;
  }
  constexpr std::size_t kBytes = sizeof(Key);
  const auto byte_of = [](Key key, std::size_t b) {
    return (static_cast<std::uint32_t>(key) ^ 0x80000000u) >> (8 * b) & 0xff;
  };
  std::array<std::array<std::uint32_t, 256>, kBytes> places{};
  for (const Key key : keys) {
    for (std::size_t b = 0; b < kBytes; ++b) ++places[b][byte_of(key, b)];
  }
  // An even number of times: the last time into `keys`.
  for (std::size_t b = 0; b < kBytes; ++b) {
    std::exclusive_scan(places[b].begin(), places[b].end(), places[b].begin(),
                        std::uint32_t{0});
    for (const Key key : keys) spare[places[b][byte_of(key, b)]++] = key;
    std::swap(keys, spare);
  }
}

// Returns an evenly spread sample of a plane, sorted and without NaN, in the
// memory of `sample`. `sample` has two planes, with a key for each object of
// the sample.
std::span<const Key> SortedSample(const Columns& floats, std::size_t plane,
                                  PlaneArrays<Key>& sample) {
  const std::span<Key> keys(sample.plane(0), sample.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::size_t at = SampledIndex(i, keys.size(), floats.size);
    const Key key = KeyOf(floats.floats(plane)[at * floats.stride], kAboveAll);
    if (key != kAboveAll) keys[count++] = key;
  }
  Sort(keys.first(count), {sample.plane(1), count});
  return keys.first(count);
}

// Writes at most `quantiles.size()` of the values, evenly spread in rank, and
// fills up with kPad. The least value is among them for a plane of minima, the
// greatest for one of maxima, so that a query beyond all objects rejects them
// all.
void Quantiles(std::span<const Key> sorted, bool is_min,
               std::span<Key> quantiles) {
  const std::size_t count = std::min(sorted.size(), quantiles.size());
  const auto chosen = quantiles.first(count);
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t rank = j * sorted.size() / count;
    chosen[j] = is_min ? sorted[rank] : sorted[sorted.size() - 1 - rank];
  }
  if (!is_min) std::reverse(chosen.begin(), chosen.end());
  std::fill(std::unique(chosen.begin(), chosen.end()), chosen.end(), kPad);
}

PlaneArrays<Key> NoThresholds(std::size_t planes,
                              const MemoryResource& memory) {
  std::array<Key, kMaxPlanes> padding;
  padding.fill(kPad);
  return {std::span(padding).first(planes), memory};
}

// The state of a Quantizer. The functions below are not its members, because a
// shared library would export them.
struct AllThresholds {
  const PlaneArrays<Key>& of_planes;
  std::size_t minima;
  std::size_t planes;
};

// Ranks one value for each plane, interleaved. The value of plane p is
// values[at(p)].
template <std::size_t kLanes, typename At>
void RankEach(const AllThresholds& all, const float* values, bool is_query,
              const At& at, std::uint32_t* ranks) {
  std::array<const Key*, kLanes> tables;
  std::array<Key, kLanes> keys;
  std::array<std::uint32_t, kLanes> counts;
  for (std::size_t p = 0; p < kLanes; ++p) {
    const std::size_t plane = std::min(p, all.planes - 1);
    const bool is_min = plane < all.minima;
    tables[p] = all.of_planes.plane(plane);
    // A NaN never rejects: an object's minimum is then below all, the query's
    // maximum, which it is compared with, above.
    const Key key_of_nan = is_min == is_query ? kAboveAll : kBelowAll;
    keys[p] = KeyOf(values[at(plane)], key_of_nan) + (is_min ? 1 : 0);
  }
  CountBelow(tables, all.of_planes.size(), keys, counts);
  for (std::size_t p = 0; p < all.planes; ++p) ranks[p] = counts[p];
}

template <typename Stored, typename At>
void EncodeEach(const AllThresholds& all, const float* values, bool is_query,
                const At& at, Stored* levels) {
  std::array<std::uint32_t, kMaxPlanes> ranks;
  if (all.planes <= 4) {
    RankEach<4>(all, values, is_query, at, ranks.data());
  } else if (all.planes <= 6) {
    RankEach<6>(all, values, is_query, at, ranks.data());
  } else if (all.planes <= 8) {
    RankEach<8>(all, values, is_query, at, ranks.data());
  } else {
    RankEach<kMaxPlanes>(all, values, is_query, at, ranks.data());
  }
  for (std::size_t p = 0; p < all.planes; ++p) {
    levels[at(p)] = Stow<Stored>(ranks[p], p < all.minima);
  }
}

}  // namespace

Quantizer::Quantizer(const PlaneLayout& layout, const MemoryResource& memory)
    : layout_(layout), thresholds_(NoThresholds(layout.plane_count, memory)) {}

Quantizer Quantizer::Trained(const Columns& floats, std::size_t levels) const {
  // With this size of the sample, the ranks of 256 levels are off by less than
  // one, and most of 65536 levels differ.
  const std::size_t sampled = levels <= 256 ? 1 << 16 : 1 << 18;
  const std::size_t per_plane =
      std::min(levels, std::bit_ceil(std::min(floats.size, sampled) + 1)) - 1;
  Quantizer quantizer(layout_, memory());
  quantizer.thresholds_.Resize(per_plane);
  PlaneArrays<Key> sample = NoThresholds(2, memory());
  sample.Resize(std::min(floats.size, sampled));
  for (std::size_t p = 0; p < layout_.plane_count; ++p) {
    Quantiles(SortedSample(floats, p, sample), p < layout_.axes,
              {quantizer.thresholds_.plane(p), per_plane});
  }
  return quantizer;
}

template <typename Stored>
void Quantizer::EncodeObjects(std::size_t p, const float* values,
                              std::size_t stride, std::size_t count,
                              Stored* levels) const {
  constexpr std::size_t kLanes = 8;
  const bool is_min = p < layout_.axes;
  const Key* table = thresholds_.plane(p);
  // A minimum reaches a threshold, a maximum exceeds it.
  const Key reach = is_min ? 1 : 0;
  const auto key_of = [&](float value) {
    return KeyOf(value, is_min ? kBelowAll : kAboveAll) + reach;
  };
  std::array<const Key*, kLanes> tables;
  tables.fill(table);
  std::array<Key, kLanes> keys;
  std::array<std::uint32_t, kLanes> ranks;
  for (std::size_t i = 0; i < count; i += kLanes) {
    const std::size_t lanes = std::min(kLanes, count - i);
    keys.fill(kBelowAll);
    for (std::size_t l = 0; l < lanes; ++l) {
      keys[l] = key_of(values[(i + l) * stride]);
    }
    CountBelow(tables, thresholds_.size(), keys, ranks);
    for (std::size_t l = 0; l < lanes; ++l)
      levels[i + l] = Stow<Stored>(ranks[l], is_min);
  }
}

template <typename Stored>
void Quantizer::EncodeObject(const float* values, Stored* levels) const {
  EncodeEach(
      AllThresholds{thresholds_, layout_.axes, layout_.plane_count}, values,
      false, [](std::size_t p) { return p; }, levels);
}

template <typename Stored>
void Quantizer::EncodeQuery(const float* values, Stored* levels) const {
  // The query's maxima, which come after its minima, are compared with the
  // objects' minima.
  EncodeEach(
      AllThresholds{thresholds_, layout_.axes, layout_.plane_count}, values,
      true,
      [this](std::size_t p) {
        return p < layout_.axes ? layout_.first_max + p : p - layout_.axes;
      },
      levels);
}

template void Quantizer::EncodeObjects(std::size_t, const float*, std::size_t,
                                       std::size_t, std::int8_t*) const;
template void Quantizer::EncodeObjects(std::size_t, const float*, std::size_t,
                                       std::size_t, std::int16_t*) const;
template void Quantizer::EncodeObject(const float*, std::int8_t*) const;
template void Quantizer::EncodeObject(const float*, std::int16_t*) const;
// A class that is exported to a DLL does not export these.
template HALFSPACE_API void Quantizer::EncodeQuery(const float*,
                                                   std::int8_t*) const;
template HALFSPACE_API void Quantizer::EncodeQuery(const float*,
                                                   std::int16_t*) const;

}  // namespace halfspace::detail

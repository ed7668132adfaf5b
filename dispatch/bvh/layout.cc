#include "dispatch/bvh/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string>

#include "dispatch/bvh/used_ids.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/outward.h"
#include "halfspace/mask.h"
#include "kernels/compiler.h"

namespace halfspace::detail {
namespace {

constexpr std::size_t kCacheLine = 64;

// A level is prefetched if its data has more bytes than this. Smaller data is
// in the second-level cache or near it, and a query of 100 000 boxes would take
// 8 % longer with prefetches.
constexpr std::size_t kInCacheBytes = std::size_t{1} << 21;

// Divides a block of memory into arrays of whole cache lines. Without memory it
// only computes the size. In new memory it clears the space between arrays,
// because that space is part of a blob.
class Parts {
 public:
  Parts(std::byte* begin, bool is_new) : begin_(begin), is_new_(is_new) {}

  // The greatest size if there are more. No block and no blob has that size.
  std::size_t bytes() const {
    constexpr std::uint64_t kMost = std::numeric_limits<std::size_t>::max();
    return static_cast<std::size_t>(std::min(bytes_, kMost));
  }

  template <typename T>
  T* Take(std::uint64_t count) {
    auto* part = begin_ == nullptr ? nullptr : reinterpret_cast<T*>(End());
    bytes_ += count * sizeof(T);
    const auto gap = static_cast<std::size_t>((0 - bytes_) % kCacheLine);
    if (begin_ != nullptr && is_new_) std::memset(End(), 0, gap);
    bytes_ += gap;
    return part;
  }

 private:
  std::byte* End() const { return begin_ + static_cast<std::size_t>(bytes_); }

  std::byte* begin_;
  bool is_new_;
  std::uint64_t bytes_ = 0;  // an altered header can ask for any number
};

// Elements are read in any order. The values of a record are in one cache line
// or two.
template <typename Scalar, typename Fetch>
void PrefetchElement(const Columns& objects, std::size_t planes, std::size_t i,
                     const Fetch& fetch) {
  if (i == kNoId) return;
  const std::size_t step = objects.stride == 1 ? 1 : planes - 1;
  for (std::size_t p = 0; p < planes; p += step) {
    fetch(static_cast<const Scalar*>(objects.column[p]) + i * objects.stride);
  }
}

void FillPart(const BvhLevels& levels, std::size_t planes,
              const Columns& objects, const std::uint32_t* elements,
              const BvhKernels::OfPlanes& kernels, std::size_t part) {
  const BvhLevel& level = levels.level[0];
  const std::size_t end_block =
      std::min(BlocksOf(level.size), (part + 1) * kBlockObjects);
  for (std::size_t b = part * kBlockObjects; b < end_block; ++b) {
    const std::size_t first = b * kBlockObjects;
    if (elements != nullptr && b + 1 < end_block) {
      for (std::size_t i = first; i < first + kBlockObjects; ++i) {
        PrefetchElement<float>(
            objects, planes, elements[i + kBlockObjects],
            [](const void* at) { kernels::PrefetchToL2(at); });
      }
    }
    const std::uint64_t present = level.present[b];
    if (~present == 0 && elements != nullptr) {
      for (std::size_t p = 0; p < planes; ++p) {
        float* const to = level.Plane(b, p);
        for (std::size_t i = 0; i < kBlockObjects; ++i) {
          to[i] = objects.floats(p)[elements[first + i] * objects.stride];
        }
      }
    } else if (~present == 0 && objects.stride == 1) {
      for (std::size_t p = 0; p < planes; ++p) {
        std::memcpy(level.Plane(b, p), objects.floats(p) + first,
                    kBlockObjects * sizeof(float));
      }
    } else {
      CopyBounds(levels, objects, elements, b, present);
    }
    kernels.encode(RangeOf(levels, 0, b, b + 1));
  }
}

// Doubles are prefetched so many elements ahead.
constexpr std::size_t kAhead = 32;

// Sets the masks of the node above a block to the union of those below it.
void OrMasks(BvhLevels& levels, std::size_t level, std::size_t block) {
  levels.level[level + 1].masks[block] = levels.level[level].MasksOf(block);
}

// A sample of the objects says where most values are.
constexpr std::size_t kMostSamples = 1024;

// Maps a range of an axis onto all codes. The least and the greatest 16th of
// the samples do not count, so a few objects that are far away or very long do
// not make the codes of the others coarser. Their values get the first code or
// the last one, and the floats decide.
void FitAxis(std::span<float> minima, std::span<float> maxima, std::size_t axis,
             CodeMap& map) {
  constexpr float kMostScale = 0x1p100f;
  float low = 0;
  float width = 0;
  if (!minima.empty() && !maxima.empty()) {
    const auto nth = [](std::span<float> values, std::size_t n) {
      float* const place = values.data() + n;
      std::nth_element(values.data(), place, values.data() + values.size());
      return *place;
    };
    low = nth(minima, minima.size() / 16);
    float high = nth(maxima, maxima.size() - 1 - maxima.size() / 16);
    if (!(low < high)) {
      low = *std::min_element(minima.begin(), minima.end());
      high = *std::max_element(maxima.begin(), maxima.end());
    }
    width = std::max(0.0f, high - low);
    // Room for values outside of the sample. Codes would be 1.5 times as fine
    // without it.
    low -= width / 4;
    width *= 1.5f;
  }
  const float scale =
      std::min(static_cast<float>(kMostCode) / width, kMostScale);
  map.base[axis] = low;
  map.scale[axis] = scale;
  map.base[CodeMap::kMaxLane + axis] = -(low + width);
  map.scale[CodeMap::kMaxLane + axis] = scale;
}

// value(p, s) is that of the object in slot s.
template <typename Value>
void FitMapFrom(const PlaneLayout& layout, const BvhLevels& levels,
                const Value& value) {
  constexpr float kMost = 0x1p100f;
  const std::size_t slots = levels.level[0].size;
  const std::size_t step = std::max({std::size_t{1}, slots / kMostSamples,
                                     std::min<std::size_t>(64, slots / 32)});
  for (std::size_t k = 0; k < layout.axes; ++k) {
    std::array<std::array<float, 2 * kMostSamples>, 2> samples;
    std::array<std::size_t, 2> counts{};
    for (std::size_t s = 0; s < slots; s += step) {
      if (!IsPresent(levels, s)) continue;
      for (std::size_t m = 0; m < 2; ++m) {
        const float v =
            value(m == 1 && layout.has_max ? layout.axes + k : k, s);
        if (std::abs(v) <= kMost) samples[m][counts[m]++] = v;
      }
    }
    FitAxis({samples[0].data(), counts[0]}, {samples[1].data(), counts[1]}, k,
            *levels.map);
  }
}

}  // namespace

std::size_t Place(const BvhType& type, const BvhRoom& room, std::byte* begin,
                  bool is_new, BvhLevels& levels) {
  levels = {};
  const std::size_t planes = type.plane_count;
  Parts parts(begin, is_new);
  parts.Take<BvhHeader>(1);
  levels.map = parts.Take<CodeMap>(1);
  std::size_t size = room.slots;
  do {
    BvhLevel& level = levels.level[levels.count++];
    const std::size_t blocks = BlocksOf(size);
    const std::uint64_t values = std::uint64_t{blocks} * planes * kBlockObjects;
    // With fewer objects, codes save less time than it takes to encode the
    // query: a query of 1000 boxes takes 34 ns by floats and 38 ns by codes.
    const bool is_coded = levels.count == 1 && room.slots > kMostWithoutCodes;
    level.is_prefetched =
        values * (is_coded ? sizeof(std::int16_t) : sizeof(float)) >
        kInCacheBytes;
    level.planes = planes;
    level.floats = parts.Take<float>(values);
    if (is_coded) levels.codes = parts.Take<std::int16_t>(values);
    level.present = parts.Take<std::uint64_t>(blocks);
    if (type.has_max && levels.count > 1) {
      level.regular = parts.Take<std::uint64_t>(blocks);
    }
    if (room.has_masks) {
      level.masks = parts.Take<std::uint32_t>(blocks * kBlockObjects);
    }
    size = blocks;
  } while (size > 1);
  levels.ids = parts.Take<std::uint32_t>(BlocksOf(room.slots) * kBlockObjects);
  if (room.ids > 0) {
    levels.slots = parts.Take<std::uint32_t>(room.ids);
    levels.used = parts.Take<std::uint64_t>(UsedIds::WordsFor(room.ids));
  }
  levels.built = parts.Take<BvhGroup>(GroupsOf(room.slots));
  return parts.bytes();
}

void SetSlots(BvhLevels& levels, std::size_t slots) {
  for (std::size_t l = 0; l < levels.count; ++l) {
    levels.level[l].size = slots;
    slots = BlocksOf(slots);
  }
}

void ClearSlots(const PlaneLayout& layout, BvhLevels& levels, std::size_t level,
                std::size_t begin) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const std::size_t end = BlocksOf(begin + 1) * kBlockObjects;
  const BvhLevel& cleared = levels.level[level];
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    const float empty = (p < layout.axes ? 1.0f : -1.0f) * kInf;
    float* const plane = cleared.Plane(begin / kBlockObjects, p);
    std::fill(plane + begin % kBlockObjects, plane + kBlockObjects, empty);
  }
  const std::uint64_t kept = (std::uint64_t{1} << begin % kBlockObjects) - 1;
  const std::size_t block = begin / kBlockObjects;
  cleared.present[block] &= kept;
  if (cleared.regular != nullptr) cleared.regular[block] &= kept;
  if (cleared.masks != nullptr) {
    std::fill(cleared.masks + begin, cleared.masks + end, 0);
  }
  if (level == 0) std::fill(levels.ids + begin, levels.ids + end, kNoId);
}

void Truncate(const PlaneLayout& layout, BvhLevels& levels, std::size_t slots) {
  SetSlots(levels, slots);
  for (std::size_t l = 0; l < levels.count; ++l) {
    const std::size_t size = levels.level[l].size;
    if (size % kBlockObjects != 0) ClearSlots(layout, levels, l, size);
  }
}

void EncodeLevels(const BvhLevels& levels, const BvhKernels::OfPlanes& kernels,
                  std::size_t from) {
  for (std::size_t l = from; l < levels.count; ++l) {
    kernels.encode(RangeOf(levels, l, 0, BlocksOf(levels.level[l].size)));
  }
}

void EncodeSlots(BvhLevels& levels, const BvhKernels::OfPlanes& kernels,
                 std::size_t begin, std::size_t end) {
  for (std::size_t l = 0; l < levels.count; ++l) {
    begin /= kBlockObjects;
    end = BlocksOf(end);
    const bool is_top = l + 1 == levels.count;
    kernels.encode(RangeOf(levels, l, begin, end));
    if (is_top || levels.level[l].masks == nullptr) continue;
    for (std::size_t b = begin; b < end; ++b) OrMasks(levels, l, b);
  }
}

// Cold, because the code that makes the texts of errors would be large
// otherwise.
[[gnu::cold]] void CheckColumns(const PlaneLayout& layout,
                                const Columns& objects, const char* call) {
  const std::size_t scalar_bytes = objects.scalar_bytes();
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    dispatch::CheckPointer(
        call, objects.column[p], scalar_bytes,
        [&] {
          return objects.stride == 1
                     ? dispatch::PlaneName("world", layout.axes, p)
                     : "bounds";
        },
        [&] {
          return "memory for " + std::to_string(objects.size) + " elements";
        });
  }
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
  if (objects.stride > kMost / scalar_bytes / objects.size) {
    dispatch::ThrowInvalid(call, "bounds.stride",
                           "bounds that fit the address space",
                           std::to_string(objects.stride));
  }
}

void FillPresent(const BvhLevel& level, std::size_t slots) {
  for (std::size_t b = 0; b < BlocksOf(slots); ++b) {
    level.present[b] = LanesOf(slots, b);
  }
}

void FitMap(const PlaneLayout& layout, const BvhLevels& levels) {
  FitMapFrom(layout, levels, [&](std::size_t p, std::size_t s) {
    return levels.level[0].Value(p, s);
  });
}

void CopyBounds(const BvhLevels& levels, const Columns& objects,
                const std::uint32_t* elements, std::size_t block,
                std::uint64_t slots) {
  const std::size_t planes = levels.level[0].planes;
  const std::size_t first = block * kBlockObjects;
  float* const to = levels.level[0].Plane(block, 0);
  const float* const rows = RowsOf(objects, planes);
  for (; slots != 0; slots &= slots - 1) {
    const std::size_t i = LowestBit(slots);
    const std::size_t from =
        (elements == nullptr ? first + i : elements[first + i]) *
        objects.stride;
    for (std::size_t p = 0; p < planes; ++p) {
      to[p * kBlockObjects + i] =
          rows != nullptr ? rows[from + p] : objects.floats(p)[from];
    }
  }
}

void FillSlots(const PlaneLayout& layout, const BvhLevels& levels,
               const Columns& objects, const std::uint32_t* elements,
               const BvhKernels::OfPlanes& kernels, const Runner& run) {
  if (levels.codes != nullptr) {
    dispatch::InDefaultFpMode([&] {
      FitMapFrom(layout, levels, [&](std::size_t p, std::size_t s) {
        return objects.floats(
            p)[(elements == nullptr ? s : elements[s]) * objects.stride];
      });
    });
  }
  dispatch::RunInDefaultFpMode(
      run, GroupsOf(levels.level[0].size, kTaskSlots), [&](std::size_t part) {
        FillPart(levels, layout.plane_count, objects, elements, kernels, part);
      });
  dispatch::InDefaultFpMode([&] { EncodeLevels(levels, kernels, 1); });
}

Rounded::Rounded(const PlaneLayout& layout, const MemoryResource& memory,
                 const Columns& objects, std::size_t count,
                 const std::uint32_t* elements, const Runner& run)
    : floats_(memory, objects.is_double
                          ? count * layout.plane_count * sizeof(float)
                          : 0),
      columns_(objects) {
  if (!objects.is_double) return;
  auto* const floats = reinterpret_cast<float*>(floats_.data());
  const std::size_t planes = layout.plane_count;
  columns_ = ColumnsOf<float>(count, 1);
  for (std::size_t p = 0; p < planes; ++p) {
    columns_.column[p] = floats + p * count;
  }
  const auto element_of = [elements](std::size_t s) -> std::size_t {
    return elements == nullptr ? s : elements[s];
  };
  const std::size_t tasks = GroupsOf(count, kTaskSlots);
  dispatch::RunInDefaultFpMode(run, tasks, [&](std::size_t task) {
    const std::size_t end = std::min(count, (task + 1) * kTaskSlots);
    for (std::size_t s = task * kTaskSlots; s < end; ++s) {
      if (s + kAhead < end) {
        PrefetchElement<double>(objects, planes, element_of(s + kAhead),
                                [](const void* at) { kernels::Prefetch(at); });
      }
      const std::size_t i = element_of(s);
      if (i == kNoId) continue;
      for (std::size_t p = 0; p < planes; ++p) {
        const double value = objects.doubles(p)[i * objects.stride];
        floats[p * count + s] = p < layout.axes ? dispatch::RoundDown(value)
                                                : dispatch::RoundUp(value);
      }
    }
  });
}

BvhGroup AsIs(const PlaneLayout& layout, const BvhLevels& levels,
              const SlotRange& range) {
  BvhGroup as_is{};
  for (std::size_t n = range.begin / kBlockObjects; n < BlocksOf(range.end);
       ++n) {
    as_is.objects += PopCount(levels.level[0].present[n]);
    if (levels.count == 1) continue;  // no nodes
    const BvhLevel& nodes = levels.level[1];
    double extents[4] = {};
    double slack = 0;
    for (std::size_t k = 0; k < layout.axes; ++k) {
      const double min = nodes.Value(k, n);
      slack -= min;
      if (layout.has_max) extents[k] = nodes.Value(layout.axes + k, n) - min;
    }
    double surface = slack;
    if (layout.has_max) {
      surface = layout.axes == 2
                    ? extents[0] + extents[1]
                    : extents[0] * extents[1] + extents[1] * extents[2] +
                          extents[2] * extents[0];
    } else if (layout.axes == 4) {
      surface = slack * slack;
    }
    if (surface > 0 && surface < std::numeric_limits<double>::infinity()) {
      as_is.cost += surface;
    }
  }
  return as_is;
}

void OrAllMasks(BvhLevels& levels) {
  for (std::size_t l = 0; l + 1 < levels.count; ++l) {
    for (std::size_t b = 0; b < BlocksOf(levels.level[l].size); ++b) {
      OrMasks(levels, l, b);
    }
  }
}

}  // namespace halfspace::detail

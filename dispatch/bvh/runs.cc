// The build of a BVH whose objects do not fit into memory: a merge sort along
// Hilbert's curve, which reads and writes its memory in order.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dispatch/bvh/order.h"
#include "dispatch/bvh/scratch.h"
#include "dispatch/bvh/tree.h"
#include "dispatch/default_fp_mode.h"

namespace halfspace::detail {
namespace {

// A key, then the planes.
std::size_t RecordBytes(const PlaneLayout& layout) {
  return sizeof(CurveKey) + layout.plane_count * sizeof(float);
}

// Writes the records of objects begin ... end - 1 in the order of the keys.
void WriteRun(const PlaneLayout& layout, const Columns& objects,
              const CurveKey* keys, std::size_t count, std::byte* records) {
  const float* const rows = RowsOf(objects, layout.plane_count);
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(records, &keys[i], sizeof(CurveKey));
    records += sizeof(CurveKey);
    const std::size_t from = keys[i].id * objects.stride;
    for (std::size_t p = 0; p < layout.plane_count; ++p) {
      const float value =
          rows != nullptr ? rows[from + p] : objects.floats(p)[from];
      std::memcpy(records, &value, sizeof(float));
      records += sizeof(float);
    }
  }
}

// The runs by their next records, the least first.
class MergedRuns {
 public:
  MergedRuns(const MemoryResource& memory, const std::byte* records,
             std::size_t record_bytes, std::size_t count,
             std::size_t run_records)
      : record_bytes_(record_bytes), heads_(BlockAllocator<Head>(memory)) {
    heads_.reserve(GroupsOf(count, run_records));
    for (std::size_t begin = 0; begin < count; begin += run_records) {
      const std::size_t end = std::min(count, begin + run_records);
      Head head = {0, records + begin * record_bytes,
                   records + end * record_bytes};
      head.key = KeyOf(head);
      heads_.push_back(head);
    }
    for (std::size_t h = heads_.size() / 2; h-- > 0;) SiftDown(h);
  }

  // Must be called once for each record.
  const std::byte* Next() {
    Head& least = heads_[0];
    const std::byte* const record = least.next;
    least.next += record_bytes_;
    if (least.next == least.end) {
      least = heads_.back();
      heads_.pop_back();
    } else {
      least.key = KeyOf(least);
    }
    if (!heads_.empty()) SiftDown(0);
    return record;
  }

 private:
  struct Head {
    std::uint64_t key;
    const std::byte* next;
    const std::byte* end;
  };

  // The order that a sort of all objects gives, however large a run is.
  static std::uint64_t KeyOf(const Head& head) {
    CurveKey key;
    std::memcpy(&key, head.next, sizeof(key));
    return std::uint64_t{key.place} << 32 | key.id;
  }

  void SiftDown(std::size_t at) {
    const Head moved = heads_[at];
    for (std::size_t below; (below = 2 * at + 1) < heads_.size(); at = below) {
      if (below + 1 < heads_.size()) {
        below += heads_[below + 1].key < heads_[below].key ? 1 : 0;
      }
      if (moved.key <= heads_[below].key) break;
      heads_[at] = heads_[below];
    }
    heads_[at] = moved;
  }

  std::size_t record_bytes_;
  BlockVector<Head> heads_;
};

}  // namespace

bool BvhState::IsSortedInRuns(std::size_t objects,
                              const BuildOptions& options) const {
  return options.run_bytes != 0 && RunObjects(options) < objects;
}

std::size_t BvhState::RunObjects(const BuildOptions& options) const {
  return std::max<std::size_t>(
      1, options.run_bytes / (kOrderScratch + RecordBytes(type_)));
}

// Orders the objects in slots begin ... end - 1 by medians.
void BvhState::SortSlots(std::size_t begin, std::size_t end,
                         const AxisWeights& weights,
                         const BvhKernels::OfPlanes& kernels,
                         const Runner& run) {
  const std::size_t count = end - begin;
  const BvhLevel& level = levels_.level[0];
  const Scratch floats(memory_, count * type_.plane_count * sizeof(float));
  const Scratch ids(memory_, 2 * count * sizeof(std::uint32_t));
  const Scratch scratch(memory_, count * kOrderScratch);
  auto* const values = reinterpret_cast<float*>(floats.data());
  auto* const order = reinterpret_cast<std::uint32_t*>(ids.data());
  std::uint32_t* const old_ids = order + count;
  Columns columns = ColumnsOf<float>(count, 1);
  for (std::size_t p = 0; p < type_.plane_count; ++p) {
    columns.column[p] = values + p * count;
    for (std::size_t i = 0; i < count; ++i) {
      values[p * count + i] = level.Value(p, begin + i);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    order[i] = static_cast<std::uint32_t>(i);
    old_ids[i] = levels_.ids[begin + i];
  }
  OrderCell(type_, columns, weights, kernels, scratch.data(), order, count,
            begin, run);
  for (std::size_t i = 0; i < count; ++i) {
    levels_.ids[begin + i] = old_ids[order[i]];
    for (std::size_t p = 0; p < type_.plane_count; ++p) {
      level.Value(p, begin + i) = values[p * count + order[i]];
    }
  }
}

void BvhState::BuildInRuns(const BvhRoom& room, const Columns& objects,
                           const AxisWeights& weights,
                           const BvhKernels::OfPlanes& kernels,
                           const BuildOptions& options) {
  const std::size_t count = objects.size;
  const std::size_t run_objects = RunObjects(options);
  const std::size_t record_bytes = RecordBytes(type_);
  const Scratch records(memory_, count * record_bytes);
  {
    const Grid grid = GridOf(objects, weights, kernels);
    const Scratch scratch(memory_, run_objects * kOrderScratch);
    for (std::size_t begin = 0; begin < count; begin += run_objects) {
      const std::size_t end = std::min(count, begin + run_objects);
      WriteRun(type_, objects,
               KeysByCurve(objects, begin, end, grid, kernels, scratch.data(),
                           options.run),
               end - begin, records.data() + begin * record_bytes);
    }
  }
  MergedRuns merge(memory_, records.data(), record_bytes, count, run_objects);
  Allocate(room);
  Truncate(type_, levels_, count);
  const BvhLevel& level = levels_.level[0];
  // A crowded cell that does not fit into memory is ordered in parts.
  constexpr std::size_t kLeastPart = std::size_t{1} << 16;
  const std::size_t part = std::max(run_objects, kLeastPart);
  std::uint32_t place = 0;
  std::size_t cell_begin = 0;
  // As ForCrowdedCells(), for a cell whose objects have come to their slots.
  const auto order_cell = [&](std::size_t end) {
    if (end - cell_begin > kBlockObjects) {
      for (std::size_t begin = cell_begin; begin < end; begin += part) {
        SortSlots(begin, std::min(end, begin + part), weights, kernels,
                  options.run);
      }
    }
    cell_begin = end;
  };
  for (std::size_t s = 0; s < count; ++s) {
    const std::byte* const record = merge.Next();
    CurveKey key;
    std::memcpy(&key, record, sizeof(key));
    if (key.place != place) order_cell(s);
    place = key.place;
    levels_.ids[s] = key.id;
    for (std::size_t p = 0; p < type_.plane_count; ++p) {
      std::memcpy(&level.Value(p, s), record + sizeof(key) + p * sizeof(float),
                  sizeof(float));
    }
  }
  order_cell(count);
  FillPresent(level, count);
  dispatch::InDefaultFpMode([&] {
    if (levels_.codes != nullptr) FitMap(type_, levels_);
    EncodeLevels(levels_, kernels, 0);
  });
}

}  // namespace halfspace::detail

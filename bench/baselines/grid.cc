#include <algorithm>

#include "bench/baselines/box_tree.h"
#include "bench/baselines/touches.h"

namespace halfspace::bench {
namespace {

template <int kDims>
class Grid : public BoxTree<kDims> {
 public:
  explicit Grid(std::span<const Aabb<kDims>> boxes) {
    ChooseCells(boxes);
    // First the number of entries of each cell; then where these end; at last,
    // as they are filled in from behind, where they begin.
    begins_.resize(CellCount() + 1);
    for (const auto& box : boxes) {
      ForEachCell(CellsOf(box), [&](std::size_t cell, const Cell& /*at*/) {
        ++begins_[cell];
      });
    }
    std::size_t sum = 0;
    for (std::size_t& begin : begins_) begin = sum += begin;
    entries_.resize(sum);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Entry entry{boxes[i], static_cast<std::uint32_t>(i)};
      ForEachCell(CellsOf(boxes[i]), [&](std::size_t cell, const Cell& /*at*/) {
        entries_[--begins_[cell]] = entry;
      });
    }
  }

  void Find(const Aabb<kDims>& query,
            std::vector<std::uint32_t>& found) const override {
    found.clear();
    const Cells cells = CellsOf(query);
    ForEachCell(cells, [&](std::size_t cell, const Cell& at) {
      for (std::size_t i = begins_[cell]; i < begins_[cell + 1]; ++i) {
        const Entry& entry = entries_[i];
        if (Touches(entry.box, query) && IsFirst(at, cells.first, entry.box)) {
          found.push_back(entry.index);
        }
      }
    });
  }

 private:
  using Cell = std::array<std::size_t, kDims>;
  struct Cells {
    Cell first;
    Cell last;
  };
  struct Entry {
    Aabb<kDims> box;
    std::uint32_t index;
  };

  // At most 2 cells, and 8 entries, for each box.
  void ChooseCells(std::span<const Aabb<kDims>> boxes) {
    if (boxes.empty()) return;
    Point<kDims, double> sum{};  // of lengths
    origin_ = boxes.front().min;
    Point<kDims> end = boxes.front().max;
    for (const auto& box : boxes) {
      for (std::size_t k = 0; k < kDims; ++k) {
        origin_[k] = std::min(origin_[k], box.min[k]);
        end[k] = std::max(end[k], box.max[k]);
        sum[k] += box.max[k] - box.min[k];
      }
    }
    for (float scale = 2;; scale *= 1.25f) {
      for (std::size_t k = 0; k < kDims; ++k) {
        const float length = end[k] - origin_[k];
        // Points have no length.
        const auto mean =
            static_cast<float>(sum[k] / static_cast<double>(boxes.size()));
        const float edge = scale * std::max(mean, length * 0x1p-12f);
        per_length_[k] = edge > 0 ? 1 / edge : 0;
        last_[k] = static_cast<std::size_t>(length * per_length_[k]);
      }
      if (CellCount() > 2 * boxes.size()) continue;
      std::size_t entries = 0;
      for (const auto& box : boxes) {
        const Cells cells = CellsOf(box);
        std::size_t product = 1;
        for (std::size_t k = 0; k < kDims; ++k) {
          product *= cells.last[k] - cells.first[k] + 1;
        }
        entries += product;
      }
      if (entries <= 8 * boxes.size()) return;
    }
  }

  std::size_t CellCount() const {
    std::size_t count = 1;
    for (std::size_t last : last_) count *= last + 1;
    return count;
  }

  Cell CellOf(const Point<kDims>& point) const {
    Cell cell;
    for (std::size_t k = 0; k < kDims; ++k) {
      const float place = (point[k] - origin_[k]) * per_length_[k];
      cell[k] = static_cast<std::size_t>(
          std::clamp(place, 0.0f, static_cast<float>(last_[k])));
    }
    return cell;
  }
  Cells CellsOf(const Aabb<kDims>& box) const {
    return {CellOf(box.min), CellOf(box.max)};
  }

  // Calls visit(index of the cell, the cell), the last axis fastest.
  template <typename Visit>
  void ForEachCell(const Cells& cells, Visit visit) const {
    Cell at = cells.first;
    for (;;) {
      std::size_t index = 0;
      for (std::size_t k = 0; k < kDims; ++k) {
        index = index * (last_[k] + 1) + at[k];
      }
      visit(index, at);
      std::size_t k = kDims;
      while (k > 0 && at[k - 1] == cells.last[k - 1]) {
        at[k - 1] = cells.first[k - 1];
        --k;
      }
      if (k == 0) return;
      ++at[k - 1];
    }
  }

  // Of the cells that a box shares with the query, only one may report it.
  bool IsFirst(const Cell& at, const Cell& query_first,
               const Aabb<kDims>& box) const {
    const Cell first = CellOf(box.min);
    for (std::size_t k = 0; k < kDims; ++k) {
      if (at[k] != std::max(first[k], query_first[k])) return false;
    }
    return true;
  }

  Point<kDims> origin_{};
  Point<kDims> per_length_{};  // cells
  Cell last_{};
  std::vector<std::size_t> begins_;  // of each cell's entries, and the end
  std::vector<Entry> entries_;
};

}  // namespace

std::unique_ptr<BoxTree<2>> MakeGrid(std::span<const Aabb2> boxes) {
  return std::make_unique<Grid<2>>(boxes);
}
std::unique_ptr<BoxTree<3>> MakeGrid(std::span<const Aabb3> boxes) {
  return std::make_unique<Grid<3>>(boxes);
}

}  // namespace halfspace::bench

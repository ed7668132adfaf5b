// What the tiles of ForEachTile must be: right, and each pair in one of them.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_COVERED_TILES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_COVERED_TILES_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "halfspace/reject_many.h"

namespace halfspace::testing {

class CoveredTiles {
 public:
  // `rows` are the survivor masks that tiles are parts of.
  CoveredTiles(std::span<const std::uint64_t> rows, std::size_t queries,
               std::size_t objects, const Range& range)
      : rows_(rows),
        queries_(queries),
        words_(MaskWords(objects)),
        begin_(std::min(range.begin, objects)),
        end_(std::min(range.end, objects)),
        times_(rows.size()) {}

  void Add(const SurvivorTile& tile) {
    if (!wrong_.empty()) return;
    wrong_ = Wrong(tile);
    if (!wrong_.empty()) {
      wrong_ += " in the tile of queries " + std::to_string(tile.first_query) +
                " + " + std::to_string(tile.queries) + ", objects " +
                std::to_string(tile.first_object) + " + " +
                std::to_string(tile.objects);
    }
  }

  // After the last tile; empty if nothing is.
  std::string WhatIsWrong() const {
    if (!wrong_.empty()) return wrong_;
    if (begin_ == end_) return {};
    for (std::size_t q = 0; q < queries_; ++q) {
      for (std::size_t w = begin_ / 64; w < MaskWords(end_); ++w) {
        if (times_[q * words_ + w] != 1) {
          return "word " + std::to_string(w) + " of query " +
                 std::to_string(q) + " came " +
                 std::to_string(times_[q * words_ + w]) + " times";
        }
      }
    }
    return {};
  }

 private:
  std::string Wrong(const SurvivorTile& tile) {
    if (tile.queries == 0 || tile.objects == 0) return "nothing";
    if (tile.first_query >= queries_ ||
        tile.queries > queries_ - tile.first_query) {
      return "no such query";
    }
    if (tile.first_object % 64 != 0) return "half a word";
    if (tile.first_object < begin_ || tile.first_object >= end_ ||
        tile.objects > end_ - tile.first_object) {
      return "objects outside the range";
    }
    if (tile.objects % 64 != 0 && tile.first_object + tile.objects != end_) {
      return "half a word at the end";
    }
    for (std::size_t q = 0; q < tile.queries; ++q) {
      const std::span<const std::uint64_t> row = tile.Row(q);
      if (row.size() != MaskWords(tile.objects)) return "a row of other size";
      const std::size_t at =
          (tile.first_query + q) * words_ + tile.first_object / 64;
      for (std::size_t w = 0; w < row.size(); ++w) {
        ++times_[at + w];
        if (row[w] != rows_[at + w]) {
          return "word " + std::to_string(w) + " of row " + std::to_string(q) +
                 " is wrong";
        }
      }
    }
    return {};
  }

  std::span<const std::uint64_t> rows_;
  std::size_t queries_;
  std::size_t words_;
  std::size_t begin_;
  std::size_t end_;
  std::vector<std::uint8_t> times_;  // each word came
  std::string wrong_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_COVERED_TILES_H_

// The results of a call on several threads. Each part of the call finds a list,
// whose length is known only at the end of the part.
#ifndef HALFSPACE_PYTHON_RESULTS_H_
#define HALFSPACE_PYTHON_RESULTS_H_

#include <halfspace/span.h>
#include <halfspace/visit.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace halfspace::python {

template <typename Item>
class Results {
 public:
  Results(std::size_t parts, std::size_t threads)
      : lists_(parts), blocks_(threads) {}

  // Stores what find(Span<Item>) writes for a part. find() returns the full
  // number of items. If the span was shorter, it is called again with a span
  // that is long enough. Two threads may call this at the same time for
  // different parts.
  template <typename Find>
  void Add(std::size_t part, std::size_t thread, const Find& find) {
    std::vector<Block>& blocks = blocks_[thread];
    if (blocks.empty()) blocks.emplace_back(kFirstItems);
    const std::size_t found = find(blocks.back().Rest());
    if (found > blocks.back().Rest().size()) {
      // Doubled, so few lists are found twice. Memory that is not touched
      // costs nothing.
      blocks.emplace_back(std::max(2 * blocks.back().size, found));
      find(blocks.back().Rest());
    }
    lists_[part] = {blocks.back().Rest().data(), found};
    blocks.back().used += found;
  }

  // Returns where the items of each part begin in the list of all items, and
  // then the number of all items. Call it after all parts.
  std::vector<std::size_t> Offsets() const {
    std::vector<std::size_t> offsets{0};
    offsets.reserve(lists_.size() + 1);
    for (const auto& list : lists_) {
      offsets.push_back(offsets.back() + list.size());
    }
    return offsets;
  }

  std::size_t parts() const { return lists_.size(); }
  Span<const Item> List(std::size_t part) const { return lists_[part]; }

 private:
  static constexpr std::size_t kFirstItems = 4096;

  struct Block {
    explicit Block(std::size_t items) : memory(new Item[items]), size(items) {}
    Span<Item> Rest() const { return {memory.get() + used, size - used}; }
    std::unique_ptr<Item[]> memory;
    std::size_t size;
    std::size_t used = 0;
  };

  std::vector<Span<const Item>> lists_;
  std::vector<std::vector<Block>> blocks_;
};

// Writes the hit with the least t, and of equal ones the one with the least id,
// so that the order of the tree does not matter. cast() receives the function
// of a cast.
template <typename Cast>
void FindFirst(std::int64_t& first, float& least, const Cast& cast) {
  first = -1;
  least = std::numeric_limits<float>::infinity();
  cast([&](std::uint32_t id, float t) {
    if (first < 0 || t < least || (t == least && id < first)) {
      first = id;
      least = t;
    }
    return Limit{least};
  });
}

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_RESULTS_H_

#include <CGAL/box_intersection_d.h>

#include "bench/baselines/box_tree.h"

namespace halfspace::bench {
namespace {

struct Entry {
  Aabb3 box;
  std::uint32_t index;
};

// The names are those that CGAL calls.
struct EntryTraits {
  using Box_parameter = const Entry&;
  using NT = float;
  using ID = std::uint32_t;

  static int dimension() { return 3; }
  static ID id(const Entry& entry) { return entry.index; }
  static NT min_coord(const Entry& entry, int axis) {
    return entry.box.min[static_cast<std::size_t>(axis)];
  }
  static NT max_coord(const Entry& entry, int axis) {
    return entry.box.max[static_cast<std::size_t>(axis)];
  }
};

class CgalPairs : public PairFinder {
 public:
  CgalPairs(std::span<const Aabb3> boxes, std::ptrdiff_t cutoff)
      : cutoff_(cutoff) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      entries_.push_back({boxes[i], static_cast<std::uint32_t>(i)});
    }
  }

  void Pairs(std::vector<IndexPair>& found) override {
    found.clear();
    // CGAL reorders what it is given, and sorted boxes would cost it less.
    scratch_ = entries_;
    CGAL::box_self_intersection_d(
        scratch_.begin(), scratch_.end(),
        [&found](const Entry& a, const Entry& b) {
          found.push_back({a.index, b.index});
        },
        EntryTraits(), cutoff_, CGAL::Box_intersection_d::CLOSED);
  }

 private:
  std::vector<Entry> entries_;
  std::vector<Entry> scratch_;
  std::ptrdiff_t cutoff_;
};

// It does all its work in Pairs(). Of `cutoff` boxes it no longer makes trees,
// but scans.
struct RegisterCutoff {
  explicit RegisterCutoff(std::ptrdiff_t cutoff) {
    Registered<PairFinder>(
        "CGAL, cutoff " + std::to_string(cutoff),
        [cutoff](auto boxes) {
          return std::make_unique<CgalPairs>(boxes, cutoff);
        },
        100'000);
  }
};
const RegisterCutoff kCutoff10(10);
const RegisterCutoff kCutoff100(100);
const RegisterCutoff kCutoff1000(1000);

}  // namespace
}  // namespace halfspace::bench

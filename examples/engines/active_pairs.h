// The pairs of an engine's active bodies: found once in a frame, and then
// handed out for each body, on any threads. For an engine that accepts a pair
// of two active bodies in one order only, that of its list, as Jolt does.
#ifndef HALFSPACE_EXAMPLES_ENGINES_ACTIVE_PAIRS_H_
#define HALFSPACE_EXAMPLES_ENGINES_ACTIVE_PAIRS_H_

#include <halfspace/broad_phase.h>

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

class ActivePairs {
 public:
  using Ids = halfspace::Span<const std::uint32_t>;

  // `active` is the engine's list of active bodies. Finds the bodies whose
  // bounds are at most `distance` apart on each axis.
  void Find(const halfspace::AabbBroadPhase3& bodies, Ids active,
            float distance) {
    place_.assign(bodies.id_limit(), kInactive);
    for (std::uint32_t i = 0; i < active.size(); ++i) place_[active[i]] = i;
    halfspace::PairOptions options;
    options.margin = distance;
    found_.clear();
    ForEachPairOf(
        bodies, active,
        [&](halfspace::Span<const halfspace::IdPair> pairs) {
          found_.insert(found_.end(), pairs.begin(), pairs.end());
        },
        options);

    // Sorts them by the place of `a`: counts, then first places, then pairs.
    // While pairs are written, first_[i + 1] is where the next one of place i
    // goes. In the end it is where place i + 1 begins.
    first_.assign(active.size() + 2, 0);
    for (halfspace::IdPair& pair : found_) {
      if (place_[pair.b] < place_[pair.a]) std::swap(pair.a, pair.b);
      ++first_[place_[pair.a] + 2];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    others_.resize(found_.size());
    for (const halfspace::IdPair& pair : found_) {
      others_[first_[place_[pair.a] + 1]++] = pair.b;
    }
  }

  // Whether the list had a body at this place.
  bool Has(std::size_t place) const { return place + 2 < first_.size(); }

  // Returns the bodies that the body at this place of the list is a pair with.
  // A pair of two active bodies is returned at the earlier place only.
  Ids Of(std::size_t place) const {
    return {others_.data() + first_[place], first_[place + 1] - first_[place]};
  }

 private:
  static constexpr std::uint32_t kInactive = 0xffffffff;

  std::vector<std::uint32_t> place_;  // by id
  std::vector<halfspace::IdPair> found_;
  std::vector<std::size_t> first_;  // by place, of others_
  std::vector<std::uint32_t> others_;
};

#endif  // HALFSPACE_EXAMPLES_ENGINES_ACTIVE_PAIRS_H_

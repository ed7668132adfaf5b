// Histories of a broad phase: changes of every kind, of it and of its model,
// which choices decide. They come from random numbers (BodyMaker) or from the
// bytes of a fuzzer.
#ifndef HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_
#define HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/broad_phase/bodies.h"

namespace halfspace::testing {

// `Choices` has Below(), Next(), Moved() and Masks() of BodyMaker.
template <typename View, typename Choices>
class BodyHistory {
 public:
  using Bound = typename View::Bound;

  BodyHistory(Choices& choices, std::size_t max_ids,
              const BroadPhaseOptions& options)
      : choices_(choices), max_ids_(max_ids), bodies_(max_ids, options) {
    model_.keep = options.filter.keep;
  }

  const BroadPhase<View>& bodies() const { return bodies_; }
  const BodyModel<View>& model() const { return model_; }

  void Insert(std::size_t count) {
    const Ids ids = Some(count, false);
    const bool has_masks = choices_.Below(2) == 0;
    std::vector<Bound> bounds;
    std::vector<BodyMasks> masks;
    for (const std::uint32_t id : ids) {
      bounds.push_back(choices_.Next());
      if (has_masks) masks.push_back(choices_.Masks());
      model_.objects[id] = {bounds.back(),
                            has_masks ? masks.back() : BodyMasks()};
    }
    bodies_.Insert(ids, bounds, masks);
  }

  // One change. Returns its number, for messages.
  std::size_t Change() {
    const std::size_t what = choices_.Below(12);
    const std::size_t count =
        choices_.Below(8) == 0 ? choices_.Below(max_ids_) : choices_.Below(20);
    const auto backwards = [](std::size_t parts, const Runner::Part& part) {
      while (parts-- > 0) part(parts);
    };
    if (what < 4) {
      Insert(count);
    } else if (what < 6) {
      const Ids ids = Some(count, true);
      for (const std::uint32_t id : ids) model_.objects.erase(id);
      bodies_.Erase(ids);
    } else if (what < 9) {
      const Ids ids = Some(2 * count, true);
      std::vector<Bound> bounds;
      for (const std::uint32_t id : ids) {
        bounds.push_back(choices_.Moved(model_.objects[id].bound));
        model_.objects[id].bound = bounds.back();
      }
      bodies_.Move(ids, bounds);
    } else if (what == 9) {
      const Ids ids = Some(count, true);
      std::vector<BodyMasks> masks;
      for (const std::uint32_t id : ids) {
        masks.push_back(choices_.Masks());
        model_.objects[id].masks = masks.back();
      }
      bodies_.SetMasks(ids, masks);
    } else if (what == 10) {
      UpdateOptions update;
      if (choices_.Below(2) == 0) update.budget = choices_.Below(2 * max_ids_);
      update.run = backwards;
      bodies_.Update(update);
    } else {
      bodies_.Rebuild(backwards);
    }
    return what;
  }

  // The events of UpdatePairs() are the differences between the sets of pairs.
  void ExpectEvents() {
    const IdPairs now = model_.Pairs();
    IdPairs began;
    IdPairs ended;
    bodies_.UpdatePairs(
        [&](std::uint32_t a, std::uint32_t b) { began.emplace_back(a, b); },
        [&](std::uint32_t a, std::uint32_t b) {
          ASSERT_TRUE(began.empty());
          ended.emplace_back(a, b);
        });
    ASSERT_EQ(began, Difference(now, pairs_));
    ASSERT_EQ(ended, Difference(pairs_, now));
    ASSERT_EQ(bodies_.Statistics().pairs, now.size());
    pairs_ = now;
  }

  // With masks of the call, or without.
  void ExpectPairsOfSome(std::size_t count, float margin) {
    const Ids set = Some(count, true);
    std::vector<std::uint64_t> masks;
    if (choices_.Below(2) == 0) {
      for (std::size_t i = 0; i < set.size(); ++i) {
        masks.push_back(choices_.Below(4) == 0 ? ~std::uint64_t{0}
                                               : choices_.Masks().category);
      }
    }
    ExpectPairsOfSet(bodies_, model_, set, masks, margin);
  }

 private:
  static IdPairs Difference(const IdPairs& of, const IdPairs& without) {
    IdPairs difference;
    std::set_difference(of.begin(), of.end(), without.begin(), without.end(),
                        std::back_inserter(difference));
    return difference;
  }

  // Up to `count` ids that are in use, some of them twice, or that are free.
  Ids Some(std::size_t count, bool are_used) {
    Ids ids;
    std::vector<bool> is_listed(max_ids_);
    for (std::size_t i = 0; i < count; ++i) {
      const auto id = static_cast<std::uint32_t>(choices_.Below(max_ids_));
      if (model_.objects.contains(id) != are_used) continue;
      if (!are_used && is_listed[id]) continue;
      is_listed[id] = true;
      ids.push_back(id);
    }
    return ids;
  }

  Choices& choices_;
  std::size_t max_ids_;
  BroadPhase<View> bodies_;
  BodyModel<View> model_;
  IdPairs pairs_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_

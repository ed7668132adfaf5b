// Histories of a broad phase: changes of every kind, of it and of its model,
// which choices decide. They come from random numbers (BodyMaker) or from the
// bytes of a fuzzer.
#ifndef HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_
#define HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/broad_phase/bodies.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {

// The bytes of Save().
template <typename View>
std::vector<std::byte> BytesOf(const BroadPhase<View>& bodies) {
  std::vector<std::byte> bytes;
  bodies.Save([&](Span<const std::byte> some) {
    bytes.insert(bytes.end(), some.begin(), some.end());
  });
  std::uint64_t size = 0;
  EXPECT_GE(bytes.size(), sizeof(size));
  std::memcpy(&size, bytes.data(), sizeof(size));
  EXPECT_EQ(size, bytes.size());
  return bytes;
}

enum class FpMode { kDefault, kTraps, kFlushes };

// `Choices` has Below(), Next(), Moved() and Masks() of BodyMaker.
template <typename View, typename Choices>
class BodyHistory {
 public:
  using Bound = typename View::Bound;

  // Ids are multiples of `stride`.
  BodyHistory(Choices& choices, std::size_t most_bodies, std::uint32_t stride,
              const BroadPhaseOptions& options, FpMode mode = FpMode::kDefault)
      : choices_(choices),
        most_bodies_(most_bodies),
        stride_(stride),
        mode_(mode) {
    all_.emplace_back(options);
    model_.moves_wait = options.moves_wait_for_update;
    model_.keep = options.filter.keep;
  }

  const BroadPhase<View>& bodies() const { return all_[0]; }
  const BodyModel<View>& model() const { return model_; }

  void Insert(std::size_t count) {
    const Ids ids = Some(count, false);
    const bool has_masks = choices_.Below(2) == 0;
    std::vector<Bound> bounds;
    std::vector<BodyMasks> masks;
    for (const std::uint32_t id : ids) {
      bounds.push_back(choices_.Next());
      if (has_masks) masks.push_back(choices_.Masks());
      model_.Insert(id, bounds.back(), has_masks ? masks.back() : BodyMasks());
    }
    Each([&](auto& bodies) { bodies.Insert(ids, bounds, masks); });
  }

  void Move(std::size_t count) {
    const Ids ids = Some(count, true);
    std::vector<Bound> bounds;
    for (const std::uint32_t id : ids) {
      const Bound& before = model_.objects.at(id).bound;
      bounds.push_back(choices_.Below(4) == 0 ? before
                                              : choices_.Moved(before));
      model_.Move(id, bounds.back());
    }
    Each([&](auto& bodies) { bodies.Move(ids, bounds); });
    for (Watch* const watch : watches_) watch->Add(Found(*watch));
  }

  // One change. Returns its number, for messages.
  std::size_t Change() {
    const std::size_t what = choices_.Below(18);
    const std::size_t count = choices_.Below(8) == 0
                                  ? choices_.Below(most_bodies_)
                                  : choices_.Below(20);
    const auto backwards = [](std::size_t parts, const Runner::Part& part) {
      while (parts-- > 0) part(parts);
    };
    if (what < 4) {
      Insert(count);
    } else if (what < 6) {
      const Ids ids = Some(count, true);
      for (const std::uint32_t id : ids) model_.objects.erase(id);
      Each([&](auto& bodies) { bodies.Erase(ids); });
    } else if (what < 9) {
      Move(2 * count);
    } else if (what == 9) {
      const Ids ids = Some(count, true);
      std::vector<BodyMasks> masks;
      for (const std::uint32_t id : ids) {
        masks.push_back(choices_.Masks());
        model_.objects.at(id).masks = masks.back();
      }
      Each([&](auto& bodies) { bodies.SetMasks(ids, masks); });
    } else if (what == 10) {
      UpdateOptions update;
      if (choices_.Below(2) == 0) {
        update.budget = choices_.Below(2 * most_bodies_);
      }
      update.run = backwards;
      model_.Update();
      Each([&](auto& bodies) { bodies.Update(update); });
    } else if (what == 11) {
      model_.Update();
      Each([&](auto& bodies) { bodies.Rebuild(backwards); });
    } else if (what < 14) {
      UpdatePairs();
    } else if (what == 14) {  // From now on there is another one.
      model_.Update();
      all_.erase(all_.begin() + 1, all_.end());
      all_.push_back(all_[0]);
    } else if (what == 15) {
      model_.Update();
      all_.erase(all_.begin() + 1, all_.end());
      const std::vector<std::byte> bytes = BytesOf(all_[0]);
      all_.push_back(all_[0]);  // which Load() replaces
      all_[1].Load(bytes);
      // Events are those of the next UpdatePairs() on.
      UpdatePairs();
    } else if (what == 16 && all_.size() > 1) {  // The copy goes on.
      all_.erase(all_.begin());
    } else {
      QueryAndMove(choices_.Below(4));
    }
    return what;
  }

  // Each broad phase answers as the model, and all in the same order.
  void ExpectIsModel(std::uint64_t seed) {
    ExpectAnswers(all_[0], model_, seed);
    Ids ids;
    for (const auto& [id, object] : model_.objects) ids.push_back(id);
    for (std::size_t i = 1; i < all_.size(); ++i) {
      ExpectSameOrder(all_[0], all_[i], ids, seed);
    }
    ASSERT_FALSE(all_[0].Has(0xFFFFFFFF));
    if (seed % 4 != 0) return;
    for (std::uint32_t i = 0; i < most_bodies_; ++i) {
      const std::uint32_t id = i * stride_;
      ASSERT_EQ(all_[0].Has(id), model_.objects.contains(id)) << id;
    }
    Each([&](auto& bodies) {
      ASSERT_TRUE(bodies.Validate());
      ASSERT_EQ(bodies.Statistics().bodies, model_.objects.size());
      ASSERT_EQ(bodies.Statistics().pairs, pairs_.size());
    });
    model_.Update();  // Validate() copies moves into the tree
  }

 private:
  // A query that runs. Of a body that moves, any of its bounds may count.
  struct Watch {
    typename View::Query query;
    QueryOptions options;
    Ids always;  // would be found at any time
    Ids ever;

    void Add(const Ids& found) {
      Ids both;
      std::set_intersection(always.begin(), always.end(), found.begin(),
                            found.end(), std::back_inserter(both));
      always = std::move(both);
      Ids either;
      std::set_union(ever.begin(), ever.end(), found.begin(), found.end(),
                     std::back_inserter(either));
      ever = std::move(either);
    }
  };

  template <typename Call>
  void Each(const Call& call) {
    for (BroadPhase<View>& bodies : all_) {
      if (mode_ == FpMode::kTraps) {
        const TrapExceptions mode;
        call(bodies);
      } else if (mode_ == FpMode::kFlushes) {
        const FlushDenormals mode;
        call(bodies);
      } else {
        call(bodies);
      }
    }
  }

  Ids Found(const Watch& watch) const {
    const Reference<View> reference = model_.Seen();
    Ids ids;
    ForEachSurvivor(
        reference.bvh, watch.query,
        [&](Span<const std::uint32_t> some) {
          for (const std::uint32_t i : some) ids.push_back(reference.Of(i));
        },
        watch.options);
    return InOrder(ids);
  }

  // The events are the differences between the lists of pairs.
  void UpdatePairs() {
    model_.Update();
    const IdPairs now = model_.Pairs();
    Each([](auto& bodies) { bodies.UpdatePairs(); });
    IdPairs pairs = PairsFrom(all_[0].pairs());
    std::sort(pairs.begin(), pairs.end());
    EXPECT_EQ(pairs, now);
    EXPECT_EQ(PairsFrom(all_[0].began()), Difference(now, pairs_));
    EXPECT_EQ(PairsFrom(all_[0].ended()), Difference(pairs_, now));
    pairs_ = now;
  }

  // A query whose function moves bodies, sees that, and begins another query.
  void QueryAndMove(std::size_t depth) {
    Watch watch;
    watch.query = choices_.Below(2) == 0
                      ? View::Query::Everything()
                      : Spread<View>(40, choices_.Below(100)).NextQuery();
    if (choices_.Below(4) == 0) watch.options.mask = 1;
    watch.always = watch.ever = Found(watch);
    watches_.push_back(&watch);
    Ids found;
    std::size_t calls = 0;
    ForEachSurvivor(
        all_[0], watch.query,
        [&](Span<const std::uint32_t> some) {
          found.insert(found.end(), some.begin(), some.end());
          // Twice in the innermost: also between two parts of late bodies.
          if (calls++ > (depth == 0 ? 1 : 0)) return;
          Move(choices_.Below(2) == 0 ? 3 : choices_.Below(most_bodies_));
          ExpectAnswers(all_[0], model_, choices_.Below(200));
          if (depth > 0) QueryAndMove(depth - 1);
        },
        watch.options);
    watches_.pop_back();
    const Ids ids = InOrder(found);
    EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
    EXPECT_TRUE(std::includes(ids.begin(), ids.end(), watch.always.begin(),
                              watch.always.end()));
    EXPECT_TRUE(std::includes(watch.ever.begin(), watch.ever.end(), ids.begin(),
                              ids.end()));
  }

  static IdPairs Difference(const IdPairs& of, const IdPairs& without) {
    IdPairs difference;
    std::set_difference(of.begin(), of.end(), without.begin(), without.end(),
                        std::back_inserter(difference));
    return difference;
  }

  // Up to `count` ids that are in use, some of them twice, or that are free.
  Ids Some(std::size_t count, bool are_used) {
    Ids ids;
    std::vector<bool> is_listed(most_bodies_);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t number = choices_.Below(most_bodies_);
      const auto id = static_cast<std::uint32_t>(number) * stride_;
      if (model_.objects.contains(id) != are_used) continue;
      if (!are_used && is_listed[number]) continue;
      is_listed[number] = true;
      ids.push_back(id);
    }
    return ids;
  }

  Choices& choices_;
  std::size_t most_bodies_;
  std::uint32_t stride_;
  FpMode mode_;
  std::vector<BroadPhase<View>> all_;  // the first, and copies of it
  BodyModel<View> model_;
  IdPairs pairs_;
  std::vector<Watch*> watches_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_

// Histories of a broad phase: changes of every kind, of it, its copies and a
// list of its bodies, which choices decide.
#ifndef HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_
#define HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "tests/library/broad_phase/any_bodies.h"
#include "tests/library/bvh/history.h"

namespace halfspace::testing {

class BodyHistory {
 public:
  // Ids are multiples of `stride`. With `memory`, which the options have, each
  // change is tried with less memory than it needs, which changes nothing.
  BodyHistory(const Layout& layout, Choices& choices, std::size_t most_bodies,
              std::uint32_t stride, const BroadPhaseOptions& options,
              FpMode mode = FpMode::kDefault, CountingMemory* memory = nullptr);

  const AnyBodies& bodies() const { return *all_[0]; }
  const BodyModel& model() const { return model_; }

  void Insert(std::size_t count);
  void Move(std::size_t count);
  // One change. Returns its number, for messages.
  std::size_t Change();
  // Each broad phase answers as the model, and all in the same order.
  void ExpectIsModel(std::uint64_t seed);

 private:
  // A query that runs. Of a body that moves, any of its bounds may count.
  struct Watch {
    Shape query;
    QueryOptions options;
    Ids always;  // would be found at any time
    Ids ever;

    void Add(const Ids& found);
  };

  template <typename Call>
  void Each(const Call& call) {
    for (auto& bodies : all_) Try(*bodies, [&] { call(*bodies); });
  }
  void Try(const AnyBodies& bodies, const std::function<void()>& call);
  Ids Found(const Watch& watch) const;
  void UpdatePairs();
  void QueryAndMove(std::size_t depth);
  Ids Some(std::size_t count, bool are_used);

  Choices& choices_;
  std::size_t most_bodies_;
  std::uint32_t stride_;
  FpMode mode_;
  CountingMemory* memory_;
  std::vector<std::unique_ptr<AnyBodies>> all_;  // the first, and a copy of it
  BodyModel model_;
  PairList pairs_;
  std::vector<Watch*> watches_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_

// Broad phases: a list of their bodies, which knows their answers, and
// histories: changes of every kind, of a broad phase, its copies and a list of
// its bodies, which choices decide.
#ifndef HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_
#define HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "tests/library/bvh/history.h"

namespace halfspace::testing {

using AnyBodies = detail::BroadPhaseCore;  // of any type
using detail::CoreOf;

// The bytes of Save().
std::vector<std::byte> BytesOf(const AnyBodies& bodies);

// By their names, for bodies 0 to 99.
using NamedCalls = std::vector<std::pair<const char*, std::function<void()>>>;
inline NamedCalls CallsThatRunAlone(AabbBroadPhase3& bodies) {
  return {
      {"Insert", [&] { bodies.Insert(100, Aabb3{}); }},
      {"Erase", [&] { bodies.Erase(2); }},
      {"SetMasks", [&] { bodies.SetMasks(1, {}); }},
      {"Update", [&] { bodies.Update(); }},
      {"Rebuild", [&] { bodies.Rebuild(); }},
      {"UpdatePairs", [&] { bodies.UpdatePairs(); }},
      {"Load", [&, bytes = BytesOf(CoreOf(bodies))] { bodies.Load(bytes); }},
      {"Save", [&] { (void)BytesOf(CoreOf(bodies)); }},
      {"BroadPhase", [&] { const AabbBroadPhase3 copy(bodies); }},
      {"Validate", [&] { (void)bodies.Validate(); }},
      {"Statistics", [&] { (void)bodies.Statistics(); }},
  };
}

struct BodyModel {
  struct Body {
    Planes bound;
    BodyMasks masks;
    Planes seen;  // by queries
  };
  Layout layout{3, 3, true};
  std::map<std::uint32_t, Body> bodies;
  bool moves_wait = false;
  bool (*keep)(void*, std::uint32_t, std::uint32_t, bool) = nullptr;

  void Insert(std::uint32_t id, const Planes& bound,
              const BodyMasks& masks = {}) {
    bodies[id] = {bound, masks, bound};
  }
  void Move(std::uint32_t id, const Planes& bound) {
    Body& body = bodies.at(id);
    body.bound = bound;
    if (!moves_wait) body.seen = bound;
  }
  void Update() {
    for (auto& [id, body] : bodies) body.seen = body.bound;
  }
  Objects Seen() const;
  // Those of UpdatePairs(), after Update().
  PairList Pairs() const;
};

inline Planes PlanesOf(const Aabb3& box) {
  return {box.min[0], box.min[1], box.min[2],
          box.max[0], box.max[1], box.max[2]};
}

// A filter: some pairs in spite of their masks, and some not.
inline bool KeepsSome(void* /*context*/, std::uint32_t a, std::uint32_t b,
                      bool masks_match) {
  return (a + b) % 8 == 0 ? !masks_match : masks_match;
}

// Loads bytes that may be wrong. They are refused, of which nothing changes, or
// do no harm to the calls of the broad phase. Returns whether they were taken.
bool LoadAltered(const Layout& layout, Span<const std::byte> bytes,
                 Random& random);

// Answers of all kinds, chosen by a seed, and what is stored of each body.
void ExpectAnswers(const AnyBodies& bodies, const BodyModel& model,
                   std::uint64_t seed);
// With the calls that run alone.
void ExpectIsModel(const AnyBodies& bodies, BodyModel& model,
                   std::uint64_t seed);

class BodyHistory {
 public:
  // Ids are multiples of `stride`. With `memory`, which the options have, each
  // change is tried with less memory than it needs, which changes nothing.
  BodyHistory(const Layout& layout, Choices& choices, std::size_t most_bodies,
              std::uint32_t stride, const BroadPhaseOptions& options,
              FpMode mode = FpMode::kDefault, CountingMemory* memory = nullptr);

  const AnyBodies& bodies() const { return all_[0]; }

  void Insert(std::size_t count);
  void Move(std::size_t count);
  void Copy();  // which goes on next to it
  void UpdatePairs();
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
    for (AnyBodies& bodies : all_) Try(bodies, [&] { call(bodies); });
  }
  void Try(const AnyBodies& bodies, const std::function<void()>& call);
  // The first and a copy answer the same, in the same order.
  void ExpectSameOrder(const AnyBodies& copy, std::uint64_t seed) const;
  Ids Found(const Watch& watch) const;
  void QueryAndMove(std::size_t depth);
  Ids Some(std::size_t count, bool are_used);

  Choices& choices_;
  std::size_t most_bodies_;
  std::uint32_t stride_;
  FpMode mode_;
  CountingMemory* memory_;
  std::vector<AnyBodies> all_;  // the first, and a copy of it
  BodyModel model_;
  PairList pairs_;
  std::vector<Watch*> watches_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BROAD_PHASE_HISTORY_H_

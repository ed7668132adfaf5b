// Programs of docs/porting.md: rules for pairs, contacts, the pairs of Jolt's
// active bodies, a cast, rollback, and a frame in phases.
#include <halfspace/broad_phase.h>
#include <halfspace/bvh.h>
#include <halfspace/bvh_pairs.h>
#include <halfspace/pair_events.h>
#include <halfspace/span.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <set>
#include <utility>
#include <vector>

#include "engines/active_pairs.h"

// Layer i is bit i of a category. Bit k of collides[i] is set if layers i and k
// collide.
halfspace::BodyMasks MasksOfLayer(unsigned layer,
                                  const std::vector<std::uint32_t>& collides) {
  return {std::uint32_t{1} << layer, collides[layer]};
}

// Box2D's filter: two shapes of one group, if it is not 0, collide if it is
// positive. All others collide by their masks.
bool KeepByGroup(void* context, std::uint32_t a, std::uint32_t b,
                 bool masks_match) {
  const auto& group = *static_cast<const std::vector<int>*>(context);
  if (group[a] != group[b] || group[a] == 0) return masks_match;
  return group[a] > 0;
}

// The contacts of a world, created and destroyed by the events of pairs.
struct Contacts {
  std::set<std::pair<std::uint32_t, std::uint32_t>> list;

  void Update(halfspace::AabbBroadPhase3& bodies) {
    bodies.Update();
    bodies.UpdatePairs();
    for (const auto& pair : bodies.began()) list.insert({pair.a, pair.b});
    for (const auto& pair : bodies.ended()) list.erase({pair.a, pair.b});
  }
};

// The body that a moving box hits first. `exact` returns the fraction of the
// motion at which it hits the body's shape, and more than 1 if it never does.
template <typename Exact>
std::uint32_t FirstHit(const halfspace::AabbBroadPhase3& bodies,
                       const halfspace::Aabb3& box,
                       const halfspace::Point3& motion, std::uint32_t mask,
                       const Exact& exact) {
  std::uint32_t hit = ~std::uint32_t{0};
  float limit = 1;
  halfspace::SearchOptions options;
  options.mask = mask;
  BoxCast(
      bodies, box, motion, 1.0f,
      [&](std::uint32_t id, float) {
        const float fraction = exact(id);
        if (fraction <= limit) {
          limit = fraction;
          hit = id;
        }
        return halfspace::Limit{limit};  // nothing beyond it is found any more
      },
      options);
  return hit;
}

// The worlds of the last frames. An input that comes late is applied to the
// world of its frame, and the frames since then are played again.
struct Rollback {
  static constexpr std::size_t kFrames = 8;
  halfspace::AabbBroadPhase3 saved[kFrames];

  // Before a frame. Copies into the memory of the world of 8 frames ago.
  void Save(const halfspace::AabbBroadPhase3& bodies, std::size_t frame) {
    saved[frame % kFrames] = bodies;
  }
  // Calls play(bodies, f) for the frames `from` ... `to` - 1.
  template <typename Play>
  void PlayAgain(halfspace::AabbBroadPhase3& bodies, std::size_t from,
                 std::size_t to, const Play& play) {
    bodies = saved[from % kFrames];
    for (std::size_t frame = from; frame < to; ++frame) {
      Save(bodies, frame);
      play(bodies, frame);
    }
  }
};

// The same frame without a broad phase, for an engine whose frame has phases:
// bodies move, then one call updates the tree, then queries run.
struct Phases {
  halfspace::AabbBvh3 bvh;
  halfspace::PairEvents contacts;

  // bounds[id] is the bound of each body.
  void Update(const std::vector<std::uint32_t>& moved,
              const std::vector<halfspace::Aabb3>& bounds) {
    bvh.Refit(moved, bounds);
    bvh.RebuildPartial(bvh.size() / 16);
    contacts.Update(bvh, moved);
  }
};

int main() {
  // Layer 0 is the ground, which collides with bodies, layer 1. Bodies collide
  // with all layers. Bodies 3 and 4 are parts of one ragdoll.
  const std::vector<std::uint32_t> collides = {2, 3};
  std::vector<int> group = {0, 0, 0, -1, -1};
  halfspace::BroadPhaseOptions options;
  options.filter = {&KeepByGroup, &group};
  halfspace::AabbBroadPhase3 bodies(options);

  const halfspace::Aabb3 ground = {{-10, -1, -10}, {10, 0, 10}};
  const auto box_at = [](float x, float y) {
    return halfspace::Aabb3{{x, y, 0}, {x + 1, y + 1, 1}};
  };
  bodies.Insert(0, ground, MasksOfLayer(0, collides));
  const std::vector<std::uint32_t> active = {1, 2, 3, 4};
  std::vector<halfspace::Aabb3> bounds = {box_at(0, 5), box_at(1.5f, 5),
                                          box_at(4, 5), box_at(4.5f, 5)};
  bodies.Insert(active, bounds,
                std::vector<halfspace::BodyMasks>(active.size(),
                                                  MasksOfLayer(1, collides)));
  Contacts contacts;
  contacts.Update(bodies);
  const bool none = contacts.list.empty();

  // All fall to the ground, and body 2 moves to body 1.
  bounds = {box_at(0, 0), box_at(1, 0), box_at(4, 0), box_at(4.5f, 0)};
  bodies.Move(active, bounds);  // or a part of them on each thread
  contacts.Update(bodies);
  // Bodies 3 and 4 overlap, but their group is negative.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> expected = {
      {0, 1}, {0, 2}, {0, 3}, {0, 4}, {1, 2}};
  bool is_right =
      none && std::equal(expected.begin(), expected.end(),
                         contacts.list.begin(), contacts.list.end());

  // Jolt accepts each pair once, whatever the order of its list.
  auto with_both = expected;
  with_both.emplace_back(3, 4);  // Jolt's own filter would reject it
  std::vector<std::uint32_t> list = active;
  ActivePairs pairs;
  do {
    pairs.Find(bodies, list, 0.02f);
    std::vector<std::uint32_t> place(group.size(), 0xffffffff);
    for (std::uint32_t i = 0; i < list.size(); ++i) place[list[i]] = i;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> accepted;
    for (std::size_t i = 0; i < list.size(); ++i) {
      for (const std::uint32_t other : pairs.Of(i)) {
        // As Body::sFindCollidingPairsCanCollide.
        if (i < place[other]) {
          accepted.push_back(std::minmax(list[i], other));
        }
      }
    }
    std::sort(accepted.begin(), accepted.end());
    is_right = is_right && accepted == with_both &&
               pairs.Has(list.size() - 1) && !pairs.Has(list.size());
  } while (std::next_permutation(list.begin(), list.end()));

  // From the left: body 1 comes first, but its shape is missed.
  const std::uint32_t hit = FirstHit(
      bodies, {{-9, 0.25f, 0.25f}, {-8, 0.75f, 0.75f}}, {20, 0, 0},
      MasksOfLayer(1, collides).category,
      [](std::uint32_t id) { return id == 1 ? 2.0f : 0.1f * float(id); });

  // Body 1 walks over the others. Frames 1 and 2 are played twice.
  Rollback rollback;
  std::vector<std::vector<halfspace::IdPair>> events;
  const auto play = [&](halfspace::AabbBroadPhase3& world, std::size_t frame) {
    world.Move(1, box_at(2 * static_cast<float>(frame), 0));
    world.Update();
    world.UpdatePairs();
    events.emplace_back(world.began().begin(), world.began().end());
    events.emplace_back(world.ended().begin(), world.ended().end());
  };
  for (std::size_t frame = 0; frame < 3; ++frame) {
    rollback.Save(bodies, frame);
    play(bodies, frame);
  }
  rollback.PlayAgain(bodies, 1, 3, play);
  is_right =
      is_right && events.size() == 10 && !events[4].empty() &&
      std::equal(events.begin() + 2, events.begin() + 6, events.begin() + 6);

  // The same bodies in phases: all rest in the air, and then fall.
  std::vector<halfspace::Aabb3> by_id = {ground, box_at(0, 5), box_at(1.5f, 5),
                                         box_at(4, 5), box_at(5.5f, 5)};
  Phases phases;
  phases.bvh = halfspace::AabbBvh3(by_id);
  phases.Update({}, by_id);
  std::copy(bounds.begin(), bounds.end(), by_id.begin() + 1);
  phases.Update(active, by_id);
  is_right = is_right && phases.contacts.began().size() == with_both.size();

  std::printf("%zu contacts, the cast hits body %u\n", contacts.list.size(),
              hit);
  return is_right && hit == 2 ? 0 : 1;
}

// The programs of docs/porting.md: rules for pairs, a frame, contacts, and a
// cast, as the broad phases of Jolt, Box2D and bepuphysics2 have them.
#include <halfspace/broad_phase.h>
#include <halfspace/span.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <set>
#include <utility>
#include <vector>

// Layer i is bit i of a category. Bit k of collides[i] is set if layers i and k
// collide.
halfspace::BodyMasks MasksOfLayer(unsigned layer,
                                  const std::vector<std::uint64_t>& collides) {
  return {std::uint64_t{1} << layer, collides[layer]};
}

// Box2D's filter: two shapes of one group, if it is not 0, collide if it is
// positive. All others collide by their masks.
bool KeepByGroup(void* context, std::uint32_t a, std::uint32_t b,
                 bool masks_match) {
  const auto& group = *static_cast<const std::vector<int>*>(context);
  if (group[a] != group[b] || group[a] == 0) return masks_match;
  return group[a] > 0;
}

// Calls add(a, b) for each pair of an active body, `a`, and another body whose
// bounds are at most `distance` apart on each axis.
template <typename Add>
void Frame(halfspace::AabbBroadPhase3& bodies,
           const std::vector<std::uint32_t>& active,
           const std::vector<halfspace::Aabb3>& bounds, float distance,
           const Add& add) {
  bodies.Move(active, bounds);  // or a part of them on each thread
  bodies.Update();
  bodies.ForEachPairOf(active, distance, add);
}

// The same for one batch of Jolt's active bodies, on any thread. place[id] is
// the index of a body in the list of active bodies, and 0xffffffff if it is not
// active. The batch is the part of that list from `first` on.
//
// Jolt accepts (a, b) only if place[a] < place[b]. A pair of two bodies of the
// batch comes once, in either order, so it is put in this order. If only `a` is
// in the batch, the pair must stay as it is: if `b` is active, the batch that
// `b` is in finds (b, a).
template <typename Add>
void FindCollidingPairs(const halfspace::AabbBroadPhase3& bodies,
                        halfspace::Span<const std::uint32_t> batch,
                        std::uint32_t first,
                        const std::vector<std::uint32_t>& place, float distance,
                        const Add& add) {
  const auto in_batch = [&](std::uint32_t id) {
    return place[id] >= first && place[id] - first < batch.size();
  };
  bodies.ForEachPairOf(batch, distance, [&](std::uint32_t a, std::uint32_t b) {
    if (in_batch(b) && place[b] < place[a]) std::swap(a, b);
    add(a, b);
  });
}

// The body that a moving box hits first. `exact` returns the fraction of the
// motion at which it hits the body's shape, and more than 1 if it never does.
template <typename Exact>
std::uint32_t FirstHit(const halfspace::AabbBroadPhase3& bodies,
                       const halfspace::Aabb3& box,
                       const halfspace::Point3& motion, std::uint64_t mask,
                       const Exact& exact) {
  std::uint32_t hit = ~std::uint32_t{0};
  float limit = 1;
  bodies.ForEachCast(box, motion, 1.0f, mask, [&](std::uint32_t id, float) {
    const float fraction = exact(id);
    if (fraction <= limit) {
      limit = fraction;
      hit = id;
    }
    return halfspace::Limit{limit};  // nothing beyond it is found any more
  });
  return hit;
}

// The contacts of a world, created and destroyed by the events of pairs.
struct Contacts {
  std::set<std::pair<std::uint32_t, std::uint32_t>> list;

  void Update(halfspace::AabbBroadPhase3& bodies) {
    bodies.UpdatePairs(
        [this](std::uint32_t a, std::uint32_t b) {
          list.insert({a, b});
        },
        [this](std::uint32_t a, std::uint32_t b) {
          list.erase({a, b});
        });
  }
};

int main() {
  // Layer 0 is the ground, which collides with bodies, layer 1. Bodies collide
  // with all layers. Bodies 3 and 4 are parts of one ragdoll.
  const std::vector<std::uint64_t> collides = {2, 3};
  std::vector<int> group = {0, 0, 0, -1, -1};
  halfspace::BroadPhaseOptions options;
  options.margin = 0.1f;
  options.filter = {&KeepByGroup, &group};
  halfspace::AabbBroadPhase3 bodies(group.size(), options);

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
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  Frame(bodies, active, bounds, 0.02f, [&](std::uint32_t a, std::uint32_t b) {
    pairs.push_back(std::minmax(a, b));
  });
  std::sort(pairs.begin(), pairs.end());
  contacts.Update(bodies);
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> expected = {
      {0, 1}, {0, 2}, {0, 3}, {0, 4}, {1, 2}};

  // Jolt finds the same pairs, each once, in batches of any size of a list in
  // any order.
  bool as_jolt = true;
  std::vector<std::uint32_t> list = active;
  do {
    std::vector<std::uint32_t> place(group.size(), 0xffffffff);
    for (std::uint32_t i = 0; i < list.size(); ++i) place[list[i]] = i;
    for (std::uint32_t size = 1; size <= list.size(); ++size) {
      std::vector<std::pair<std::uint32_t, std::uint32_t>> accepted;
      for (std::uint32_t first = 0; first < list.size(); first += size) {
        const auto end = std::min<std::size_t>(first + size, list.size());
        FindCollidingPairs(bodies, {list.data() + first, end - first}, first,
                           place, 0.02f, [&](std::uint32_t a, std::uint32_t b) {
                             // As Body::sFindCollidingPairsCanCollide.
                             if (place[a] < place[b])
                               accepted.push_back(std::minmax(a, b));
                           });
      }
      std::sort(accepted.begin(), accepted.end());
      as_jolt = as_jolt && accepted == expected;
    }
  } while (std::next_permutation(list.begin(), list.end()));

  // From the left: body 1 comes first, but its shape is missed.
  const std::uint32_t hit = FirstHit(
      bodies, {{-9, 0.25f, 0.25f}, {-8, 0.75f, 0.75f}}, {20, 0, 0},
      MasksOfLayer(1, collides).category,
      [](std::uint32_t id) { return id == 1 ? 2.0f : 0.1f * float(id); });

  std::printf("%zu pairs, %zu contacts, the cast hits body %u\n", pairs.size(),
              contacts.list.size(), hit);
  return none && as_jolt && pairs == expected && hit == 2 &&
                 std::equal(expected.begin(), expected.end(),
                            contacts.list.begin(), contacts.list.end())
             ? 0
             : 1;
}

// All pairs of a BVH, frame by frame: moving bodies whose bounds touch.
// Bodies move a little in a frame, so pairs within a margin are found once for
// several frames. The world keeps its order while bodies move, receives all new
// bounds at once, and sorts some bodies again where the order has decayed. A
// few bodies that are moved elsewhere are searched alone.
#include <halfspace/halfspace.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

struct Body {
  halfspace::Point3 center;
  halfspace::Point3 velocity;
};

constexpr float kRadius = 0.5f;
constexpr float kWorld = 40.0f;
constexpr float kSpeed = 3.0f;  // the greatest, along an axis
constexpr float kFrameTime = 1.0f / 60.0f;
constexpr int kFrames = 4;  // for which pairs are found at once
// Two bodies that move towards each other for so many frames.
constexpr float kMargin = 2.0f * kSpeed * kFrameTime * kFrames;

std::vector<Body> MakeBodies() {
  std::vector<Body> bodies;
  std::uint32_t random = 1;
  const auto next = [&random](float from, float to) {
    random = random * 1664525u + 1013904223u;
    return from + (to - from) * static_cast<float>(random >> 8) * 0x1p-24f;
  };
  for (int i = 0; i < 8000; ++i) {
    Body body;
    for (float& x : body.center) x = next(0.0f, kWorld);
    for (float& v : body.velocity) v = next(-kSpeed, kSpeed);
    bodies.push_back(body);
  }
  return bodies;
}

halfspace::Aabb3 BoundOf(const Body& body) {
  return halfspace::BoundSphere(halfspace::Sphere3{body.center, kRadius})
      .aabb();
}

bool Touch(const halfspace::Aabb3& a, const halfspace::Aabb3& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (a.min[k] > b.max[k] || b.min[k] > a.max[k]) return false;
  }
  return true;
}

void Move(Body& body) {
  for (std::size_t k = 0; k < 3; ++k) {
    body.center[k] += body.velocity[k] * kFrameTime;
    if (body.center[k] < 0.0f || body.center[k] > kWorld) {
      body.velocity[k] = -body.velocity[k];
    }
  }
}

}  // namespace

int main() {
  std::vector<Body> bodies = MakeBodies();
  std::vector<halfspace::Aabb3> bounds(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i)
    bounds[i] = BoundOf(bodies[i]);
  halfspace::AabbBvh3 world(bounds,
                            {.quality = halfspace::BuildQuality::kFast});

  std::vector<halfspace::IdPair> pairs(100'000);
  std::size_t near = 0;
  std::size_t touching = 0;
  std::size_t sorted = 0;
  for (int frame = 0; frame < 60; ++frame) {
    if (frame % kFrames == 0) {
      world.Refit(bounds);
      if (world.CostRatio() > 1.2) {
        sorted += world.RebuildPartial(bodies.size() / 2);
      }
      halfspace::PairOptions options;
      options.margin = kMargin;
      near = Pairs(world, pairs, options);
      if (near > pairs.size()) return 1;
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      Move(bodies[i]);
      bounds[i] = BoundOf(bodies[i]);
    }
    touching = 0;  // and their narrow phase
    for (std::size_t p = 0; p < near; ++p) {
      touching += Touch(bounds[pairs[p].a], bounds[pairs[p].b]) ? 1 : 0;
    }
  }

  // The last frame's, by a test of each pair.
  std::size_t expected = 0;
  for (std::size_t a = 0; a < bounds.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      expected += Touch(bounds[a], bounds[b]) ? 1 : 0;
    }
  }
  std::printf(
      "%zu of %zu near pairs touch in the last frame; %zu times a body was "
      "sorted again\n",
      touching, near, sorted);
  if (touching != expected) return 1;

  // Two bodies are moved to another one.
  world.Refit(bounds);
  const std::vector<std::uint32_t> moved = {1, 2};
  for (std::uint32_t id : moved) {
    bodies[id].center = bodies[0].center;
    bounds[id] = BoundOf(bodies[id]);
    world.Set(id, bounds[id]);
  }
  const std::size_t new_pairs = PairsOf(world, moved, pairs);
  std::printf("%zu pairs have one of the bodies that were moved\n", new_pairs);
  return new_pairs >= 3 && new_pairs <= pairs.size() ? 0 : 1;
}

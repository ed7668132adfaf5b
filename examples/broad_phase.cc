// A broad phase, frame by frame: all pairs of moving bodies whose bounds touch.
// The world keeps its order while bodies move, is told their new bounds at
// once, and sorts a few of them anew where the order has decayed.
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
    for (float& v : body.velocity) v = next(-3.0f, 3.0f);
    bodies.push_back(body);
  }
  return bodies;
}

halfspace::Aabb3 BoundOf(const Body& body) {
  return halfspace::BoundSphere(halfspace::Sphere3{body.center, kRadius})
      .aabb();
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
  std::size_t count = 0;
  std::size_t bvh = 0;
  for (int frame = 0; frame < 60; ++frame) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      Body& body = bodies[i];
      for (std::size_t k = 0; k < 3; ++k) {
        body.center[k] += body.velocity[k] / 60.0f;
        if (body.center[k] < 0.0f || body.center[k] > kWorld) {
          body.velocity[k] = -body.velocity[k];
        }
      }
      bounds[i] = BoundOf(body);
    }
    world.Refit(bounds);
    if (world.CostRatio() > 1.2) bvh += world.RebuildPartial(bodies.size() / 2);
    count = Pairs(world, pairs);  // for the narrow phase
  }

  // The last frame's, by a test of each pair.
  std::size_t expected = 0;
  for (std::size_t a = 0; a < bounds.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      bool touch = true;
      for (std::size_t k = 0; k < 3; ++k) {
        touch &= bounds[a].min[k] <= bounds[b].max[k] &&
                 bounds[b].min[k] <= bounds[a].max[k];
      }
      expected += touch ? 1 : 0;
    }
  }
  std::printf("%zu pairs in the last frame; %zu times a body was sorted anew\n",
              count, bvh);
  return count == expected && count <= pairs.size() ? 0 : 1;
}

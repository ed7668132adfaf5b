// A broad phase: bodies that move on two threads, the pairs that began or ended
// to touch in each frame, a query, and a ray cast.
#include <halfspace/halfspace.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <thread>
#include <vector>

namespace {

using Ids = std::vector<std::uint32_t>;
using Boxes = std::vector<halfspace::Aabb3>;

constexpr std::size_t kBodies = 4000;
constexpr int kFrames = 40;

// Body i moves to and fro along X.
halfspace::Aabb3 BoxAt(std::size_t i, int frame) {
  const auto at = [](std::size_t n) { return static_cast<float>(n); };
  const float x = at(i % 20) + 0.02f * static_cast<float>(frame % 60) *
                                   (i % 2 == 0 ? 1.0f : -1.0f);
  const float y = at(i / 20 % 20);
  const float z = at(i / 400);
  return {{x, y, z}, {x + 0.7f, y + 0.7f, z + 0.7f}};
}

void MoveAll(halfspace::AabbBroadPhase3& bodies, std::size_t begin,
             std::size_t end, int frame) {
  Ids ids;
  Boxes boxes;
  for (std::size_t i = begin; i < end; ++i) {
    ids.push_back(static_cast<std::uint32_t>(i));
    boxes.push_back(BoxAt(i, frame));
  }
  bodies.Move(ids, boxes);
}

}  // namespace

int main() {
  halfspace::AabbBroadPhase3 bodies;
  Ids ids;
  Boxes boxes;
  for (std::size_t i = 0; i < kBodies; ++i) {
    ids.push_back(static_cast<std::uint32_t>(i));
    boxes.push_back(BoxAt(i, 0));
  }
  bodies.Insert(ids, boxes);

  std::size_t touching = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    std::thread other([&] { MoveAll(bodies, 0, kBodies / 2, frame); });
    MoveAll(bodies, kBodies / 2, kBodies, frame);
    other.join();
    bodies.Update();
    bodies.UpdatePairs();
    const std::size_t began = bodies.began().size();
    const std::size_t ended = bodies.ended().size();
    touching += began - ended;
    if (began + ended > 0) {
      std::printf("frame %d: %zu pairs began and %zu ended\n", frame, began,
                  ended);
    }
  }

  const halfspace::Aabb3 corner = {{0, 0, 0}, {1.5f, 0.5f, 0.5f}};
  std::printf("%zu pairs touch in the last frame; the query finds %zu bodies\n",
              touching, CountSurvivors(bodies, corner));

  // The first body that a ray enters.
  const halfspace::Ray3 ray = {{-5, 0.5f, 0.5f}, {1, 0, 0}, 100};
  std::uint32_t first = 0;
  float distance = ray.max_t;
  RayCast(bodies, ray, [&](std::uint32_t id, float t) {
    if (t < distance) {
      distance = t;
      first = id;
    }
    return halfspace::Limit{distance};  // finds nothing beyond it any more
  });
  std::printf("the ray enters body %u at %g\n", first, distance);

  // By a test of each pair.
  std::size_t expected = 0;
  for (std::size_t a = 0; a < kBodies; ++a) {
    const halfspace::Aabb3 one = BoxAt(a, kFrames - 1);
    for (std::size_t b = 0; b < a; ++b) {
      const halfspace::Aabb3 other = BoxAt(b, kFrames - 1);
      bool is_apart = false;
      for (std::size_t k = 0; k < 3; ++k) {
        is_apart |= one.min[k] > other.max[k] || other.min[k] > one.max[k];
      }
      expected += is_apart ? 0 : 1;
    }
  }
  return touching == expected && touching == bodies.pairs().size() &&
                 expected > 0 && first == 1
             ? 0
             : 1;
}

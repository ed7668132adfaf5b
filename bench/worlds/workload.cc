#include "bench/worlds/workload.h"

#include <algorithm>
#include <array>
#include <utility>

#include "bench/worlds/moved_clouds.h"
#include "bench/worlds/random.h"
#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kDefaultQueries = 256;

// Every step-th object.
std::vector<Aabo3> SomeOf(const AaboWorld3& objects, std::size_t count) {
  const std::size_t step = std::max<std::size_t>(1, objects.size() / count);
  std::vector<Aabo3> some;
  for (std::size_t i = 0; i < objects.size(); i += step) {
    some.push_back(objects.Get(i));
  }
  return some;
}

}  // namespace

Aabb3 BoxAround(const AaboWorld3& objects) {
  Aabb3 box = Aabb3::Empty();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Aabo3 object = objects.Get(i);
    if (object == Aabo3::Everything()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      box.min[k] = std::min(box.min[k], object.min[k]);
      box.max[k] = std::max(box.max[k], object.max[k]);
    }
  }
  return box == Aabb3::Empty() ? Aabb3{} : box;
}

void QueryWith(Workload& workload, const AaboWorld3& source,
               std::size_t queries) {
  if (queries != 0) {
    workload.queries = SomeOf(source, queries);
    workload.timed_queries = workload.queries;
    return;
  }
  workload.queries = SomeOf(source, kDefaultQueries);
  std::vector<Aabo3>& timed = workload.timed_queries;
  timed = SomeOf(source, kTimedQueries);
  // Neighbours in a file are neighbours in space, and have the same path.
  Random random(1);
  for (std::size_t i = timed.size(); i > 1; --i) {
    std::swap(timed[i - 1], timed[random.Below(i)]);
  }
}

AaboWorld3 RandomBoxes(const Workload& workload, double percent,
                       std::size_t queries, std::uint64_t seed) {
  const Aabb3 around = BoxAround(workload.objects);
  Random random(seed);
  AaboWorld3 boxes;
  boxes.Reserve(queries == 0 ? kTimedQueries : queries);
  while (boxes.size() < (queries == 0 ? kTimedQueries : queries)) {
    Aabb3 box;
    for (std::size_t k = 0; k < 3; ++k) {
      const double whole = double{around.max[k]} - around.min[k];
      const double side = whole * percent / 100;
      const double low =
          around.min[k] + (whole - side) * (random.Signed() / 2.0 + 0.5);
      box.min[k] = static_cast<float>(low);
      box.max[k] = static_cast<float>(low + side);
    }
    boxes.Push(BoundAabb(box));
  }
  return boxes;
}

AaboWorld3 ResizedTo(const AaboWorld3& source, std::size_t objects) {
  AaboWorld3 world;
  world.Reserve(objects);
  for (std::size_t i = 0; i < objects; ++i) {
    world.Push(source.Get(i % source.size()));
  }
  return world;
}

AaboWorld3 Thinned(const AaboWorld3& source, std::size_t most) {
  const std::size_t step = (source.size() + most - 1) / most;
  AaboWorld3 world;
  world.Reserve(source.size() / step + 1);
  for (std::size_t i = 0; i < source.size(); i += step) {
    world.Push(source.Get(i));
  }
  return world;
}

Workload WorkloadOfTriangles(std::string name,
                             const std::vector<float>& coordinates,
                             const std::vector<std::uint32_t>& indices,
                             std::size_t queries) {
  Workload workload{std::move(name), {}, {}};
  workload.objects.Reserve(indices.size() / 3);
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    std::array<float, 9> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      std::copy_n(&coordinates[3 * std::size_t{indices[t + c]}], 3,
                  &corners[3 * c]);
    }
    workload.objects.Push(BoundPoints(Points3{corners.data(), 3}));
  }
  QueryWith(workload, workload.objects, queries);
  return workload;
}

Workload BoxesOf(const Workload& workload) {
  Workload boxes{"boxes of " + workload.name, {}, {}};
  for (std::size_t i = 0; i < workload.objects.size(); ++i) {
    boxes.objects.Push(BoundAabb(workload.objects.Get(i).aabb()));
  }
  for (const Aabo3& query : workload.timed_queries) {
    boxes.timed_queries.push_back(BoundAabb(query.aabb()));
  }
  return boxes;
}

Workload WorkloadOfBoxes(std::string name, const std::vector<Aabb3>& boxes,
                         std::size_t queries) {
  Workload workload{std::move(name), {}, {}};
  workload.objects.Reserve(boxes.size());
  for (const Aabb3& box : boxes) workload.objects.Push(BoundAabb(box));
  QueryWith(workload, workload.objects, queries);
  return workload;
}

Workload MakeScene(std::size_t objects, std::size_t queries, std::uint64_t seed,
                   float radius) {
  auto [boxes, asked] = MakeSceneOf<3>(objects, queries, seed, radius);
  return {"scene", std::move(boxes), std::move(asked)};
}

Workload SceneOfSize(double share, std::size_t objects, std::uint64_t seed,
                     std::size_t queries) {
  Workload scene = MakeScene(objects, queries, seed,
                             static_cast<float>(share) * kSceneSide / 2);
  scene.timed_queries = scene.queries;
  return scene;
}

std::vector<std::array<Triangle, 2>> TrianglePairs(std::size_t count,
                                                   std::uint64_t seed) {
  constexpr float kBetween = 0.75f;
  Random random(seed);
  std::vector<std::array<Triangle, 2>> pairs(count);
  for (std::array<Triangle, 2>& pair : pairs) {
    for (Triangle& corners : pair) {
      Vector3 at;
      for (float& x : at) x = kBetween * random.Signed();
      for (Vector3& corner : corners) {
        for (std::size_t k = 0; k < 3; ++k) {
          corner[k] = at[k] + 0.5f * random.Signed();
        }
      }
    }
  }
  return pairs;
}

}  // namespace halfspace::bench

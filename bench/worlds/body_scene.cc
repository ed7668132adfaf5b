#include "bench/worlds/body_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "halfspace/bvh.h"
#include "halfspace/bvh_pairs.h"

namespace halfspace::bench {
namespace {

// What a kind is made of. x is uniform in [0, 1).
struct Recipe {
  const char* name;
  float (*side)(Random& random);
  float space[2];  // for each body in 2D and 3D
  // The greatest speed, of a frame and on an axis.
  float (*speed)(Random& random);
};

float Uniform(Random& random) { return 0.5f * (random.Signed() + 1.0f); }
float TenthPower(Random& random) { return std::pow(Uniform(random), 10.0f); }

// The exponential of an Irwin-Hall sum, which is nearly normal.
float LogNormal(Random& random) {
  const float sum =
      random.Signed() + random.Signed() + random.Signed() + random.Signed();
  return 0.7f * std::exp(0.6f * sum);
}

// In the order of BodyKind. Half of the bodies of a lattice touch the next one
// on an axis.
constexpr Recipe kRecipes[] = {
    {"gas",
     [](Random& random) { return 1.0f + 0.5f * random.Signed(); },
     {4, 8},
     [](Random&) { return 0.1f; }},
    {"sparse",
     [](Random& random) { return 1.0f + 0.5f * random.Signed(); },
     {100, 100},
     [](Random&) { return 0.1f; }},
    {"pile",
     [](Random&) { return 1.0f; },
     {1, 1},
     [](Random&) { return 0.002f; }},
    {"log-normal", LogNormal, {4.7f, 19}, [](Random&) { return 0.1f; }},
    {"bepu",
     [](Random& random) { return 1.0f + 99.0f * TenthPower(random); },
     {585, 47000},
     [](Random& random) { return 10.0f / 60.0f * TenthPower(random); }},
    {"fast",
     [](Random&) { return 1.0f; },
     {10, 10},
     [](Random&) { return 2.0f; }}};

const Recipe& RecipeOf(BodyKind kind) {
  return kRecipes[static_cast<std::size_t>(kind)];
}

}  // namespace

const char* NameOf(BodyKind kind) { return RecipeOf(kind).name; }

template <int kDims>
BodyScene<kDims>::BodyScene(BodyKind kind, std::size_t bodies,
                            std::uint64_t seed)
    : boxes_(bodies), velocities_(bodies), seed_(seed) {
  const Recipe& recipe = RecipeOf(kind);
  Random random(seed);
  const auto count = static_cast<float>(bodies);
  const bool is_pile = kind == BodyKind::kPile;
  float side = std::pow(count * recipe.space[kDims - 2], 1.0f / kDims);
  if (is_pile) side = std::ceil(side);
  const auto row = static_cast<std::size_t>(side);
  for (std::size_t i = 0; i < bodies; ++i) {
    const float length = recipe.side(random);
    const float speed = recipe.speed(random);
    std::size_t cell = i;
    for (std::size_t k = 0; k < kDims; ++k) {
      float place = side * Uniform(random);
      if (is_pile) {
        place = static_cast<float>(cell % row) + 0.01f * random.Signed();
        cell /= row;
      }
      boxes_[i].min[k] = place;
      boxes_[i].max[k] = place + length;
      velocities_[i][k] = speed * random.Signed();
    }
  }
}

template <int kDims>
typename BodyScene<kDims>::Ids BodyScene<kDims>::AllIds() const {
  Ids ids(size());
  std::iota(ids.begin(), ids.end(), 0u);
  return ids;
}

template <int kDims>
typename BodyScene<kDims>::Ids BodyScene<kDims>::Some(
    std::size_t percent) const {
  Random random(seed_ + 1);
  Ids ids;
  for (std::uint32_t id : AllIds()) {
    if (random.Below(100) < percent) ids.push_back(id);
  }
  return ids;
}

template <int kDims>
std::vector<Aabb<kDims>> BodyScene<kDims>::At(const Ids& ids,
                                              std::size_t state) const {
  std::vector<Box> boxes;
  boxes.reserve(ids.size());
  for (std::uint32_t id : ids) {
    Box box = boxes_[id];
    for (std::size_t k = 0; k < kDims; ++k) {
      const float way = static_cast<float>(state) * velocities_[id][k];
      box.min[k] += way;
      box.max[k] += way;
    }
    boxes.push_back(box);
  }
  return boxes;
}

template <int kDims>
bool BodyScene<kDims>::ArePairs(const Ids& moved, std::size_t state,
                                float slack,
                                std::vector<IndexPair>& found) const {
  std::vector<Box> boxes = At(AllIds(), 0);
  const std::vector<Box> now = At(moved, state);
  std::vector<bool> is_moved(boxes.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    boxes[moved[i]] = now[i];
    is_moved[moved[i]] = true;
  }
  for (IndexPair& pair : found) std::sort(pair.begin(), pair.end());
  std::sort(found.begin(), found.end());
  const auto touching = [&] {
    std::vector<IndexPair> pairs;
    ForEachPair(Bvh<AabbView<kDims>>(boxes), [&](Span<const IdPair> some) {
      for (const auto& [a, b] : some) {
        if (is_moved[a] || is_moved[b]) {
          pairs.push_back({std::min(a, b), std::max(a, b)});
        }
      }
    });
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  };
  const std::vector<IndexPair> most = touching();
  for (Box& box : boxes) {
    float square = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      const float far = std::max(std::abs(box.min[k]), std::abs(box.max[k]));
      square += far * far;
    }
    for (float& x : box.min) x += slack * std::sqrt(square);
    for (float& x : box.max) x -= slack * std::sqrt(square);
  }
  const std::vector<IndexPair> least = touching();
  return std::includes(found.begin(), found.end(), least.begin(),
                       least.end()) &&
         std::includes(most.begin(), most.end(), found.begin(), found.end());
}

template class BodyScene<2>;
template class BodyScene<3>;

}  // namespace halfspace::bench

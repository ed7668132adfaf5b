// Boxes in the arrays of an engine, tested by the unchecked calls: by the
// chosen target, and by the table of one target.
#include <halfspace/kernels.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

// Boxes of side 1 in a row, 2 apart.
struct Scene {
  std::size_t n = 1000;
  std::vector<float> min_x, max_x, min_yz, max_yz;

  Scene() : min_yz(n, 0.0f), max_yz(n, 1.0f) {
    for (std::size_t i = 0; i < n; ++i) {
      min_x.push_back(2.0f * static_cast<float>(i));
      max_x.push_back(min_x.back() + 1);
    }
  }
};

std::size_t CountBits(const std::vector<std::uint64_t>& mask) {
  std::size_t count = 0;
  for (std::uint64_t word : mask) {
    for (; word != 0; word &= word - 1) ++count;
  }
  return count;
}

std::size_t Call(const Scene& scene) {
  const float* planes[] = {scene.min_x.data(),  scene.min_yz.data(),
                           scene.min_yz.data(), scene.max_x.data(),
                           scene.max_yz.data(), scene.max_yz.data()};
  const float query[] = {10, 0, 0, 20, 1, 1};  // min x y z, max x y z
  std::vector<std::uint64_t> mask((scene.n + 63) / 64);
  halfspace::SurvivorsOfBoxes3(planes, scene.n, query, mask.data());
  return CountBits(mask);
}

std::size_t Table(const Scene& scene) {
  const float* planes[] = {scene.min_x.data(),  scene.min_yz.data(),
                           scene.min_yz.data(), scene.max_x.data(),
                           scene.max_yz.data(), scene.max_yz.data()};
  const float queries[] = {10, 0, 0, 20, 1, 1,   // one
                           40, 0, 0, 41, 1, 1};  // after the other
  const std::size_t words = (scene.n + 63) / 64;
  std::vector<std::uint64_t> masks(2 * words);
  const auto& kernels = halfspace::KernelsOf();
  kernels.boxes3.several(planes, scene.n, queries, 2, masks.data());
  return CountBits(masks);
}

}  // namespace

int main() {
  const Scene scene;
  const std::size_t of_one = Call(scene);
  const std::size_t of_two = Table(scene);
  std::printf("%zu boxes could touch the query, %zu one of two\n", of_one,
              of_two);
  return of_one == 6 && of_two == 7 ? 0 : 1;
}

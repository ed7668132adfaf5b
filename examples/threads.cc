// Which of many boxes could each of many queries touch? Every thread takes a
// range of the world, and all of them fill the same rows of masks, each its own
// words of them, so no lock is needed.
#include <halfspace/halfspace.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <thread>
#include <vector>

int main() {
  // A street of houses, and cars that drive along it.
  halfspace::AabbWorld2 houses;
  for (int i = 0; i < 100000; ++i) {
    const auto x = static_cast<float>(20 * i);
    houses.Push({{x, 5}, {x + 8, 15}});
  }
  std::vector<halfspace::Aabb2> cars;
  for (int i = 0; i < 64; ++i) {
    const auto x = static_cast<float>(31253 * i);
    cars.push_back({{x, 0}, {x + 4, 6}});
  }

  // Row q is the mask of cars[q].
  const std::size_t words = halfspace::MaskWords(houses.size());
  std::vector<std::uint64_t> rows(cars.size() * words);

  // As many words for each thread; the last one's range ends past the world.
  const std::size_t threads =
      std::clamp<std::size_t>(std::thread::hardware_concurrency(), 2, 16);
  const std::size_t objects = 64 * (words / threads + 1);
  {
    std::vector<std::thread> workers;
    for (std::size_t t = 0; t < threads; ++t) {
      const halfspace::Range range{t * objects, (t + 1) * objects};
      workers.emplace_back([&, t, range] {
        halfspace::SurvivorMasks(houses, cars,
                                 std::span(rows).subspan(t * objects / 64),
                                 {.range = range}, words);
      });
    }
    for (std::thread& worker : workers) worker.join();
  }

  const std::size_t near = halfspace::CountBits(rows);
  std::printf("%zu cars are at a house\n", near);

  // The calls alone, without threads, say the same.
  std::vector<std::size_t> counts(cars.size());
  halfspace::SurvivorCounts(houses, cars, counts);
  std::size_t expected = 0;
  for (std::size_t count : counts) expected += count;
  return near == expected ? 0 : 1;
}
